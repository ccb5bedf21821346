//! Scene + basis → exchange T, scattering S, emission E, measurement W.

mod exchange;
mod laws;
mod operators;
mod system;

pub use exchange::{Exchange, ExchangeReport, Repair};
pub use laws::Laws;
pub use operators::{Propagation, Transport};
pub use system::{AssemblyError, System, assemble, assemble_watched};
