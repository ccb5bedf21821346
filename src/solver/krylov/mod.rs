//! Methods that choose the best combination of bounces.

mod anderson;
mod bicg;
mod bicgstab;
mod cg;
mod gmres;
mod inner;
mod minres;
mod preconditioner;

pub use anderson::Anderson;
pub use bicg::BiCg;
pub use bicgstab::BiCgStab;
pub use cg::Cg;
pub(super) use gmres::minimise;
pub use gmres::{FlexibleGmres, Gmres};
pub use minres::Minres;
pub use preconditioner::{MinimalResidual, OwnGain, Preconditioner, Prepared};
