//! Bounds around the discrete answer that trust no solver.
//!
//! With K ≥ 0 and every row of K summing to less than one, (I − K)⁻¹ ≥ 0, and for any L̃ with residual r = E + K L̃ − L̃:
//!
//! ```text
//! L − L̃ = (I − K)⁻¹ r,      −max(−r, 0) / (1 − ‖K‖∞)  ≤  L − L̃  ≤  max(r, 0) / (1 − ‖K‖∞)
//! ```
//!
//! The residual and the row sums are inflated by a bound on their own rounding. Cost: one product with K.

use crate::linalg::{Block, Equation};

/// L − below ≤ (I − K)⁻¹E ≤ L + above for every bundle; one number a band.
#[derive(Clone, Debug, PartialEq)]
pub struct Bracket {
    pub below: Vec<f64>,
    pub above: Vec<f64>,
}

impl Bracket {
    /// The wider side of the worst band, relative to that band's largest radiance.
    pub fn relative_width(&self, radiance: &Block) -> f64 {
        let sides = self.below.iter().zip(&self.above);
        sides.zip(radiance.columns()).fold(0.0, |worst: f64, ((below, above), column)| {
            let scale = crate::linalg::max_abs(column);
            if scale > 0.0 { worst.max(below.max(*above) / scale) } else { worst }
        })
    }
}

/// The bracket around `radiance` with this residual; `None` where some row of K sums to one or more.
pub(super) fn around(equation: Equation<'_>, radiance: &Block, residual: &Block) -> Option<Bracket> {
    let (n, n_bands) = (radiance.n_rows(), radiance.n_columns());
    let ones = Block::from_fn(n, n_bands, |_, _| 1.0);
    let mut gain = Block::zeros(n, n_bands);
    equation.transport.apply(&ones, &mut gain);

    let mut bracket = Bracket { below: Vec::new(), above: Vec::new() };
    for band in 0..n_bands {
        // A sum of n products is off by at most (n + 2) ulp of the sum of their magnitudes; K ≥ 0, so that is ‖K‖ ‖L‖.
        let rounding = (n as f64 + 4.0) * f64::EPSILON;
        let gain = gain.column(band).iter().copied().fold(0.0, f64::max) * (1.0 + rounding);
        let contraction = 1.0 - gain;
        if contraction.is_nan() || contraction <= 0.0 {
            return None;
        }
        let largest = |block: &Block| crate::linalg::max_abs(block.column(band));
        let slack = rounding * (largest(equation.emission) + 2.0 * largest(radiance));
        let side = |sign: f64| residual.column(band).iter().map(|r| sign * r).fold(0.0, f64::max);
        let bound = |worst: f64| (worst + slack) / contraction * (1.0 + 4.0 * f64::EPSILON);
        bracket.below.push(bound(side(-1.0)));
        bracket.above.push(bound(side(1.0)));
    }
    Some(bracket)
}
