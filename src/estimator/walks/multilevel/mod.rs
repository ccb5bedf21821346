//! Multilevel Monte Carlo over refinements: the radiance of every fine bundle from many walks on coarse bundles and few on fine ones.
//!
//! ```text
//! L_fine = P … P L₀ + … + P (L₂ − P L₁) + (L_fine − P L_coarse),      (P L)ᵢ = L of the bundle that i is a part of
//! ```
//!
//! A sample of level ℓ is a fine walk less a coarse one, both from where a bundle of that level is; they stay together as long as their laws
//! allow, so that their difference varies little, and coarse bundles are few, so that the level that varies most costs least. Where the
//! fine walk steps from i into the coarse bundle J, the coarse one on I follows it there with the largest probability that keeps its own law,
//!
//! ```text
//! min(1, G_IJ / Σ over j in J of Gᵢⱼ),
//! ```
//!
//! and otherwise draws from what is left of its law, (G_IJ − Σ Gᵢⱼ)⁺, by rejection; walks that have parted may meet again. No weight comes of
//! it, so that all moments exist as they do for [`MatrixWalk`](super::MatrixWalk). (Weighing one path by both laws has been tried: likelihood ratios of
//! neighbouring patches multiply up to a variance twenty times that of the coarsest level.) The sum has the fine solution as its
//! expectation, without bias.
//!
//! Samples a level follow N ∝ √(V/C), V the variance of a difference and C the cost of one sample of all bundles of the level, both
//! from a pilot that is then thrown away. Meshes must be nested. Memory: the tables
//! of `MatrixWalk` for every level, and 8 bytes a pair of a fine and a coarse bundle.
//! Source: Heinrich 1998; Giles 2008; Lindvall 2002, §I.5 (maximal coupling).

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
            Level::new(chains[k].clone(), coarser)
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
