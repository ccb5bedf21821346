//! Sparse matrices, compressed by rows.

use super::share::share;
use super::{Block, LinearOperator};
use rayon::prelude::*;
use sprs::CsMatI;

/// Rows that are worth a task.
const ROWS_A_TASK: usize = 64;

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
        Self::from_row_fn(operator.n_rows(), operator.n_columns(), |r, out| operator.row(band, r, out))
    }

    /// The nonzeros of rows that are written out one at a time and a thread: `write(row, out)` has `out` as it left it.
    pub fn from_row_fn(n_rows: usize, n_columns: usize, write: impl Fn(usize, &mut [f64]) + Sync) -> Self {
        let room = || vec![0.0; n_columns];
        let row = |full: &mut Vec<f64>, r: usize| {
            write(r, full);
            let nonzero = full.iter().enumerate().filter(|(_, v)| **v != 0.0);
            nonzero.map(|(c, v)| (c as u32, *v)).collect::<Vec<_>>()
        };
        let rows: Vec<_> = (0..n_rows).into_par_iter().map_init(room, row).collect();
        Self::from_rows(n_columns, &rows)
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

    /// y ← A x for C columns, every row summed in two halves in a fixed order.
    fn apply_columns<const C: usize>(&self, x: [&[f64]; C], y: [&mut [f64]; C]) {
        share(y, 0, ROWS_A_TASK, &|first, mut y| {
            for r in 0..y[0].len() {
                let (columns, values) = self.row_entries(first + r);
                let (pairs, last) = columns.as_chunks::<2>();
                let (entries, tail) = values.as_chunks::<2>();
                let mut sums = [[0.0; 2]; C];
                for (at, v) in pairs.iter().zip(entries) {
                    for (sum, x) in sums.iter_mut().zip(x) {
                        sum[0] += v[0] * x[at[0] as usize];
                        sum[1] += v[1] * x[at[1] as usize];
                    }
                }
                for ((sum, x), y) in sums.iter().zip(x).zip(&mut y) {
                    let tail = last.first().zip(tail.first()).map_or(0.0, |(at, v)| v * x[*at as usize]);
                    y[r] = sum[0] + sum[1] + tail;
                }
            }
        });
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
        // Read every row once for up to four columns.
        for first in (0..x.n_columns()).step_by(4) {
            match x.n_columns() - first {
                1 => self.apply_columns::<1>(x.columns_from(first), y.columns_from_mut(first)),
                2 => self.apply_columns::<2>(x.columns_from(first), y.columns_from_mut(first)),
                3 => self.apply_columns::<3>(x.columns_from(first), y.columns_from_mut(first)),
                _ => self.apply_columns::<4>(x.columns_from(first), y.columns_from_mut(first)),
            }
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

    fn is_nonnegative(&self) -> bool {
        self.0.data().iter().all(|v| *v >= 0.0)
    }

    fn n_entries(&self) -> u64 {
        self.0.nnz() as u64
    }
}
