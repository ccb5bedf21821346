//! Scene + basis → exchange T, scattering S, emission E, measurement W.

mod exchange;
mod laws;
mod measurement;
mod operators;
mod system;

pub use exchange::{
    Exchange, ExchangeReport, Ladder, Nodes, Occlusion, Repair, point_factor, point_factors, point_to_disk, unoccluded,
};
pub use laws::Laws;
pub use measurement::{Gather, Measurement};
pub use operators::{Propagation, Transport};
pub use system::{AssemblyError, System, assemble, assemble_watched};
