//! Gauss rules on [−1, 1] that are known to integrate: nodes and weights in double-double, and proof of how well they do.
//!
//! Nodes and weights are whatever Newton's method leaves; they are *taken as exact numbers*, and what is enclosed are the moments they
//! give: |Σ wᵢ Tₖ(xᵢ) − ∫Tₖ| ≤ δ for k < 2n. For f = Σ aₖ Tₖ on [−1, 1], odd terms cancel by symmetry and
//!
//! ```text
//! |Σ wᵢ f(xᵢ) − ∫f| ≤ δ Σ_{k<2n} |aₖ| + Σ_{k≥2n} |aₖ| (2 + δ + 2/(k² − 1))        (even k)
//! ```
//!
//! So no root needs to be isolated, and nothing is lost to nodes that are not quite those of Gauss.

use super::ball::Ball;
use std::sync::LazyLock;

/// Sizes of the rules, even so that no node is 0.
const SIZES: [usize; 10] = [6, 8, 10, 12, 14, 16, 20, 24, 28, 32];

pub struct Rule {
    /// Positive nodes and the weight that each has on either side.
    pub nodes: Vec<(Ball, Ball)>,
    /// δ, no less than the error of any moment below 2n.
    pub moment_error: f64,
}

/// By rising size.
pub static RULES: LazyLock<Vec<Rule>> = LazyLock::new(|| SIZES.map(Rule::gauss).into());

impl Rule {
    /// Number of nodes n.
    pub fn size(&self) -> usize {
        2 * self.nodes.len()
    }

    fn gauss(n: usize) -> Self {
        let nodes: Vec<(Ball, Ball)> = (0..n / 2).map(|k| node(n, k)).collect();
        // T₂ⱼ(x) = Tⱼ(2x² − 1), and T_{a+b} = 2 T_a T_b − T_{a−b}, which lets errors grow like j² only.
        let mut moments = vec![Ball::ZERO; n];
        for (x, weight) in &nodes {
            let y = (*x * *x).scaled(2.0) - Ball::ONE;
            let mut chebyshev = vec![Ball::ONE, y];
            for j in 2..n {
                let (a, b) = (j.div_ceil(2), j / 2);
                chebyshev.push((chebyshev[a] * chebyshev[b]).scaled(2.0) - chebyshev[a - b]);
            }
            for (moment, value) in moments.iter_mut().zip(&chebyshev) {
                *moment = *moment + (*weight * *value).scaled(2.0);
            }
        }
        let error = |(j, moment): (usize, &Ball)| {
            let square = (2 * j * 2 * j) as f64;
            (*moment - Ball::exact(2.0).over(Ball::exact(1.0 - square))).magnitude()
        };
        Self { nodes, moment_error: moments.iter().enumerate().map(error).fold(0.0, f64::max) }
    }
}

/// The k-th positive root of Pₙ from the right, and its weight 2 / ((1 − x²) Pₙ′(x)²): good guesses, taken as exact.
fn node(n: usize, k: usize) -> (Ball, Ball) {
    let mut x = Ball::exact((std::f64::consts::PI * (k as f64 + 0.75) / (n as f64 + 0.5)).cos());
    let mut slope = Ball::ONE;
    for _ in 0..8 {
        // j Pⱼ = (2j − 1) x Pⱼ₋₁ − (j − 1) Pⱼ₋₂; (x² − 1) Pₙ′ = n (x Pₙ − Pₙ₋₁).
        let (mut previous, mut value) = (Ball::ONE, x);
        for j in 2..=n {
            let next = Ball::exact((2 * j - 1) as f64) * x * value - Ball::exact((j - 1) as f64) * previous;
            (previous, value) = (value, next.over(Ball::exact(j as f64)).midpoint());
        }
        slope = (Ball::exact(n as f64) * (x * value - previous)).over(x * x - Ball::ONE);
        x = (x - value.over(slope)).midpoint();
    }
    let weight = Ball::exact(2.0).over((Ball::ONE - x * x) * slope * slope);
    (x, weight.midpoint())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_integrate_powers() {
        for rule in RULES.iter() {
            let n = rule.size();
            assert!(rule.moment_error < 1e-28, "{n}: {:e}", rule.moment_error);
            // What the bound of the tail takes for granted.
            assert!(rule.nodes.iter().all(|(x, w)| x.lower() > 0.0 && x.upper() < 1.0 && w.lower() > 0.0), "{n}");
            // Powers are sums of Chebyshev polynomials whose coefficients sum to 1.
            for power in (0..2 * n as i32).step_by(2) {
                let value = |x: Ball| (0..power).fold(Ball::ONE, |product, _| product * x);
                let sum = rule.nodes.iter().fold(Ball::ZERO, |sum, (x, w)| sum + (*w * value(*x)).scaled(2.0));
                let left = sum - Ball::exact(2.0).over(Ball::exact(f64::from(power + 1)));
                assert!(left.mignitude() <= rule.moment_error, "{n}, power {power}: {left:?}");
            }
        }
    }
}
