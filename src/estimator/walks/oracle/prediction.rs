//! What a walk's error bars will be.

use crate::linalg::Block;
use thiserror::Error;

/// How many moments to predict.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Order {
    /// Error bars: one equation.
    Variance,
    /// And how far a measured variance may be off its prediction: two more.
    Fourth,
}

/// Moments of one sample's score about its mean, n × columns each, exact for the matrix to the accuracy of the solver.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    pub mean: Block,
    pub variance: Block,
    /// Third and fourth moments about the mean, if asked for.
    pub third: Option<Block>,
    pub fourth: Option<Block>,
}

/// Why a walk's moments cannot be predicted.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum OracleError<E> {
    #[error(
        "the score has no moment of order {order}: the spectral radius of its matrix is at least {radius:.6}, must be below 1"
    )]
    Infinite { order: usize, radius: f64 },
    #[error(
        "whether the score has a moment of order {order} is undecided: the spectral radius of its matrix lies between {low:.9} and {high:.9}"
    )]
    Undecided { order: usize, low: f64, high: f64 },
    #[error("the sum of bounces up to {last} is not predicted where particles are shot: score each bounce, or all")]
    PartialSum { last: usize },
    #[error(transparent)]
    Solve(E),
}

impl Prediction {
    /// Standard errors of the means of so many samples, n × columns.
    pub fn standard_error(&self, n_samples: u64) -> Block {
        let of = |variance: f64| (variance / n_samples as f64).sqrt();
        self.each(|i, c| of(self.variance.get(i, c)))
    }

    /// Samples after which no standard error exceeds `error`, in the units of the mean.
    pub fn samples_for(&self, error: f64) -> u64 {
        self.most_samples(|_| error)
    }

    /// Samples after which no standard error exceeds `error` times the magnitude of its own mean; entries with mean 0 have no say.
    pub fn samples_for_relative(&self, error: f64) -> u64 {
        self.most_samples(|mean| if mean == 0.0 { f64::INFINITY } else { error * mean.abs() })
    }

    /// Standard errors of the sample variances of so many samples, n × columns: √((F − V² (N − 3)/(N − 1)) / N).
    pub fn variance_standard_error(&self, n_samples: u64) -> Option<Block> {
        let (fourth, n) = (self.fourth.as_ref()?, n_samples as f64);
        Some(self.each(|i, c| {
            let variance = self.variance.get(i, c);
            ((fourth.get(i, c) - variance * variance * (n - 3.0) / (n - 1.0)) / n).max(0.0).sqrt()
        }))
    }

    /// T / V^(3/2), n × columns; 0 where nothing varies.
    pub fn skewness(&self) -> Option<Block> {
        let third = self.third.as_ref()?;
        Some(self.each(|i, c| ratio(third.get(i, c), self.variance.get(i, c).powf(1.5))))
    }

    /// F / V², n × columns; 0 where nothing varies.
    pub fn kurtosis(&self) -> Option<Block> {
        let fourth = self.fourth.as_ref()?;
        Some(self.each(|i, c| ratio(fourth.get(i, c), self.variance.get(i, c).powi(2))))
    }

    fn each(&self, value: impl FnMut(usize, usize) -> f64) -> Block {
        Block::from_fn(self.mean.n_rows(), self.mean.n_columns(), value)
    }

    /// The most that any entry needs for its error, at least 1.
    fn most_samples(&self, error: impl Fn(f64) -> f64) -> u64 {
        let needs = self
            .mean
            .values()
            .iter()
            .zip(self.variance.values())
            .map(|(mean, variance)| variance / error(*mean).powi(2));
        needs.fold(1.0, |most: f64, n| most.max(n.ceil())) as u64
    }
}

fn ratio(moment: f64, scale: f64) -> f64 {
    if scale > 0.0 { moment / scale } else { 0.0 }
}
