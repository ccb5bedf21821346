//! A function on [0, 1], tabulated once and looked up with (nearly) all digits.

use super::quadrature::gauss_legendre;
use std::f64::consts::PI;
use std::sync::LazyLock;

/// Polynomials through Chebyshev points on intervals that halve toward 0 and toward 1: what bends like x ln x or like x/(x + α) at 0, or
/// like exp(−1/(1 − x)) at 1, is smooth on each. Below the last, a straight line to the value at 0. A look-up costs some 50 operations.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct GradedTable {
    at_zero: f64,
    /// Panel k over [2⁻ᵏ⁻², 2⁻ᵏ⁻¹].
    lower: Vec<Panel>,
    /// Panel k over 1 − [2⁻ᵏ⁻², 2⁻ᵏ⁻¹], the last up to 1.
    upper: Vec<Panel>,
}

type Panel = [f64; N_POINTS];

/// Points of a panel: the interpolant of x ln x is right to 1e-15.
const N_POINTS: usize = 16;
/// Panels of the upper half.
const N_UPPER: usize = 6;

/// Chebyshev points of the second kind, from 1 down to −1.
static NODES: LazyLock<[f64; N_POINTS]> =
    LazyLock::new(|| std::array::from_fn(|j| (PI * j as f64 / (N_POINTS - 1) as f64).cos()));

impl GradedTable {
    /// Tabulates down to 2⁻ⁿ⁻¹, at 16 (n + 6) points.
    pub fn new(n_lower: usize, at_zero: f64, function: impl Fn(f64) -> f64) -> Self {
        let panel = |[low, high]: [f64; 2]| NODES.map(|x| function(0.5 * ((high + low) + (high - low) * x)));
        let lower = (0..n_lower).map(|k| panel(lower_ends(k))).collect();
        let upper = (0..N_UPPER).map(|k| panel(upper_ends(k))).collect();
        Self { at_zero, lower, upper }
    }

    /// The function at x in [0, 1].
    pub fn at(&self, x: f64) -> f64 {
        if x >= 0.5 {
            let k = halvings(1.0 - x).min(N_UPPER - 1);
            return interpolate(&self.upper[k], upper_ends(k), x);
        }
        let k = halvings(x);
        match self.lower.get(k) {
            Some(panel) => interpolate(panel, lower_ends(k), x),
            None => {
                let edge = self.lower.last().map_or(self.at_zero, |panel| panel[N_POINTS - 1]);
                self.at_zero + x / lower_ends(self.lower.len())[1] * (edge - self.at_zero)
            }
        }
    }

    /// The mean 2 ∫₀¹ f(μ) μ dμ over the hemisphere of a function of the cosine, to rounding of the interpolant.
    pub fn hemispherical_mean(&self) -> f64 {
        let rule = gauss_legendre(N_POINTS);
        let lower = (0..self.lower.len()).map(lower_ends);
        let rest = [0.0, lower_ends(self.lower.len())[1]];
        let panels = lower.chain((0..N_UPPER).map(upper_ends)).chain([rest]);
        let integral = |[low, high]: [f64; 2]| -> f64 {
            let at = |u: f64| low + (high - low) * u;
            rule.iter().map(|(u, weight)| 2.0 * (high - low) * weight * at(*u) * self.at(at(*u))).sum()
        };
        panels.map(integral).sum()
    }
}

fn lower_ends(k: usize) -> [f64; 2] {
    let high = 0.5_f64.powi(k as i32 + 1);
    [0.5 * high, high]
}

fn upper_ends(k: usize) -> [f64; 2] {
    let [near, far] = lower_ends(k);
    [1.0 - far, if k + 1 == N_UPPER { 1.0 } else { 1.0 - near }]
}

/// How often ½ must be halved to come to x or just above: read from the exponent of the number.
fn halvings(x: f64) -> usize {
    (1021 - ((x.to_bits() >> 52) & 0x7ff) as i32).max(0) as usize
}

/// The polynomial through the points of a panel, by the barycentric formula (Salzer 1972).
fn interpolate(values: &Panel, [low, high]: [f64; 2], x: f64) -> f64 {
    let x = (2.0 * x - (high + low)) / (high - low);
    let (mut above, mut below) = (0.0, 0.0);
    for (j, (node, value)) in NODES.iter().zip(values).enumerate() {
        let distance = x - node;
        if distance == 0.0 {
            return *value;
        }
        let end = if j == 0 || j == N_POINTS - 1 { 0.5 } else { 1.0 };
        let weight = if j % 2 == 0 { end } else { -end } / distance;
        above += weight * value;
        below += weight;
    }
    above / below
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What barycentric interpolation leaves of numbers of the order of 1.
    const ROUNDING: f64 = 4e-15;

    #[test]
    fn tables_hold_what_bends_at_the_ends() {
        let at_zero = |x: f64| if x > 0.0 { 1.0 + x * x.ln() } else { 1.0 };
        let at_one = |x: f64| (-x * x / (1.0 - x * x)).exp();
        let table = GradedTable::new(50, 1.0, at_zero);
        let other = GradedTable::new(30, 1.0, at_one);
        for k in 0..=5000 {
            let fraction = f64::from(k) / 5000.0;
            for x in [fraction, (-40.0 * fraction).exp2()] {
                assert!((table.at(x) - at_zero(x)).abs() < ROUNDING, "{x}: {} against {}", table.at(x), at_zero(x));
                // Twenty Chebyshev terms of an essential singularity.
                assert!((other.at(x) - at_one(x)).abs() < 1e-11, "{x}: {} against {}", other.at(x), at_one(x));
            }
        }
        // 2 ∫ (μ + μ² ln μ) dμ = 1 − 2/9.
        assert!((table.hemispherical_mean() - 7.0 / 9.0).abs() < ROUNDING);
    }
}
