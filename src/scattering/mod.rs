//! How light turns at a surface: BRDFs, and surfaces that let light through.
//!
//! | surface | smooth part | mirrors | sides |
//! |---|---|---|---|
//! | [`Lambert`], [`LommelSeeliger`], [`Chandrasekhar`] | diffuse, clouds seen once and to the end | – | 1 |
//! | [`Phong`], [`BlinnPhong`], [`Ward`] | lobes without facets | – | 1 |
//! | [`Conductor`] | – | 1 | 1 |
//! | [`RoughConductor`], [`CompensatedConductor`] | [`Microfacets`] of [`Metal`] | – | 1 |
//! | [`Plastic`], [`RoughPlastic`] | diffuse under a coat | 1, – | 1 |
//! | [`Dielectric`], [`ThinDielectric`] | – | 2 | 2 |
//! | [`RoughDielectric`] | [`Microfacets`] of [`Glass`] | – | 2 |
//! | [`DiffuseTransmission`] | paper | – | 2 |
//! | [`Tabulated`], [`HalfDifferenceTable`] | measured | – | 1 |
//! | [`Blend`] | of any two | theirs | theirs |
//!
//! Conventions and laws are [`Brdf`]'s. Parameters bear Mitsuba 3's names. Directional albedos are closed forms or quadratures of stated error,
//! never samples; light that meets a second facet is absorbed, but for [`CompensatedConductor`].

mod blend;
mod blinn_phong;
mod brdf;
mod chandrasekhar;
mod choice;
mod compensated;
mod conductor;

mod deltas;
mod dielectric;
mod diffuse_transmission;
pub mod fresnel;
mod glass;
mod graded_table;
mod half_difference;
mod half_vectors;
mod lambert;
mod lommel_seeliger;
mod metal;
mod microfacet;
mod parameter;
mod phong;
mod plastic;
mod quadrature;
mod refracting_facets;
mod rough_conductor;
mod rough_dielectric;
mod rough_plastic;
mod tabulated;
mod thin_dielectric;
mod ward;

pub use blend::Blend;
pub use blinn_phong::BlinnPhong;
pub use brdf::Brdf;
pub use chandrasekhar::Chandrasekhar;
pub use compensated::CompensatedConductor;
pub use conductor::Conductor;
pub use deltas::{Delta, Deltas};
pub use dielectric::Dielectric;
pub use diffuse_transmission::DiffuseTransmission;
pub use glass::Glass;
pub use half_difference::HalfDifferenceTable;
pub use lambert::Lambert;
pub use lommel_seeliger::LommelSeeliger;
pub use metal::Metal;
pub use microfacet::{Distribution, Masking, Microfacets};
pub use parameter::ParameterError;
pub use phong::{Phong, PhongError};
pub use plastic::{Base, Plastic};
pub use quadrature::Quadrature;
pub use rough_conductor::RoughConductor;
pub use rough_dielectric::RoughDielectric;
pub use rough_plastic::RoughPlastic;
pub use tabulated::{PatchRings, TableError, Tabulated, Violations};
pub use thin_dielectric::ThinDielectric;
pub use ward::Ward;
