//! Uniform numbers and what they are warped into. Knows no light; the only door to `rand_philox`.
//!
//! Points and directions are plain `[f64; 3]`. Every warp is a pure function of numbers uniform in [0, 1), and its density is
//! the next function, so that a sample can be drawn from a random stream or from a low-discrepancy point alike.

mod alias;
mod cumulative;
mod directions;
mod kronecker;
mod padded;
mod philox;
mod sobol;
mod stream;
pub mod warp;

pub use alias::{AliasError, AliasRows, AliasTable, Draw, ROW_SUM_TOLERANCE};
pub use cumulative::CumulativeRows;
pub use directions::N_SOBOL_DIMENSIONS;
pub use kronecker::{Kronecker, mix};
pub use padded::PaddedSobol;
pub use sobol::Sobol;
pub use stream::{Stream, Streams, mix_seed};
