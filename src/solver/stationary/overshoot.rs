//! Overshooting: every shot also gives what the unknown is expected to receive later.
//!
//! ```text
//! Δ = ω rᵢ / (1 − Kᵢᵢ),      ω rᵢ = rᵢ + aᵢ ambient,      ambient = Σ μⱼ rⱼ / Σ μⱼ (1 − aⱼ),      aᵢ = Σⱼ Kᵢⱼ
//! ```
//!
//! What was given too much comes back as negative light, which is shot plainly, ω = 1, as is all whose sign is not the ambient's. ω is kept
//! below [`LIMIT`]: for a self-adjoint equation with ρ(K) < 1 every shot with 0 < ω < 2 brings the answer closer in the energy norm. Needs
//! Kᵢᵢ < 1. Shots cost as Southwell's. Source: Feda and Purgathofer (1992); Xu and Fussell, as super-shooting (1994).

use super::ambient::Ambient;
use super::jacobi::one_minus_diagonal;
use super::shooting::{Shooting, Shot};
use crate::linalg::Equation;
use crate::solver::monitor::Monitor;
use crate::solver::report::relative_residual;
use crate::solver::{Attempt, Observer, SolveError, Solver};

/// Largest ω.
const LIMIT: f64 = 1.8;

/// Shoots until the residual is below the tolerance. An iteration is n shots in every band.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overshooting {
    /// On ‖E + K L − L‖∞ / ‖E‖∞.
    pub tolerance: f64,
}

impl Solver for Overshooting {
    fn name(&self) -> &'static str {
        "overshooting"
    }

    fn tolerance(&self) -> Option<f64> {
        Some(self.tolerance)
    }

    fn attempt<'a>(&self, equation: Equation<'a>, observer: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        let mut monitor = Monitor::new(self.name(), equation, self.tolerance, observer);
        let mut shooting = Shooting::new(equation, one_minus_diagonal(self.name(), equation)?);
        let ambient = Ambient::new(equation, &shooting.weights, &mut monitor.work);
        let relaxation = |shot: &Shot| {
            let expected = ambient.gain.get(shot.unknown, shot.band) * ambient.radiance(shot.band, shot.power);
            (1.0 + (expected / shot.residual).max(0.0)).min(LIMIT)
        };
        let stop = loop {
            let residual = relative_residual(equation.emission, &shooting.residual);
            if let Some(stop) = monitor.check(residual, &shooting.radiance)? {
                break stop;
            }
            shooting.shoot(&relaxation);
            monitor.work.products += 1.0;
        };
        Ok(Attempt::ended(shooting.radiance, stop, monitor))
    }
}
