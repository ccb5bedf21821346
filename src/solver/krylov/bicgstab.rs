//! Stabilised biconjugate gradients: a step of BiCG without K*, then a step of minimal residual.
//!
//! ```text
//! p ← r + β (p − ω v),   v = (I − K) P⁻¹ p,   s = r − α v,   t = (I − K) P⁻¹ s,   L ← L + P⁻¹ (α p + ω s),   r ← s − ω t
//! ```
//!
//! Needs I − K to have an inverse, and nothing of symmetry. Two products an iteration and those of the preconditioner. A band that would
//! divide by nothing starts again from its residual; breaking down at once after that is an error. Source: van der Vorst (1992); Saad
//! (2003), algorithm 7.7.

use super::inner::{Inner, add_scaled, one_minus_transport};
use super::preconditioner::Preconditioner;
use crate::linalg::{Block, Equation, Residual};
use crate::solver::monitor::Monitor;
use crate::solver::report::{band_residual, relative_residual};
use crate::solver::{Attempt, Observer, SolveError, Solver};

/// Below this share of its factors' sizes an inner product is rounding.
const NOTHING: f64 = 1e-30;

/// Iterates until the residual is below the tolerance.
#[derive(Clone, Copy)]
pub struct BiCgStab<'p> {
    /// On ‖E + K L − L‖∞ / ‖E‖∞.
    pub tolerance: f64,
    /// A fixed one: not one that depends on what it is applied to.
    pub preconditioner: Option<&'p dyn Preconditioner>,
}

/// Scalars of one band.
#[derive(Clone, Copy)]
struct Scalars {
    rho: f64,
    alpha: f64,
    omega: f64,
    is_fresh: bool,
}

impl Solver for BiCgStab<'_> {
    fn name(&self) -> &'static str {
        if self.preconditioner.is_some() { "preconditioned-bicgstab" } else { "bicgstab" }
    }

    fn tolerance(&self) -> Option<f64> {
        Some(self.tolerance)
    }

    fn attempt<'a>(&self, equation: Equation<'a>, observer: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        let method = self.name();
        let mut monitor = Monitor::new(method, equation, self.tolerance, observer);
        let prepare = |p: &dyn Preconditioner| p.prepare(method, equation, &mut monitor.work);
        let mut prepared = self.preconditioner.map(prepare).transpose()?;
        let (n, n_bands) = (equation.n_unknowns(), equation.n_bands());
        let inner = Inner::of(equation);

        // Start from L = E.
        let mut radiance = equation.emission.clone();
        let zeros = || Block::zeros(n, n_bands);
        let (mut r, mut v, mut t, mut step) = (zeros(), zeros(), zeros(), zeros());
        Residual::new(equation).evaluate(&radiance, None, &mut r);
        monitor.count_applies(1);
        let (mut shadow, mut p) = (r.clone(), r.clone());
        let begin =
            |shadow: &[f64], r: &[f64]| Scalars { rho: inner.dot(shadow, r), alpha: 0.0, omega: 0.0, is_fresh: true };
        let mut scalars: Vec<Scalars> = (0..n_bands).map(|band| begin(r.column(band), r.column(band))).collect();
        let mut is_done = vec![false; n_bands];

        let stop = loop {
            if let Some(stop) = monitor.check(relative_residual(equation.emission, &r), &radiance)? {
                break stop;
            }
            let iteration = monitor.work.n_iterations;
            for (band, is_done) in is_done.iter_mut().enumerate() {
                *is_done = band_residual(equation.emission, &r, band) <= self.tolerance;
            }

            // The step of biconjugate gradients: s, in the place of r.
            match &mut prepared {
                Some(prepared) => prepared.apply(&p, &mut step, &mut monitor.work),
                None => step.copy_from(&p),
            }
            one_minus_transport(equation, &step, &mut v);
            monitor.count_applies(1);
            for (band, state) in scalars.iter_mut().enumerate().filter(|(band, _)| !is_done[*band]) {
                let curvature = inner.dot(shadow.column(band), v.column(band));
                if !curvature.is_finite() {
                    return Err(SolveError::NotFinite { method, iteration });
                }
                let is_broken =
                    curvature.abs() <= NOTHING * inner.norm(shadow.column(band)) * inner.norm(v.column(band));
                if is_broken && state.is_fresh {
                    let residual = band_residual(equation.emission, &r, band);
                    let (quantity, value) = ("⟨r̃, (I − K) p⟩", curvature);
                    return Err(SolveError::Breakdown { method, band, iteration, quantity, value, residual });
                }
                state.alpha = if is_broken { 0.0 } else { state.rho / curvature };
                add_scaled(radiance.column_mut(band), state.alpha, step.column(band));
                add_scaled(r.column_mut(band), -state.alpha, v.column(band));
            }

            // The step of minimal residual.
            match &mut prepared {
                Some(prepared) => prepared.apply(&r, &mut step, &mut monitor.work),
                None => step.copy_from(&r),
            }
            one_minus_transport(equation, &step, &mut t);
            monitor.count_applies(1);
            for (band, state) in scalars.iter_mut().enumerate().filter(|(band, _)| !is_done[*band]) {
                let size = inner.dot(t.column(band), t.column(band));
                state.omega = if size > 0.0 { inner.dot(t.column(band), r.column(band)) / size } else { 0.0 };
                add_scaled(radiance.column_mut(band), state.omega, step.column(band));
                add_scaled(r.column_mut(band), -state.omega, t.column(band));

                // Turn the next direction, or begin anew.
                let (column, shadow) = (r.column(band), shadow.column_mut(band));
                let rho = inner.dot(shadow, column);
                let is_broken = rho.abs() <= NOTHING * inner.norm(shadow) * inner.norm(column);
                if is_broken || state.omega == 0.0 || state.alpha == 0.0 {
                    shadow.copy_from_slice(column);
                    p.column_mut(band).copy_from_slice(column);
                    *state = begin(shadow, column);
                    continue;
                }
                let turn = rho / state.rho * (state.alpha / state.omega);
                for ((p, r), v) in p.column_mut(band).iter_mut().zip(column).zip(v.column(band)) {
                    *p = r + turn * (*p - state.omega * v);
                }
                (state.rho, state.is_fresh) = (rho, false);
            }
        };
        Ok(Attempt::ended(radiance, stop, monitor))
    }
}
