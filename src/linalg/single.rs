//! LU in single precision: half the room and half the time, and seven digits.

use super::factor::{by_columns, check_finite};
use super::{Dense, FactorError, LinearOperator};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting as lu;
use faer::perm::PermRef;
use faer::prelude::default;
use faer::{Conj, Mat, MatMut, Par};

/// Parts that a factorization is split into, on any number of threads.
const DEGREE: usize = 4;

/// P A = L U with partial pivoting, A rounded to f32. Cost ⅔ n³ in f32.
pub struct SingleLuFactor {
    factors: Mat<f32>,
    forward: Vec<usize>,
    backward: Vec<usize>,
    /// Room to solve in.
    rounded: Vec<f32>,
    stack: MemBuffer,
}

impl SingleLuFactor {
    /// # Errors
    /// [`FactorError::NotFinite`]; [`FactorError::Singular`] at a pivot that is zero in single precision.
    pub fn new(a: &Dense) -> Result<Self, FactorError> {
        check_finite(a)?;
        let n = a.n_rows();
        let mut factors = by_columns(a, false, |v| v as f32);
        let (mut forward, mut backward) = (vec![0; n], vec![0; n]);
        let parallel = Par::rayon(DEGREE);
        let scratch = lu::factor::lu_in_place_scratch::<usize, f32>(n, n, parallel, default());
        let stack = &mut MemBuffer::new(scratch);
        lu::factor::lu_in_place(
            factors.as_mut(),
            &mut forward,
            &mut backward,
            parallel,
            MemStack::new(stack),
            default(),
        );
        match (0..n).map(|k| (k, factors[(k, k)])).find(|(_, pivot)| *pivot == 0.0 || !pivot.is_finite()) {
            Some((pivot, value)) => Err(FactorError::Singular { pivot, size: n, value: value.into() }),
            None => {
                let scratch = lu::solve::solve_in_place_scratch::<usize, f32>(n, 1, Par::Seq);
                Ok(Self { factors, forward, backward, rounded: vec![0.0; n], stack: MemBuffer::new(scratch) })
            }
        }
    }

    /// x ← A⁻¹ x to single precision; x is scaled to 1 before it is rounded, so that no size of it is out of range. Cost 2 n², and no
    /// allocation.
    pub fn solve(&mut self, x: &mut [f64]) {
        let n = self.forward.len();
        let scale = super::max_abs(x);
        if scale == 0.0 {
            return;
        }
        self.rounded.iter_mut().zip(&*x).for_each(|(rounded, v)| *rounded = (v / scale) as f32);
        lu::solve::solve_in_place_with_conj(
            self.factors.as_ref(),
            self.factors.as_ref(),
            PermRef::new_checked(&self.forward, &self.backward, n),
            Conj::No,
            MatMut::from_column_major_slice_mut(&mut self.rounded, n, 1),
            Par::Seq,
            MemStack::new(&mut self.stack),
        );
        x.iter_mut().zip(&self.rounded).for_each(|(x, v)| *x = f64::from(*v) * scale);
    }
}
