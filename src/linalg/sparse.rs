//! Sparse matrices, compressed by rows.

use super::{Block, LinearOperator};
use rayon::prelude::*;
use sprs::CsMatI;

/// n_rows × n_columns in CSR with u32 columns. As an operator it is grey. The container is `sprs`'s.
#[derive(Clone, Debug, PartialEq)]
pub struct Sparse(CsMatI<f64, u32, usize>);

impl Sparse {
    /// From the nonzeros of every row, columns ascending.
    pub fn from_rows(n_columns: usize, rows: &[Vec<(u32, f64)>]) -> Self {
        let mut starts = Vec::with_capacity(rows.len() + 1);
        starts.push(0);
        starts.extend(rows.iter().scan(0, |end, row| {
            *end += row.len();
            Some(*end)
        }));
        let columns = rows.iter().flatten().map(|entry| entry.0).collect();
        let values = rows.iter().flatten().map(|entry| entry.1).collect();
        Self(CsMatI::new((rows.len(), n_columns), starts, columns, values))
    }

    /// The nonzeros of one band of any operator.
    pub fn from_operator(operator: &dyn LinearOperator, band: usize) -> Self {
        let row = |r| {
            let mut full = vec![0.0; operator.n_columns()];
            operator.row(band, r, &mut full);
            let nonzero = full.iter().enumerate().filter(|(_, v)| **v != 0.0);
            nonzero.map(|(c, v)| (c as u32, *v)).collect::<Vec<_>>()
        };
        let rows: Vec<_> = (0..operator.n_rows()).into_par_iter().map(row).collect();
        Self::from_rows(operator.n_columns(), &rows)
    }

    /// The `sprs` matrix itself.
    pub fn as_sprs(&self) -> &CsMatI<f64, u32, usize> {
        &self.0
    }

    /// Columns and values of one row.
    pub fn row_entries(&self, r: usize) -> (&[u32], &[f64]) {
        let range = self.0.indptr().outer_inds_sz(r);
        (&self.0.indices()[range.clone()], &self.0.data()[range])
    }

    /// Entry (r, c) ← map(r, c, entry), for the stored entries.
    pub(super) fn map_entries(&mut self, map: impl Fn(usize, usize, f64) -> f64) {
        let n_rows = self.0.rows();
        let starts = self.0.indptr().raw_storage().to_vec();
        let columns = self.0.indices().to_vec();
        let values = self.0.data_mut();
        for r in 0..n_rows {
            for k in starts[r]..starts[r + 1] {
                values[k] = map(r, columns[k] as usize, values[k]);
            }
        }
    }
}

impl LinearOperator for Sparse {
    fn n_rows(&self) -> usize {
        self.0.rows()
    }

    fn n_columns(&self) -> usize {
        self.0.cols()
    }

    fn n_bands(&self) -> usize {
        1
    }

    fn apply(&self, x: &Block, y: &mut Block) {
        assert_eq!((x.n_rows(), y.n_rows(), x.n_columns()), (self.n_columns(), self.n_rows(), y.n_columns()));
        for c in 0..x.n_columns() {
            let x = x.column(c);
            y.column_mut(c).par_iter_mut().enumerate().with_min_len(64).for_each(|(r, y)| {
                let (columns, values) = self.row_entries(r);
                *y = columns.iter().zip(values).map(|(c, v)| v * x[*c as usize]).sum();
            });
        }
    }

    fn apply_transpose(&self, x: &Block, y: &mut Block) {
        assert_eq!((x.n_rows(), y.n_rows(), x.n_columns()), (self.n_rows(), self.n_columns(), y.n_columns()));
        for c in 0..x.n_columns() {
            let (x, y) = (x.column(c), y.column_mut(c));
            y.fill(0.0);
            for (r, x) in x.iter().enumerate() {
                let (columns, values) = self.row_entries(r);
                columns.iter().zip(values).for_each(|(c, v)| y[*c as usize] += v * x);
            }
        }
    }

    fn row(&self, _band: usize, row: usize, out: &mut [f64]) {
        out.fill(0.0);
        let (columns, values) = self.row_entries(row);
        columns.iter().zip(values).for_each(|(c, v)| out[*c as usize] = *v);
    }

    fn column(&self, _band: usize, column: usize, out: &mut [f64]) {
        for (r, out) in out.iter_mut().enumerate() {
            let (columns, values) = self.row_entries(r);
            *out = columns.binary_search(&(column as u32)).map_or(0.0, |k| values[k]);
        }
    }

    fn n_entries(&self) -> u64 {
        self.0.nnz() as u64
    }
}
