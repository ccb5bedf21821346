//! Intervals that hold at all times together: one may look while it runs, and stop when one has seen enough.
//!
//! A confidence interval at 95 % that is looked at again and again misses the truth sooner or later, by the law of the iterated
//! logarithm. A confidence *sequence* misses it at any time at all with probability alpha at most. The price is a width some 1.5
//! to 2 times that of an interval for one look.

use super::{Moments, z_score};
use serde::Serialize;
use thiserror::Error;

/// The mixture of Robbins (1970) over normal means, for means of many numbers of any distribution with a variance:
///
/// ```text
/// |mean − μ| < s √( 2 (n ρ² + 1) / (n² ρ²) · ln(√(n ρ² + 1) / α) )   for all n ≥ n₀ together, with probability 1 − α
/// ```
///
/// Exact for normal numbers of known variance s², from n₀ = 1 on. With the sample's own variance it is asymptotic in n₀
/// (Waudby-Smith, Arbour, Sinha, Kennedy & Ramdas 2024): nothing is claimed before `first`, and what is claimed from there on is
/// as good as the normal approximation is at `first`. Measured on exponential numbers at α = 0.05: 5.0 % of runs are missed at
/// some time between the 100th number and the 30 000th, 2.8 % from the 1000th on. Scores that hit once in N need `first` ≫ N.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NormalMixture {
    alpha: f64,
    /// ρ².
    mixture: f64,
    first: u64,
}

impl NormalMixture {
    /// The sequence of level alpha that starts after `first` numbers and is about as narrow as can be after `best` of them. At α = 0.05
    /// it is 27 % wider than could be at a tenth of `best`, and 7 % at ten times it.
    ///
    /// # Errors
    /// A significance outside (0, 1).
    pub fn new(alpha: f64, first: u64, best: u64) -> Result<Self, ConfidenceError> {
        check_significance(alpha)?;
        let surprise = -2.0 * alpha.ln();
        let mixture = (surprise + (surprise + 1.0).ln()) / best.max(1) as f64;
        Ok(Self { alpha, mixture, first: first.max(2) })
    }

    /// The probability of ever missing.
    pub fn alpha(&self) -> f64 {
        self.alpha
    }

    /// The same sequence at another level, in (0, 1): for one of many.
    pub fn at_level(self, alpha: f64) -> Self {
        Self { alpha, ..self }
    }

    /// Half the width of the interval in standard errors of the mean of n numbers: what a |z| may come to at that time. Infinite
    /// before the sequence starts.
    pub fn critical_z(&self, n: u64) -> f64 {
        if n < self.first {
            return f64::INFINITY;
        }
        let spread = n as f64 * self.mixture;
        let growth = spread + 1.0;
        (2.0 * growth / spread * (growth.sqrt() / self.alpha).ln()).sqrt()
    }

    /// The level at which the sequence ends at this z-score of n numbers, at most 1: a p-value that is valid whenever one looks,
    /// and so is the least of all looks.
    pub fn p_value_of_z(&self, z: f64, n: u64) -> f64 {
        if n < self.first {
            return 1.0;
        }
        let spread = n as f64 * self.mixture;
        let growth = spread + 1.0;
        (growth.sqrt() * (-0.5 * z * z * spread / growth).exp()).min(1.0)
    }

    /// Half the width of the interval around the mean of these numbers.
    pub fn half_width(&self, sample: &Moments) -> f64 {
        if sample.n() < self.first { f64::INFINITY } else { self.critical_z(sample.n()) * sample.standard_error() }
    }

    /// The interval, lowest and highest.
    pub fn interval(&self, sample: &Moments) -> [f64; 2] {
        let half = self.half_width(sample);
        [sample.mean() - half, sample.mean() + half]
    }

    /// [`p_value_of_z`](Self::p_value_of_z) of the hypothesis that these numbers have this mean.
    pub fn p_value(&self, sample: &Moments, hypothesis: f64) -> f64 {
        if sample.n() < self.first {
            return 1.0;
        }
        self.p_value_of_z(z_score(sample.mean(), hypothesis, sample.variance_of_mean()), sample.n())
    }
}

/// The empirical-Bernstein sequence with predictable plug-ins (Waudby-Smith & Ramdas 2024, theorem 2), for scores between two
/// known bounds.
///
/// Holds for *any* distribution within the bounds, from the first number on, with nothing asymptotic about it: the numbers must
/// only all have the same mean given those before. For rare and large scores it is honest where every normal approximation is not.
/// Its width goes as the numbers' own standard deviation, not as the bounds', once there are many. The numbers' order counts, so
/// parts cannot be merged: push means of batches of one size to look less often.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct EmpiricalBernstein {
    bounds: [f64; 2],
    /// ln 2/α.
    surprise: f64,
    n: u64,
    /// Σ x and Σ (x − prediction)² of the numbers scaled to [0, 1].
    sum: f64,
    squares: f64,
    /// Σ λ, Σ λ x and Σ (−ln(1 − λ) − λ)(x − prediction)², the λ being bets placed before each number is seen.
    bets: f64,
    weighted: f64,
    spread: f64,
    interval: [f64; 2],
}

/// Why numbers have no confidence sequence.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum ConfidenceError {
    #[error("the bounds {low:e} and {high:e} must be finite and rising")]
    Bounds { low: f64, high: f64 },
    #[error("the significance is {value:e}, must be in (0, 1)")]
    Significance { value: f64 },
    #[error("number {index} is {value:e}, outside the bounds {low:e} and {high:e}: the sequence promises nothing")]
    OutOfBounds { index: u64, value: f64, low: f64, high: f64 },
}

impl EmpiricalBernstein {
    /// No bet is larger: keeps ψ finite.
    const LARGEST_BET: f64 = 0.5;

    /// # Errors
    /// Bounds that are not finite and rising, or a significance outside (0, 1).
    pub fn new([low, high]: [f64; 2], alpha: f64) -> Result<Self, ConfidenceError> {
        if !(low.is_finite() && high.is_finite() && low < high) {
            return Err(ConfidenceError::Bounds { low, high });
        }
        check_significance(alpha)?;
        Ok(Self {
            bounds: [low, high],
            surprise: (2.0 / alpha).ln(),
            n: 0,
            sum: 0.0,
            squares: 0.0,
            bets: 0.0,
            weighted: 0.0,
            spread: 0.0,
            interval: [low, high],
        })
    }

    /// Adds the next number.
    ///
    /// # Errors
    /// A number outside the bounds, which is not added.
    pub fn push(&mut self, value: f64) -> Result<(), ConfidenceError> {
        let [low, high] = self.bounds;
        if !(low..=high).contains(&value) {
            return Err(ConfidenceError::OutOfBounds { index: self.n, value, low, high });
        }
        let x = (value - low) / (high - low);

        // Bet by what the numbers so far, and half a coin toss, predict.
        let so_far = self.n as f64 + 1.0;
        let mean = (0.5 + self.sum) / so_far;
        let variance = (0.25 + self.squares) / so_far;
        let bet = (2.0 * self.surprise / (variance * so_far * (1.0 + so_far).ln())).sqrt().min(Self::LARGEST_BET);

        // Settle it.
        let cost = -(-bet).ln_1p() - bet;
        self.n += 1;
        self.sum += x;
        self.bets += bet;
        self.weighted += bet * x;
        self.spread += cost * (x - mean) * (x - mean);
        let updated = (0.5 + self.sum) / (so_far + 1.0);
        self.squares += (x - updated) * (x - updated);

        // An interval that held at all times lies in all intervals so far.
        let (centre, half) = (self.weighted / self.bets, (self.surprise + self.spread) / self.bets);
        let here = [centre - half, centre + half].map(|edge| low + edge * (high - low));
        self.interval = [self.interval[0].max(here[0]), self.interval[1].min(here[1])];
        Ok(())
    }

    /// How many numbers.
    pub fn n(&self) -> u64 {
        self.n
    }

    /// The lowest and the highest mean that no look so far has ruled out. Lowest above highest: all are ruled out, and the numbers
    /// do not share one mean.
    pub fn interval(&self) -> [f64; 2] {
        self.interval
    }
}

fn check_significance(value: f64) -> Result<(), ConfidenceError> {
    if value > 0.0 && value < 1.0 { Ok(()) } else { Err(ConfidenceError::Significance { value }) }
}
