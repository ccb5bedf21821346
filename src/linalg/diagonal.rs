//! Diagonal operators, one diagonal a band.

use super::{Block, LinearOperator};

/// diag(values) for every band: values is n × bands.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagonal(Block);

impl Diagonal {
    pub fn new(values: Block) -> Self {
        Self(values)
    }

    /// n × bands.
    pub fn values(&self) -> &Block {
        &self.0
    }
}

impl LinearOperator for Diagonal {
    fn n_rows(&self) -> usize {
        self.0.n_rows()
    }

    fn n_columns(&self) -> usize {
        self.0.n_rows()
    }

    fn n_bands(&self) -> usize {
        self.0.n_columns()
    }

    fn apply(&self, x: &Block, y: &mut Block) {
        assert_eq!(x.n_columns(), self.0.n_columns(), "one column a band");
        for ((y, x), d) in y.values_mut().iter_mut().zip(x.values()).zip(self.0.values()) {
            *y = d * x;
        }
    }

    fn apply_transpose(&self, x: &Block, y: &mut Block) {
        self.apply(x, y);
    }

    fn row(&self, band: usize, row: usize, out: &mut [f64]) {
        out.fill(0.0);
        out[row] = self.0.get(row, band);
    }

    fn column(&self, band: usize, column: usize, out: &mut [f64]) {
        self.row(band, column, out);
    }

    fn diagonal(&self, band: usize, out: &mut [f64]) {
        out.copy_from_slice(self.0.column(band));
    }

    fn is_nonnegative(&self) -> bool {
        self.0.values().iter().all(|v| *v >= 0.0)
    }

    fn n_entries(&self) -> u64 {
        self.0.values().len() as u64
    }
}
