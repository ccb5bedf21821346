//! LU in single precision: half the room and half the time, and seven digits.

use super::factor::check_finite;
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
}

impl SingleLuFactor {
    /// # Errors
    /// [`FactorError::NotFinite`]; [`FactorError::Singular`] at a pivot that is zero in single precision.
    pub fn new(a: &Dense) -> Result<Self, FactorError> {
        check_finite(a)?;
        let n = a.n_rows();
        let mut factors = Mat::from_fn(n, n, |r, c| a.get(r, c) as f32);
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
            None => Ok(Self { factors, forward, backward }),
        }
    }

    /// x ← A⁻¹ x to single precision; x is scaled to 1 before it is rounded, so that no size of it is out of range. `room` is room to
    /// work in, kept between calls. Cost 2 n².
    pub fn solve(&self, x: &mut [f64], room: &mut Vec<f32>) {
        let n = self.forward.len();
        let scale = super::max_abs(x);
        if scale == 0.0 {
            return;
        }
        room.clear();
        room.extend(x.iter().map(|v| (v / scale) as f32));
        let scratch = lu::solve::solve_in_place_scratch::<usize, f32>(n, 1, Par::Seq);
        lu::solve::solve_in_place_with_conj(
            self.factors.as_ref(),
            self.factors.as_ref(),
            PermRef::new_checked(&self.forward, &self.backward, n),
            Conj::No,
            MatMut::from_column_major_slice_mut(room, n, 1),
            Par::Seq,
            MemStack::new(&mut MemBuffer::new(scratch)),
        );
        x.iter_mut().zip(room.iter()).for_each(|(x, v)| *x = f64::from(*v) * scale);
    }
}
