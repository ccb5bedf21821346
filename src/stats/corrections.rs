//! What many p-values together may say.
//!
//! | correction | bounds | where |
//! |---|---|---|
//! | [`sidak`] | the probability of any false alarm | independent tests, or positively dependent ones |
//! | [`holm`] | the same, with more power | any dependence |
//! | [`benjamini_hochberg`] | the expected share of false alarms among the alarms | independent or positively dependent tests |
//! | [`benjamini_yekutieli`] | the same, with less power | any dependence |
//!
//! A p-value that is not a number stands for a comparison that could not be made, and counts as 0: it never agrees.

use serde::Serialize;

/// Which of many hypotheses fall.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Correction {
    /// For each hypothesis the smallest level at which it would fall, at most 1.
    pub adjusted: Vec<f64>,
    /// Those whose adjusted p-value is at most the level.
    pub rejected: Vec<bool>,
    pub n_rejected: usize,
}

/// Probability that the smallest of `n` independent p-values is at most p: 1 − (1 − p)ⁿ (Šidák 1967).
///
/// For comparisons that are not independent it errs towards keeping the hypothesis wherever they are positively dependent.
pub fn sidak(p: f64, n: usize) -> f64 {
    -(n as f64 * (-p).ln_1p()).exp_m1()
}

/// The level of one comparison that gives `n` of them together the level alpha: 1 − (1 − α)^{1/n}, the inverse of [`sidak`].
pub fn sidak_level(alpha: f64, n: usize) -> f64 {
    if n == 0 { alpha } else { -((-alpha).ln_1p() / n as f64).exp_m1() }
}

/// Holm's step-down procedure (1979): the probability of any false alarm is at most alpha, whatever the dependence.
///
/// Exact where the p-values are. Cost O(n log n).
pub fn holm(p_values: &[f64], alpha: f64) -> Correction {
    let n = p_values.len();
    let mut largest: f64 = 0.0;
    let mut adjusted = vec![0.0; n];
    for (rank, k) in ascending(p_values).into_iter().enumerate() {
        largest = largest.max((n - rank) as f64 * number(p_values[k])).min(1.0);
        adjusted[k] = largest;
    }
    correction(adjusted, alpha)
}

/// Benjamini's and Hochberg's step-up procedure (1995): of the hypotheses that fall, an expected share of at most alpha are true.
/// Where all are true, that is the probability of any alarm.
///
/// For independent p-values, or positively dependent ones (Benjamini & Yekutieli 2001). Cost O(n log n).
pub fn benjamini_hochberg(p_values: &[f64], alpha: f64) -> Correction {
    step_up(p_values, alpha, 1.0)
}

/// Benjamini's and Yekutieli's procedure (2001): [`benjamini_hochberg`] at alpha over 1 + 1/2 + … + 1/n, for any dependence.
pub fn benjamini_yekutieli(p_values: &[f64], alpha: f64) -> Correction {
    let penalty = (1..=p_values.len()).map(|k| 1.0 / k as f64).sum();
    step_up(p_values, alpha, penalty)
}

fn step_up(p_values: &[f64], alpha: f64, penalty: f64) -> Correction {
    let n = p_values.len();
    let mut smallest: f64 = 1.0;
    let mut adjusted = vec![0.0; n];
    for (rank, k) in ascending(p_values).into_iter().enumerate().rev() {
        smallest = smallest.min(penalty * n as f64 / (rank + 1) as f64 * number(p_values[k]));
        adjusted[k] = smallest;
    }
    correction(adjusted, alpha)
}

fn correction(adjusted: Vec<f64>, alpha: f64) -> Correction {
    let rejected: Vec<bool> = adjusted.iter().map(|p| *p <= alpha).collect();
    let n_rejected = rejected.iter().filter(|r| **r).count();
    Correction { adjusted, rejected, n_rejected }
}

fn ascending(p_values: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..p_values.len()).collect();
    order.sort_by(|a, b| number(p_values[*a]).total_cmp(&number(p_values[*b])));
    order
}

fn number(p: f64) -> f64 {
    if p.is_nan() { 0.0 } else { p }
}
