//! LU in single precision, refined in double.
//!
//! ```text
//! P (I − K) ≈ L U  in f32,      L ← L + (L U)⁻¹ P r,      r = E + K L − L  in f64
//! ```
//!
//! Needs I − K to have an inverse that seven digits show: each refinement wins some 7 − log₁₀ κ digits, with κ up to 2 / (1 − albedo), and
//! none where κ passes 1e7, which ends as stagnation or divergence. Cost ⅔ n³ a band in f32, half of LU's time and room, and one product and
//! 2 n² a band for every refinement. Source: Langou et al. (2006); Higham (2002), chapter 12.

use super::factored::one_minus_transport;
use crate::linalg::{Block, Doubled, Equation, Residual, SingleLuFactor};
use crate::solver::monitor::Monitor;
use crate::solver::report::{band_residual, relative_residual};
use crate::solver::{Attempt, Observer, SolveError, Solver};

/// LU by faer in f32, refined until the residual is below the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SingleLu {
    /// On ‖E + K L − L‖∞ / ‖E‖∞.
    pub tolerance: f64,
}

impl Solver for SingleLu {
    fn name(&self) -> &'static str {
        "lu-f32"
    }

    fn tolerance(&self) -> Option<f64> {
        Some(self.tolerance)
    }

    fn writes_out(&self) -> bool {
        true
    }

    fn attempt<'a>(&self, equation: Equation<'a>, observer: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        let method = self.name();
        let mut monitor = Monitor::new(method, equation, self.tolerance, observer);
        let (n, n_bands) = (equation.n_unknowns(), equation.n_bands());
        let mut factors = (0..n_bands)
            .map(|band| {
                SingleLuFactor::new(&one_minus_transport(equation, band)).map_err(|source| SolveError::Factor {
                    method,
                    band,
                    source,
                })
            })
            .collect::<Result<Vec<_>, _>>()?;

        // Refine from L = E.
        let mut radiance = Doubled::from(equation.emission.clone());
        let mut evaluated = Residual::new(equation);
        let mut residual = Block::zeros(n, n_bands);
        let stop = loop {
            evaluated.evaluate(&radiance.high, Some(&radiance.low), &mut residual);
            monitor.count_applies(1);
            if let Some(stop) = monitor.check(relative_residual(equation.emission, &residual), &radiance.high)? {
                break stop;
            }
            for (band, factors) in factors.iter_mut().enumerate() {
                if band_residual(equation.emission, &residual, band) > self.tolerance {
                    factors.solve(residual.column_mut(band));
                    radiance.add_scaled(band, 1.0, residual.column(band));
                }
            }
        };
        Ok(Attempt::ended(radiance, stop, monitor))
    }
}
