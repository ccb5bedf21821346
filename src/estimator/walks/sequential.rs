//! Sequential Monte Carlo: walks on the residual, again and again.
//!
//! ```text
//! r = E + K L̃ − L̃,      δ = r + K δ by walks,      L̃ ← L̃ + δ̃
//! ```
//!
//! The error of a stage is the random error of δ̃, whose standard deviation is proportional to what was left before: with N walks a bundle
//! the error falls by a factor of about σ/√N every stage, σ² the variance of a walk whose right-hand side is 1 in size. So it falls
//! exponentially with the work, where plain averaging halves it for four times the work, and the same number of walks suffices
//! for any accuracy until the residual is rounding. N must exceed σ², or the error grows.
//!
//! The answer is an estimate of L with a known residual, not a mean with an error bar. Cost of a stage: one product (two where expected
//! values are scored), N walks a bundle.
//! Source: Halton 1962, 1994.

use super::super::{Bounces, estimate};
use super::MatrixWalk;
use crate::linalg::{Block, max_abs};
use crate::sampling::mix_seed;

/// A residual that has not halved for so many stages is rounding, or N is too small.
const PATIENCE: usize = 4;

/// When to stop, and how much to draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sequential {
    /// ‖E + K L̃ − L̃‖∞ ≤ tolerance · ‖E‖∞ in every band.
    pub tolerance: f64,
    /// N, walks a bundle and stage.
    pub n_walks: u64,
    pub max_stages: usize,
}

/// One stage, after its walks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stage {
    /// Products with K so far.
    pub n_products: usize,
    /// Steps of walks so far.
    pub n_steps: u64,
    /// ‖E + K L̃ − L̃‖∞ / ‖E‖∞, the worst band.
    pub residual: f64,
}

/// Why it stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SequentialStop {
    /// The residual is within the tolerance.
    Converged,
    /// The number of stages was used up.
    Budget,
    /// The residual falls no further: it is rounding, or there are too few walks.
    Stalled,
}

/// An answer and how it was reached.
#[derive(Clone, Debug, PartialEq)]
pub struct SequentialEstimate {
    /// L̃ of the smallest residual, n × bands, W m⁻² sr⁻¹.
    pub radiance: Block,
    /// Stage 0 is L̃ = 0.
    pub history: Vec<Stage>,
    pub stop: SequentialStop,
}

impl MatrixWalk {
    /// Sequential Monte Carlo by these walks, of any scoring; bounces are not looked at.
    pub fn sequential(&self, settings: Sequential, seed: u64) -> SequentialEstimate {
        self.sequential_watched(settings, seed, &mut |_, _| ())
    }

    /// [`MatrixWalk::sequential`], showing every stage after it and its L̃ to `watch`.
    pub fn sequential_watched(
        &self,
        settings: Sequential,
        seed: u64,
        watch: &mut dyn FnMut(Stage, &Block),
    ) -> SequentialEstimate {
        let emission = self.emission();
        let sizes: Vec<f64> = emission.columns().map(max_abs).collect();
        let relative = |residual: &Block| {
            let bands = residual.columns().zip(&sizes);
            bands.fold(0.0, |worst: f64, (r, size)| if *size > 0.0 { worst.max(max_abs(r) / size) } else { worst })
        };
        let whole = self.clone().with_bounces(Bounces::All);
        let mut radiance = Block::zeros(emission.n_rows(), emission.n_columns());
        let mut residual = emission.clone();
        let mut history = vec![Stage { n_products: 0, n_steps: 0, residual: relative(&residual) }];
        let (mut best, mut since_halved) = (radiance.clone(), (history[0].residual, 0));
        let stop = loop {
            let (n_stages, last) = (history.len() - 1, history[history.len() - 1]);
            if last.residual <= settings.tolerance {
                break SequentialStop::Converged;
            }
            if since_halved.1 >= PATIENCE {
                break SequentialStop::Stalled;
            }
            if n_stages == settings.max_stages {
                break SequentialStop::Budget;
            }

            // Estimate the correction from what is left, with walks of this stage alone.
            let walk = whole.with_emission(residual.clone());
            let correction = estimate(&walk, settings.n_walks, mix_seed(seed, n_stages as u64));
            radiance.add_scaled(1.0, &correction.mean);

            // See what is left now.
            residual = self.chain.transported(&radiance);
            residual.add_scaled(-1.0, &radiance);
            residual.add_scaled(1.0, emission);
            let size = relative(&residual);
            if history.iter().all(|stage| size < stage.residual) {
                best.copy_from(&radiance);
            }
            since_halved = if size <= 0.5 * since_halved.0 { (size, 0) } else { (since_halved.0, since_halved.1 + 1) };
            let n_products = last.n_products + 1 + self.scoring().first_bounce();
            let n_steps = last.n_steps + correction.n_steps;
            let stage = Stage { n_products, n_steps, residual: size };
            watch(stage, &radiance);
            history.push(stage);
        };
        SequentialEstimate { radiance: best, history, stop }
    }
}
