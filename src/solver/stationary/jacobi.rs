//! Jacobi's method: every unknown solves its own equation, all at once.
//!
//! ```text
//! Lᵢ ← Lᵢ + (E + K L − L)ᵢ / (1 − Kᵢᵢ)
//! ```
//!
//! Needs ρ(K) < 1 and Kᵢᵢ < 1. One product a sweep. Flat patches do not see themselves, so there it is the Neumann series; cells of
//! a medium and glossy bins do. Source: Jacobi (1845); Saad (2003), §4.1.

use crate::linalg::{Block, Doubled, Equation, Residual};
use crate::solver::monitor::Monitor;
use crate::solver::report::relative_residual;
use crate::solver::{Attempt, Observer, SolveError, Solver};

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

    fn tolerance(&self) -> Option<f64> {
        Some(self.tolerance)
    }

    fn attempt<'a>(&self, equation: Equation<'a>, observer: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        let monitor = Monitor::new(self.name(), equation, self.tolerance, observer);
        let mut steps = one_minus_diagonal(self.name(), equation)?;
        steps.values_mut().iter_mut().for_each(|own| *own = 1.0 / *own);
        step_along_residuals(equation, monitor, &steps)
    }
}

/// Lᵢ ← Lᵢ + sᵢ (E + K L − L)ᵢ until the residual is below the tolerance, with steps s, n × bands. One product a step.
pub(super) fn step_along_residuals<'a>(
    equation: Equation<'a>,
    mut monitor: Monitor<'_>,
    steps: &Block,
) -> Result<Attempt<'a>, SolveError> {
    let mut radiance = Doubled::from(equation.emission.clone());
    let mut evaluated = Residual::new(equation);
    let mut residual = Block::zeros(equation.n_unknowns(), equation.n_bands());
    let stop = loop {
        evaluated.evaluate(&radiance.high, Some(&radiance.low), &mut residual);
        monitor.count_applies(1);
        if let Some(stop) = monitor.check(relative_residual(equation.emission, &residual), &radiance.high)? {
            break stop;
        }
        residual.values_mut().iter_mut().zip(steps.values()).for_each(|(r, step)| *r *= step);
        radiance.add(&residual);
    };
    Ok(Attempt::ended(radiance, stop, monitor))
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
