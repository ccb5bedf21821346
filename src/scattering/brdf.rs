//! The one trait of reflecting surfaces.

use crate::geometry::Vec3;
use std::fmt::Debug;

/// A bidirectional reflectance distribution function f_r, in sr⁻¹, one value a band.
///
/// Conventions, said once: directions are unit vectors in the surface's local frame, z its normal; both point **away** from
/// the surface; the cosine is **never** inside `eval`; densities are with respect to solid angle. Every implementation is
/// positive, reciprocal (eval symmetric in its directions) and conserves energy (albedo ≤ 1), and is tested for each.
pub trait Brdf: Debug + Send + Sync {
    /// Number of colour bands.
    fn n_bands(&self) -> usize;

    /// f_r(incident, outgoing), sr⁻¹; zero where either points below the surface.
    fn eval(&self, band: usize, incident: Vec3, outgoing: Vec3) -> f64;

    /// A direction of incidence for this outgoing one, from two numbers uniform in [0, 1); `None` where the warp leaves the
    /// upper hemisphere (that sample counts as absorbed).
    fn sample(&self, outgoing: Vec3, uniform: [f64; 2]) -> Option<Vec3>;

    /// Density of [`Brdf::sample`], sr⁻¹.
    fn pdf(&self, outgoing: Vec3, incident: Vec3) -> f64;

    /// Directional albedo: ∫ f_r(incident, outgoing) cosθᵢ dωᵢ.
    fn albedo(&self, band: usize, outgoing: Vec3) -> f64;

    /// The albedo in each band if f_r is constant, f_r = albedo/π: one bin of directions then represents it exactly.
    fn lambertian(&self) -> Option<&[f64]>;

    /// What the BRDF is, with its parameters: enters the scene's hash.
    fn description(&self) -> String;
}
