//! The spectral radius of K ≥ 0 between two bounds that need no eigenvector.
//!
//! ```text
//! min (K x)ᵢ / xᵢ  ≤  ρ(K)  ≤  max (K x)ᵢ / xᵢ      for any x > 0
//! ```
//!
//! Both ends hold for every x, and are widened by a bound on their own rounding; powers of K + θ bring them together, θ damping what
//! swings between two sides. Unknowns that K leaves dark after some bounces have no part in it. Source: Collatz (1942);
//! Wielandt (1950); Varga (2000), theorem 2.2.

use crate::linalg::{Block, Equation, max_abs};

/// θ, in units of the upper bound.
const SHIFT: f64 = 0.25;

/// ρ(K) of one band.
#[derive(Clone, Debug, PartialEq)]
pub struct RadiusBounds {
    /// low ≤ ρ(K) ≤ high.
    pub low: f64,
    pub high: f64,
    /// x of the last product, n, max 1: nearly the Perron vector where the bounds are close.
    pub vector: Vec<f64>,
}

/// Bounds of every band, and what they took.
#[derive(Clone, Debug, PartialEq)]
pub struct SpectralRadius {
    pub bands: Vec<RadiusBounds>,
    /// Products with K, all bands at once.
    pub n_applies: usize,
}

/// Bounds of ρ(K) of every band, K ≥ 0, no further apart than `width` relative to the upper one, or what `n_products` reach.
/// `None` where K has entries below zero.
pub fn spectral_radius(equation: Equation<'_>, width: f64, n_products: usize) -> Option<SpectralRadius> {
    if !equation.transport.is_nonnegative() {
        return None;
    }
    let (n, n_bands) = (equation.n_unknowns(), equation.n_bands());
    // A sum of n products is off by at most (n + 2) ulp of itself, and the quotient by one.
    let rounding = (n as f64 + 4.0) * f64::EPSILON;
    let mut x = Block::from_fn(n, n_bands, |_, _| 1.0);
    let mut image = Block::zeros(n, n_bands);
    let whole = RadiusBounds { low: 0.0, high: f64::INFINITY, vector: Vec::new() };
    let mut bands = vec![whole; n_bands];
    let mut n_applies = 0;
    let is_wide = |bounds: &RadiusBounds| bounds.low < (1.0 - width) * bounds.high;
    while n_applies < n_products && bands.iter().any(is_wide) {
        equation.transport.apply(&x, &mut image);
        n_applies += 1;
        for (band, bounds) in bands.iter_mut().enumerate() {
            // Tighten both ends by the quotients where x is not dark.
            let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
            for (x, y) in x.column(band).iter().zip(image.column(band)).filter(|(x, _)| **x > 0.0) {
                low = low.min(y / x);
                high = high.max(y / x);
            }
            bounds.low = bounds.low.max(if low.is_finite() { low * (1.0 - rounding) } else { 0.0 });
            bounds.high = bounds.high.min(high * (1.0 + rounding));
            // Take one step of K + θ, in which the dark stays dark.
            let shift = SHIFT * high;
            let column = x.column_mut(band);
            column
                .iter_mut()
                .zip(image.column(band))
                .for_each(|(x, y)| *x = if *y > 0.0 { y + shift * *x } else { 0.0 });
            let largest = max_abs(column);
            if largest > 0.0 {
                column.iter_mut().for_each(|x| *x /= largest);
            }
        }
    }
    for (band, bounds) in bands.iter_mut().enumerate() {
        bounds.vector = x.column(band).to_vec();
    }
    Some(SpectralRadius { bands, n_applies })
}

/// How far K x is from a gain of `gain`: the largest (K x)ᵢ / xᵢ of one band, widened by its rounding, for an x > 0 where K is not dark.
/// One product.
pub fn largest_gain(equation: Equation<'_>, x: &Block) -> Vec<f64> {
    let (n, n_bands) = (equation.n_unknowns(), equation.n_bands());
    let rounding = (n as f64 + 4.0) * f64::EPSILON;
    let mut image = Block::zeros(n, n_bands);
    equation.transport.apply(x, &mut image);
    let gain = |band: usize| {
        let quotients = x.column(band).iter().zip(image.column(band)).map(|(x, y)| if *y == 0.0 { 0.0 } else { y / x });
        quotients.fold(0.0, f64::max) * (1.0 + rounding)
    };
    (0..n_bands).map(gain).collect()
}
