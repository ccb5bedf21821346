//! Walks of one level: of the coarsest alone, or the difference to the next coarser along the same path.

use super::super::chain::Chain;
use super::parents::Parents;
use crate::assembly::System;
use crate::estimator::bands::Bands;
use crate::estimator::{Estimator, Score, Truth};
use crate::linalg::Matrix;
use crate::sampling::Stream;
use std::sync::Arc;

/// What one level adds to the coarser ones.
#[derive(Debug)]
pub struct Level<'a> {
    chain: Arc<Chain>,
    exchange: &'a Matrix,
    coarser: Option<Coarser<'a>>,
}

#[derive(Debug)]
struct Coarser<'a> {
    chain: Arc<Chain>,
    exchange: &'a Matrix,
    parents: Parents,
}

/// Both walks of a pair that shares its path, by what they carry.
struct Pair {
    bundle: usize,
    fine: Bands,
    coarse: Bands,
}

impl<'a> Level<'a> {
    pub fn new(chain: Arc<Chain>, system: &'a System, coarser: Option<(Arc<Chain>, &'a System, Parents)>) -> Self {
        let coarser = coarser.map(|(chain, system, parents)| Coarser { chain, exchange: system.exchange(), parents });
        Self { chain, exchange: system.exchange(), coarser }
    }

    pub fn n_bundles(&self) -> usize {
        self.chain.n_bundles()
    }

    /// μ, m² sr.
    pub fn etendue(&self) -> &[f64] {
        &self.chain.etendue
    }

    /// The next coarser bundle of every bundle; none on the coarsest level.
    pub fn parents(&self) -> Option<&[u32]> {
        self.coarser.as_ref().map(|coarser| coarser.parents.of.as_slice())
    }

    /// Steps by the middle of both laws, and weighs both walks by their own; false where the path leaves the scene.
    fn step(&self, pair: &mut Pair, stream: &mut Stream) -> bool {
        let Some(coarser) = &self.coarser else {
            let next = self.chain.steps.sample(pair.bundle, stream.uniform());
            next.inspect(|next| pair.bundle = *next);
            return next.is_some();
        };
        let (from, parents) = (pair.bundle, &coarser.parents);
        let parent = parents.of[from] as usize;
        let next = if stream.uniform() < 0.5 {
            self.chain.steps.sample(from, stream.uniform())
        } else {
            let next = coarser.chain.steps.sample(parent, stream.uniform());
            next.map(|next| parents.draw(next, stream.uniform()))
        };
        let Some(to) = next else { return false };
        let geometry = entry(self.exchange, from, to) / self.chain.etendue[from];
        let spread = entry(coarser.exchange, parent, parents.of[to] as usize) / coarser.chain.etendue[parent]
            * parents.share[to];
        let drawn = 0.5 * (geometry + spread);
        pair.fine.iter_mut().for_each(|weight| *weight *= geometry / drawn);
        pair.coarse.iter_mut().for_each(|weight| *weight *= spread / drawn);
        pair.bundle = to;
        true
    }
}

/// One entry of a stored matrix.
fn entry(matrix: &Matrix, row: usize, column: usize) -> f64 {
    match matrix {
        Matrix::Dense(dense) => dense.row_slice(row)[column],
        Matrix::Sparse(sparse) => {
            let (columns, values) = sparse.row_entries(row);
            columns.binary_search(&(column as u32)).map_or(0.0, |k| values[k])
        }
    }
}

impl Estimator for Level<'_> {
    fn name(&self) -> &'static str {
        "multilevel-walk"
    }

    fn truth(&self) -> Truth {
        Truth::Discrete
    }

    fn n_bundles(&self) -> usize {
        self.chain.n_bundles()
    }

    fn n_columns(&self) -> usize {
        self.chain.n_bands
    }

    fn sample(&self, start: usize, stream: &mut Stream, score: &mut Score) {
        let n_bands = self.chain.n_bands;
        let subtracted = if self.coarser.is_some() { 1.0 } else { 0.0 };
        let mut pair = Pair { bundle: start, fine: Bands::all(1.0, n_bands), coarse: Bands::all(subtracted, n_bands) };
        let mut n_steps = 0;
        loop {
            // Score the visit of both; nested bundles lie on the same surface and emit alike.
            let emission = self.chain.emission.row(pair.bundle);
            let weights = pair.fine.iter().zip(pair.coarse.iter());
            for ((total, e), (fine, coarse)) in score.totals(start).iter_mut().zip(emission).zip(weights) {
                *total += (fine - coarse) * e;
            }

            // Survive alike, and step.
            if stream.uniform() >= self.chain.survival[pair.bundle] {
                break;
            }
            for (band, gain) in self.chain.gain(pair.bundle).enumerate() {
                pair.fine[band] *= gain;
                pair.coarse[band] *= gain;
            }
            n_steps += 1;
            if !self.step(&mut pair, stream) {
                break;
            }
        }
        score.count_steps(n_steps);
    }
}
