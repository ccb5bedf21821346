//! How light turns at a surface: BRDFs, and surfaces that let light through.

mod blend;
mod blinn_phong;
mod brdf;
mod chandrasekhar;
mod compensated;
mod conductor;

mod deltas;
mod dielectric;
mod diffuse_transmission;
pub mod fresnel;
mod graded_table;
mod half_vectors;
mod lambert;
mod lommel_seeliger;
mod microfacet;
mod parameter;
mod phong;
mod plastic;
mod quadrature;
mod refracting_facets;
mod rough_conductor;
mod rough_dielectric;
mod rough_plastic;
mod ward;

pub use blend::Blend;
pub use blinn_phong::BlinnPhong;
pub use brdf::Brdf;
pub use chandrasekhar::Chandrasekhar;
pub use compensated::CompensatedConductor;
pub use conductor::Conductor;
pub use deltas::{Delta, Deltas};
pub use dielectric::{Dielectric, Glass, ThinDielectric};
pub use diffuse_transmission::DiffuseTransmission;
pub use lambert::Lambert;
pub use lommel_seeliger::LommelSeeliger;
pub use microfacet::{Distribution, Masking, Microfacets};
pub use parameter::ParameterError;
pub use phong::{Phong, PhongError};
pub use plastic::{Base, Plastic};
pub use quadrature::Quadrature;
pub use rough_conductor::{Metal, RoughConductor};
pub use rough_dielectric::RoughDielectric;
pub use rough_plastic::RoughPlastic;
pub use ward::Ward;
