//! Southwell's method, shooting: the unknown with most unshot power gives it to all others.
//!
//! ```text
//! i = argmax μᵢ |rᵢ|,      Δ = rᵢ / (1 − Kᵢᵢ),      Lᵢ ← Lᵢ + Δ,      r ← r + K eᵢ Δ − eᵢ Δ
//! ```
//!
//! with r = E + K L − L kept up to date from L = 0, r = E. Needs Kᵢᵢ < 1; converges for K ≥ 0 with ρ(K) < 1. A shot reads one
//! column of K: 1/n of a product. Source: Southwell (1940); as progressive radiosity, Gortler, Cohen and Slusallek (1994).

use super::jacobi::one_minus_diagonal;
use super::monitor::Monitor;
use super::report::{conclude, relative_residual};
use super::{Observer, Solution, SolveError, Solver};
use crate::linalg::{Block, Equation};
use rayon::prelude::*;

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

    fn solve(&self, equation: Equation<'_>, observer: &mut dyn Observer) -> Result<Solution, SolveError> {
        let mut monitor = Monitor::new(self.name(), equation, self.tolerance, observer);
        let (n, n_bands) = (equation.n_unknowns(), equation.n_bands());
        let own = one_minus_diagonal(self.name(), equation)?;
        let ones = vec![1.0; n];
        let weights = equation.self_adjoint.map_or(ones.as_slice(), |form| form.etendue);
        let mut radiance = Block::zeros(n, n_bands);
        let mut residual = equation.emission.clone();
        let mut columns = Block::zeros(n, n_bands);
        let stop = loop {
            if let Some(stop) = monitor.check(relative_residual(equation.emission, &residual), &radiance)? {
                break stop;
            }
            // Shoot n times, each band on its own thread.
            let bands =
                radiance.values_mut().par_chunks_mut(n.max(1)).zip(residual.values_mut().par_chunks_mut(n.max(1)));
            bands.zip(columns.values_mut().par_chunks_mut(n.max(1))).enumerate().for_each(
                |(band, ((l, r), column))| {
                    for _ in 0..n {
                        shoot(equation, band, own.column(band), weights, l, r, column);
                    }
                },
            );
            monitor.work.products += 1.0;
        };
        conclude(self.name(), equation, radiance, stop, monitor.work, monitor.history)
    }
}

/// One shot in one band.
fn shoot(
    equation: Equation<'_>,
    band: usize,
    own: &[f64],
    weights: &[f64],
    radiance: &mut [f64],
    residual: &mut [f64],
    column: &mut [f64],
) {
    let power = |i: usize, residual: &[f64]| weights[i] * residual[i].abs();
    let (mut brightest, mut most) = (0, 0.0);
    for i in 0..residual.len() {
        let power = power(i, residual);
        if power > most {
            (brightest, most) = (i, power);
        }
    }
    if most == 0.0 {
        return;
    }
    let shot = residual[brightest] / own[brightest];
    equation.transport.column(band, brightest, column);
    residual.iter_mut().zip(column.iter()).for_each(|(r, k)| *r += k * shot);
    residual[brightest] -= shot;
    radiance[brightest] += shot;
}
