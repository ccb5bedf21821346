//! Tails of the distributions that tests ask for, and the critical values that have a given tail.
//!
//! Each tail is summed up where it lies, never as 1 − the rest: relative errors stay below 1e-12 down to the smallest normal
//! number. A critical value is the tail's inverse, to the rounding that ln p allows.

use super::special::{complementary_error_function, regularised_incomplete_beta_of};
use super::special::{regularised_lower_gamma, regularised_upper_gamma};
use std::f64::consts::FRAC_1_SQRT_2;

/// Probability of a standard normal number above z, ½ erfc(z/√2).
pub fn normal_tail(z: f64) -> f64 {
    0.5 * complementary_error_function(z * FRAC_1_SQRT_2)
}

/// The z with [`normal_tail`] p, for p in (0, 1).
pub fn normal_critical(p: f64) -> f64 {
    if p > 0.5 {
        return -normal_critical(1.0 - p);
    }
    if p == 0.5 { 0.0 } else { invert(p, (-2.0 * p.ln()).sqrt(), normal_tail) }
}

/// Probability of a Student's t above t with this many degrees of freedom, any number above zero (Student 1908).
///
/// ½ I_x(ν/2, ½) with x = ν/(ν + t²). Cost O(√ν) for |t| about 1.
pub fn student_tail(t: f64, n_degrees_of_freedom: f64) -> f64 {
    if t < 0.0 {
        return 1.0 - student_tail(-t, n_degrees_of_freedom);
    }
    if n_degrees_of_freedom == f64::INFINITY {
        return normal_tail(t);
    }
    0.5 * regularised_incomplete_beta_of(0.5 * n_degrees_of_freedom, 0.5, shares(n_degrees_of_freedom, t * t))
}

/// The t with [`student_tail`] p, for p in (0, 1).
pub fn student_critical(p: f64, n_degrees_of_freedom: f64) -> f64 {
    if p > 0.5 {
        return -student_critical(1.0 - p, n_degrees_of_freedom);
    }
    if p == 0.5 { 0.0 } else { invert(p, normal_critical(p), |t| student_tail(t, n_degrees_of_freedom)) }
}

/// Probability of a χ² above x with this many degrees of freedom: Q(ν/2, x/2).
pub fn chi_squared_tail(x: f64, n_degrees_of_freedom: f64) -> f64 {
    regularised_upper_gamma(0.5 * n_degrees_of_freedom, 0.5 * x)
}

/// Probability of a χ² below x: P(ν/2, x/2).
pub fn chi_squared_lower_tail(x: f64, n_degrees_of_freedom: f64) -> f64 {
    regularised_lower_gamma(0.5 * n_degrees_of_freedom, 0.5 * x)
}

/// The x with [`chi_squared_tail`] p, for p in (0, 1).
pub fn chi_squared_critical(p: f64, n_degrees_of_freedom: f64) -> f64 {
    invert(p, n_degrees_of_freedom, |x| chi_squared_tail(x, n_degrees_of_freedom))
}

/// Probability of a ratio of two mean squares above f, with these degrees of freedom above and below the line (Fisher, Snedecor).
///
/// I_x(ν₂/2, ν₁/2) with x = ν₂/(ν₂ + ν₁ f).
pub fn fisher_tail(f: f64, n_above: f64, n_below: f64) -> f64 {
    regularised_incomplete_beta_of(0.5 * n_below, 0.5 * n_above, shares(n_below, n_above * f.max(0.0)))
}

/// The f with [`fisher_tail`] p, for p in (0, 1).
pub fn fisher_critical(p: f64, n_above: f64, n_below: f64) -> f64 {
    invert(p, 1.0, |f| fisher_tail(f, n_above, n_below))
}

/// Probability of at least k successes in n trials of probability p each: I_p(k, n − k + 1). Exact.
pub fn binomial_tail(k: u64, n: u64, p: f64) -> f64 {
    if k == 0 {
        return 1.0;
    }
    if k > n {
        return 0.0;
    }
    regularised_incomplete_beta_of(k as f64, (n - k) as f64 + 1.0, [p, 1.0 - p])
}

/// Probability of at most k successes in n trials of probability p each: I_{1−p}(n − k, k + 1). Exact.
pub fn binomial_lower_tail(k: u64, n: u64, p: f64) -> f64 {
    if k >= n {
        return 1.0;
    }
    regularised_incomplete_beta_of((n - k) as f64, k as f64 + 1.0, [1.0 - p, p])
}

/// a/(a + b) and b/(a + b), for a > 0 and b ≥ 0 of any size.
fn shares(a: f64, b: f64) -> [f64; 2] {
    [1.0 / (1.0 + b / a), 1.0 / (1.0 + a / b)]
}

/// The x > 0 at which a tail, falling from x = 0 on, is p: NaN where p is not between 0 and the tail at 0.
///
/// Halves a bracket of ln x until it has no middle, some sixty tails: slow and sure.
fn invert(p: f64, guess: f64, tail: impl Fn(f64) -> f64) -> f64 {
    if !(p > 0.0 && p < tail(0.0)) {
        return f64::NAN;
    }
    let (mut low, mut high) = (guess, guess);
    while low > 0.0 && tail(low) < p {
        low *= 0.5;
    }
    while tail(high) > p {
        high *= 2.0;
    }
    loop {
        let middle = low * (high / low).sqrt();
        if !(middle > low && middle < high) {
            return middle;
        }
        if tail(middle) > p {
            low = middle;
        } else {
            high = middle;
        }
    }
}
