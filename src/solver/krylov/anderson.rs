//! Anderson acceleration of the Neumann map.
//!
//! ```text
//! f(L) = E + K L − L,      Lₖ₊₁ = Lₖ + fₖ − Σⱼ γⱼ (ΔLⱼ + ΔFⱼ),      γ = argmin ‖fₖ − Σⱼ γⱼ ΔFⱼ‖
//! ```
//!
//! over the last m differences of iterates and of their residuals, kept orthonormal: for this linear map a truncated GMRES without restarts.
//! Needs I − K to have an inverse; one product an iteration, room for 2 m blocks. f is the residual itself. Source: Anderson (1965); Walker
//! and Ni (2011).

use super::inner::{Inner, add_scaled};
use crate::linalg::{Block, Doubled, Equation, Residual};
use crate::solver::monitor::Monitor;
use crate::solver::report::relative_residual;
use crate::solver::{Attempt, Observer, SolveError, Solver};

/// A difference of residuals that is this much smaller once made orthogonal brings nothing new.
const NOTHING: f64 = 1e-12;

/// Accelerates the Neumann series until the residual is below the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Anderson {
    /// On ‖E + K L − L‖∞ / ‖E‖∞.
    pub tolerance: f64,
    /// m, the differences that are remembered.
    pub depth: usize,
}

impl Solver for Anderson {
    fn name(&self) -> &'static str {
        "anderson"
    }

    fn tolerance(&self) -> Option<f64> {
        Some(self.tolerance)
    }

    fn attempt<'a>(&self, equation: Equation<'a>, observer: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        let mut monitor = Monitor::new(self.name(), equation, self.tolerance, observer);
        let (n, n_bands) = (equation.n_unknowns(), equation.n_bands());
        let inner = Inner::of(equation);
        let m = self.depth.max(1);
        let zeros = || Block::zeros(n, n_bands);
        let (mut steps, mut falls): (Vec<Block>, Vec<Block>) = (0..m).map(|_| (zeros(), zeros())).unzip();
        let mut radiance = Doubled::from(equation.emission.clone());
        let mut evaluated = Residual::new(equation);
        let (mut residual, mut step, mut before) = (zeros(), zeros(), zeros());

        let stop = loop {
            evaluated.evaluate(&radiance.high, Some(&radiance.low), &mut residual);
            monitor.count_applies(1);
            if let Some(stop) = monitor.check(relative_residual(equation.emission, &residual), &radiance.high)? {
                break stop;
            }
            let k = monitor.work.n_iterations;
            let oldest = k % m;
            for band in 0..n_bands {
                let f = residual.column(band);
                if k > 0 {
                    // Remember the last difference in the place of the oldest, orthogonal to the others.
                    let fall = falls[oldest].column_mut(band);
                    fall.iter_mut().zip(f).zip(before.column(band)).for_each(|((d, f), g)| *d = f - g);
                    steps[oldest].column_mut(band).copy_from_slice(step.column(band));
                    remember(&inner, band, oldest, &mut steps, &mut falls);
                }
                // The Neumann step, corrected by what the differences foretell.
                before.column_mut(band).copy_from_slice(f);
                let step = step.column_mut(band);
                step.copy_from_slice(f);
                for (moved, fall) in steps.iter().zip(&falls) {
                    let weight = inner.dot(fall.column(band), f);
                    add_scaled(step, -weight, moved.column(band));
                    add_scaled(step, -weight, fall.column(band));
                }
            }
            radiance.add(&step);
        };
        Ok(Attempt::ended(radiance, stop, monitor))
    }
}

/// Makes the newest pair of differences orthonormal to the others in residuals, or forgets it.
fn remember(inner: &Inner<'_>, band: usize, newest: usize, steps: &mut [Block], falls: &mut [Block]) {
    let before = inner.norm(falls[newest].column(band));
    let others = |j: &usize| *j != newest;
    for j in (0..falls.len()).filter(others) {
        let Ok([fall, other]) = falls.get_disjoint_mut([newest, j]) else { continue };
        let Ok([step, moved]) = steps.get_disjoint_mut([newest, j]) else { continue };
        let weight = inner.dot(other.column(band), fall.column(band));
        add_scaled(fall.column_mut(band), -weight, other.column(band));
        add_scaled(step.column_mut(band), -weight, moved.column(band));
    }
    let size = inner.norm(falls[newest].column(band));
    let scale = if size > NOTHING * before { 1.0 / size } else { 0.0 };
    falls[newest].column_mut(band).iter_mut().for_each(|v| *v *= scale);
    steps[newest].column_mut(band).iter_mut().for_each(|v| *v *= scale);
}
