//! What a z-test will see, before there is a sample to show it: budgets.

use super::{normal_critical, normal_tail};
use thiserror::Error;

/// Why no number of samples suffices.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum PowerError {
    #[error("a true difference of {difference:e} can never be shown to be within {margin:e}")]
    OutsideMargin { difference: f64, margin: f64 },
    #[error("a difference of {difference:e} can never be found, must be finite and not zero")]
    NoDifference { difference: f64 },
    #[error("{name} is {value:e}, must be in (0, 1)")]
    Probability { name: &'static str, value: f64 },
    #[error("the variance is {value:e}, must be finite and not negative")]
    Variance { value: f64 },
}

/// Probability that a two-sided z-test at significance alpha finds a mean to be off that is off by this much: of |Z + d/σ| >
/// z_{α/2}.
///
/// For one comparison of `n` use [`sidak_level`](super::sidak_level) as alpha. Exact for a normal mean of known standard error.
pub fn detection_power(difference: f64, standard_error: f64, alpha: f64) -> f64 {
    let (critical, shift) = (normal_critical(0.5 * alpha), difference.abs() / standard_error);
    normal_tail(critical - shift) + normal_tail(critical + shift)
}

/// Samples that a two-sided z-test needs to find a mean that is off by `difference` with probability `power`, for numbers of this
/// variance: about (z_{α/2} + z_{1−power})² variance/difference².
///
/// Where numbers are rare and large the normal approximation may ask for more: some 400 of them that are not zero.
///
/// # Errors
/// No difference to find, probabilities outside (0, 1), a variance that is negative or not finite.
pub fn detection_samples(difference: f64, variance: f64, alpha: f64, power: f64) -> Result<u64, PowerError> {
    if difference == 0.0 || !difference.is_finite() {
        return Err(PowerError::NoDifference { difference });
    }
    fewest_samples(variance, alpha, power, |standard_error| detection_power(difference, standard_error, alpha))
}

/// The least n at which a test reaches a power that rises as its standard error √(variance/n) falls.
pub(super) fn fewest_samples(
    variance: f64,
    alpha: f64,
    power: f64,
    power_of: impl Fn(f64) -> f64,
) -> Result<u64, PowerError> {
    for (name, value) in [("the significance", alpha), ("the power", power)] {
        if !(value > 0.0 && value < 1.0) {
            return Err(PowerError::Probability { name, value });
        }
    }
    if !(variance.is_finite() && variance >= 0.0) {
        return Err(PowerError::Variance { value: variance });
    }
    if variance == 0.0 {
        return Ok(1);
    }

    // Double until it suffices, then halve the gap.
    let suffices = |n: u64| power_of((variance / n as f64).sqrt()) >= power;
    let mut high = 1;
    while !suffices(high) && high < 1 << 62 {
        high *= 2;
    }
    let mut low = high / 2;
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        if suffices(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    Ok(high)
}
