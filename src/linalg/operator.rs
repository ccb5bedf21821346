//! The one trait every matrix of this program answers to.

use super::Block;

/// A family of n_rows × n_columns matrices, one a colour band.
///
/// A *grey* operator (`n_bands() == 1`) acts alike on every column of a block, however many; any other acts with band c on column
/// c, and a block must have exactly `n_bands()` columns.
///
/// Implementations give the same bits on any number of threads, and do not allocate per call beyond O(n) scratch.
pub trait LinearOperator: Sync {
    fn n_rows(&self) -> usize;

    fn n_columns(&self) -> usize;

    /// 1 for an operator that is the same in every band.
    fn n_bands(&self) -> usize;

    /// y ← A x, every column by its band.
    fn apply(&self, x: &Block, y: &mut Block);

    /// y ← Aᵀ x, the plain transpose (not the adjoint in the étendue inner product).
    fn apply_transpose(&self, x: &Block, y: &mut Block);

    /// out ← row `row` of the matrix of one band. Cost O(n_columns).
    fn row(&self, band: usize, row: usize, out: &mut [f64]);

    /// out ← column `column` of the matrix of one band. Cost O(n_rows).
    fn column(&self, band: usize, column: usize, out: &mut [f64]);

    /// out ← the diagonal of the matrix of one band. Reads every row unless the implementation knows better.
    fn diagonal(&self, band: usize, out: &mut [f64]) {
        let mut row = vec![0.0; self.n_columns()];
        for (i, slot) in out.iter_mut().enumerate() {
            self.row(band, i, &mut row);
            *slot = row[i];
        }
    }

    /// True if no entry of any band is below zero, or not a number. Reads every row unless the implementation knows better.
    fn is_nonnegative(&self) -> bool {
        let mut row = vec![0.0; self.n_columns()];
        (0..self.n_bands()).all(|band| {
            (0..self.n_rows()).all(|i| {
                self.row(band, i, &mut row);
                row.iter().all(|v| *v >= 0.0)
            })
        })
    }

    /// Stored entries that one apply reads: the currency of the work counts.
    fn n_entries(&self) -> u64;
}
