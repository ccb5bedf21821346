//! Convergence foretold: what each method's residual will be, from the spectrum alone.

use super::leading::Spectrum;
use crate::linalg::{Block, max_abs};

/// ‖Kᵏ⁺¹ E‖∞ / ‖E‖∞ for k = 0 … n − 1, the residual of k bounces of the Neumann series, of one band: E in the eigenvectors of K.
///
/// ```text
/// Kᵏ⁺¹ E ≈ Σᵢ ⟨xᵢ, E⟩ λᵢᵏ⁺¹ xᵢ
/// ```
///
/// Exact for k large, as soon as the eigenvalues left out have died away. `None` where K has no self-adjoint form.
pub fn neumann(spectrum: &Spectrum, emission: &Block, band: usize, n: usize) -> Option<Vec<f64>> {
    let weight = spectrum.weights.as_ref()?.column(band);
    let e = emission.column(band);
    let scale = max_abs(e).max(f64::MIN_POSITIVE);
    let pairs = &spectrum.bands[band];
    let share = |x: &[f64]| weight.iter().zip(x).zip(e).map(|((w, x), e)| w * x * e).sum::<f64>();
    let mut parts: Vec<f64> = pairs.iter().map(|pair| share(&pair.vector_re)).collect();
    let mut residual = vec![0.0; e.len()];
    let curve = (0..n).map(|_| {
        residual.fill(0.0);
        for (pair, part) in pairs.iter().zip(&mut parts) {
            *part *= pair.re;
            residual.iter_mut().zip(&pair.vector_re).for_each(|(r, x)| *r += *part * x);
        }
        max_abs(&residual) / scale
    });
    Some(curve.collect())
}

/// Chebyshev's bound on the error of conjugate gradients in the energy norm, relative to the first, for k = 0 … n − 1, where the
/// eigenvalues of K lie in [low, high], high < 1:
///
/// ```text
/// 2 q^k / (1 + q^2k),      q = (√κ − 1) / (√κ + 1),      κ = (1 − low) / (1 − high)
/// ```
pub fn cg_bound(low: f64, high: f64, n: usize) -> Vec<f64> {
    let root = ((1.0 - low) / (1.0 - high)).sqrt();
    let q = (root - 1.0) / (root + 1.0);
    (0..n).map(|k| 2.0 * q.powi(k as i32) / (1.0 + q.powi(2 * k as i32))).collect()
}

/// The same bound where conjugate gradients have found the outlying eigenvalues: the least over how many of the largest, `outliers`
/// given largest first and above `high`, are killed by a root of the polynomial each, and the rest left to Chebyshev.
///
/// ```text
/// min_j  Π_{i ≤ j} (1 − (1 − low)/(1 − λᵢ))  ·  2 q^(k−j) / (1 + q^2(k−j))      with κ of the eigenvalues left
/// ```
pub fn cg_bound_beyond(low: f64, high: f64, outliers: &[f64], n: usize) -> Vec<f64> {
    let mut best = cg_bound(low, outliers.first().copied().unwrap_or(high), n);
    let mut factor = 1.0;
    for (j, outlier) in outliers.iter().enumerate() {
        factor *= ((1.0 - low) / (1.0 - outlier) - 1.0).abs().max(1.0);
        let left = outliers.get(j + 1).copied().unwrap_or(high);
        let bound = cg_bound(low, left, n.saturating_sub(j + 1));
        best[(j + 1).min(n)..].iter_mut().zip(bound).for_each(|(best, bound)| *best = best.min(factor * bound));
    }
    best
}

/// Residuals of a method that takes `factor` off at every step, for k = 0 … n − 1: two-grid's by the spectral radius of Π K.
pub fn geometric(factor: f64, n: usize) -> Vec<f64> {
    (0..n).map(|k| factor.powi(k as i32)).collect()
}
