//! Conjugate gradients in the étendue inner product.
//!
//! ```text
//! (I − A) u = S^½ G E,      L = E + S^½ u,      A = S^½ G S^½,      ⟨a, b⟩ = Σ μᵢ aᵢ bᵢ
//! ```
//!
//! Needs the self-adjoint form, checks it by two products, and ρ(K) < 1. One product an iteration; the residual of L is S^½ times
//! the residual of u. Every band has its own step lengths and rests when it is done. Source: Hestenes and Stiefel (1952); Saad
//! (2003), algorithm 6.18.

use super::inner::add_scaled;
use crate::linalg::{Block, Equation};
use crate::solver::monitor::Monitor;
use crate::solver::report::{band_residual, relative_residual};
use crate::solver::self_adjoint::{CHECK, checked_form};
use crate::solver::{Attempt, Observer, SolveError, Solver};

/// Iterates until the residual is below the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cg {
    /// On ‖E + K L − L‖∞ / ‖E‖∞.
    pub tolerance: f64,
}

impl Solver for Cg {
    fn name(&self) -> &'static str {
        "cg"
    }

    fn tolerance(&self) -> Option<f64> {
        Some(self.tolerance)
    }

    fn attempt<'a>(&self, equation: Equation<'a>, observer: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        let method = self.name();
        let mut monitor = Monitor::new(method, equation, self.tolerance, observer);
        let form = checked_form(method, equation)?;
        monitor.count_applies(CHECK);

        // Start from u = 0.
        let (n, n_bands) = (equation.n_unknowns(), equation.n_bands());
        let zeros = || Block::zeros(n, n_bands);
        let (mut r, mut scratch, mut direction, mut image) = (zeros(), zeros(), zeros(), zeros());
        monitor.count_applies(form.right_side(equation.emission, &mut scratch, &mut r));
        let mut p = r.clone();
        let (mut radiance, mut residual) = (equation.emission.clone(), zeros());
        let mut norms: Vec<f64> = (0..n_bands).map(|band| form.inner(r.column(band), r.column(band))).collect();

        let stop = loop {
            form.residual(&r, &mut residual);
            if let Some(stop) = monitor.check(relative_residual(equation.emission, &residual), &radiance)? {
                break stop;
            }

            // image = (I − A) p.
            form.apply(&p, &mut scratch, &mut direction, &mut image);
            monitor.count_applies(1);
            for (a, p) in image.values_mut().iter_mut().zip(p.values()) {
                *a = p - *a;
            }

            for (band, norm) in norms.iter_mut().enumerate() {
                // A band that is done rests: its numbers would only sink into the denormals.
                if *norm < f64::MIN_POSITIVE || band_residual(equation.emission, &residual, band) <= self.tolerance {
                    continue;
                }
                // Step to the minimum along p, and turn the next direction conjugate.
                let curvature = form.inner(p.column(band), image.column(band));
                let iteration = monitor.work.n_iterations;
                if !curvature.is_finite() {
                    return Err(SolveError::NotFinite { method, iteration });
                }
                if curvature <= 0.0 {
                    return Err(SolveError::NotPositiveDefinite { method, band, iteration, curvature });
                }
                let step = *norm / curvature;
                add_scaled(radiance.column_mut(band), step, direction.column(band));
                add_scaled(r.column_mut(band), -step, image.column(band));
                let next = form.inner(r.column(band), r.column(band));
                let turn = next / *norm;
                p.column_mut(band).iter_mut().zip(r.column(band)).for_each(|(p, r)| *p = r + turn * *p);
                *norm = next;
            }
        };
        Ok(Attempt::ended(radiance, stop, monitor))
    }
}
