//! Owen-scrambled Sobol' points in as many dimensions as a walk turns out to need.

use super::directions::N_SOBOL_DIMENSIONS;
use super::sobol::{scramble, sobol};
use super::stream::{mix_seed, unit_interval};

/// Scrambled Sobol' points, dimension by dimension, without end.
///
/// The first 32 dimensions are those of [`Sobol`](super::Sobol). Later ones come in pairs, each the first two dimensions again — a (0, 2)-sequence —
/// scrambled anew and gone through in a shuffled order: the shuffle permutes aligned blocks of 2ᵏ indices among and within themselves, so
/// that every such block is a net in every pair still, and pairs are independent of one another (Burley 2020). Every point is uniform in the
/// cube of any dimension, and seeds are independent.
///
/// Cost of a coordinate: one exclusive-or for every set bit of the index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PaddedSobol {
    seed: u64,
}

impl PaddedSobol {
    pub fn new(seed: u64) -> Self {
        Self { seed }
    }

    /// One coordinate of point number `index`, in [0, 1).
    pub fn coordinate(self, index: u64, dimension: usize) -> f64 {
        let key = mix_seed(self.seed, dimension as u64);
        if dimension < N_SOBOL_DIMENSIONS {
            return unit_interval(scramble(sobol(dimension, index), key));
        }
        // Both of a pair shuffle by the key of its first.
        let shuffled = scramble(index, mix_seed(self.seed ^ u64::MAX, (dimension & !1) as u64));
        unit_interval(scramble(sobol(dimension & 1, shuffled), key))
    }
}
