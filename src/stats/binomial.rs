//! Exact tests of how often something happened.

use super::{binomial_lower_tail, binomial_tail};
use serde::Serialize;

/// The outcome of the test.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BinomialTest {
    pub n_successes: u64,
    pub n_trials: u64,
    /// Probability of as many successes or more, were the rate true.
    pub upper: f64,
    /// Probability of as many or fewer.
    pub lower: f64,
    /// Twice the smaller of the two, at most 1.
    pub p_value: f64,
}

/// Tests how often something happened in independent trials against the rate it should have (Clopper & Pearson 1934).
///
/// Exact, and by the discreteness of counts a little reluctant: false alarms are no more frequent than the significance, often
/// rarer. `n_successes` is taken as at most `n_trials`.
pub fn binomial_test(n_successes: u64, n_trials: u64, rate: f64) -> BinomialTest {
    let upper = binomial_tail(n_successes, n_trials, rate);
    let lower = binomial_lower_tail(n_successes, n_trials, rate);
    BinomialTest { n_successes, n_trials, upper, lower, p_value: (2.0 * upper.min(lower)).min(1.0) }
}

/// The rates that [`binomial_test`] at significance alpha does not refute, lowest and highest (Clopper & Pearson 1934): they hold
/// the true one with probability 1 − α at least.
pub fn binomial_interval(n_successes: u64, n_trials: u64, alpha: f64) -> [f64; 2] {
    let bisect = |is_below: &dyn Fn(f64) -> bool| {
        let (mut low, mut high) = (0.0, 1.0);
        loop {
            let middle: f64 = 0.5 * (low + high);
            if !(middle > low && middle < high) {
                return middle;
            }
            if is_below(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
    };
    let lowest =
        if n_successes == 0 { 0.0 } else { bisect(&|p| binomial_tail(n_successes, n_trials, p) < 0.5 * alpha) };
    let highest = if n_successes >= n_trials {
        1.0
    } else {
        bisect(&|p| binomial_lower_tail(n_successes, n_trials, p) > 0.5 * alpha)
    };
    [lowest, highest]
}
