//! Southwell's method, shooting: the unknown with most unshot power gives it to all others.
//!
//! ```text
//! i = argmax μᵢ |rᵢ|,      Δ = rᵢ / (1 − Kᵢᵢ),      Lᵢ ← Lᵢ + Δ,      r ← r + K eᵢ Δ − eᵢ Δ
//! ```
//!
//! with r = E + K L − L kept up to date from L = 0, r = E. Needs Kᵢᵢ < 1; converges for K ≥ 0 with ρ(K) < 1. A shot reads one
//! column of K: 1/n of a product. Source: Southwell (1940); as progressive radiosity, Gortler, Cohen and Slusallek (1994).

use super::jacobi::one_minus_diagonal;
use super::shooting::Shooting;
use crate::linalg::Equation;
use crate::solver::monitor::Monitor;
use crate::solver::report::relative_residual;
use crate::solver::{Attempt, Observer, SolveError, Solver};

/// Shoots until the residual is below the tolerance. An iteration is n shots in every band.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Southwell {
    /// On ‖E + K L − L‖∞ / ‖E‖∞.
    pub tolerance: f64,
}

impl Solver for Southwell {
    fn name(&self) -> &'static str {
        "southwell"
    }

    fn tolerance(&self) -> Option<f64> {
        Some(self.tolerance)
    }

    fn attempt<'a>(&self, equation: Equation<'a>, observer: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        let mut monitor = Monitor::new(self.name(), equation, self.tolerance, observer);
        let mut shooting = Shooting::new(equation, one_minus_diagonal(self.name(), equation)?);
        let stop = loop {
            let residual = relative_residual(equation.emission, &shooting.residual);
            if let Some(stop) = monitor.check(residual, &shooting.radiance)? {
                break stop;
            }
            shooting.shoot(&|_| 1.0);
            monitor.work.products += 1.0;
        };
        Ok(Attempt::ended(shooting.radiance, stop, monitor))
    }
}
