//! How light turns at a surface: BRDFs.

mod brdf;
mod lambert;
mod phong;

pub use brdf::Brdf;
pub use lambert::Lambert;
pub use phong::{Phong, PhongError};
