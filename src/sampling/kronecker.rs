//! Rank-one lattices without end: xₖ = frac(shift + k α).

use rand_philox::splitmix64;

/// A D-dimensional additive sequence with the generalised golden ratio (Roberts 2018), shifted at random by a key: a randomised
/// quasi-Monte Carlo rule that needs no state. D ≤ 4.
#[derive(Clone, Copy, Debug)]
pub struct Kronecker<const D: usize> {
    step: [f64; D],
    shift: [f64; D],
}

impl<const D: usize> Kronecker<D> {
    /// The sequence whose random shift is a function of the key alone.
    pub fn new(key: u64) -> Self {
        // The generalised golden ratio is the positive root of x^(D+1) = x + 1.
        let mut ratio = 2.0f64;
        for _ in 0..64 {
            ratio = (1.0 + ratio).powf(1.0 / (D as f64 + 1.0));
        }
        let mut step = [0.0; D];
        let mut shift = [0.0; D];
        let mut state = splitmix64(key.wrapping_add(0x9e37_79b9_7f4a_7c15));
        for d in 0..D {
            step[d] = ratio.powi(-(d as i32) - 1);
            state = splitmix64(state.wrapping_add(0x9e37_79b9_7f4a_7c15));
            shift[d] = (state >> 11) as f64 * (1.0 / (1u64 << 53) as f64);
        }
        Self { step, shift }
    }

    /// Point k, every coordinate in [0, 1).
    pub fn point(&self, k: usize) -> [f64; D] {
        std::array::from_fn(|d| (self.shift[d] + k as f64 * self.step[d]).fract())
    }
}

/// Mixes numbers into one key.
pub fn mix(parts: &[u64]) -> u64 {
    parts.iter().fold(0x243f_6a88_85a3_08d3, |key, part| splitmix64(key ^ part.wrapping_mul(0x9e37_79b9_7f4a_7c15)))
}
