//! Welch's test: do two samples of unequal variance have the same mean?

use super::Moments;
use super::student_tail;

/// The outcome of the test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TTest {
    /// Difference of the means over its standard error.
    pub t: f64,
    /// Effective number of degrees of freedom (Welch 1947).
    pub n_degrees_of_freedom: f64,
    /// Probability of a |t| at least this large, were the means equal.
    pub p_value: f64,
}

/// Tests whether two independent samples have the same mean, their variances being unknown and perhaps unequal.
///
/// Exact to a few per cent of the p-value for normal numbers, from five of each on. Others are normal in the mean only: a sample of
/// skewness γ moves a p-value by about γ (2t² + 1) / 6√n times the density at t, which in a far tail is a factor of exp(γ t³ / 3√n).
///
/// All NaN where either has fewer than two numbers; where neither varies, the
/// p-value is 1 for equal means and 0 for others.
pub fn welch_test(a: &Moments, b: &Moments) -> TTest {
    let (va, vb) = (a.variance_of_mean(), b.variance_of_mean());
    let difference = a.mean() - b.mean();
    if va + vb == 0.0 {
        let equal = difference == 0.0;
        let t = if equal { 0.0 } else { difference.signum() * f64::INFINITY };
        return TTest { t, n_degrees_of_freedom: (a.n() + b.n() - 2) as f64, p_value: if equal { 1.0 } else { 0.0 } };
    }
    let t = difference / (va + vb).sqrt();
    let share = va / (va + vb);
    let n_degrees_of_freedom = 1.0
        / (share * share / (a.n().saturating_sub(1)) as f64
            + (1.0 - share) * (1.0 - share) / (b.n().saturating_sub(1)) as f64);
    if t.is_nan() {
        return TTest { t, n_degrees_of_freedom: f64::NAN, p_value: f64::NAN };
    }
    TTest { t, n_degrees_of_freedom, p_value: 2.0 * student_tail(t.abs(), n_degrees_of_freedom) }
}
