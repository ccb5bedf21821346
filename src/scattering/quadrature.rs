//! Gauss–Legendre rules, and doubling them until the answer stands.

use std::f64::consts::PI;
use std::sync::LazyLock;

/// Nodes and weights on [0, 1].
pub(super) type Rule = Vec<(f64, f64)>;

/// Numbers of nodes of the rules at hand, each twice the one before.
pub(super) const SIZES: [usize; 6] = [12, 24, 48, 96, 192, 384];

static RULES: LazyLock<[Rule; SIZES.len()]> = LazyLock::new(|| SIZES.map(gauss_legendre));

/// The rule with `SIZES[level]` nodes.
pub(super) fn rule(level: usize) -> &'static Rule {
    &RULES[level]
}

/// A number and the estimate of its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quadrature {
    pub value: f64,
    /// |d₂| √min(1, |d₂/d₁|) of the last two changes as the rule was doubled: where rules converge exponentially the next change would be
    /// smaller still.
    pub error: f64,
}

impl Quadrature {
    /// No light, exactly.
    pub(super) const ZERO: Self = Self { value: 0.0, error: 0.0 };
}

/// Doubling stops at this estimate, absolutely, for integrals of the order of 1.
const TOLERANCE: f64 = 1e-11;

/// Doubles the rule, from level 0 up to below `n_levels`, until the estimated error is small.
pub(super) fn doubled(n_levels: usize, with_level: impl Fn(usize) -> f64) -> Quadrature {
    let mut value = with_level(0);
    let mut change = f64::INFINITY;
    let mut error = f64::INFINITY;
    for level in 1..n_levels {
        let next = with_level(level);
        let last = (next - value).abs();
        error = if last < change && change.is_finite() { last * (last / change).sqrt() } else { last };
        (value, change) = (next, last);
        if level > 1 && error <= TOLERANCE {
            break;
        }
    }
    Quadrature { value, error }
}

/// Nodes and weights of n-point Gauss–Legendre quadrature on [0, 1], exact for polynomials of degree 2n − 1.
///
/// Newton's method on the Legendre polynomial from Tricomi's asymptotic nodes. Cost O(n²).
pub(super) fn gauss_legendre(n: usize) -> Rule {
    let count = n as f64;
    (0..n)
        .map(|k| {
            let mut x = (PI * (k as f64 + 0.75) / (count + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..20 {
                // Climb the three-term recurrence to P_n and P_{n−1}.
                let (mut before, mut value) = (1.0, x);
                for j in 2..=n {
                    let j = j as f64;
                    (before, value) = (value, ((2.0 * j - 1.0) * x * value - (j - 1.0) * before) / j);
                }
                slope = count * (x * value - before) / (x * x - 1.0);
                let step = value / slope;
                x -= step;
                if step.abs() < 1e-15 {
                    break;
                }
            }
            (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}
