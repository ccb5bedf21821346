//! How light turns at a surface: BRDFs.

mod brdf;

pub use brdf::Brdf;
