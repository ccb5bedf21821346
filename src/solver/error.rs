//! Why there is no answer.

use crate::linalg::FactorError;
use thiserror::Error;

/// An equation that a method cannot answer, with the number that shows it.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SolveError {
    #[error("{method}: band {band}: {source}")]
    Factor { method: &'static str, band: usize, source: FactorError },
    #[error("{method} diverges: after {iteration} iterations the residual is {residual:e}, it was {best:e}")]
    Diverged { method: &'static str, iteration: usize, residual: f64, best: f64 },
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
}
