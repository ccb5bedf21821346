//! What one step of a walk does, in numbers a linear system can be made of.

use super::super::chain::Chain;
use crate::linalg::{Block, LinearOperator};

/// The walk that stands on bundle i with weight 1, in one band:
///
/// ```text
/// ends with probability αᵢ and scores Aᵢ,
/// or scores Bᵢ and steps to j with probability Pᵢⱼ = rᵢ Gᵢⱼ dⱼ, its weight times ωᵢⱼ = oᵢ eⱼ,
/// or scores Bᵢ and leaves.
/// ```
pub struct Law<'a> {
    /// G, grey.
    pub propagation: &'a dyn LinearOperator,
    /// α, n × bands.
    pub ending: Block,
    /// A, n × bands.
    pub at_last: Block,
    /// B, n × bands.
    pub at_other: Block,
    /// r, n × bands.
    pub row: Block,
    /// o, n × bands.
    pub gain: Block,
    /// d and e, n × bands; 1 if there are none.
    pub guide: Option<[Block; 2]>,
    /// True if walks may leave; otherwise what Σ P and α lack to 1 is rounding.
    pub may_leave: bool,
    /// True if r Σ G d ≤ 1 and o e ≤ 1 by construction, and every bundle can reach the end of walks: then all moments exist.
    pub never_grows: bool,
}

impl<'a> Law<'a> {
    /// Survive by p, step by G, with what the last visit and the others score, n × bands.
    pub fn of_chain(chain: &'a Chain, [at_last, at_other]: [Block; 2]) -> Self {
        let (n, n_bands) = (chain.n_bundles(), chain.n_bands);
        let gain: Vec<Vec<f64>> = (0..n).map(|i| chain.gain(i).collect()).collect();
        Self {
            propagation: &chain.propagation,
            ending: Block::from_fn(n, n_bands, |i, _| 1.0 - chain.survival[i]),
            at_last,
            at_other,
            row: Block::from_fn(n, n_bands, |i, _| chain.survival[i]),
            gain: Block::from_fn(n, n_bands, |i, band| gain[i][band]),
            guide: None,
            may_leave: true,
            never_grows: true,
        }
    }

    pub fn n_bundles(&self) -> usize {
        self.row.n_rows()
    }

    pub fn n_bands(&self) -> usize {
        self.row.n_columns()
    }

    /// dⱼ and eⱼ.
    #[inline]
    pub fn guide(&self, bundle: usize, band: usize) -> (f64, f64) {
        match &self.guide {
            Some([d, e]) => (d.get(bundle, band), e.get(bundle, band)),
            None => (1.0, 1.0),
        }
    }

    /// α A + (1 − α) B: what a visit scores on average.
    pub fn expected_score(&self) -> Block {
        Block::from_fn(self.n_bundles(), self.n_bands(), |i, band| {
            let ending = self.ending.get(i, band);
            ending * self.at_last.get(i, band) + (1.0 - ending) * self.at_other.get(i, band)
        })
    }
}
