//! The Neumann series, bounce by bounce.
//!
//! ```text
//! L = E + K E + K² E + …
//! ```
//!
//! Needs ρ(K) < 1. One product a bounce; after k bounces the residual *is* the next term, Kᵏ⁺¹E. Never better than the spectral
//! radius. Source: Neumann (1877); as bounces of light, Kajiya (1986), eq. 7.

use crate::linalg::{Block, Equation};
use crate::solver::monitor::Monitor;
use crate::solver::report::relative_residual;
use crate::solver::{Attempt, Observer, SolveError, Solver};

/// Sums bounces until the next one is below the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neumann {
    /// On ‖E + K L − L‖∞ / ‖E‖∞.
    pub tolerance: f64,
}

impl Solver for Neumann {
    fn name(&self) -> &'static str {
        "neumann"
    }

    fn tolerance(&self) -> Option<f64> {
        Some(self.tolerance)
    }

    fn attempt<'a>(&self, equation: Equation<'a>, observer: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        let mut monitor = Monitor::new(self.name(), equation, self.tolerance, observer);
        let mut radiance = equation.emission.clone();
        let mut term = equation.emission.clone();
        let mut next = Block::zeros(term.n_rows(), term.n_columns());
        let stop = loop {
            // The next bounce is the residual of the sum so far.
            equation.transport.apply(&term, &mut next);
            monitor.count_applies(1);
            std::mem::swap(&mut term, &mut next);
            if let Some(stop) = monitor.check(relative_residual(equation.emission, &term), &radiance)? {
                break stop;
            }
            radiance.add_scaled(1.0, &term);
        };
        Ok(Attempt::ended(radiance, stop, monitor))
    }
}
