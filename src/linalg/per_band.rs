//! A matrix of its own for every band.

use super::{Block, LinearOperator, Matrix, Scratch};

/// Matrices of one shape, band by band.
#[derive(Clone, Debug, PartialEq)]
pub struct PerBand {
    bands: Vec<Matrix>,
    scratch: [Scratch; 2],
}

impl PerBand {
    /// At least one, all of one shape.
    pub fn new(bands: Vec<Matrix>) -> Self {
        let shapes: Vec<_> = bands.iter().map(|matrix| (matrix.n_rows(), matrix.n_columns())).collect();
        assert!(!shapes.is_empty() && shapes.windows(2).all(|pair| pair[0] == pair[1]));
        Self { bands, scratch: Default::default() }
    }

    /// y ← op(x), column by column.
    fn each(&self, x: &Block, y: &mut Block, operator: impl Fn(&Matrix, &Block, &mut Block)) {
        assert_eq!(x.n_columns(), self.bands.len(), "one column a band");
        for (c, matrix) in self.bands.iter().enumerate() {
            self.scratch[0].with(x.n_rows(), 1, |from| {
                self.scratch[1].with(y.n_rows(), 1, |to| {
                    from.column_mut(0).copy_from_slice(x.column(c));
                    operator(matrix, from, to);
                    y.column_mut(c).copy_from_slice(to.column(0));
                });
            });
        }
    }
}

impl LinearOperator for PerBand {
    fn n_rows(&self) -> usize {
        self.bands[0].n_rows()
    }

    fn n_columns(&self) -> usize {
        self.bands[0].n_columns()
    }

    fn n_bands(&self) -> usize {
        self.bands.len()
    }

    fn apply(&self, x: &Block, y: &mut Block) {
        self.each(x, y, |matrix, x, y| matrix.apply(x, y));
    }

    fn apply_transpose(&self, x: &Block, y: &mut Block) {
        self.each(x, y, |matrix, x, y| matrix.apply_transpose(x, y));
    }

    fn row(&self, band: usize, row: usize, out: &mut [f64]) {
        self.bands[band].row(0, row, out);
    }

    fn column(&self, band: usize, column: usize, out: &mut [f64]) {
        self.bands[band].column(0, column, out);
    }

    fn diagonal(&self, band: usize, out: &mut [f64]) {
        self.bands[band].diagonal(0, out);
    }

    fn is_nonnegative(&self) -> bool {
        self.bands.iter().all(LinearOperator::is_nonnegative)
    }

    fn n_entries(&self) -> u64 {
        self.bands.iter().map(LinearOperator::n_entries).sum()
    }
}
