//! Jacobi's method: every unknown solves its own equation, all at once.
//!
//! ```text
//! Lᵢ ← Lᵢ + (E + K L − L)ᵢ / (1 − Kᵢᵢ)
//! ```
//!
//! Needs ρ(K) < 1 and Kᵢᵢ < 1. One product a sweep. Flat patches do not see themselves, so there it is the Neumann series; cells of
//! a medium and glossy bins do. Source: Jacobi (1845); Saad (2003), §4.1.

use crate::linalg::{Block, Equation};
use crate::solver::monitor::Monitor;
use crate::solver::report::{conclude, relative_residual};
use crate::solver::{Observer, Solution, SolveError, Solver};

/// Sweeps until the residual is below the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jacobi {
    /// On ‖E + K L − L‖∞ / ‖E‖∞.
    pub tolerance: f64,
}

impl Solver for Jacobi {
    fn name(&self) -> &'static str {
        "jacobi"
    }

    fn solve(&self, equation: Equation<'_>, observer: &mut dyn Observer) -> Result<Solution, SolveError> {
        let mut monitor = Monitor::new(self.name(), equation, self.tolerance, observer);
        let own = one_minus_diagonal(self.name(), equation)?;
        let mut radiance = equation.emission.clone();
        let mut residual = Block::zeros(radiance.n_rows(), radiance.n_columns());
        let stop = loop {
            equation.residual(&radiance, &mut residual);
            monitor.count_applies(1);
            if let Some(stop) = monitor.check(relative_residual(equation.emission, &residual), &radiance)? {
                break stop;
            }
            for ((l, r), own) in radiance.values_mut().iter_mut().zip(residual.values()).zip(own.values()) {
                *l += r / own;
            }
        };
        conclude(self.name(), equation, radiance, stop, monitor.work, monitor.history)
    }
}

/// 1 − Kᵢᵢ, n × bands.
///
/// # Errors
/// [`SolveError::SelfGain`] where it is not above zero.
pub(in crate::solver) fn one_minus_diagonal(method: &'static str, equation: Equation<'_>) -> Result<Block, SolveError> {
    let mut own = Block::zeros(equation.n_unknowns(), equation.n_bands());
    for band in 0..equation.n_bands() {
        equation.transport.diagonal(band, own.column_mut(band));
        for (unknown, value) in own.column_mut(band).iter_mut().enumerate() {
            let gain = *value;
            *value = 1.0 - gain;
            if value.is_nan() || *value <= 0.0 {
                return Err(SolveError::SelfGain { method, band, unknown, gain });
            }
        }
    }
    Ok(own)
}
