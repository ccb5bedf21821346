//! A random answer with its error bars.

use super::{Estimator, Truth};
use crate::linalg::Block;
use std::ops::Range;
use thiserror::Error;

/// Means over independent samples, and how far they may be off.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// [`Estimator::name`].
    pub estimator: &'static str,
    /// What the mean would be after infinitely many samples.
    pub truth: Truth,
    pub seed: u64,
    /// Samples a start.
    pub n_samples: u64,
    /// Steps that all samples took together, of walks or rays; 0 for an estimator that does not count them.
    pub n_steps: u64,
    /// Which samples: disjoint, ascending.
    pub samples: Vec<Range<u64>>,
    /// n × bands, W m⁻² sr⁻¹.
    pub mean: Block,
    /// n × bands, the unbiased estimate of the variance of `mean`: (sample variance) / n_samples. NaN below two samples.
    pub variance_of_mean: Block,
    /// True if no sample scores two bundles, so that the errors of different bundles are independent.
    pub independent_bundles: bool,
}

/// Why two estimates are not parts of one.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum MergeError {
    #[error("estimates of '{left}' and of '{right}' are not parts of one")]
    Estimator { left: &'static str, right: &'static str },
    #[error("estimates with seeds {left} and {right} are not parts of one")]
    Seed { left: u64, right: u64 },
    #[error("estimates of {left:?} and of {right:?} bundles × bands are not parts of one")]
    Shape { left: (usize, usize), right: (usize, usize) },
    #[error("both estimates hold sample {sample}")]
    Overlap { sample: u64 },
}

/// A weighted mean of many bundles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightedMean {
    pub mean: f64,
    /// Variance of `mean`.
    pub variance: f64,
}

impl Estimate {
    /// Both estimates' samples together, as if they had been drawn at once; the same to rounding (Chan, Golub & LeVeque 1979).
    ///
    /// # Errors
    /// Estimates of different things, or with a sample in common.
    pub fn merge(&self, other: &Self) -> Result<Self, MergeError> {
        let shape = |estimate: &Self| (estimate.mean.n_rows(), estimate.mean.n_columns());
        if self.estimator != other.estimator {
            return Err(MergeError::Estimator { left: self.estimator, right: other.estimator });
        }
        if self.seed != other.seed {
            return Err(MergeError::Seed { left: self.seed, right: other.seed });
        }
        if shape(self) != shape(other) {
            return Err(MergeError::Shape { left: shape(self), right: shape(other) });
        }
        let samples = union(&self.samples, &other.samples)?;

        // Move each mean towards the other's by its share, and count how far apart they were as spread.
        let n_samples = self.n_samples + other.n_samples;
        let share = if n_samples == 0 { 0.0 } else { other.n_samples as f64 / n_samples as f64 };
        let mut merged = Self { n_samples, n_steps: self.n_steps + other.n_steps, samples, ..self.clone() };
        for (k, (theirs, variance)) in other.mean.values().iter().zip(other.variance_of_mean.values()).enumerate() {
            let (mine, apart) = (self.mean.values()[k], theirs - self.mean.values()[k]);
            let squared_deviations = squared_deviations(self.variance_of_mean.values()[k], self.n_samples)
                + squared_deviations(*variance, other.n_samples)
                + apart * apart * self.n_samples as f64 * share;
            merged.mean.values_mut()[k] = mine + apart * share;
            merged.variance_of_mean.values_mut()[k] = variance_of_mean(squared_deviations, n_samples);
        }
        Ok(merged)
    }

    /// Σ wᵢ meanᵢ / Σ wᵢ in one band, e.g. with areas as weights the mean of a surface. `None` where one sample scores several bundles,
    /// whose covariances are not kept.
    ///
    /// # Panics
    /// If there is not one weight a bundle.
    pub fn weighted_mean(&self, weights: &[f64], band: usize) -> Option<WeightedMean> {
        assert_eq!(weights.len(), self.mean.n_rows(), "there must be one weight a bundle");
        let total: f64 = weights.iter().sum();
        let (mut mean, mut variance) = (0.0, 0.0);
        let entries = self.mean.column(band).iter().zip(self.variance_of_mean.column(band)).zip(weights);
        for ((value, variance_of_value), weight) in entries.filter(|(_, weight)| **weight != 0.0) {
            let share = weight / total;
            mean += share * value;
            variance += share * share * variance_of_value;
        }
        self.independent_bundles.then_some(WeightedMean { mean, variance })
    }

    /// No samples yet.
    pub(super) fn empty(estimator: &dyn Estimator, seed: u64) -> Self {
        let (n, n_columns) = (estimator.n_bundles(), estimator.n_columns());
        Self {
            estimator: estimator.name(),
            truth: estimator.truth(),
            seed,
            n_samples: 0,
            n_steps: 0,
            samples: Vec::new(),
            mean: Block::zeros(n, n_columns),
            variance_of_mean: Block::from_fn(n, n_columns, |_, _| f64::NAN),
            independent_bundles: (0..estimator.n_starts()).all(|start| estimator.reach(start).len() <= 1),
        }
    }
}

/// Σ (x − mean)², back from the variance of the mean; 0 for a single number.
fn squared_deviations(variance_of_mean: f64, n: u64) -> f64 {
    if n < 2 { 0.0 } else { variance_of_mean * n as f64 * (n - 1) as f64 }
}

fn variance_of_mean(squared_deviations: f64, n: u64) -> f64 {
    if n < 2 { f64::NAN } else { squared_deviations / (n - 1) as f64 / n as f64 }
}

/// All samples of both, neighbours joined.
fn union(left: &[Range<u64>], right: &[Range<u64>]) -> Result<Vec<Range<u64>>, MergeError> {
    let mut ranges: Vec<Range<u64>> = left.iter().chain(right).cloned().collect();
    ranges.sort_by_key(|range| range.start);
    let mut joined: Vec<Range<u64>> = Vec::with_capacity(ranges.len());
    for range in ranges {
        match joined.last_mut() {
            Some(last) if range.start < last.end => return Err(MergeError::Overlap { sample: range.start }),
            Some(last) if range.start == last.end => last.end = range.end,
            _ => joined.push(range),
        }
    }
    Ok(joined)
}
