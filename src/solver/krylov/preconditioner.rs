//! Approximations of I − K that are cheap to invert.

use super::inner::{Inner, add_scaled, one_minus_transport};
use crate::linalg::{Block, Equation};
use crate::solver::SolveError;
use crate::solver::report::Work;
use crate::solver::stationary::one_minus_diagonal;

/// A way to approximate (I − K)⁻¹. Applied from the right, so that residuals stay those of L.
pub trait Preconditioner {
    /// Makes ready for one equation on behalf of a method; what it costs is added to `work`.
    ///
    /// # Errors
    /// An equation it cannot approximate, in the name of the method.
    fn prepare<'a>(
        &self,
        method: &'static str,
        equation: Equation<'a>,
        work: &mut Work,
    ) -> Result<Box<dyn Prepared + 'a>, SolveError>;
}

/// A preconditioner that is ready for its equation.
pub trait Prepared {
    /// out ← P⁻¹ x for every band; what it costs is added to `work`. Allocates nothing.
    fn apply(&mut self, x: &Block, out: &mut Block, work: &mut Work);
}

/// P = 1 − Kᵢᵢ: what an unknown keeps for itself. The identity where patches are flat. Free.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnGain;

impl Preconditioner for OwnGain {
    fn prepare<'a>(
        &self,
        method: &'static str,
        equation: Equation<'a>,
        _: &mut Work,
    ) -> Result<Box<dyn Prepared + 'a>, SolveError> {
        Ok(Box::new(Own(one_minus_diagonal(method, equation)?)))
    }
}

struct Own(Block);

impl Prepared for Own {
    fn apply(&mut self, x: &Block, out: &mut Block, _: &mut Work) {
        for ((y, x), own) in out.values_mut().iter_mut().zip(x.values()).zip(self.0.values()) {
            *y = x / own;
        }
    }
}

/// Some steps along the residual, each as long as lowers it most. P depends on what it is applied to: only flexible methods may use it.
///
/// ```text
/// z ← z + α r,      r ← r − α (I − K) r,      α = ⟨(I − K) r, r⟩ / ‖(I − K) r‖²
/// ```
///
/// One product a step. Source: Saad (2003), algorithm 5.3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MinimalResidual {
    pub n_steps: usize,
}

impl Preconditioner for MinimalResidual {
    fn prepare<'a>(
        &self,
        _: &'static str,
        equation: Equation<'a>,
        _: &mut Work,
    ) -> Result<Box<dyn Prepared + 'a>, SolveError> {
        let zeros = || Block::zeros(equation.n_unknowns(), equation.n_bands());
        Ok(Box::new(Steps { equation, n_steps: self.n_steps, residual: zeros(), image: zeros() }))
    }
}

struct Steps<'a> {
    equation: Equation<'a>,
    n_steps: usize,
    residual: Block,
    image: Block,
}

impl Prepared for Steps<'_> {
    fn apply(&mut self, x: &Block, out: &mut Block, work: &mut Work) {
        let inner = Inner::of(self.equation);
        self.residual.copy_from(x);
        out.values_mut().fill(0.0);
        for _ in 0..self.n_steps {
            one_minus_transport(self.equation, &self.residual, &mut self.image);
            work.count_applies(1);
            for band in 0..x.n_columns() {
                let (r, image) = (self.residual.column_mut(band), self.image.column(band));
                let size = inner.dot(image, image);
                if size > 0.0 {
                    let step = inner.dot(image, r) / size;
                    add_scaled(out.column_mut(band), step, r);
                    add_scaled(r, -step, image);
                }
            }
        }
    }
}
