//! Sobol' points, Owen-scrambled: low-discrepancy points that are also random, hence unbiased and with a measurable error.

use super::directions::{DIRECTIONS, N_SOBOL_DIMENSIONS};
use super::stream::{mix_seed, unit_interval};

/// The Sobol' sequence in `D` ≤ 32 dimensions, each scrambled by its own random nested permutation of digits.
///
/// The first 2ᵏ points put exactly one into each interval of length 2⁻ᵏ of every dimension, and dimensions 0 and 1 form a
/// (0, 2)-sequence; scrambling keeps both. Every point is uniform in the cube, and different seeds are independent: the spread of an
/// integral over seeds measures its error, which falls as N^(−3/2) (up to logarithms) for smooth integrands against N^(−1/2).
///
/// The scrambling hashes the digits from the top down (Laine & Karras 2011, here on 64 digits): good to the full 53 bits of a
/// coordinate and to any index. Cost: one exclusive-or for every set bit of the index and dimension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sobol<const D: usize> {
    seeds: [u64; D],
}

impl<const D: usize> Sobol<D> {
    const FITS: () = assert!(D <= N_SOBOL_DIMENSIONS, "there are direction numbers for 32 dimensions; pad beyond");

    /// The sequence of this seed. For one sequence a task, mix the task's number in with [`mix_seed`].
    pub fn new(seed: u64) -> Self {
        let () = Self::FITS;
        Self { seeds: std::array::from_fn(|d| mix_seed(seed, d as u64)) }
    }

    /// Point number `index`, each coordinate uniform in [0, 1).
    pub fn point(&self, index: u64) -> [f64; D] {
        std::array::from_fn(|d| unit_interval(scramble(sobol(d, index), self.seeds[d])))
    }
}

/// Digits of the unscrambled coordinate.
pub(super) fn sobol(dimension: usize, index: u64) -> u64 {
    let mut remaining = index;
    let mut digits = 0;
    while remaining != 0 {
        digits ^= DIRECTIONS[dimension][remaining.trailing_zeros() as usize];
        remaining &= remaining - 1;
    }
    digits
}

/// A random permutation of 64-digit numbers that keeps every dyadic interval together: digit k is flipped by a hash of the digits
/// above it alone.
pub(super) fn scramble(digits: u64, seed: u64) -> u64 {
    // Turn the digits round, so that 'above' becomes 'below', the only way in which sums and products carry.
    let mut x = digits.reverse_bits();
    x = x.wrapping_add(seed);
    x ^= x.wrapping_mul(0x9fb2_1c65_1e98_df24);
    x = x.wrapping_mul(seed.rotate_left(32) | 1);
    x ^= x.wrapping_mul(0xc2b2_ae3d_27d4_eb4e);
    x = x.wrapping_add(seed.rotate_left(17));
    x ^= x.wrapping_mul(0x1656_67b1_9e37_79f8);
    x = x.wrapping_mul(0xd6e8_feb8_6659_fd93);
    x ^= x.wrapping_mul(0xa076_1d64_78bd_642e);
    x.reverse_bits()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_points_are_the_published_ones() {
        // Bratley & Fox's example order without Gray code: index 1, 2, 3 in the first three dimensions.
        let value = |d, i| unit_interval(sobol(d, i));
        assert_eq!([1, 2, 3].map(|i| value(0, i)), [0.5, 0.25, 0.75]);
        assert_eq!([1, 2, 3].map(|i| value(1, i)), [0.5, 0.75, 0.25]);
        assert_eq!([1, 2, 3].map(|i| value(2, i)), [0.5, 0.75, 0.25]);
        assert_eq!([4, 5, 6, 7].map(|i| value(1, i)), [0.625, 0.125, 0.375, 0.875]);
    }

    #[test]
    fn a_digit_is_flipped_by_the_digits_above_alone() {
        for (n, seed) in [7, 1 << 40, u64::MAX].into_iter().enumerate() {
            for bit in 0..64 {
                let a = mix_seed(91, (64 * n + bit) as u64);
                let above = if bit == 63 { 0 } else { !0 << (bit + 1) };
                let b = (a & above) | (mix_seed(92, a) & !above);
                assert_eq!(scramble(a, seed) & above, scramble(b, seed) & above);
            }
        }
    }
}
