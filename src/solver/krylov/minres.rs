//! The minimal residual method in the étendue inner product.
//!
//! ```text
//! (I − A) u = S^½ G E,      L = E + S^½ u,      A = S^½ G S^½,      uₖ = argmin ‖S^½ G E − (I − A) u‖  over the Krylov space
//! ```
//!
//! Needs the self-adjoint form and checks it by two products. I − A may be indefinite: rows of K may gain more than 1, where CG breaks
//! down; it must not be singular. One product an iteration; the residual is minimal in the étendue norm of u and never rises there.
//! Source: Paige and Saunders (1975); the recurrence of its residual, Choi, Paige and Saunders (2011), lemma 3.1.

use super::inner::{add_scaled, set_scaled};
use crate::linalg::{Block, Equation};
use crate::solver::monitor::Monitor;
use crate::solver::report::{band_residual, relative_residual};
use crate::solver::self_adjoint::{CHECK, checked_form};
use crate::solver::{Attempt, Observer, SolveError, Solver};

/// Iterates until the residual is below the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Minres {
    /// On ‖E + K L − L‖∞ / ‖E‖∞.
    pub tolerance: f64,
}

/// Scalars of one band, in the letters of the paper.
#[derive(Clone, Copy, Default)]
struct Scalars {
    beta: f64,
    epsilon: f64,
    delta_bar: f64,
    phi_bar: f64,
    c: f64,
    s: f64,
}

impl Solver for Minres {
    fn name(&self) -> &'static str {
        "minres"
    }

    fn tolerance(&self) -> Option<f64> {
        Some(self.tolerance)
    }

    fn attempt<'a>(&self, equation: Equation<'a>, observer: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        let method = self.name();
        let mut monitor = Monitor::new(method, equation, self.tolerance, observer);
        let form = checked_form(method, equation)?;
        monitor.count_applies(CHECK);

        // Start from u = 0: the first Lanczos vector is the right-hand side.
        let (n, n_bands) = (equation.n_unknowns(), equation.n_bands());
        let zeros = || Block::zeros(n, n_bands);
        let (mut r, mut scratch, mut direction, mut image) = (zeros(), zeros(), zeros(), zeros());
        monitor.count_applies(form.right_side(equation.emission, &mut scratch, &mut r));
        let (mut v, mut v_before) = (zeros(), zeros());
        let (mut w, mut w_before) = (zeros(), zeros());
        let (mut radiance, mut residual) = (equation.emission.clone(), zeros());
        let mut scalars = vec![Scalars::default(); n_bands];
        for (band, state) in scalars.iter_mut().enumerate() {
            let norm = form.inner(r.column(band), r.column(band)).sqrt();
            *state = Scalars { phi_bar: norm, c: -1.0, ..Scalars::default() };
            if norm > 0.0 {
                set_scaled(v.column_mut(band), 1.0 / norm, r.column(band));
            }
        }

        let stop = loop {
            form.residual(&r, &mut residual);
            if let Some(stop) = monitor.check(relative_residual(equation.emission, &residual), &radiance)? {
                break stop;
            }

            // image = (I − A) v, and how L moves with v.
            form.apply(&v, &mut scratch, &mut direction, &mut image);
            monitor.count_applies(1);
            image.values_mut().iter_mut().zip(v.values()).for_each(|(a, v)| *a = v - *a);

            for (band, state) in scalars.iter_mut().enumerate() {
                if state.phi_bar == 0.0 || band_residual(equation.emission, &residual, band) <= self.tolerance {
                    continue;
                }
                // The next Lanczos vector, orthogonal to the last two.
                let Scalars { beta, epsilon, delta_bar, phi_bar, c, s } = *state;
                let next = image.column_mut(band);
                let alpha = form.inner(v.column(band), next);
                add_scaled(next, -alpha, v.column(band));
                add_scaled(next, -beta, v_before.column(band));
                let beta = form.inner(next, next).sqrt();

                // Rotate the new column of the tridiagonal matrix.
                let delta = c * delta_bar + s * alpha;
                let gamma_bar = s * delta_bar - c * alpha;
                let gamma = gamma_bar.hypot(beta);
                let iteration = monitor.work.n_iterations;
                if !gamma.is_finite() {
                    return Err(SolveError::NotFinite { method, iteration });
                }
                if gamma == 0.0 {
                    let residual = band_residual(equation.emission, &residual, band);
                    return Err(SolveError::Breakdown {
                        method,
                        band,
                        iteration,
                        quantity: "γ",
                        value: gamma,
                        residual,
                    });
                }
                let (c, s_before, s) = (gamma_bar / gamma, s, beta / gamma);
                *state =
                    Scalars { beta, epsilon: s_before * beta, delta_bar: -state.c * beta, phi_bar: s * phi_bar, c, s };

                // Move L along the new direction.
                let (older, newer) = (w_before.column_mut(band), w.column(band));
                for ((older, newer), d) in older.iter_mut().zip(newer).zip(direction.column(band)) {
                    *older = (d - epsilon * *older - delta * newer) / gamma;
                }
                add_scaled(radiance.column_mut(band), c * phi_bar, w_before.column(band));

                // And the residual with it.
                v_before.column_mut(band).copy_from_slice(v.column(band));
                let inverse = if beta > 0.0 { 1.0 / beta } else { 0.0 };
                set_scaled(v.column_mut(band), inverse, image.column(band));
                let turned = s * phi_bar * c;
                r.column_mut(band).iter_mut().zip(v.column(band)).for_each(|(r, v)| *r = s * s * *r - turned * v);
                w.column_mut(band).swap_with_slice(w_before.column_mut(band));
            }
        };
        Ok(Attempt::ended(radiance, stop, monitor))
    }
}
