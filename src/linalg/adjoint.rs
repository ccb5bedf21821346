//! The adjoint of an operator in a weighted inner product.

use super::{Block, LinearOperator, Scratch};

/// K* = M⁻¹ Kᵀ M, so that ⟨a, K b⟩ = ⟨K* a, b⟩ with ⟨a, b⟩ = Σ μᵢ aᵢ bᵢ, for a square operator.
pub struct Adjoint<'a> {
    operator: &'a dyn LinearOperator,
    etendue: &'a [f64],
    scratch: Scratch,
}

impl<'a> Adjoint<'a> {
    /// Of an n × n operator, with n weights above zero.
    pub fn new(operator: &'a dyn LinearOperator, etendue: &'a [f64]) -> Self {
        assert_eq!((operator.n_rows(), operator.n_columns()), (etendue.len(), etendue.len()));
        Self { operator, etendue, scratch: Scratch::default() }
    }

    /// y ← M⁻¹ op(M x).
    fn conjugate(&self, x: &Block, y: &mut Block, operator: impl Fn(&Block, &mut Block), inverted: bool) {
        let weigh = |values: &mut [f64], is_inverse: bool| {
            let pairs = values.iter_mut().zip(self.etendue);
            pairs.for_each(|(v, mu)| if is_inverse { *v /= mu } else { *v *= mu });
        };
        self.scratch.with(x.n_rows(), x.n_columns(), |weighted| {
            weighted.copy_from(x);
            (0..x.n_columns()).for_each(|c| weigh(weighted.column_mut(c), inverted));
            operator(weighted, y);
            (0..y.n_columns()).for_each(|c| weigh(y.column_mut(c), !inverted));
        });
    }
}

impl LinearOperator for Adjoint<'_> {
    fn n_rows(&self) -> usize {
        self.etendue.len()
    }

    fn n_columns(&self) -> usize {
        self.etendue.len()
    }

    fn n_bands(&self) -> usize {
        self.operator.n_bands()
    }

    fn apply(&self, x: &Block, y: &mut Block) {
        self.conjugate(x, y, |x, y| self.operator.apply_transpose(x, y), false);
    }

    fn apply_transpose(&self, x: &Block, y: &mut Block) {
        self.conjugate(x, y, |x, y| self.operator.apply(x, y), true);
    }

    fn row(&self, band: usize, row: usize, out: &mut [f64]) {
        self.operator.column(band, row, out);
        out.iter_mut().zip(self.etendue).for_each(|(v, mu)| *v *= mu / self.etendue[row]);
    }

    fn column(&self, band: usize, column: usize, out: &mut [f64]) {
        self.operator.row(band, column, out);
        out.iter_mut().zip(self.etendue).for_each(|(v, mu)| *v *= self.etendue[column] / mu);
    }

    fn diagonal(&self, band: usize, out: &mut [f64]) {
        self.operator.diagonal(band, out);
    }

    fn n_entries(&self) -> u64 {
        self.operator.n_entries()
    }

    fn is_nonnegative(&self) -> bool {
        self.operator.is_nonnegative()
    }
}
