//! Random walks on the assembled matrix: gathering, one walk a sample.
//!
//! ```text
//! Lᵢ = Eᵢ + aᵢ Σⱼ Gᵢⱼ Lⱼ        K = S G with S = diag(a), a for the albedo of one band
//! ```
//!
//! A walk stands on bundle i with weight w, survives with probability pᵢ = max over bands of aᵢ, and then steps to bundle j with
//! probability Gᵢⱼ: rows of G sum to at most 1, and what they lack is light from outside, where the walk ends. All bands share the
//! walk; w ← w aᵢ / pᵢ ≤ w sets them right. On its way it scores
//!
//! ```text
//! X = Σ over visits of w vⱼ  +  w uⱼ on the bundle that absorbs it,      vⱼ + (1 − pⱼ) uⱼ = Eⱼ,
//! ```
//!
//! and for every such choice of v and u its expectation obeys E[Xᵢ] = vᵢ + (1 − pᵢ) uᵢ + pᵢ Σⱼ Gᵢⱼ (aᵢ/pᵢ) E[Xⱼ], which is the
//! equation of L. The *collision* walk has v = E, u = 0. The *absorption* (last event) walk has v = 0, u = E / (1 − p); on bundles with
//! pⱼ > 0.9, which end few walks or none, it would score rarely and hugely, or never, and scores v = E as the collision walk does.
//!
//! Variance: weights never exceed 1 and a score never 10 E, so X is at most 10 max E times the length of the walk. The tail of the
//! length falls geometrically as soon as every bundle can reach one that absorbs or loses light (checked), so all moments exist.
//!
//! Cost: one random number, one alias slot and 2 × bands additions a step. A slot is 16 bytes, for every entry of G above zero.
//! Source: Forsythe & Leibler 1950 (last event); Wasow 1952 (every visit).

use super::super::bands::Bands;
use super::super::bounces::Columns;
use super::super::{Bounces, Estimator, EstimatorError, Score, Truth};
use super::chain::Chain;
use crate::assembly::System;
use crate::sampling::{Stream, Streams};
use std::ops::Range;
use std::sync::Arc;

/// Bundles that absorb less than a tenth of the walks score every visit.
const LAST_EVENT_LIMIT: f64 = 0.9;

/// Walks that one thread moves in turns: hides the time that memory takes to deliver a slot of a large matrix.
const N_ABREAST: usize = 16;

/// When a walk scores.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Scoring {
    /// At every visit.
    Collision,
    /// Where it is absorbed.
    Absorption,
}

/// Walks on K whose mean is (I − K)⁻¹E, in every band.
#[derive(Clone, Debug)]
pub struct MatrixWalk {
    scoring: Scoring,
    columns: Columns,
    chain: Arc<Chain>,
    /// n × (1 + 3 bands), row by row: p, then a / p, v and u of every band.
    bundles: Vec<f64>,
}

/// A walk on its way.
struct Walk {
    bundle: usize,
    is_inside: bool,
    /// Steps taken.
    bounce: usize,
    stream: Stream,
    /// Chooses the next step.
    uniform: f64,
    weights: Bands,
    totals: Bands,
}

impl MatrixWalk {
    /// Walks that score at every visit. Cost O(n²), memory [`MatrixWalk::memory_estimate`].
    ///
    /// # Errors
    /// Rows of G that sum above 1 (closure was left unrepaired), or a closed part of the scene in which the largest albedo over the bands is
    /// 1 everywhere.
    pub fn collision(system: &System) -> Result<Self, EstimatorError> {
        Ok(Self::over(Arc::new(Chain::new(system)?), Scoring::Collision))
    }

    /// Walks that score where they are absorbed. Cost, memory and errors as for [`MatrixWalk::collision`].
    pub fn absorption(system: &System) -> Result<Self, EstimatorError> {
        Ok(Self::over(Arc::new(Chain::new(system)?), Scoring::Absorption))
    }

    /// The same walks scored otherwise, on the same tables: nothing of size n² is copied.
    pub fn with_scoring(&self, scoring: Scoring) -> Self {
        Self { columns: self.columns, ..Self::over(self.chain.clone(), scoring) }
    }

    /// The same walks, scored for these bounces.
    pub fn with_bounces(self, bounces: Bounces) -> Self {
        Self { columns: Columns { bounces, ..self.columns }, ..self }
    }

    pub fn scoring(&self) -> Scoring {
        self.scoring
    }

    /// Bytes that the tables for n bundles may take, with nothing hidden: 16 a slot, twice that while their list grows.
    pub fn memory_estimate(n_bundles: usize) -> u64 {
        let n = n_bundles as u64;
        n.saturating_mul(n + 1).saturating_mul(32)
    }

    fn over(chain: Arc<Chain>, scoring: Scoring) -> Self {
        // Split E into what a visit scores and what an absorption scores.
        let n_bands = chain.n_bands;
        let mut bundles = Vec::with_capacity(chain.bundles.len() / (1 + 2 * n_bands) * (1 + 3 * n_bands));
        for row in chain.bundles.chunks_exact(1 + 2 * n_bands) {
            let (survival, emission) = (row[0], &row[1 + n_bands..]);
            let at_end = scoring == Scoring::Absorption && survival <= LAST_EVENT_LIMIT;
            bundles.extend_from_slice(&row[..1 + n_bands]);
            bundles.extend(emission.iter().map(|e| if at_end { 0.0 } else { *e }));
            bundles.extend(emission.iter().map(|e| if at_end { e / (1.0 - survival) } else { 0.0 }));
        }
        let columns = Columns { n_bands, bounces: Bounces::All };
        Self { scoring, columns, chain, bundles }
    }
}

impl Estimator for MatrixWalk {
    fn name(&self) -> &'static str {
        match self.scoring {
            Scoring::Collision => "collision-walk",
            Scoring::Absorption => "absorption-walk",
        }
    }

    fn truth(&self) -> Truth {
        Truth::Discrete
    }

    fn n_bundles(&self) -> usize {
        self.chain.steps.n_rows()
    }

    fn n_columns(&self) -> usize {
        self.columns.count()
    }

    fn sample(&self, start: usize, stream: &mut Stream, score: &mut Score) {
        let mut walk = Walk::new(start, stream.clone(), self.columns);
        while walk.is_inside && self.visit(&mut walk) {
            self.step(&mut walk);
        }
        *stream = walk.stream;
        score.totals(start).iter_mut().zip(walk.totals.iter()).for_each(|(total, scored)| *total += scored);
    }

    fn samples(&self, start: usize, numbers: Range<u64>, streams: &Streams, score: &mut Score) {
        let mut waiting = numbers.map(|number| Walk::new(start, streams.stream(start as u32, number), self.columns));
        let mut walks: Vec<Walk> = waiting.by_ref().take(N_ABREAST).collect();
        while !walks.is_empty() {
            // Score every walk, and put a new one in the place of each that ends.
            let mut k = 0;
            while k < walks.len() {
                if walks[k].is_inside && self.visit(&mut walks[k]) {
                    k += 1;
                    continue;
                }
                score.totals(start).copy_from_slice(&walks[k].totals);
                score.end_sample();
                match waiting.next() {
                    Some(walk) => walks[k] = walk,
                    None => drop(walks.swap_remove(k)),
                }
            }

            // Move them all: nothing else here, so that memory delivers many slots at a time.
            walks.iter_mut().for_each(|walk| self.step(walk));
        }
    }
}

impl MatrixWalk {
    /// Scores the bundle that a walk stands on; false where it is absorbed.
    #[inline]
    fn visit(&self, walk: &mut Walk) -> bool {
        let n_bands = self.chain.n_bands;
        let row = &self.bundles[walk.bundle * (1 + 3 * n_bands)..][..1 + 3 * n_bands];
        let (survival, row) = (row[0], &row[1..]);
        let (gain, row) = row.split_at(n_bands);
        let (at_visit, at_end) = row.split_at(n_bands);
        let Some(here) = self.columns.of(walk.bounce) else { return false };
        let totals = &mut walk.totals[here];
        add(totals, &walk.weights, at_visit);

        // Absorb it with probability 1 − p; below p, the number over p is uniform again.
        let uniform = walk.stream.uniform();
        if uniform >= survival {
            add(totals, &walk.weights, at_end);
            return false;
        }
        walk.uniform = uniform / survival;
        walk.weights.iter_mut().zip(gain).for_each(|(weight, gain)| *weight *= gain);
        true
    }

    /// Moves a walk by G, maybe out of the scene.
    #[inline]
    fn step(&self, walk: &mut Walk) {
        match self.chain.steps.sample(walk.bundle, walk.uniform) {
            Some(next) => (walk.bundle, walk.bounce) = (next, walk.bounce + 1),
            None => walk.is_inside = false,
        }
    }
}

impl Walk {
    fn new(start: usize, stream: Stream, columns: Columns) -> Self {
        let (weights, totals) = (Bands::all(1.0, columns.n_bands), Bands::all(0.0, columns.count()));
        Self { bundle: start, is_inside: true, bounce: 0, stream, uniform: 0.0, weights, totals }
    }
}

/// totals ← totals + weights · values, band by band.
#[inline]
fn add(totals: &mut [f64], weights: &[f64], values: &[f64]) {
    for ((total, weight), value) in totals.iter_mut().zip(weights).zip(values) {
        *total += weight * value;
    }
}
