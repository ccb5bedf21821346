//! Eigenpairs of small dense matrices, by faer and nalgebra.

use super::{Dense, FactorError, LinearOperator};
use faer::MatRef;
use nalgebra::{DMatrix, SymmetricEigen};

/// An eigenvalue re + i im of a real matrix and its eigenvector, of Euclidean norm 1.
#[derive(Clone, Debug, PartialEq)]
pub struct SmallPair {
    pub re: f64,
    pub im: f64,
    pub vector_re: Vec<f64>,
    pub vector_im: Vec<f64>,
}

/// All eigenpairs of a square matrix, largest magnitude first; of a complex pair the one with im > 0 comes first. Cost some 25 n³.
///
/// # Errors
/// [`FactorError::NotFinite`]; [`FactorError::Singular`] where the iteration for a Schur form gives up.
pub fn eigenpairs(matrix: &Dense) -> Result<Vec<SmallPair>, FactorError> {
    super::factor::check_finite(matrix)?;
    let n = matrix.n_rows();
    let view = MatRef::from_row_major_slice(matrix.values(), n, n);
    let eigen = view.eigen().map_err(|_| FactorError::Singular { pivot: n, size: n, value: f64::NAN })?;
    let (values, vectors) = (eigen.S(), eigen.U());
    let pair = |k: usize| SmallPair {
        re: values[k].re,
        im: values[k].im,
        vector_re: (0..n).map(|i| vectors[(i, k)].re).collect(),
        vector_im: (0..n).map(|i| vectors[(i, k)].im).collect(),
    };
    let mut pairs: Vec<SmallPair> = (0..n).map(pair).collect();
    let magnitude = |pair: &SmallPair| pair.re.hypot(pair.im);
    // Conjugates have one magnitude to the last bit or two: let not rounding choose which comes first.
    pairs.sort_by(|a, b| {
        let is_pair = a.im == -b.im && (a.re - b.re).abs() <= 1e-14 * magnitude(a);
        if is_pair { b.im.total_cmp(&a.im) } else { magnitude(b).total_cmp(&magnitude(a)) }
    });
    Ok(pairs)
}

/// All eigenpairs of a symmetric matrix, largest magnitude first. Only the lower triangle is read. Cost some 10 n³.
pub fn symmetric_eigenpairs(matrix: &Dense) -> Vec<SmallPair> {
    let n = matrix.n_rows();
    let eigen = SymmetricEigen::new(DMatrix::from_row_slice(n, n, matrix.values()));
    let pair = |k: usize| SmallPair {
        re: eigen.eigenvalues[k],
        im: 0.0,
        vector_re: eigen.eigenvectors.column(k).iter().copied().collect(),
        vector_im: vec![0.0; n],
    };
    let mut pairs: Vec<SmallPair> = (0..n).map(pair).collect();
    pairs.sort_by(|a, b| b.re.abs().total_cmp(&a.re.abs()));
    pairs
}

/// All eigenvalues of a symmetric matrix, largest first. Only the lower triangle is read. Cost some 10 n³.
pub fn symmetric_eigenvalues(matrix: &Dense) -> Vec<f64> {
    let mut values: Vec<f64> = symmetric_eigenpairs(matrix).into_iter().map(|pair| pair.re).collect();
    values.sort_by(|a, b| b.total_cmp(a));
    values
}

/// All singular values of a matrix, largest first. Cost some 10 n³.
///
/// # Errors
/// [`FactorError::NotFinite`]; [`FactorError::Singular`] where the iteration gives up.
pub fn singular_values(matrix: &Dense) -> Result<Vec<f64>, FactorError> {
    super::factor::check_finite(matrix)?;
    let (n, m) = (matrix.n_rows(), matrix.n_columns());
    let view = MatRef::from_row_major_slice(matrix.values(), n, m);
    view.singular_values().map_err(|_| FactorError::Singular { pivot: n, size: n, value: f64::NAN })
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

    /// A rotation by 90° with a stretch of 2, beside a 1: eigenvalues ±2i and 1.
    #[test]
    fn a_turn_has_complex_eigenvalues() {
        let entries = [[0.0, -2.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
        let matrix = Dense::from_fn(3, 3, |r, c| entries[r][c]);
        let pairs = eigenpairs(&matrix).unwrap_or_else(|error| panic!("{error}"));
        // A few ulp of 2.
        let close = |a: f64, b: f64| (a - b).abs() < 1e-14;
        assert!(close(pairs[0].im, 2.0) && close(pairs[1].im, -2.0) && close(pairs[2].re, 1.0), "{pairs:?}");
        let values = singular_values(&matrix).unwrap_or_else(|error| panic!("{error}"));
        assert!(close(values[0], 2.0) && close(values[1], 2.0) && close(values[2], 1.0));
    }
}
