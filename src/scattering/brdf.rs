//! The one trait of surfaces that reflect or transmit.

use super::Deltas;
use crate::geometry::Vec3;
use std::fmt::Debug;

/// A bidirectional reflectance (or scattering) distribution function f, in sr⁻¹, one value a band.
///
/// ```text
/// L(outgoing) = ∫ f(incident, outgoing) L(incident) |cosθᵢ| dωᵢ  +  Σₖ wₖ L(incidentₖ)
///               smooth part: eval, sample, pdf                     mirror-like part: deltas
/// ```
///
/// Conventions, said once: directions are unit vectors in the surface's local frame, z its normal; both point **away** from
/// the surface; the cosine is **never** inside `eval`; densities are with respect to solid angle. Every implementation is
/// positive, reciprocal (eval symmetric in its directions) and conserves energy (albedo ≤ 1), and is tested for each.
///
/// **Mirrors.** `eval`, `sample` and `pdf` know the smooth part only: no direction has the measure of a mirror's. `deltas` lists the
/// rest, and `albedo` counts both.
///
/// **Transmission.** A surface that is not `is_transmissive` knows only its upper side: below it everything is zero. One that is
/// joins the medium above (index n₊) to the one below (n₋), and takes incident and outgoing directions on either side. L is then
/// *basic* radiance L/n², which no interface changes, and reciprocity is that of étendue n² cosθ dω:
///
/// ```text
/// n(outgoing)² f(incident, outgoing) = n(incident)² f(outgoing, incident),      relative_index = n₋/n₊
/// ```
///
/// so that on one side, and between equal indices, f is symmetric as ever; weights of mirror-like terms are symmetric always. An albedo
/// is the share of light sent into the surface along the outgoing direction that leaves it again, on whichever side.
pub trait Brdf: Debug + Send + Sync {
    /// Number of colour bands.
    fn n_bands(&self) -> usize;

    /// f(incident, outgoing) of the smooth part, sr⁻¹; zero where either points below an opaque surface.
    fn eval(&self, band: usize, incident: Vec3, outgoing: Vec3) -> f64;

    /// A direction of incidence for this outgoing one, from two numbers uniform in [0, 1); `None` where the warp leaves the
    /// surface's sides (that sample counts as absorbed).
    fn sample(&self, outgoing: Vec3, uniform: [f64; 2]) -> Option<Vec3>;

    /// Density of [`Brdf::sample`], sr⁻¹.
    fn pdf(&self, outgoing: Vec3, incident: Vec3) -> f64;

    /// Directional albedo: ∫ f(incident, outgoing) |cosθᵢ| dωᵢ + Σ weights of the mirror-like terms.
    fn albedo(&self, band: usize, outgoing: Vec3) -> f64;

    /// The mirror-like terms for this outgoing direction. Their directions, and the order of these, are the same in every band.
    fn deltas(&self, _band: usize, _outgoing: Vec3) -> Deltas {
        Deltas::NONE
    }

    /// A good chance, in [0, 1], with which to follow a mirror-like term rather than a sample of the smooth part: 0 where nothing mirrors,
    /// 1 where nothing is smooth. Cheap, unlike albedos; any number strictly between is as right, with more noise.
    fn mirror_share(&self, outgoing: Vec3) -> f64 {
        if self.deltas(0, outgoing).is_empty() { 0.0 } else { 0.5 }
    }

    /// Whether light passes to the other side.
    fn is_transmissive(&self) -> bool {
        false
    }

    /// n₋/n₊, the refractive index below over that above; 1 for all that does not refract.
    fn relative_index(&self) -> f64 {
        1.0
    }

    /// The albedo in each band if f is constant, f = albedo/π, on an opaque surface: one bin of directions then represents it exactly.
    fn lambertian(&self) -> Option<&[f64]>;

    /// What the BRDF is, with its parameters: enters the scene's hash.
    fn description(&self) -> String;
}
