//! Quadrature rules on [0, 1].

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::LazyLock;

/// Nodes and weights on [0, 1]; the weights sum to 1.
#[derive(Clone, Debug)]
pub struct Rule {
    pub nodes: Vec<f64>,
    pub weights: Vec<f64>,
}

/// Gauss–Legendre with n nodes, exact for polynomials of degree 2n − 1. Roots of Pₙ by Newton's method from Tricomi's estimate.
pub fn gauss_legendre(n: usize) -> Rule {
    let mut rule = Rule { nodes: vec![0.0; n], weights: vec![0.0; n] };
    for k in 0..n {
        let mut x = (PI * (k as f64 + 0.75) / (n as f64 + 0.5)).cos();
        let mut slope = 0.0;
        for _ in 0..100 {
            // Three-term recurrence for Pₙ and Pₙ₋₁; n (x Pₙ − Pₙ₋₁) / (x² − 1) is the derivative.
            let (mut previous, mut value) = (1.0, x);
            for j in 2..=n {
                (previous, value) = (value, ((2 * j - 1) as f64 * x * value - (j - 1) as f64 * previous) / j as f64);
            }
            slope = n as f64 * (x * value - previous) / (x * x - 1.0);
            let step = value / slope;
            x -= step;
            if step.abs() < 1e-16 {
                break;
            }
        }
        rule.nodes[k] = 0.5 * (1.0 - x);
        rule.weights[k] = 1.0 / ((1.0 - x * x) * slope * slope);
    }
    rule
}

/// One node of a double-exponential rule; distances to *both* ends are kept, so that nodes next to 1 lose no digits.
#[derive(Clone, Copy, Debug)]
pub struct EndNode {
    /// Distance from 0.
    pub low: f64,
    /// Distance from 1.
    pub high: f64,
    pub weight: f64,
}

/// Steps of the tanh-sinh rules: each halves the one before.
const STEPS: [f64; 4] = [0.2, 0.1, 0.05, 0.025];

/// How far the rules reach: out to where the weights times their logarithm fall below 1e-16.
const REACH: f64 = 3.3;

/// Double-exponential (tanh-sinh) quadrature of Takahashi and Mori (1974): integrands analytic inside (0, 1) with any integrable
/// singularity at the ends. Level 0 is a whole rule; every further level holds the nodes that halving the step adds, weighted for
/// the new step, so that rule(k) = rule(k − 1) / 2 + level(k).
pub static TANH_SINH: LazyLock<[Vec<EndNode>; STEPS.len()]> = LazyLock::new(|| {
    std::array::from_fn(|level| {
        let step = STEPS[level];
        let reach = (REACH / step).round() as i32;
        let added = |k: &i32| level == 0 || k % 2 != 0;
        (-reach..=reach).filter(added).map(|k| end_node(step * f64::from(k), step)).collect()
    })
});

/// x = 1/(1 + exp(−π sinh t)), and the complement by the mirrored formula.
fn end_node(t: f64, step: f64) -> EndNode {
    let angle = FRAC_PI_2 * t.sinh();
    let (low, high) = (1.0 / (1.0 + (-2.0 * angle).exp()), 1.0 / (1.0 + (2.0 * angle).exp()));
    EndNode { low, high, weight: step * FRAC_PI_2 * t.cosh() * 2.0 * low * high }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gauss_legendre_integrates_powers_exactly() {
        for n in 1..12 {
            let rule = gauss_legendre(n);
            for power in 0..2 * n as i32 {
                let sum: f64 = rule.nodes.iter().zip(&rule.weights).map(|(x, w)| w * x.powi(power)).sum();
                // A few ulp for each of the n terms.
                assert!((sum * f64::from(power + 1) - 1.0).abs() < 1e-14, "n {n}, power {power}: {sum}");
            }
        }
    }

    #[test]
    fn tanh_sinh_takes_logarithmic_ends_at_every_level() {
        // ∫₀¹ ln x dx = −1 and ∫₀¹ ln(1 − x) dx = −1.
        for end in [0, 1] {
            let mut sum = 0.0;
            for (level, nodes) in TANH_SINH.iter().enumerate() {
                let added: f64 = nodes.iter().map(|n| n.weight * if end == 0 { n.low } else { n.high }.ln()).sum();
                sum = if level == 0 { added } else { 0.5 * sum + added };
                // The first level is coarse, the second good to rounding.
                let allowed = if level == 0 { 1e-6 } else { 1e-14 };
                assert!((sum + 1.0).abs() < allowed, "level {level}: {sum}");
            }
        }
    }
}
