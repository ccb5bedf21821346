//! How light fades and turns on its way: homogeneous media and phase functions.

mod henyey_greenstein;
mod homogeneous;
mod isotropic;
mod phase;

pub use henyey_greenstein::{HenyeyGreenstein, HenyeyGreensteinError};
pub use homogeneous::{Homogeneous, MediumError};
pub use isotropic::Isotropic;
pub use phase::Phase;
