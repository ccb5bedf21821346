//! Rank-one lattices without end: xₖ = frac(shift + k α).

use rand_philox::splitmix64;

/// The generalised golden ratios: the positive roots of x^(D+1) = x + 1 for D = 1 … 4.
const RATIOS: [f64; 4] =
    [1.618_033_988_749_895, 1.324_717_957_244_746, 1.220_744_084_605_759_5, 1.167_303_978_261_418_7];

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
        let ratio = RATIOS[D - 1];
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_solve_their_equation() {
        for (d, ratio) in (1..).zip(RATIOS) {
            // One ulp of the ratio, times the slope of the power.
            assert!((ratio.powi(d + 1) - ratio - 1.0).abs() < 1e-15 * f64::from(d + 2), "{d}: {ratio}");
        }
    }

    #[test]
    fn points_integrate_a_product_better_than_random_ones() {
        let n = 4096;
        for key in 0..20 {
            let points = Kronecker::<4>::new(key);
            let mean = (0..n).map(|k| points.point(k).iter().map(|x| 2.0 * x).product::<f64>()).sum::<f64>() / n as f64;
            // A random mean is off by √((4/3)⁴ − 1) / √n = 0.023.
            assert!((mean - 1.0).abs() < 0.01, "{key}: {mean}");
        }
    }
}
