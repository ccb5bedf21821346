//! How fast answers converge, and to what.

use crate::stats::{FitError, fit_power_law};
use serde::Serialize;
use thiserror::Error;

/// Orders looked for by [`richardson`]: nothing converges slower or faster in practice.
const ORDERS: (f64, f64) = (0.01, 64.0);

/// Order p of error ~ h^p, fitted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ObservedOrder {
    pub order: f64,
    /// From the scatter about the fit; infinite for two levels.
    pub standard_error: f64,
    pub n_levels: usize,
}

/// One level of refinement: a step width and what was computed with it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Level {
    pub step: f64,
    pub value: f64,
}

/// Where three levels are heading.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Extrapolation {
    /// The value at step 0, if value = limit + constant · step^order holds.
    pub limit: f64,
    pub order: f64,
    /// |limit − finest value|: the estimated discretisation error of the finest level.
    pub finest_error: f64,
}

/// Why a sequence shows no rate.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum RatesError {
    #[error("no order can be fitted: {0}")]
    Fit(#[from] FitError),
    #[error("steps must be finite, above zero and falling: level {level} has {step:e}")]
    Steps { level: usize, step: f64 },
    #[error("level {level} has the value {value:e}, must be finite")]
    NotFinite { level: usize, value: f64 },
    #[error("the values do not settle: the differences {coarse:e} and then {fine:e} oscillate, grow, or vanish")]
    NotConverging { coarse: f64, fine: f64 },
}

/// Order of convergence from pairs (step, error), errors unsigned and above zero: the slope of log error over log step.
///
/// # Errors
/// Fewer than two pairs, or a number that is not finite and above zero.
pub fn observed_order(errors: &[(f64, f64)]) -> Result<ObservedOrder, RatesError> {
    let (steps, errors): (Vec<f64>, Vec<f64>) = errors.iter().copied().unzip();
    let line = fit_power_law(&steps, &errors)?;
    Ok(ObservedOrder { order: line.slope, standard_error: line.slope_standard_error, n_levels: line.n_points })
}

/// Limit and order from three levels, coarsest first, whose steps may shrink unevenly: solves
/// value = limit + constant · step^order for its three unknowns (Richardson 1911; Roache 1994 for unknown order).
///
/// The order is the root of (h₁ᵖ − h₂ᵖ)/(h₂ᵖ − h₃ᵖ) = (v₁ − v₂)/(v₂ − v₃), which rises with p, found by bisection to the last digit.
///
/// # Errors
/// Steps that do not fall, values that are not finite, or differences that oscillate, grow or vanish: then the levels are not in the asymptotic
/// range and there is no limit to be had from them.
pub fn richardson(levels: [Level; 3]) -> Result<Extrapolation, RatesError> {
    for (level, Level { step, value }) in levels.iter().enumerate() {
        let falls = level == 0 || *step < levels[level - 1].step;
        if !(step.is_finite() && *step > 0.0 && falls) {
            return Err(RatesError::Steps { level, step: *step });
        }
        if !value.is_finite() {
            return Err(RatesError::NotFinite { level, value: *value });
        }
    }
    let [first, second, third] = levels;
    let (coarse, fine) = (first.value - second.value, second.value - third.value);
    let not_converging = RatesError::NotConverging { coarse, fine };
    let observed = coarse / fine;
    let (wide, narrow) = ((first.step / second.step).ln(), (third.step / second.step).ln());
    let expected = |order: f64| (order * wide).exp_m1() / -(order * narrow).exp_m1();
    let (mut low, mut high) = ORDERS;
    if !(expected(low)..=expected(high)).contains(&observed) {
        return Err(not_converging);
    }

    // Halve the interval until it has no middle left.
    let order = loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break middle;
        }
        if expected(middle) < observed {
            low = middle;
        } else {
            high = middle;
        }
    };

    // Follow the power law from the two finest levels down to step 0.
    let remaining = fine / (-order * narrow).exp_m1();
    Ok(Extrapolation { limit: third.value - remaining, order, finest_error: remaining.abs() })
}
