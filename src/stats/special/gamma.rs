//! The regularised incomplete gamma functions.

use super::{continued_fraction, deviance, stirling_error};
use std::f64::consts::PI;

/// Q(a, x) = ∫ₓ^∞ tᵃ⁻¹ e⁻ᵗ dt / Γ(a), the regularised upper incomplete gamma function; a > 0, x ≥ 0. NaN for what is not a number.
///
/// Relative error below 1e-12 for a ≥ ½, down to the smallest normal number. Cost O(√a) near x = a, a few dozen steps elsewhere.
pub fn regularised_upper_gamma(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        1.0
    } else if x == f64::INFINITY {
        0.0
    } else if x < a + 1.0 {
        1.0 - power_series(a, x)
    } else {
        fraction(a, x)
    }
}

/// P(a, x) = 1 − Q(a, x), accurate where it is small.
pub fn regularised_lower_gamma(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        0.0
    } else if x == f64::INFINITY {
        1.0
    } else if x < a + 1.0 {
        power_series(a, x)
    } else {
        1.0 - fraction(a, x)
    }
}

/// xᵃ e⁻ˣ / Γ(a + 1) = exp(−a dev(x/a) − δ(a)) / √(2πa): see [`deviance`] and [`stirling_error`].
fn density(a: f64, x: f64) -> f64 {
    (-a * deviance(x / a, (x - a) / a) - stirling_error(a)).exp() / (2.0 * PI * a).sqrt()
}

/// P(a, x) = xᵃ e⁻ˣ / Γ(a + 1) · Σₖ xᵏ / ((a + 1) … (a + k)) (DLMF 8.11.4), whose terms fall from the start where x < a + 1.
fn power_series(a: f64, x: f64) -> f64 {
    let (mut term, mut sum, mut k) = (1.0, 1.0, 0.0);
    while term > 0.1 * f64::EPSILON * sum {
        k += 1.0;
        term *= x / (a + k);
        sum += term;
    }
    density(a, x) * sum
}

/// Q(a, x) = xᵃ e⁻ˣ / Γ(a) · 1/(x + 1 − a − 1(1 − a)/(x + 3 − a − …)) (DLMF 8.9.2, its even part), for x > a.
fn fraction(a: f64, x: f64) -> f64 {
    let first = x + 1.0 - a;
    density(a, x) * a / continued_fraction(first, |k| (k * (a - k), first + 2.0 * k))
}
