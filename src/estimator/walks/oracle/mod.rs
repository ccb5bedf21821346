//! Exact variances of walks, before any is drawn: moments of a score solve linear systems of their own.
//!
//! ```text
//! X = A where the walk ends,      X = B + ω X' where it goes on
//! E[Xᵐ] = … lower moments … + Hₘ E[X'ᵐ],      (Hₘ)ᵢⱼ = Pᵢⱼ ωᵢⱼᵐ,      H₁ = K
//! ```
//!
//! The moments are kept about the mean, so that nothing cancels: with D what one step alone puts off the mean (D = B + ω L' − L),
//!
//! ```text
//! V = E[D²] + H₂ V
//! T = E[D³ + 3 D ω² V'] + H₃ T
//! F = E[D⁴ + 6 D² ω² V' + 4 D ω³ T'] + H₄ F
//! ```
//!
//! This room hands the equations to a solver of the caller's choice, one call an equation, every band at once. A moment exists if the
//! spectral radius of its Hₘ is below 1: so it always is for walks whose weights never grow, and it is bounded from above for all others,
//! or the moment refused. Cost: two products a moment beside the solve. Source: Halton 1962; Spanier & Gelbard 1969, §3;
//! Sbert 1997 (walks of radiosity).

mod existence;
mod gathering;
mod guided;
mod kernel;
mod law;
mod prediction;
mod recursion;
mod shooting;

pub(super) use law::Law;
pub use prediction::{OracleError, Order, Prediction};
