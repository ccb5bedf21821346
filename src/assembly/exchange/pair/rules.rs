//! Quadrature rules on [0, 1].

use super::real::Real;
use std::f64::consts::PI;

/// Nodes and weights on [0, 1]; the weights sum to 1.
#[derive(Clone, Debug)]
pub struct Rule {
    pub nodes: Vec<f64>,
    pub weights: Vec<f64>,
}

/// Gauss–Legendre with n nodes, exact for polynomials of degree 2n − 1.
pub fn gauss_legendre(n: usize) -> Rule {
    let (nodes, weights) = gauss_nodes::<f64>(n, 1).into_iter().unzip();
    Rule { nodes, weights }
}

/// The same as pairs of node and weight, to the precision of the numbers: roots of Pₙ by Newton's method from Tricomi's
/// estimate. `multiple` makes their number one of its multiples, by nodes of weight zero.
pub fn gauss_nodes<R: Real>(n: usize, multiple: usize) -> Vec<(R, R)> {
    let (one, half, degree) = (R::from(1.0), R::from(0.5), R::from(n as f64));
    let node = |k: usize| {
        let mut x = R::from((PI * (k as f64 + 0.75) / (n as f64 + 0.5)).cos());
        let mut slope = one;
        for _ in 0..8 {
            // Three-term recurrence for Pₙ and Pₙ₋₁; n (x Pₙ − Pₙ₋₁) / (x² − 1) is the derivative.
            let (mut previous, mut value) = (one, x);
            for j in 2..=n {
                let [two_j, j, before] = [2 * j - 1, j, j - 1].map(|j| R::from(j as f64));
                (previous, value) = (value, (two_j * x * value - before * previous) / j);
            }
            slope = degree * (x * value - previous) / (x * x - one);
            x = x - value / slope;
        }
        (half * (one - x), one / ((one - x * x) * slope * slope))
    };
    let filling = std::iter::repeat_n((half, R::from(0.0)), n.next_multiple_of(multiple) - n);
    (0..n).map(node).chain(filling).collect()
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
}
