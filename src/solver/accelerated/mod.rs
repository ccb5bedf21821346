//! Methods that know which unknowns are near each other: what converges slowly is smooth, and is solved for on groups of them.

mod coarse;
mod deflated_cg;
mod deflated_gmres;
mod levels;
mod multigrid;
mod near;
mod shifted;
mod two_grid;

pub(super) use coarse::weights as self_adjoint_weights;
pub use deflated_cg::DeflatedCg;
pub use deflated_gmres::{CoarseSpace, DeflatedGmres};
pub use multigrid::Multigrid;
pub use two_grid::{Perron, TwoGrid};
