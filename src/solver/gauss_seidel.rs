//! The Gauss–Seidel method: every unknown in turn gathers from the newest values of the others.
//!
//! ```text
//! Lᵢ ← (Eᵢ + Σ_{j≠i} Kᵢⱼ Lⱼ) / (1 − Kᵢᵢ),      i = 1 … n
//! ```
//!
//! Needs Kᵢᵢ < 1; converges for K ≥ 0 with ρ(K) < 1, never slower than Jacobi (Stein and Rosenberg 1948). A sweep reads every
//! entry of K once: one product. The residual it reports is that of each equation just before its turn, which is free; the last is
//! verified. Source: Saad (2003), §4.1; as gathering radiosity, Cohen and Wallace (1993), §5.3.

use super::jacobi::one_minus_diagonal;
use super::monitor::Monitor;
use super::report::conclude;
use super::{Observer, Solution, SolveError, Solver};
use crate::linalg::{Block, Equation, max_abs, worst as largest};
use rayon::prelude::*;

/// Sweeps forward until the residual is below the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaussSeidel {
    /// On ‖E + K L − L‖∞ / ‖E‖∞.
    pub tolerance: f64,
}

impl Solver for GaussSeidel {
    fn name(&self) -> &'static str {
        "gauss-seidel"
    }

    fn solve(&self, equation: Equation<'_>, observer: &mut dyn Observer) -> Result<Solution, SolveError> {
        let mut monitor = Monitor::new(self.name(), equation, self.tolerance, observer);
        let (n, n_bands) = (equation.n_unknowns(), equation.n_bands());
        let own = one_minus_diagonal(self.name(), equation)?;
        let mut radiance = equation.emission.clone();
        let mut rows = Block::zeros(n, n_bands);
        let mut worst = vec![0.0; n_bands];
        let stop = loop {
            // Sweep each band on its own thread.
            let columns = radiance.values_mut().par_chunks_mut(n.max(1));
            let scratch = rows.values_mut().par_chunks_mut(n.max(1));
            columns.zip(scratch).zip(worst.par_iter_mut()).enumerate().for_each(|(band, ((l, row), worst))| {
                *worst = sweep(equation, band, own.column(band), l, row);
            });
            monitor.work.products += 1.0;
            let residual = largest(worst.iter().copied());
            if let Some(stop) = monitor.check(residual, &radiance)? {
                break stop;
            }
        };
        conclude(self.name(), equation, radiance, stop, monitor.work, monitor.history)
    }
}

/// One forward sweep over one band: the largest residual met, relative to ‖E‖∞.
fn sweep(equation: Equation<'_>, band: usize, own: &[f64], radiance: &mut [f64], row: &mut [f64]) -> f64 {
    let emission = equation.emission.column(band);
    let mut worst = 0.0;
    for i in 0..radiance.len() {
        equation.transport.row(band, i, row);
        let gathered: f64 = row.iter().zip(radiance.iter()).map(|(k, l)| k * l).sum();
        let residual = emission[i] + gathered - radiance[i];
        radiance[i] += residual / own[i];
        worst = largest([worst, residual.abs()].into_iter());
    }
    let scale = max_abs(emission);
    if worst == 0.0 { 0.0 } else { worst / scale }
}
