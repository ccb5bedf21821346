//! Progressive refinement: shooting, shown with what is yet to be shot as if it had spread evenly.
//!
//! ```text
//! L̂ = L + r + a ambient,      ambient = Σ μᵢ rᵢ / Σ μᵢ (1 − aᵢ),      aᵢ = Σⱼ Kᵢⱼ
//! ```
//!
//! L and r are those of Southwell's shooting, which goes on undisturbed; the answer is L̂, and so is every iterate. Needs Kᵢᵢ < 1; converges
//! for K ≥ 0 with ρ(K) < 1. Two products an iteration: n shots in every band, and one to know the residual of L̂. Source: Cohen, Chen,
//! Wallace and Greenberg (1988).

use super::ambient::Ambient;
use super::jacobi::one_minus_diagonal;
use super::shooting::Shooting;
use crate::linalg::{Block, Equation, Residual};
use crate::solver::monitor::Monitor;
use crate::solver::report::relative_residual;
use crate::solver::{Attempt, Observer, SolveError, Solver};

/// Shoots until the residual of what is shown is below the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progressive {
    /// On ‖E + K L − L‖∞ / ‖E‖∞.
    pub tolerance: f64,
}

impl Solver for Progressive {
    fn name(&self) -> &'static str {
        "progressive"
    }

    fn tolerance(&self) -> Option<f64> {
        Some(self.tolerance)
    }

    fn attempt<'a>(&self, equation: Equation<'a>, observer: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        let mut monitor = Monitor::new(self.name(), equation, self.tolerance, observer);
        let mut shooting = Shooting::new(equation, one_minus_diagonal(self.name(), equation)?);
        let ambient = Ambient::new(equation, &shooting.weights, &mut monitor.work);
        let mut shown = equation.emission.clone();
        let mut evaluated = Residual::new(equation);
        let mut residual = Block::zeros(equation.n_unknowns(), equation.n_bands());
        let stop = loop {
            // Show what is shot with what is not.
            for band in 0..equation.n_bands() {
                let unshot = shooting.residual.column(band);
                let power = shooting.weights.iter().zip(unshot).map(|(mu, r)| mu * r).sum();
                let even = ambient.radiance(band, power);
                let parts = shooting.radiance.column(band).iter().zip(unshot).zip(ambient.gain.column(band));
                let shown = shown.column_mut(band).iter_mut();
                shown.zip(parts).for_each(|(shown, ((l, r), gain))| *shown = l + r + gain * even);
            }
            evaluated.evaluate(&shown, None, &mut residual);
            monitor.count_applies(1);
            if let Some(stop) = monitor.check(relative_residual(equation.emission, &residual), &shown)? {
                break stop;
            }
            shooting.shoot(&|_| 1.0);
            monitor.work.products += 1.0;
        };
        Ok(Attempt::ended(shown, stop, monitor))
    }
}
