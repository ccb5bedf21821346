//! Random answers to L = E + K L: walks on the matrix, and light paths in the scene itself.
//!
//! An estimator draws independent samples whose expectation is the radiance of the bundles. [`estimate`] averages them and keeps
//! the variance of every mean, so that each number can be held against the deterministic ones by its own error bar. A sample is
//! a function of (seed, estimator, start, number) alone: more samples, other threads, another order change none.

mod bands;
mod bounces;
mod error;
mod estimate;
mod paths;
mod run;
mod score;
mod walks;

pub use bounces::Bounces;
pub use error::EstimatorError;
pub use estimate::{Estimate, MergeError, WeightedMean};
pub use paths::{Bidirectional, Heuristic, Kernel, LightTracer, PathTracer, PhotonDensity, Roulette, Sampling};
pub use run::{estimate, estimate_range, estimate_watched};
pub use score::Score;
pub use walks::{
    GuidedWalk, LevelReport, MatrixWalk, MeasuringWalk, Multilevel, MultilevelEstimate, NestingError, OracleError,
    Order, Prediction, QuasiWalk, Scoring, Sequential, SequentialEstimate, SequentialStop, ShootingWalk, Stage,
    StochasticJacobi,
};

use crate::linalg::Block;
use crate::sampling::{Stream, Streams};
use std::fmt;
use std::ops::Range;

/// Which of the two truths a random answer has as its expectation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Truth {
    /// (I − K)⁻¹E of the assembled K.
    Discrete,
    /// The scene's own radiance, averaged over the étendue of every bundle.
    Continuous,
    /// The scene's own radiance smoothed by the kernel of a density estimate, and so biased by its width; or that bias itself.
    Smoothed,
}

impl fmt::Display for Truth {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Discrete => "discrete",
            Self::Continuous => "continuous",
            Self::Smoothed => "smoothed",
        })
    }
}

/// A way of drawing random numbers whose expectation is the radiance of the bundles.
///
/// Its samples begin at *starts*, and every start owns the bundles that its samples score. A gathering estimator has one start a
/// bundle and scores that bundle alone; a shooting one has a single start and scores all of them. No bundle belongs to two starts.
pub trait Estimator: Sync {
    /// Name on the command line and in reports. It keys the random numbers: two estimators of different names are independent.
    fn name(&self) -> &'static str;

    /// What the samples have as their expectation.
    fn truth(&self) -> Truth;

    /// How many bundles are scored, or measurements by an estimator of those: rows of its answer.
    fn n_bundles(&self) -> usize;

    /// Numbers scored a bundle: one a band, or one for every bounce and band, see [`Bounces`].
    fn n_columns(&self) -> usize;

    /// How many starts there are, at most 2³².
    fn n_starts(&self) -> usize {
        self.n_bundles()
    }

    /// The bundles that samples from this start may score.
    fn reach(&self, start: usize) -> Range<usize> {
        start..start + 1
    }

    /// Consecutive samples of one start that one thread draws: many enough that setting up and merging moments of its reach is little against
    /// drawing them, and no function of the threads.
    fn samples_a_task(&self) -> u64 {
        1024
    }

    /// What is added to the means without being sampled, n × columns, where something is: the samples' expectation is the rest.
    fn known(&self) -> Option<&Block> {
        None
    }

    /// Adds one sample to the score. For every bundle in reach, the expectation of what is added is its radiance; bundles to which
    /// nothing is added count as zero.
    fn sample(&self, start: usize, stream: &mut Stream, score: &mut Score);

    /// Draws the samples of these numbers from one start, each from its own stream, and ends each. Overridden where many samples at a
    /// time are faster than one after another.
    fn samples(&self, start: usize, numbers: Range<u64>, streams: &Streams, score: &mut Score) {
        for number in numbers {
            self.sample(start, &mut streams.stream(start as u32, number), score);
            score.end_sample();
        }
    }
}
