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

/// Double-exponential (tanh-sinh) quadrature of Takahashi and Mori (1974): integrands analytic inside (0, 1) with any integrable
/// singularity at the ends. Distances to *both* ends are kept, so that nodes next to 1 lose no digits.
pub struct TanhSinh {
    /// (distance from 0, distance from 1, weight), step h.
    pub fine: Vec<(f64, f64, f64)>,
    /// The rule of step 2h: every other node of `fine`, weights doubled.
    pub coarse_is_even: Vec<bool>,
}

/// 67 nodes, step 0.1, out to where the weights times their logarithm fall below 1e-16: 14 digits for logarithmic ends.
pub static TANH_SINH: LazyLock<TanhSinh> = LazyLock::new(|| {
    let (step, reach) = (0.1, 33);
    let mut fine = Vec::new();
    let mut coarse_is_even = Vec::new();
    for k in -reach..=reach {
        let t = step * f64::from(k);
        let angle = FRAC_PI_2 * t.sinh();
        // x = 1/(1 + exp(−2 angle)), and the complement by the mirrored formula.
        let (low, high) = (1.0 / (1.0 + (-2.0 * angle).exp()), 1.0 / (1.0 + (2.0 * angle).exp()));
        let weight = step * FRAC_PI_2 * t.cosh() * 2.0 * low * high;
        fine.push((low, high, weight));
        coarse_is_even.push(k % 2 == 0);
    }
    TanhSinh { fine, coarse_is_even }
});

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
    fn tanh_sinh_takes_logarithmic_ends() {
        // ∫₀¹ ln x dx = −1 and ∫₀¹ ln(1 − x) dx = −1.
        for end in [0, 1] {
            let sum: f64 = TANH_SINH.fine.iter().map(|n| n.2 * if end == 0 { n.0 } else { n.1 }.ln()).sum();
            assert!((sum + 1.0).abs() < 1e-14, "{sum}");
        }
    }
}
