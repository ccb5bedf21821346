//! Eigenvalues of small symmetric matrices, by nalgebra.

use super::{Dense, LinearOperator};
use nalgebra::{DMatrix, SymmetricEigen};

/// All eigenvalues of a symmetric matrix, largest first. Only the lower triangle is read. Cost some 10 n³.
pub fn symmetric_eigenvalues(matrix: &Dense) -> Vec<f64> {
    let n = matrix.n_rows();
    let mut values: Vec<f64> =
        SymmetricEigen::new(DMatrix::from_row_slice(n, n, matrix.values())).eigenvalues.iter().copied().collect();
    values.sort_by(|a, b| b.total_cmp(a));
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coupled_pair_splits() {
        let matrix = Dense::from_fn(2, 2, |r, c| if r == c { 1.0 } else { 0.25 });
        let values = symmetric_eigenvalues(&matrix);
        // A few ulp of 1.
        assert!((values[0] - 1.25).abs() < 1e-15 && (values[1] - 0.75).abs() < 1e-15, "{values:?}");
    }
}
