//! Many p-values at a glance.

use super::{KolmogorovSmirnov, UniformityError, sidak, uniformity_test};
use serde::Serialize;

/// How p-values are spread over [0, 1], and whether as true hypotheses' would be.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PValueHistogram {
    /// p-values in each of equal bins, the last one holding 1 too.
    pub counts: Vec<u64>,
    pub n: usize,
    /// Are they uniform? Sees a bulk that is shifted: error bars that are too small or too large.
    pub uniformity: KolmogorovSmirnov,
    pub smallest: f64,
    /// Probability that the smallest is this small, were all hypotheses true: sees one that is far off.
    pub smallest_corrected: f64,
}

/// Sorts p-values of independent tests into bins and judges them.
///
/// Only independent p-values are uniform *together*: those of correlated tests may bunch up with nothing wrong. Cost O(n log n).
///
/// # Errors
/// No p-values, or one outside [0, 1].
pub fn p_value_histogram(p_values: &[f64], n_bins: usize) -> Result<PValueHistogram, UniformityError> {
    let uniformity = uniformity_test(p_values)?;
    let n_bins = n_bins.max(1);
    let mut counts = vec![0; n_bins];
    for p in p_values {
        counts[((p * n_bins as f64) as usize).min(n_bins - 1)] += 1;
    }
    let smallest = p_values.iter().copied().fold(1.0, f64::min);
    let n = p_values.len();
    Ok(PValueHistogram { counts, n, uniformity, smallest, smallest_corrected: sidak(smallest, n) })
}
