//! Chebyshev iteration: the polynomial of bounces that is smallest over a whole interval.
//!
//! ```text
//! (I − A) u = S^½ G E,      L = E + S^½ u,      rₖ = T_k((c − (I − A)) / d) / T_k(c / d) r₀,      c ± d the ends of the interval
//! ```
//!
//! Needs the self-adjoint form with ρ(K) < 1, and no inner product but those that measure the interval: fourteen products once. One product
//! an iteration, each of which lowers the residual by at least (√κ − 1) / (√κ + 1) in the long run, κ the ratio of the ends. Source: Golub
//! and Varga (1961); Saad (2003), algorithm 12.1.

use super::interval;
use crate::linalg::{Block, Equation};
use crate::solver::monitor::Monitor;
use crate::solver::report::relative_residual;
use crate::solver::{Attempt, Observer, SolveError, Solver};

/// Least half-width of the interval relative to its centre.
const NARROWEST: f64 = 1e-6;

/// Iterates until the residual is below the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chebyshev {
    /// On ‖E + K L − L‖∞ / ‖E‖∞.
    pub tolerance: f64,
}

/// Centre, half-width and the ratio of the last two polynomials of one band.
struct Scalars {
    centre: f64,
    half_width: f64,
    ratio: f64,
}

impl Solver for Chebyshev {
    fn name(&self) -> &'static str {
        "chebyshev"
    }

    fn tolerance(&self) -> Option<f64> {
        Some(self.tolerance)
    }

    fn attempt<'a>(&self, equation: Equation<'a>, observer: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        let method = self.name();
        let mut monitor = Monitor::new(method, equation, self.tolerance, observer);
        let form = equation.self_adjoint.ok_or(SolveError::NoSelfAdjointForm { method })?;
        let intervals = interval::measure(method, equation, &mut monitor)?;
        let mut scalars: Vec<Scalars> = intervals
            .iter()
            .map(|band| {
                let centre = 0.5 * (band.high + band.low);
                let half_width = (0.5 * (band.high - band.low)).max(NARROWEST * centre);
                Scalars { centre, half_width, ratio: half_width / centre }
            })
            .collect();

        // Start from u = 0.
        let zeros = || Block::zeros(equation.n_unknowns(), equation.n_bands());
        let (mut r, mut scratch, mut direction, mut image) = (zeros(), zeros(), zeros(), zeros());
        monitor.count_applies(form.right_side(equation.emission, &mut scratch, &mut r));
        let mut step = r.clone();
        for (band, state) in scalars.iter().enumerate() {
            step.column_mut(band).iter_mut().for_each(|d| *d /= state.centre);
        }
        let (mut radiance, mut residual) = (equation.emission.clone(), zeros());
        let stop = loop {
            form.residual(&r, &mut residual);
            if let Some(stop) = monitor.check(relative_residual(equation.emission, &residual), &radiance)? {
                break stop;
            }
            form.apply(&step, &mut scratch, &mut direction, &mut image);
            monitor.count_applies(1);
            for (band, state) in scalars.iter_mut().enumerate() {
                let moved = radiance.column_mut(band).iter_mut().zip(direction.column(band));
                moved.for_each(|(l, d)| *l += d);
                let step = step.column_mut(band);
                let falls = r.column_mut(band).iter_mut().zip(&*step).zip(image.column(band));
                falls.for_each(|((r, d), a)| *r -= d - a);

                // The next step mixes the last one with the residual.
                let next = 1.0 / (2.0 * state.centre / state.half_width - state.ratio);
                let (kept, added) = (next * state.ratio, 2.0 * next / state.half_width);
                step.iter_mut().zip(r.column(band)).for_each(|(d, r)| *d = kept * *d + added * r);
                state.ratio = next;
            }
        };
        Ok(Attempt::ended(radiance, stop, monitor))
    }
}
