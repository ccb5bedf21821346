//! Successive over-relaxation: Gauss–Seidel, every step longer by the same factor.
//!
//! ```text
//! Lᵢ ← Lᵢ + ω (E + K L − L)ᵢ / (1 − Kᵢᵢ),      i = 1 … n,      0 < ω < 2
//! ```
//!
//! Needs Kᵢᵢ < 1. Where the equation is self-adjoint with ρ(K) < 1 any such ω converges, because rows over their albedo make I − K
//! symmetric positive definite (Ostrowski 1954); for K ≥ 0 without that, ω ≤ 1 does. One product a sweep; residuals as Gauss–Seidel's.
//!
//! An ω that is not given is 1 for some sweeps; the factor λ by which their residuals fall at the end of these then gives Young's
//! ω = 2 / (1 + (1 − λ)^½), band by band. That is the best one for consistently ordered matrices, which transport's are not, and only a sane
//! one here; it stays 1 where the equation has no self-adjoint form. Source: Young (1954); Saad (2003), §4.1.

use super::jacobi::one_minus_diagonal;
use super::sweep::{Order, Sweep};
use crate::linalg::{Equation, worst};
use crate::solver::monitor::Monitor;
use crate::solver::{Attempt, Observer, SolveError, Solver};

/// Plain sweeps that measure λ.
const MEASURED: usize = 6;

/// Sweeps until the residual is below the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sor {
    /// On ‖E + K L − L‖∞ / ‖E‖∞.
    pub tolerance: f64,
    /// ω; measured if `None`.
    pub relaxation: Option<f64>,
}

impl Solver for Sor {
    fn name(&self) -> &'static str {
        "sor"
    }

    fn tolerance(&self) -> Option<f64> {
        Some(self.tolerance)
    }

    fn attempt<'a>(&self, equation: Equation<'a>, observer: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        let mut monitor = Monitor::new(self.name(), equation, self.tolerance, observer);
        let mut sweep = Sweep::new(equation, one_minus_diagonal(self.name(), equation)?);
        let mut relaxation = vec![self.relaxation.unwrap_or(1.0); equation.n_bands()];
        let is_measured = self.relaxation.is_none() && equation.self_adjoint.is_some();
        let mut before = vec![0.0; equation.n_bands()];
        let mut radiance = equation.emission.clone();
        let stop = loop {
            before.copy_from_slice(&sweep.residuals);
            sweep.pass(&mut radiance, Order::Forward, &relaxation);
            monitor.work.products += 1.0;
            if let Some(stop) = monitor.check(worst(sweep.residuals.iter().copied()), &radiance)? {
                break stop;
            }
            if is_measured && monitor.work.n_iterations + 1 == MEASURED {
                for ((omega, now), before) in relaxation.iter_mut().zip(&sweep.residuals).zip(&before) {
                    *omega = young(now / before);
                }
            }
        };
        Ok(Attempt::ended(radiance, stop, monitor))
    }
}

/// The best ω where Gauss–Seidel's residuals fall by λ; 1 where they do not fall.
fn young(lambda: f64) -> f64 {
    if (0.0..1.0).contains(&lambda) { 2.0 / (1.0 + (1.0 - lambda).sqrt()) } else { 1.0 }
}
