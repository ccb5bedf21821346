//! Scene + basis → exchange T, scattering S, emission E, measurement W.

mod exchange;
mod laws;
mod letters;
mod measurement;
mod operators;
mod orbits;
mod sensitivity;
mod system;
mod translates;

pub use exchange::{
    Enclosure, Exchange, ExchangeReport, Ladder, Nodes, Occlusion, Repair, RepairMethod, enclose, exchange_of_pair,
    point_factor, point_factors, point_to_disk, unoccluded,
};
pub use laws::Laws;
pub use letters::Letter;
pub use measurement::{Gather, Measurement};
pub use operators::{AdjointTransport, Propagation, Transport};
pub use orbits::Orbits;
pub use sensitivity::Sensitivity;
pub use system::{AdjointSystem, AssemblyError, System, assemble, assemble_orbits, assemble_watched};
