//! Random walks on the assembled matrix: gathering, one walk a sample.
//!
//! ```text
//! Lᵢ = Eᵢ + aᵢ Σⱼ Gᵢⱼ Lⱼ        K = S G with S = diag(a), a for the albedo of one band
//! ```
//!
//! A walk stands on bundle i with weight w, survives with probability pᵢ = max over bands of aᵢ, and then steps to bundle j with
//! probability Gᵢⱼ: rows of G sum to at most 1, and what they lack is light from outside, where the walk ends. All bands share the
//! walk; w ← w aᵢ / pᵢ ≤ w sets them right. A visit scores w αᵢ if it is the last and w βᵢ if it is not, and whatever these are, the
//! expectation of a walk's score obeys
//!
//! ```text
//! E[Xᵢ] = (1 − pᵢ) αᵢ + pᵢ βᵢ + pᵢ Σⱼ Gᵢⱼ (aᵢ/pᵢ) E[Xⱼ],
//! ```
//!
//! which is the equation of L if (1 − p) α + p β = E: see [`Scoring`]. Expected-value walks answer L − E = K E + K (L − E) instead, and E is
//! added unsampled.
//!
//! Variance: weights never exceed 1 and a score never 10 E, so X is at most 10 max E times the length of the walk. The tail of the
//! length falls geometrically as soon as every bundle can reach one that absorbs or loses light (checked), so all moments exist.
//!
//! Cost: one random number, one alias slot and 2 × bands additions a step. A slot is 16 bytes, for every entry of G above zero.

use super::super::bands::Bands;
use super::super::bounces::Columns;
use super::super::{Bounces, Estimator, EstimatorError, Score, Truth};
use super::Scoring;
use super::chain::Chain;
use crate::assembly::System;
use crate::linalg::Block;
use crate::sampling::{Stream, Streams};
use std::ops::Range;
use std::sync::Arc;

/// Walks that one thread moves in turns: hides the time that memory takes to deliver a slot of a large matrix.
pub(super) const N_ABREAST: usize = 64;

/// Walks on K whose mean is (I − K)⁻¹E, in every band.
#[derive(Clone, Debug)]
pub struct MatrixWalk {
    scoring: Scoring,
    columns: Columns,
    pub(super) chain: Arc<Chain>,
    /// n × (1 + 3 bands), row by row: p, then a / p, α and β of every band.
    bundles: Vec<f64>,
    /// E.
    emission: Block,
}

/// A walk on its way.
pub(super) struct Walk {
    bundle: usize,
    is_inside: bool,
    /// Steps taken.
    n_steps: usize,
    stream: Stream,
    /// Chooses the next step.
    uniform: f64,
    pub weights: Bands,
    totals: Bands,
}

impl MatrixWalk {
    /// Walks that score at every visit. Cost O(n²), memory [`MatrixWalk::memory_estimate`].
    ///
    /// # Errors
    /// Rows of G that sum above 1 (closure was left unrepaired), or a closed part of the scene in which the largest albedo over the bands is
    /// 1 everywhere.
    pub fn collision(system: &System) -> Result<Self, EstimatorError> {
        Self::new(system, Scoring::Collision)
    }

    /// Walks that score where they are absorbed. Cost, memory and errors as for [`MatrixWalk::collision`].
    pub fn absorption(system: &System) -> Result<Self, EstimatorError> {
        Self::new(system, Scoring::Absorption)
    }

    /// Walks of any scoring. Cost, memory and errors as for [`MatrixWalk::collision`].
    pub fn new(system: &System, scoring: Scoring) -> Result<Self, EstimatorError> {
        Ok(Self::over(Arc::new(Chain::new(system)?), system.emission().clone(), scoring))
    }

    /// The same walks scored otherwise, on the same tables: nothing of size n² is copied. Expected values take one product.
    pub fn with_scoring(&self, scoring: Scoring) -> Self {
        Self { columns: self.columns, ..Self::over(self.chain.clone(), self.emission.clone(), scoring) }
    }

    /// The same walks, scored for these bounces.
    pub fn with_bounces(self, bounces: Bounces) -> Self {
        Self { columns: Columns { bounces, ..self.columns }, ..self }
    }

    /// The same walks for another right-hand side E, n × bands, of any sign, on the same tables.
    ///
    /// # Panics
    /// If E has another shape than the system's.
    pub fn with_emission(&self, emission: Block) -> Self {
        assert_eq!((emission.n_rows(), emission.n_columns()), (self.chain.n_bundles(), self.chain.n_bands));
        Self { columns: self.columns, ..Self::over(self.chain.clone(), emission, self.scoring) }
    }

    pub fn scoring(&self) -> Scoring {
        self.scoring
    }

    /// Bytes that the tables for n bundles may take, with nothing hidden: 16 a slot, twice that while their list grows.
    pub fn memory_estimate(n_bundles: usize) -> u64 {
        let n = n_bundles as u64;
        n.saturating_mul(n + 1).saturating_mul(32)
    }

    fn over(chain: Arc<Chain>, emission: Block, scoring: Scoring) -> Self {
        // Split what a visit is worth into what the last one scores and what all others do.
        let n_bands = chain.n_bands;
        let expected = (scoring == Scoring::ExpectedValue).then(|| chain.transported(&emission));
        let worth = expected.as_ref().unwrap_or(&emission);
        let mut bundles = Vec::with_capacity(chain.n_bundles() * (1 + 3 * n_bands));
        for (i, survival) in chain.survival.iter().enumerate() {
            let (last, other) = scoring.shares(*survival);
            bundles.push(*survival);
            bundles.extend(chain.gain(i));
            bundles.extend(worth.row(i).map(|e| last * e));
            bundles.extend(worth.row(i).map(|e| other * e));
        }
        let columns = Columns { n_bands, bounces: Bounces::All };
        Self { scoring, columns, chain, bundles, emission }
    }

    pub(super) fn bounces(&self) -> Bounces {
        self.columns.bounces
    }

    /// α and β, n × bands each.
    pub(super) fn scores(&self) -> [Block; 2] {
        let (n, n_bands) = (self.chain.n_bundles(), self.chain.n_bands);
        let at =
            |first: usize| Block::from_fn(n, n_bands, |i, band| self.bundles[i * (1 + 3 * n_bands) + first + band]);
        [at(1 + n_bands), at(1 + 2 * n_bands)]
    }

    pub(super) fn emission(&self) -> &Block {
        &self.emission
    }
}

impl Estimator for MatrixWalk {
    fn name(&self) -> &'static str {
        match self.scoring {
            Scoring::Collision => "collision-walk",
            Scoring::Absorption => "absorption-walk",
            Scoring::Survival => "survival-walk",
            Scoring::ExpectedValue => "expected-value-walk",
        }
    }

    fn truth(&self) -> Truth {
        Truth::Discrete
    }

    fn n_bundles(&self) -> usize {
        self.chain.n_bundles()
    }

    fn n_columns(&self) -> usize {
        self.columns.count()
    }

    fn sample(&self, start: usize, stream: &mut Stream, score: &mut Score) {
        *stream = self.finish(self.begin(start, stream.clone()), start, score);
    }

    fn samples(&self, start: usize, numbers: Range<u64>, streams: &Streams, score: &mut Score) {
        let walks = numbers.map(|number| self.begin(start, streams.stream(start as u32, number)));
        self.abreast(walks, start, score);
    }
}

impl MatrixWalk {
    /// A walk that stands on its first bundle.
    pub(super) fn begin(&self, start: usize, stream: Stream) -> Walk {
        let (n_bands, weights) = (self.columns.n_bands, Bands::all(1.0, self.columns.n_bands));
        let mut totals = Bands::all(0.0, self.columns.count());
        if self.scoring == Scoring::ExpectedValue {
            totals[..n_bands].iter_mut().zip(self.emission.row(start)).for_each(|(total, e)| *total = e);
        }
        Walk { bundle: start, is_inside: true, n_steps: 0, stream, uniform: 0.0, weights, totals }
    }

    /// Takes one walk to its end, scores it in `slot` and gives its stream back.
    pub(super) fn finish(&self, mut walk: Walk, slot: usize, score: &mut Score) -> Stream {
        while walk.is_inside && self.visit(&mut walk) {
            let next = self.chain.steps.sample(walk.bundle, walk.uniform);
            walk.go(next);
        }
        walk.score(slot, score);
        walk.stream
    }

    /// Takes all these walks to their ends, many at a time, each a sample scored in `slot`.
    pub(super) fn abreast(&self, mut waiting: impl Iterator<Item = Walk>, slot: usize, score: &mut Score) {
        let mut walks: Vec<Walk> = waiting.by_ref().take(N_ABREAST).collect();
        let mut draws = Vec::with_capacity(N_ABREAST);
        while !walks.is_empty() {
            // Score every walk, and put a new one in the place of each that ends.
            let mut k = 0;
            while k < walks.len() {
                if walks[k].is_inside && self.visit(&mut walks[k]) {
                    k += 1;
                    continue;
                }
                walks[k].score(slot, score);
                score.end_sample();
                match waiting.next() {
                    Some(walk) => walks[k] = walk,
                    None => drop(walks.swap_remove(k)),
                }
            }

            // Move them all: first nothing but reads, so that memory delivers many slots at a time.
            draws.clear();
            draws.extend(walks.iter().map(|walk| self.chain.steps.fetch(walk.bundle, walk.uniform)));
            walks.iter_mut().zip(&draws).for_each(|(walk, draw)| walk.go(draw.column()));
        }
    }

    /// Scores the bundle that a walk stands on; false where it is absorbed.
    #[inline]
    fn visit(&self, walk: &mut Walk) -> bool {
        let n_bands = self.chain.n_bands;
        let row = &self.bundles[walk.bundle * (1 + 3 * n_bands)..][..1 + 3 * n_bands];
        let (survival, row) = (row[0], &row[1..]);
        let (gain, row) = row.split_at(n_bands);
        let (at_last, at_other) = row.split_at(n_bands);
        let Some(here) = self.columns.of(self.scoring.first_bounce() + walk.n_steps) else { return false };
        let totals = &mut walk.totals[here];

        // Absorb it with probability 1 − p; below p, the number over p is uniform again.
        let uniform = walk.stream.uniform();
        if uniform >= survival {
            add(totals, &walk.weights, at_last);
            return false;
        }
        add(totals, &walk.weights, at_other);
        walk.uniform = uniform / survival;
        walk.weights.iter_mut().zip(gain).for_each(|(weight, gain)| *weight *= gain);
        true
    }
}

impl Walk {
    /// Begins with other weights than 1.
    pub fn weigh(&mut self, weights: impl Iterator<Item = f64>) {
        for (band, w) in weights.enumerate() {
            self.weights[band] = w;
            self.totals[band] *= w;
        }
    }

    /// Moves to the next bundle, or out of the scene.
    #[inline]
    fn go(&mut self, next: Option<usize>) {
        self.n_steps += 1;
        match next {
            Some(next) => self.bundle = next,
            None => self.is_inside = false,
        }
    }

    fn score(&self, slot: usize, score: &mut Score) {
        score.count_steps(self.n_steps as u64);
        score.totals(slot).iter_mut().zip(self.totals.iter()).for_each(|(total, scored)| *total += scored);
    }
}

/// totals ← totals + weights · values, band by band.
#[inline]
pub(super) fn add(totals: &mut [f64], weights: &[f64], values: &[f64]) {
    for ((total, weight), value) in totals.iter_mut().zip(weights).zip(values) {
        *total += weight * value;
    }
}
