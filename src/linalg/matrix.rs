//! A matrix that is stored, full or sparse.

use super::{Block, Dense, LinearOperator, Sparse};
use rayon::prelude::*;

/// Stored entries, in whichever form takes less room.
#[derive(Clone, Debug, PartialEq)]
pub enum Matrix {
    Dense(Dense),
    Sparse(Sparse),
}

/// Below this share of nonzeros, CSR (12 bytes an entry, gathered reads) beats a full matrix.
const SPARSE_BELOW: f64 = 0.3;

impl Matrix {
    /// The symmetric n × n matrix whose upper triangle (diagonal included) is given row by row, columns ascending. Both triangles
    /// hold the same bits.
    pub fn symmetric(upper: &[Vec<(u32, f64)>]) -> Self {
        let n = upper.len();
        let n_upper: usize = upper.iter().map(Vec::len).sum();
        if (2 * n_upper) as f64 > SPARSE_BELOW * (n * n) as f64 {
            let mut dense = Dense::zeros(n, n);
            for (r, row) in upper.iter().enumerate() {
                row.iter().for_each(|(c, v)| dense.row_mut(r)[*c as usize] = *v);
            }
            mirror(&mut dense);
            return Self::Dense(dense);
        }
        let mut rows: Vec<Vec<(u32, f64)>> = vec![Vec::new(); n];
        for (r, row) in upper.iter().enumerate() {
            for &(c, v) in row {
                rows[r].push((c, v));
                if c as usize != r {
                    rows[c as usize].push((r as u32, v));
                }
            }
        }
        rows.par_iter_mut().for_each(|row| row.sort_unstable_by_key(|entry| entry.0));
        Self::Sparse(Sparse::from_rows(n, &rows))
    }

    /// Entry (r, c) ← map(r, c, entry), for the stored entries.
    pub fn map_entries(&mut self, map: impl Fn(usize, usize, f64) -> f64 + Sync) {
        match self {
            Self::Dense(dense) => {
                let n = dense.n_columns().max(1);
                let rows = dense.values_mut().par_chunks_mut(n).enumerate();
                rows.for_each(|(r, row)| row.iter_mut().enumerate().for_each(|(c, v)| *v = map(r, c, *v)));
            }
            Self::Sparse(sparse) => sparse.map_entries(map),
        }
    }

    /// Calls `visit(column, value)` for the stored entries of a row, columns ascending.
    pub fn for_each_in_row(&self, row: usize, mut visit: impl FnMut(usize, f64)) {
        match self {
            Self::Dense(dense) => dense.row_slice(row).iter().enumerate().for_each(|(c, v)| visit(c, *v)),
            Self::Sparse(sparse) => {
                let (columns, values) = sparse.row_entries(row);
                columns.iter().zip(values).for_each(|(c, v)| visit(*c as usize, *v));
            }
        }
    }

    /// Bytes held.
    pub fn n_bytes(&self) -> u64 {
        match self {
            Self::Dense(dense) => 8 * dense.n_entries(),
            Self::Sparse(sparse) => 12 * sparse.n_entries(),
        }
    }

    fn operator(&self) -> &dyn LinearOperator {
        match self {
            Self::Dense(dense) => dense,
            Self::Sparse(sparse) => sparse,
        }
    }
}

/// Copies the upper triangle onto the lower one, tile by tile for the cache's sake.
fn mirror(dense: &mut Dense) {
    const TILE: usize = 64;
    let n = dense.n_rows();
    let values = dense.values_mut();
    for top in (0..n).step_by(TILE) {
        for left in (top..n).step_by(TILE) {
            for r in top..(top + TILE).min(n) {
                for c in left.max(r + 1)..(left + TILE).min(n) {
                    values[c * n + r] = values[r * n + c];
                }
            }
        }
    }
}

impl LinearOperator for Matrix {
    fn n_rows(&self) -> usize {
        self.operator().n_rows()
    }

    fn n_columns(&self) -> usize {
        self.operator().n_columns()
    }

    fn n_bands(&self) -> usize {
        1
    }

    fn apply(&self, x: &Block, y: &mut Block) {
        self.operator().apply(x, y);
    }

    fn apply_transpose(&self, x: &Block, y: &mut Block) {
        self.operator().apply_transpose(x, y);
    }

    fn row(&self, band: usize, row: usize, out: &mut [f64]) {
        self.operator().row(band, row, out);
    }

    fn column(&self, band: usize, column: usize, out: &mut [f64]) {
        self.operator().column(band, column, out);
    }

    fn is_nonnegative(&self) -> bool {
        self.operator().is_nonnegative()
    }

    fn n_entries(&self) -> u64 {
        self.operator().n_entries()
    }
}
