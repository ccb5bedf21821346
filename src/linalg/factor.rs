//! Dense factorizations: faer's, and nalgebra's as an independent check.
//!
//! faer splits its work by the degree of parallelism it is told, which would make the bits depend on the number of threads; here the
//! degree is fixed, and rayon may run the parts on as many threads as there are.

use super::{Block, Dense, LinearOperator};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::{cholesky::llt, lu::partial_pivoting as lu};
use faer::perm::PermRef;
use faer::prelude::default;
use faer::{Conj, Mat, MatMut, Par};
use thiserror::Error;

/// Parts that a factorization is split into, on any number of threads.
const DEGREE: usize = 4;

/// A matrix that has no inverse, or not the factorization asked for.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum FactorError {
    #[error("the matrix is singular: pivot {pivot} of {size} is {value:e}")]
    Singular { pivot: usize, size: usize, value: f64 },
    #[error("the matrix is not positive definite: pivot {pivot} of {size} is not above zero")]
    NotPositiveDefinite { pivot: usize, size: usize },
    #[error("entry ({row}, {column}) of the matrix is {value}")]
    NotFinite { row: usize, column: usize, value: f64 },
    #[error("K must be at least 0 everywhere, and entry ({row}, {column}) is {value:e}")]
    Negative { row: usize, column: usize, value: f64 },
    #[error("no row of K may gain more than 1, and row {row} loses {loss:e}")]
    Gain { row: usize, loss: f64 },
}

/// A square matrix A that is factored once and solved for many right-hand sides.
pub trait Factorization: Send + Sync {
    /// x ← A⁻¹ x for every column.
    fn solve(&self, x: &mut Block);

    /// x ← A⁻ᵀ x for every column.
    fn solve_transpose(&self, x: &mut Block);
}

impl Dense {
    /// # Errors
    /// [`FactorError::NotFinite`] with the first entry that is not.
    pub fn check_finite(&self) -> Result<(), FactorError> {
        check_finite(self)
    }
}

pub(super) fn check_finite(a: &Dense) -> Result<(), FactorError> {
    match a.values().iter().position(|v| !v.is_finite()) {
        None => Ok(()),
        Some(k) => {
            let (row, column) = (k / a.n_columns(), k % a.n_columns());
            Err(FactorError::NotFinite { row, column, value: a.get(row, column) })
        }
    }
}

/// Rows and columns of the tiles that a matrix is turned in, so that both ways of going through it stay in the cache.
const TILE: usize = 16;

/// A matrix by rows as faer's by columns, its entries as they are stored there; if so wanted, of the tiles above the diagonal only zeros.
pub(super) fn by_columns<T: Copy + Default>(a: &Dense, is_lower: bool, store: impl Fn(f64) -> T) -> Mat<T> {
    let n = a.n_rows();
    let mut matrix = Mat::from_fn(n, n, |_, _| T::default());
    for first in (0..n).step_by(TILE) {
        for top in (if is_lower { first } else { 0 }..n).step_by(TILE) {
            let rows = top..(top + TILE).min(n);
            for c in first..(first + TILE).min(n) {
                let column = &mut matrix.col_as_slice_mut(c)[rows.clone()];
                column.iter_mut().zip(rows.clone()).for_each(|(v, r)| *v = store(a.get(r, c)));
            }
        }
    }
    matrix
}

/// The block as faer's matrix.
pub(super) fn view(block: &mut Block) -> MatMut<'_, f64> {
    let (n, m) = (block.n_rows(), block.n_columns());
    MatMut::from_column_major_slice_mut(block.values_mut(), n, m)
}

/// P A = L U with partial pivoting. Cost ⅔ n³.
pub struct LuFactor {
    factors: Mat<f64>,
    forward: Vec<usize>,
    backward: Vec<usize>,
}

impl LuFactor {
    /// # Errors
    /// [`FactorError::Singular`] at an exactly zero pivot, [`FactorError::NotFinite`].
    pub fn new(a: &Dense) -> Result<Self, FactorError> {
        check_finite(a)?;
        let n = a.n_rows();
        let mut factors = by_columns(a, false, |v| v);
        let (mut forward, mut backward) = (vec![0; n], vec![0; n]);
        let parallel = Par::rayon(DEGREE);
        let scratch = lu::factor::lu_in_place_scratch::<usize, f64>(n, n, parallel, default());
        lu::factor::lu_in_place(
            factors.as_mut(),
            &mut forward,
            &mut backward,
            parallel,
            MemStack::new(&mut MemBuffer::new(scratch)),
            default(),
        );
        match (0..n).map(|k| (k, factors[(k, k)])).find(|(_, pivot)| *pivot == 0.0 || !pivot.is_finite()) {
            Some((pivot, value)) => Err(FactorError::Singular { pivot, size: n, value }),
            None => Ok(Self { factors, forward, backward }),
        }
    }

    /// x ← A⁻¹ x for every column. Cost 2 n² a column.
    pub fn solve(&self, x: &mut Block) {
        let n = self.forward.len();
        let scratch = lu::solve::solve_in_place_scratch::<usize, f64>(n, x.n_columns(), Par::Seq);
        lu::solve::solve_in_place_with_conj(
            self.factors.as_ref(),
            self.factors.as_ref(),
            PermRef::new_checked(&self.forward, &self.backward, n),
            Conj::No,
            view(x),
            Par::Seq,
            MemStack::new(&mut MemBuffer::new(scratch)),
        );
    }
}

impl Factorization for LuFactor {
    fn solve(&self, x: &mut Block) {
        self.solve(x);
    }

    fn solve_transpose(&self, x: &mut Block) {
        let n = self.forward.len();
        let scratch = lu::solve::solve_transpose_in_place_scratch::<usize, f64>(n, x.n_columns(), Par::Seq);
        lu::solve::solve_transpose_in_place_with_conj(
            self.factors.as_ref(),
            self.factors.as_ref(),
            PermRef::new_checked(&self.forward, &self.backward, n),
            Conj::No,
            view(x),
            Par::Seq,
            MemStack::new(&mut MemBuffer::new(scratch)),
        );
    }
}

/// A = L Lᵀ for symmetric positive definite A; reads the lower triangle. Cost ⅓ n³.
pub struct CholeskyFactor(Mat<f64>);

impl CholeskyFactor {
    /// # Errors
    /// [`FactorError::NotPositiveDefinite`] with the pivot, [`FactorError::NotFinite`].
    pub fn new(a: &Dense) -> Result<Self, FactorError> {
        check_finite(a)?;
        let n = a.n_rows();
        let mut factor = by_columns(a, true, |v| v);
        let parallel = Par::rayon(DEGREE);
        let scratch = llt::factor::cholesky_in_place_scratch::<f64>(n, parallel, default());
        llt::factor::cholesky_in_place(
            factor.as_mut(),
            default(),
            parallel,
            MemStack::new(&mut MemBuffer::new(scratch)),
            default(),
        )
        .map_err(|error| {
            let llt::factor::LltError::NonPositivePivot { index } = error;
            FactorError::NotPositiveDefinite { pivot: index, size: n }
        })?;
        Ok(Self(factor))
    }

    /// x ← A⁻¹ x for every column. Cost 2 n² a column.
    pub fn solve(&self, x: &mut Block) {
        let scratch = llt::solve::solve_in_place_scratch::<f64>(self.0.nrows(), x.n_columns(), Par::Seq);
        let stack = &mut MemBuffer::new(scratch);
        llt::solve::solve_in_place_with_conj(self.0.as_ref(), Conj::No, view(x), Par::Seq, MemStack::new(stack));
    }
}

impl Factorization for CholeskyFactor {
    fn solve(&self, x: &mut Block) {
        self.solve(x);
    }

    fn solve_transpose(&self, x: &mut Block) {
        self.solve(x);
    }
}

/// P A = L U by nalgebra: slower, and sharing no line with faer.
pub struct NalgebraLu(nalgebra::LU<f64, nalgebra::Dyn, nalgebra::Dyn>);

impl NalgebraLu {
    /// # Errors
    /// As [`LuFactor::new`].
    pub fn new(a: &Dense) -> Result<Self, FactorError> {
        check_finite(a)?;
        let n = a.n_rows();
        let factor = nalgebra::DMatrix::from_row_slice(n, n, a.values()).lu();
        let pivots = factor.u().diagonal();
        match pivots.iter().enumerate().find(|(_, pivot)| **pivot == 0.0 || !pivot.is_finite()) {
            Some((pivot, value)) => Err(FactorError::Singular { pivot, size: n, value: *value }),
            None => Ok(Self(factor)),
        }
    }

    /// x ← A⁻¹ x for every column.
    pub fn solve(&self, x: &mut Block) {
        for c in 0..x.n_columns() {
            let mut column = nalgebra::DVector::from_column_slice(x.column(c));
            let solved = self.0.solve_mut(&mut column);
            debug_assert!(solved, "pivots were checked");
            x.column_mut(c).copy_from_slice(column.as_slice());
        }
    }
}

impl Factorization for NalgebraLu {
    fn solve(&self, x: &mut Block) {
        self.solve(x);
    }

    fn solve_transpose(&self, x: &mut Block) {
        // Aᵀ = Uᵀ Lᵀ P.
        for c in 0..x.n_columns() {
            let mut column = nalgebra::DVector::from_column_slice(x.column(c));
            let solved = self.0.u().tr_solve_upper_triangular_mut(&mut column)
                && self.0.l().tr_solve_lower_triangular_mut(&mut column);
            debug_assert!(solved, "pivots were checked");
            self.0.p().inv_permute_rows(&mut column);
            x.column_mut(c).copy_from_slice(column.as_slice());
        }
    }
}
