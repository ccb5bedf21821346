//! What is left of L after so many bounces, bounded before a bounce is computed.
//!
//! ```text
//! Lₖ = Σ_{m ≤ k} Kᵐ E,      |L − Lₖ| ≤ c λᵏ⁺¹ / (1 − λ) x      where K x ≤ λ x, λ < 1, and |E| ≤ c x
//! ```
//!
//! With x = 1 and λ = 1 − min absorption the bound needs nothing but the albedos; with a nearly Perron vector λ is nearly the spectral
//! radius, and the bound falls as fast as the series does. Source: Collatz (1952); the tail of a geometric series.

use super::radius::largest_gain;
use crate::linalg::{Block, Equation, max_abs};

/// A bound c λᵏ⁺¹ / (1 − λ) max x on what every unknown of one band lacks after k bounces, relative to max E.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TruncationBound {
    /// λ < 1.
    pub gain: f64,
    /// c max x / max E.
    pub scale: f64,
}

impl TruncationBound {
    /// From absorption alone, x = 1; `None` where it is not known or a row absorbs nothing. No product.
    pub fn by_absorption(equation: Equation<'_>, band: usize) -> Option<Self> {
        let least = equation.absorption?.column(band).iter().copied().fold(f64::INFINITY, f64::min);
        // One rounding in the difference.
        let gain = (1.0 - least) * (1.0 + f64::EPSILON);
        (gain < 1.0).then_some(Self { gain, scale: 1.0 })
    }

    /// From an x ≥ 0 of every band, n × bands; `None` for a band where K x ≤ λ x holds for no λ < 1, or x is dark where K leads. What is
    /// bounded is the first bounce, K E ≤ c λ x, so that a black lamp needs no share in x. Two products for all bands.
    pub fn by_vector(equation: Equation<'_>, x: &Block) -> Vec<Option<Self>> {
        let gains = largest_gain(equation, x);
        let mut first = Block::zeros(x.n_rows(), x.n_columns());
        equation.transport.apply(equation.emission, &mut first);
        let rounding = (x.n_rows() as f64 + 4.0) * f64::EPSILON;
        let bound = |(band, gain): (usize, f64)| {
            let x = x.column(band);
            let lit = x.iter().zip(first.column(band)).filter(|(_, bounce)| **bounce != 0.0);
            let c = lit.map(|(x, bounce)| bounce.abs() / x).fold(0.0, f64::max) * (1.0 + rounding);
            let scale = if c > 0.0 { c / gain * max_abs(x) / max_abs(equation.emission.column(band)) } else { 0.0 };
            (gain < 1.0 && scale.is_finite()).then_some(Self { gain, scale })
        };
        gains.into_iter().enumerate().map(bound).collect()
    }

    /// The bound after k bounces.
    pub fn after(&self, n_bounces: usize) -> f64 {
        self.scale * self.gain.powf(n_bounces as f64 + 1.0) / (1.0 - self.gain)
    }

    /// Bounces after which no more than `tolerance` is lacking.
    pub fn bounces_needed(&self, tolerance: f64) -> usize {
        if self.after(0) <= tolerance {
            return 0;
        }
        let k = (tolerance * (1.0 - self.gain) / self.scale).ln() / self.gain.ln() - 1.0;
        // The logarithms are right to some ulp: look once beside.
        let k = k.ceil().max(0.0) as usize;
        if self.after(k) <= tolerance { k } else { k + 1 }
    }
}
