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
//! Long walks need many coordinates, and high dimensions are never even. *Sorted* replicates ([`QuasiWalk::sorted`]) need two: all walks take a step at a
//! time, sorted by the bundles they stand on, and walk number k of the order steps by the k-th number of a fresh scrambled sequence, so that
//! walks on neighbouring bundles spread evenly over where one may go from there. Still each walk alone is a Monte Carlo walk.
//!
//! Cost: O(log n) a step, O(log N) more where sorted, and ln 64 / −ln albedo steps a walk before roulette; 12 bytes an entry of G above zero. Source: Owen 1997, 1998;
//! Keller 1996 (in radiosity); L'Ecuyer, Lécot & Tuffin 2008 (sorted).

use super::super::bands::Bands;
use super::super::bounces::Columns;
use super::super::{Estimator, Score, Truth};
use super::chain::Chain;
use super::gathering::add;
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
    is_sorted: bool,
}

/// A walk of a sorted replicate.
struct Walker {
    bundle: usize,
    weights: Bands,
    /// The largest weight it began with.
    first: f64,
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
        let (steps, starts) = (Arc::new(steps), Vec::new());
        QuasiWalk { columns, first_bounce, chain, steps, bundles, offset, starts, n_points, is_sorted: false }
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

    /// The same walks, all of a replicate taken step by step in the order of their bundles. Memory: the walks of a replicate.
    pub fn sorted(&self) -> Self {
        Self { is_sorted: true, ..self.clone() }
    }

    /// A walk on its first bundle, or where the measurement looks by the number `uniform`; scores what is not sampled.
    fn begin(&self, start: usize, uniform: f64, totals: &mut [f64]) -> Option<Walker> {
        let n_bands = self.columns.n_bands;
        let mut weights = Bands::all(1.0 / self.n_points as f64, n_bands);
        let mut bundle = start;
        if let Some((starts, table)) = self.starts.get(start) {
            // What rounding leaves above the last share counts as nothing drawn.
            bundle = table.sample(0, uniform)?;
            weights.iter_mut().zip(starts.weights(bundle)).for_each(|(weight, w)| *weight *= w);
        }
        if let Some(offset) = &self.offset {
            let firsts = totals[..n_bands].iter_mut().zip(offset.row(bundle)).zip(weights.iter());
            firsts.for_each(|((total, e), weight)| *total += weight * e);
        }
        let first = largest(&weights);
        Some(Walker { bundle, weights, first })
    }

    /// Scores the visit after `n_steps` steps and moves on; false where the walk has ended.
    #[inline]
    fn go(&self, walker: &mut Walker, n_steps: usize, mut uniform: f64, totals: &mut [f64]) -> bool {
        let n_bands = self.columns.n_bands;
        let Some(here) = self.columns.of(self.first_bounce + n_steps) else { return false };
        let (albedo, worth) = self.bundles[walker.bundle * 2 * n_bands..][..2 * n_bands].split_at(n_bands);
        add(&mut totals[here], &walker.weights, worth);

        // Reflect; absorb only what carries little, and use what is left of the number.
        walker.weights.iter_mut().zip(albedo).for_each(|(weight, albedo)| *weight *= albedo);
        if largest(&walker.weights) < LEAST_WEIGHT * walker.first {
            let survival = self.chain.survival[walker.bundle];
            if uniform >= survival {
                return false;
            }
            uniform /= survival;
            walker.weights.iter_mut().for_each(|weight| *weight /= survival);
        }
        let next = self.steps.sample(walker.bundle, uniform);
        walker.bundle = next.unwrap_or(walker.bundle);
        next.is_some()
    }

    /// One walk by one point; its steps.
    fn walk(&self, start: usize, points: PaddedSobol, index: u64, totals: &mut [f64]) -> u64 {
        let first_dimension = usize::from(!self.starts.is_empty());
        let Some(mut walker) = self.begin(start, points.coordinate(index, 0), totals) else { return 0 };
        let mut n_steps = 0;
        while self.go(&mut walker, n_steps, points.coordinate(index, first_dimension + n_steps), totals) {
            n_steps += 1;
        }
        n_steps as u64
    }

    /// All walks, step by step; their steps.
    fn walk_sorted(&self, start: usize, stream: &mut Stream, totals: &mut [f64]) -> u64 {
        let points = PaddedSobol::new(stream.bits());
        let begin = |index| self.begin(start, points.coordinate(index, 0), totals);
        let mut walkers: Vec<Walker> = (0..self.n_points).filter_map(begin).collect();
        let mut n_all = 0;
        for n_steps in 0.. {
            if walkers.is_empty() {
                break;
            }
            walkers.sort_by_key(|walker| walker.bundle);
            let (points, mut index) = (PaddedSobol::new(stream.bits()), 0);
            walkers.retain_mut(|walker| {
                index += 1;
                self.go(walker, n_steps, points.coordinate(index - 1, 0), totals)
            });
            n_all += walkers.len() as u64;
        }
        n_all
    }
}

/// The largest magnitude.
fn largest(weights: &[f64]) -> f64 {
    weights.iter().fold(0.0, |largest: f64, weight| largest.max(weight.abs()))
}

impl Estimator for QuasiWalk {
    fn name(&self) -> &'static str {
        match (self.starts.is_empty(), self.is_sorted) {
            (true, false) => "quasi-walk",
            (false, false) => "quasi-measurement",
            (true, true) => "sorted-quasi-walk",
            (false, true) => "sorted-quasi-measurement",
        }
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
        let totals = score.totals(start);
        let n_steps = if self.is_sorted {
            self.walk_sorted(start, stream, totals)
        } else {
            let points = PaddedSobol::new(stream.bits());
            (0..self.n_points).map(|index| self.walk(start, points, index, totals)).sum()
        };
        score.count_steps(n_steps);
    }
}
