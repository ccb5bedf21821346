//! Biconjugate gradients: two three-term recurrences, one with K and one with K*.
//!
//! ```text
//! p ← r + β p,   p̃ ← r̃ + β p̃,      α = ⟨r̃, r⟩ / ⟨p̃, (I − K) p⟩,      L ← L + α p,   r ← r − α (I − K) p,   r̃ ← r̃ − α (I − K*) p̃
//! ```
//!
//! Needs I − K to have an inverse, and nothing of symmetry. One product with K and one with K* an iteration; where K is self-adjoint that
//! is conjugate gradients at twice the cost. The residual does not fall steadily. A band whose α or β would divide by nothing starts again
//! from its residual; breaking down at once after that is an error. Source: Lanczos (1952); Fletcher (1976); Saad (2003), algorithm 7.3.

use super::inner::{Inner, add_scaled, one_minus_transport};
use crate::linalg::{Block, Equation, Residual};
use crate::solver::monitor::Monitor;
use crate::solver::report::{band_residual, relative_residual};
use crate::solver::{Attempt, Observer, SolveError, Solver};

/// Below this share of its factors' sizes an inner product is rounding.
const NOTHING: f64 = 1e-30;

/// Iterates until the residual is below the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BiCg {
    /// On ‖E + K L − L‖∞ / ‖E‖∞.
    pub tolerance: f64,
}

impl Solver for BiCg {
    fn name(&self) -> &'static str {
        "bicg"
    }

    fn tolerance(&self) -> Option<f64> {
        Some(self.tolerance)
    }

    fn attempt<'a>(&self, equation: Equation<'a>, observer: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        let method = self.name();
        let mut monitor = Monitor::new(method, equation, self.tolerance, observer);
        let (n, n_bands) = (equation.n_unknowns(), equation.n_bands());
        let inner = Inner::of(equation);
        // Start from L = E. The shadow is kept weighted, M r̃, so that K* is the plain transpose.
        let mut radiance = equation.emission.clone();
        let mut r = Block::zeros(n, n_bands);
        Residual::new(equation).evaluate(&radiance, None, &mut r);
        monitor.count_applies(1);
        let mut shadow = r.clone();
        (0..n_bands).for_each(|band| inner.weigh(shadow.column_mut(band)));
        let (mut p, mut shadow_p) = (r.clone(), shadow.clone());
        let (mut image, mut shadow_image) = (Block::zeros(n, n_bands), Block::zeros(n, n_bands));
        let mut products: Vec<f64> = (0..n_bands).map(|band| dot(shadow.column(band), r.column(band))).collect();
        let mut is_fresh = vec![true; n_bands];

        let stop = loop {
            if let Some(stop) = monitor.check(relative_residual(equation.emission, &r), &radiance)? {
                break stop;
            }
            one_minus_transport(equation, &p, &mut image);
            equation.transport.apply_transpose(&shadow_p, &mut shadow_image);
            shadow_image.values_mut().iter_mut().zip(shadow_p.values()).for_each(|(y, x)| *y = x - *y);
            monitor.count_applies(1);
            monitor.count_adjoint_applies(1);

            for (band, product) in products.iter_mut().enumerate() {
                let relative = band_residual(equation.emission, &r, band);
                if relative <= self.tolerance {
                    continue;
                }
                // Step so that the new residual is orthogonal to the shadow.
                let curvature = dot(shadow_p.column(band), image.column(band));
                let size = norm(shadow_p.column(band)) * norm(image.column(band));
                let iteration = monitor.work.n_iterations;
                if !curvature.is_finite() {
                    return Err(SolveError::NotFinite { method, iteration });
                }
                let mut next = 0.0;
                let is_broken = curvature.abs() <= NOTHING * size;
                if is_broken && is_fresh[band] {
                    let (quantity, value) = ("⟨p̃, (I − K) p⟩", curvature);
                    return Err(SolveError::Breakdown { method, band, iteration, quantity, value, residual: relative });
                }
                if !is_broken {
                    let step = *product / curvature;
                    add_scaled(radiance.column_mut(band), step, p.column(band));
                    add_scaled(r.column_mut(band), -step, image.column(band));
                    add_scaled(shadow.column_mut(band), -step, shadow_image.column(band));
                    next = dot(shadow.column(band), r.column(band));
                }

                // Turn the next pair of directions, or begin anew.
                let size = norm(shadow.column(band)) * norm(r.column(band));
                is_fresh[band] = is_broken || next.abs() <= NOTHING * size;
                if is_fresh[band] {
                    shadow.column_mut(band).copy_from_slice(r.column(band));
                    inner.weigh(shadow.column_mut(band));
                    next = dot(shadow.column(band), r.column(band));
                }
                let turn = if is_fresh[band] { 0.0 } else { next / *product };
                p.column_mut(band).iter_mut().zip(r.column(band)).for_each(|(p, r)| *p = r + turn * *p);
                let pairs = shadow_p.column_mut(band).iter_mut().zip(shadow.column(band));
                pairs.for_each(|(p, r)| *p = r + turn * *p);
                *product = next;
            }
        };
        Ok(Attempt::ended(radiance, stop, monitor))
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}
