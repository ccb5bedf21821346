//! z-scores, and how surprising they are.

use super::sidak_level;
use super::special::complementary_error_function;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// (value − reference) / √variance, normal where the value is and its variance is known. For a mean of n numbers of skewness γ with
/// their own variance, |z| beyond a critical z is more frequent than it should be by about exp(z⁴/4n) · (1 + (γ z³)²/18n).
///
/// ±∞ where the variance is zero and they differ, 0 where they are equal.
pub fn z_score(value: f64, reference: f64, variance: f64) -> f64 {
    if value == reference { 0.0 } else { (value - reference) / variance.sqrt() }
}

/// Probability of a standard normal number at least this far from zero, erfc(|z|/√2). Relative error below z² ulp, up to |z| =
/// 37.5, beyond which it is no normal number.
pub fn two_sided_p(z: f64) -> f64 {
    complementary_error_function(z.abs() * FRAC_1_SQRT_2)
}

/// The |z| that the largest of `n` comparisons exceeds with probability alpha, for alpha in (0, 1).
///
/// Newton's method on ln p(z) from the tail's leading behaviour; relative error below 1e-14.
pub fn critical_z(alpha: f64, n: usize) -> f64 {
    let level = sidak_level(alpha, n);
    let mut z = if level > 0.5 { 0.1 } else { (-2.0 * level.ln()).sqrt() };
    for _ in 0..60 {
        let p = two_sided_p(z);
        let density = 2.0 * (-0.5 * z * z).exp() / (2.0 * PI).sqrt();
        let step = (p / level).ln() * p / density;
        z = (z + step).max(0.0);
        if step.abs() <= 1e-15 * z {
            break;
        }
    }
    z
}
