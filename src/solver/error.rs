//! Why there is no answer.

use crate::linalg::{Block, Equation, FactorError};
use std::fmt;
use thiserror::Error;

/// An equation that a method cannot answer, with the number that shows it.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SolveError {
    #[error("{method}: band {band}: {source}")]
    Factor { method: &'static str, band: usize, source: FactorError },
    #[error(
        "{method} diverges: after {iteration} iterations the residual is {residual:e}, it was {best:e}{}",
        .gain.map_or(String::new(), |gain| format!("\n  = {gain}"))
    )]
    Diverged { method: &'static str, iteration: usize, residual: f64, best: f64, gain: Option<RowGain> },
    #[error("{method}: the residual is not a number after {iteration} iterations")]
    NotFinite { method: &'static str, iteration: usize },
    #[error("{method} needs the self-adjoint form of the equation, and this one has none")]
    NoSelfAdjointForm { method: &'static str },
    #[error(
        "{method} needs G to be self-adjoint in the étendue inner product: ⟨x, G y⟩ and ⟨G x, y⟩ differ by {violation:e} \
         (relative), allowed is {allowed:e}"
    )]
    NotSelfAdjoint { method: &'static str, violation: f64, allowed: f64 },
    #[error(
        "{method} needs I − K to be positive definite: ⟨p, A p⟩ = {curvature:e} in band {band} at iteration {iteration}"
    )]
    NotPositiveDefinite { method: &'static str, band: usize, iteration: usize, curvature: f64 },
    #[error(
        "{method} cannot solve unknown {unknown} in band {band} for itself: its own gain Kᵢᵢ is {gain:e}, must be below 1"
    )]
    SelfGain { method: &'static str, band: usize, unknown: usize, gain: f64 },
    #[error(
        "{method} broke down in band {band} at iteration {iteration}: {quantity} = {value:e}, at a relative residual of {residual:e}"
    )]
    Breakdown { method: &'static str, band: usize, iteration: usize, quantity: &'static str, value: f64, residual: f64 },
}

/// A row of K that gives out as much as it takes in, or more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowGain {
    pub band: usize,
    pub unknown: usize,
    /// Σⱼ Kᵢⱼ.
    pub gain: f64,
}

impl RowGain {
    /// The row that gains most, if that is 1 or more beyond rounding. One product.
    pub fn of(equation: Equation<'_>) -> Option<Self> {
        let (n, n_bands) = (equation.n_unknowns(), equation.n_bands());
        let ones = Block::from_fn(n, n_bands, |_, _| 1.0);
        let mut gains = Block::zeros(n, n_bands);
        equation.transport.apply(&ones, &mut gains);
        let rows = (0..n_bands).flat_map(|band| (0..n).map(move |unknown| (band, unknown)));
        let gains = rows.map(|(band, unknown)| Self { band, unknown, gain: gains.get(unknown, band) });
        // A row that loses nothing sums to 1 within rounding.
        let least = 1.0 - n as f64 * f64::EPSILON;
        gains.filter(|row| row.gain >= least).max_by(|a, b| a.gain.total_cmp(&b.gain))
    }
}

impl fmt::Display for RowGain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { band, unknown, gain } = self;
        write!(f, "row {unknown} of K sums to {gain} in band {band}: what gains 1 or more may never come to rest")
    }
}
