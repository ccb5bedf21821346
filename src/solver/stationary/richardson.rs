//! Richardson's iteration: the Neumann series, every step scaled.
//!
//! ```text
//! L ← L + ω (E + K L − L),      best at  ω = 2 / (λ₋ + λ₊)  of the eigenvalues of I − K
//! ```
//!
//! ω = 1 is the Neumann series; an ω that is given must keep |1 − ω λ| < 1, as 0 < ω ≤ 1 does for K ≥ 0 with ρ(K) < 1. An ω that is not
//! given is measured, band by band, from the self-adjoint form, which must be there: fourteen products once. One product an iteration.
//! Source: Richardson (1911); Saad (2003), §4.2.1.

use super::interval;
use super::jacobi::step_along_residuals;
use crate::linalg::{Block, Equation};
use crate::solver::monitor::Monitor;
use crate::solver::{Attempt, Observer, SolveError, Solver};

/// Iterates until the residual is below the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Richardson {
    /// On ‖E + K L − L‖∞ / ‖E‖∞.
    pub tolerance: f64,
    /// ω; measured if `None`.
    pub damping: Option<f64>,
}

impl Solver for Richardson {
    fn name(&self) -> &'static str {
        "richardson"
    }

    fn tolerance(&self) -> Option<f64> {
        Some(self.tolerance)
    }

    fn attempt<'a>(&self, equation: Equation<'a>, observer: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        let mut monitor = Monitor::new(self.name(), equation, self.tolerance, observer);
        let damping = match self.damping {
            Some(omega) => vec![omega; equation.n_bands()],
            None => {
                let intervals = interval::measure(self.name(), equation, &mut monitor)?;
                intervals.iter().map(|band| 2.0 / (band.low + band.high)).collect()
            }
        };
        let steps = Block::from_fn(equation.n_unknowns(), equation.n_bands(), |_, band| damping[band]);
        step_along_residuals(equation, monitor, &steps)
    }
}
