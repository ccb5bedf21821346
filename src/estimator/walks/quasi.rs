//! Randomised quasi-Monte Carlo: gathering walks driven by scrambled Sobol' points.
//!
//! Point k of a scrambled sequence drives walk k, its first coordinate where a measurement begins, one more for each step. Each walk alone is
//! a Monte Carlo walk, so the mean over points has no bias; together they are more even than independent ones, and the error falls
//! faster than N^(−½), by as much as the score depends smoothly on few coordinates. Three things make it so: destinations come from
//! cumulative probabilities, so that walks of neighbouring points stay neighbours; a walk is weighed by the albedo in place of being absorbed,
//! while its weight is above 1/64; and later coordinates are weighed less for it.
//!
//! A sample is a whole *replicate* of N points with its own scrambling: the spread of replicates is the error bar, and nothing else is.
//!
//! Cost: O(log n) a step, and ln 64 / −ln albedo steps a walk before roulette; 12 bytes an entry of G above zero. Source: Owen 1997, 1998;
//! Keller 1996 (in radiosity).

use super::super::bands::Bands;
use super::super::bounces::Columns;
use super::super::{Estimator, Score, Truth};
use super::chain::Chain;
use super::measuring::Starts;
use super::{MatrixWalk, MeasuringWalk, Scoring};
use crate::linalg::{Block, LinearOperator};
use crate::sampling::{CumulativeRows, PaddedSobol, Stream};
use std::sync::Arc;

/// Weight below which walks are absorbed, and not before.
const LEAST_WEIGHT: f64 = 1.0 / 64.0;

/// Walks that one thread takes, in whole replicates.
const WALKS_A_TASK: u64 = 1 << 16;

/// Replicates of so many walks on one scrambled sequence. Scored: radiance of bundles, or measurements.
#[derive(Clone, Debug)]
pub struct QuasiWalk {
    columns: Columns,
    first_bounce: usize,
    chain: Arc<Chain>,
    steps: Arc<CumulativeRows>,
    /// n × 2 bands, row by row: a, and what a visit is worth, of every band.
    bundles: Vec<f64>,
    /// E, where expected values leave it to be added.
    offset: Option<Block>,
    /// One table of starts a measurement; none where every bundle is a start.
    starts: Vec<(Starts, CumulativeRows)>,
    n_points: u64,
}

impl MatrixWalk {
    /// These walks by scrambled points, `n_points` a bundle and replicate; best a power of two. Absorption and survival scoring become
    /// collision scoring, with nothing absorbed.
    pub fn quasi(&self, n_points: u64) -> QuasiWalk {
        let (chain, n) = (self.chain.clone(), self.n_bundles());
        let steps = CumulativeRows::new(n, n, |i, row| chain.propagation.row(0, i, row));
        let offset = (self.scoring() == Scoring::ExpectedValue).then(|| self.emission().clone());
        let worth = offset.as_ref().map(|emission| chain.transported(emission));
        let worth = worth.as_ref().unwrap_or(self.emission());
        let bundles = (0..n).flat_map(|i| chain.albedo.row(i).chain(worth.row(i))).collect();
        let columns = Columns { n_bands: chain.n_bands, bounces: self.bounces() };
        let first_bounce = self.scoring().first_bounce();
        QuasiWalk {
            columns,
            first_bounce,
            chain,
            steps: Arc::new(steps),
            bundles,
            offset,
            starts: Vec::new(),
            n_points,
        }
    }
}

impl MeasuringWalk {
    /// These walks by scrambled points, `n_points` a measurement and replicate; best a power of two.
    pub fn quasi(&self, n_points: u64) -> QuasiWalk {
        let table = |starts: &Starts| {
            let probabilities = starts.probabilities();
            CumulativeRows::new(1, probabilities.len(), |_, row| row.copy_from_slice(&probabilities))
        };
        let starts = self.starts.iter().map(|starts| (starts.clone(), table(starts))).collect();
        QuasiWalk { starts, ..self.walk.quasi(n_points) }
    }
}

impl QuasiWalk {
    /// The same with another number of points, on the same tables.
    pub fn with_points(&self, n_points: u64) -> Self {
        Self { n_points, ..self.clone() }
    }

    /// Adds the share of walk number `index` to the totals, and counts its steps.
    fn walk(&self, start: usize, points: PaddedSobol, index: u64, share: f64, totals: &mut [f64]) -> u64 {
        // Begin on the bundle, or where the measurement looks.
        let n_bands = self.columns.n_bands;
        let mut weights = Bands::all(share, n_bands);
        let (mut bundle, mut dimension) = (start, 0);
        if let Some((starts, table)) = self.starts.get(start) {
            // What rounding leaves above the last share counts as nothing drawn.
            let Some(drawn) = table.sample(0, points.coordinate(index, 0)) else { return 0 };
            (bundle, dimension) = (drawn, 1);
            weights.iter_mut().zip(starts.weights(bundle)).for_each(|(weight, w)| *weight *= w);
        }
        if let Some(offset) = &self.offset {
            let firsts = totals[..n_bands].iter_mut().zip(offset.row(bundle)).zip(weights.iter());
            firsts.for_each(|((total, e), weight)| *total += weight * e);
        }
        let first = weights.iter().fold(0.0, |largest: f64, weight| largest.max(weight.abs()));
        for n_steps in 0.. {
            // Score the visit.
            let Some(here) = self.columns.of(self.first_bounce + n_steps) else { return n_steps as u64 };
            let (albedo, worth) = self.bundles[bundle * 2 * n_bands..][..2 * n_bands].split_at(n_bands);
            for ((total, weight), worth) in totals[here].iter_mut().zip(weights.iter()).zip(worth) {
                *total += weight * worth;
            }

            // Reflect; absorb only what carries little, and use what is left of the number.
            let mut uniform = points.coordinate(index, dimension + n_steps);
            weights.iter_mut().zip(albedo).for_each(|(weight, albedo)| *weight *= albedo);
            let carried = weights.iter().fold(0.0, |largest: f64, weight| largest.max(weight.abs()));
            if carried < LEAST_WEIGHT * first {
                let survival = self.chain.survival[bundle];
                if uniform >= survival {
                    return n_steps as u64;
                }
                uniform /= survival;
                weights.iter_mut().for_each(|weight| *weight /= survival);
            }
            let Some(next) = self.steps.sample(bundle, uniform) else { return n_steps as u64 + 1 };
            bundle = next;
        }
        0
    }
}

impl Estimator for QuasiWalk {
    fn name(&self) -> &'static str {
        if self.starts.is_empty() { "quasi-walk" } else { "quasi-measurement" }
    }

    fn truth(&self) -> Truth {
        Truth::Discrete
    }

    fn n_bundles(&self) -> usize {
        if self.starts.is_empty() { self.chain.n_bundles() } else { self.starts.len() }
    }

    fn n_columns(&self) -> usize {
        self.columns.count()
    }

    fn samples_a_task(&self) -> u64 {
        WALKS_A_TASK / self.n_points.max(1)
    }

    fn sample(&self, start: usize, stream: &mut Stream, score: &mut Score) {
        let points = PaddedSobol::new(stream.bits());
        let (share, mut n_steps) = (1.0 / self.n_points as f64, 0);
        for index in 0..self.n_points {
            n_steps += self.walk(start, points, index, share, score.totals(start));
        }
        score.count_steps(n_steps);
    }
}
