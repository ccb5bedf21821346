//! Multilevel Monte Carlo over refinements: the radiance of every fine bundle from many walks on coarse bundles and few on fine ones.
//!
//! ```text
//! L_fine = P … P L₀ + … + P (L₂ − P L₁) + (L_fine − P L_coarse),      (P L)ᵢ = L of the bundle that i is a part of
//! ```
//!
//! A walk of level ℓ begins on every bundle of that level and scores both its own L and that of the next coarser level, along *the same
//! path*, so that their difference varies little; coarse bundles are few, so that the level that varies most costs least. The paths'
//! steps are drawn from the middle of both laws and weighed by each:
//!
//! ```text
//! j ~ Q = ½ G + ½ G̃,      G̃ᵢⱼ = G_IJ μⱼ/μ_J      (I, J hold i, j),      w ← w (a/p) G/Q,      w̃ ← w̃ (a/p) G̃/Q
//! ```
//!
//! G̃ is the coarse propagation spread over fine bundles: its walks are the coarse ones, step for step. Both likelihood ratios are at most 2,
//! and near 1 where the two levels see alike. The sum has the fine solution as its expectation, without bias.
//!
//! Samples a level follow N ∝ √(V/C), V the variance of a difference and C the cost of one sample of all bundles of the level, both
//! from a pilot that is then thrown away. Meshes must be nested. Memory: the tables of [`MatrixWalk`](super::MatrixWalk) for every level.
//! Source: Heinrich 1998; Giles 2008.

mod estimate;
mod level;
mod parents;

pub use estimate::{LevelReport, MultilevelEstimate};
pub use parents::NestingError;

use super::chain::Chain;
use crate::assembly::System;
use crate::basis::Bundles;
use crate::estimator::EstimatorError;
use level::Level;
use parents::Parents;
use std::sync::Arc;

/// The same scene at several resolutions, coarsest first, ready for walks.
#[derive(Debug)]
pub struct Multilevel<'a> {
    levels: Vec<Level<'a>>,
}

impl<'a> Multilevel<'a> {
    /// Of bundles and their systems, coarsest first. Cost O(n²) a level.
    ///
    /// # Errors
    /// No level; bundles that are not parts of the coarser ones; systems that [`MatrixWalk`](super::MatrixWalk) refuses.
    pub fn new(levels: &[(&Bundles, &'a System)]) -> Result<Self, EstimatorError> {
        if levels.is_empty() {
            return Err(EstimatorError::NoLevels);
        }
        let (mut chains, mut nested) = (Vec::with_capacity(levels.len()), Vec::with_capacity(levels.len()));
        for (k, (bundles, system)) in levels.iter().enumerate() {
            let nesting = |source| EstimatorError::Nesting { level: k, source };
            nested.push(match k {
                0 => None,
                _ => Some(Parents::new(bundles, levels[k - 1].0).map_err(nesting)?),
            });
            chains.push(Arc::new(Chain::new(system)?));
        }
        let level = |(k, parents): (usize, Option<Parents>)| {
            let coarser = parents.map(|parents| (chains[k - 1].clone(), levels[k - 1].1, parents));
            Level::new(chains[k].clone(), levels[k].1, coarser)
        };
        let levels = nested.into_iter().enumerate().map(level).collect();
        Ok(Self { levels })
    }

    /// How many levels there are.
    pub fn n_levels(&self) -> usize {
        self.levels.len()
    }

    /// Bundles of the finest.
    pub fn n_bundles(&self) -> usize {
        self.levels[self.levels.len() - 1].n_bundles()
    }
}
