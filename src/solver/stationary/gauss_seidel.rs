//! The Gauss–Seidel method: every unknown in turn gathers from the newest values of the others.
//!
//! ```text
//! Lᵢ ← (Eᵢ + Σ_{j≠i} Kᵢⱼ Lⱼ) / (1 − Kᵢᵢ),      i = 1 … n
//! ```
//!
//! Needs Kᵢᵢ < 1; converges for K ≥ 0 with ρ(K) < 1, never slower than Jacobi (Stein and Rosenberg 1948). A sweep reads every
//! entry of K once: one product. The residual it reports is that of each equation just before its turn, which is free; the last is
//! verified. The symmetric form goes forward and then backward, two products; its residual is that of the way back. Source: Saad (2003), §4.1; as gathering radiosity, Cohen and Wallace (1993), §5.3.

use super::jacobi::one_minus_diagonal;
use super::sweep::{Order, Sweep};
use crate::linalg::{Equation, worst};
use crate::solver::monitor::Monitor;
use crate::solver::{Attempt, Observer, SolveError, Solver};

/// Sweeps forward until the residual is below the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaussSeidel {
    /// On ‖E + K L − L‖∞ / ‖E‖∞.
    pub tolerance: f64,
}

/// Sweeps forward and backward until the residual is below the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SymmetricGaussSeidel {
    /// On ‖E + K L − L‖∞ / ‖E‖∞.
    pub tolerance: f64,
}

impl Solver for GaussSeidel {
    fn name(&self) -> &'static str {
        "gauss-seidel"
    }

    fn tolerance(&self) -> Option<f64> {
        Some(self.tolerance)
    }

    fn attempt<'a>(&self, equation: Equation<'a>, observer: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        repeat(self.name(), equation, self.tolerance, &[Order::Forward], observer)
    }
}

impl Solver for SymmetricGaussSeidel {
    fn name(&self) -> &'static str {
        "symmetric-gauss-seidel"
    }

    fn tolerance(&self) -> Option<f64> {
        Some(self.tolerance)
    }

    fn attempt<'a>(&self, equation: Equation<'a>, observer: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        repeat(self.name(), equation, self.tolerance, &[Order::Forward, Order::Backward], observer)
    }
}

fn repeat<'a>(
    method: &'static str,
    equation: Equation<'a>,
    tolerance: f64,
    passes: &[Order],
    observer: &mut dyn Observer,
) -> Result<Attempt<'a>, SolveError> {
    let mut monitor = Monitor::new(method, equation, tolerance, observer);
    let mut sweep = Sweep::new(equation, one_minus_diagonal(method, equation)?);
    let plain = vec![1.0; equation.n_bands()];
    let mut radiance = equation.emission.clone();
    let stop = loop {
        for order in passes {
            sweep.pass(&mut radiance, *order, &plain);
            monitor.work.products += 1.0;
        }
        if let Some(stop) = monitor.check(worst(sweep.residuals.iter().copied()), &radiance)? {
            break stop;
        }
    };
    Ok(Attempt::ended(radiance, stop, monitor))
}
