//! Walks of one level: of the coarsest alone, or the difference to the next coarser by two walks that stay together.

use super::super::chain::Chain;
use super::parents::Parents;
use crate::assembly::System;
use crate::estimator::bands::Bands;
use crate::estimator::{Estimator, Score, Truth};
use crate::linalg::{Block, LinearOperator, Matrix};
use crate::sampling::Stream;
use std::sync::Arc;

/// Draws after which a coarse walk takes what it has; never reached but by rounding.
const MAX_DRAWS: usize = 1 << 20;

/// What one level adds to the coarser ones.
#[derive(Debug)]
pub struct Level<'a> {
    chain: Arc<Chain>,
    coarser: Option<Coarser<'a>>,
}

#[derive(Debug)]
struct Coarser<'a> {
    chain: Arc<Chain>,
    exchange: &'a Matrix,
    /// The coarse bundle of every fine one.
    parents: Vec<u32>,
    /// n fine × (n coarse + 1), row by row: the probability of stepping from a fine bundle into each coarse one, and out of the scene.
    gathered: Vec<f64>,
    /// The probability of stepping out of the scene from every coarse bundle.
    lost: Vec<f64>,
}

/// A walk and what it carries; on no bundle once it has ended.
struct Walker {
    bundle: Option<usize>,
    weights: Bands,
}

impl<'a> Level<'a> {
    /// Cost O(n²), 8 bytes an entry between the two levels.
    pub fn new(chain: Arc<Chain>, coarser: Option<(Arc<Chain>, &'a System, Parents)>) -> Self {
        let coarser = coarser.map(|(coarse, system, parents)| {
            let width = coarse.n_bundles() + 1;
            let mut gathered = vec![0.0; chain.n_bundles() * width];
            for (i, row) in gathered.chunks_exact_mut(width).enumerate() {
                chain.propagation.for_each_in_row(i, |j, geometry| row[parents.of[j] as usize] += geometry);
                row[width - 1] = (1.0 - row.iter().sum::<f64>()).max(0.0);
            }
            let mut kept = Block::zeros(coarse.n_bundles(), 1);
            coarse.propagation.apply(&Block::from_fn(coarse.n_bundles(), 1, |_, _| 1.0), &mut kept);
            let lost = kept.values().iter().map(|kept| (1.0 - kept).max(0.0)).collect();
            Coarser { chain: coarse, exchange: system.exchange(), parents: parents.of, gathered, lost }
        });
        Self { chain, coarser }
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
        self.coarser.as_ref().map(|coarser| coarser.parents.as_slice())
    }
}

impl Coarser<'_> {
    /// The coarse walk's step from `from`, where the fine one has gone from `fine_from` to `fine_to`: there too as often as both laws allow.
    fn follow(&self, from: usize, fine_from: usize, fine_to: Option<usize>, stream: &mut Stream) -> Option<usize> {
        let target = fine_to.map(|to| self.parents[to] as usize);
        if stream.uniform() * self.gathered(fine_from, target) < self.probability(from, target) {
            return target;
        }
        // What both laws have in common is used up: draw from what is left of the coarse one.
        let mut next = None;
        for _ in 0..MAX_DRAWS {
            next = self.chain.steps.sample(from, stream.uniform());
            if stream.uniform() * self.probability(from, next) >= self.gathered(fine_from, next) {
                break;
            }
        }
        next
    }

    /// Of stepping from a fine bundle into a coarse one, or out.
    fn gathered(&self, from: usize, to: Option<usize>) -> f64 {
        let width = self.lost.len() + 1;
        self.gathered[from * width + to.unwrap_or(width - 1)]
    }

    /// Of stepping from a coarse bundle to another, or out.
    fn probability(&self, from: usize, to: Option<usize>) -> f64 {
        let Some(to) = to else { return self.lost[from] };
        let exchange = match self.exchange {
            Matrix::Dense(dense) => dense.row_slice(from)[to],
            Matrix::Sparse(sparse) => {
                let (columns, values) = sparse.row_entries(from);
                columns.binary_search(&(to as u32)).map_or(0.0, |k| values[k])
            }
        };
        exchange / self.chain.etendue[from]
    }
}

impl Walker {
    fn new(bundle: Option<usize>, n_bands: usize) -> Self {
        Self { bundle, weights: Bands::all(1.0, n_bands) }
    }

    /// Scores where it stands, with this sign, and survives or ends.
    fn visit(&mut self, chain: &Chain, uniform: f64, sign: f64, totals: &mut [f64]) {
        let Some(bundle) = self.bundle else { return };
        for ((total, weight), e) in totals.iter_mut().zip(self.weights.iter()).zip(chain.emission.row(bundle)) {
            *total += sign * weight * e;
        }
        if uniform >= chain.survival[bundle] {
            self.bundle = None;
        }
        self.weights.iter_mut().zip(chain.gain(bundle)).for_each(|(weight, gain)| *weight *= gain);
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
        let parent = self.coarser.as_ref().map(|coarser| coarser.parents[start] as usize);
        let (mut fine, mut coarse) = (Walker::new(Some(start), n_bands), Walker::new(parent, n_bands));
        let mut n_steps = 0;
        while fine.bundle.is_some() || coarse.bundle.is_some() {
            // Score both, and absorb both by one number.
            let uniform = stream.uniform();
            fine.visit(&self.chain, uniform, 1.0, score.totals(start));
            if let Some(coarser) = &self.coarser {
                coarse.visit(&coarser.chain, uniform, -1.0, score.totals(start));
            }

            // Step the fine one by its own law, and the coarse one after it, or by its own where it is alone.
            let from = fine.bundle;
            fine.bundle = from.and_then(|from| self.chain.steps.sample(from, stream.uniform()));
            n_steps += u64::from(from.is_some()) + u64::from(coarse.bundle.is_some());
            if let (Some(coarser), Some(bundle)) = (&self.coarser, coarse.bundle) {
                coarse.bundle = match from {
                    Some(from) => coarser.follow(bundle, from, fine.bundle, stream),
                    None => coarser.chain.steps.sample(bundle, stream.uniform()),
                };
            }
        }
        score.count_steps(n_steps);
    }
}
