//! The one trait of scattering particles.

use crate::geometry::Vec3;
use std::fmt::Debug;

/// A phase function p, in sr⁻¹: the density of directions into which a scattering particle turns light, ∫ p dω = 1.
///
/// Conventions, said once: directions are unit vectors and both point **away** from the particle, so light that goes straight on has
/// incident = −outgoing, and the scattering angle θ has cosθ = −incident · outgoing. No albedo is inside. Every implementation is
/// positive, reciprocal (eval symmetric in its directions) and normalised, and is tested for each.
pub trait Phase: Debug + Send + Sync {
    /// p(incident, outgoing), sr⁻¹.
    fn eval(&self, incident: Vec3, outgoing: Vec3) -> f64;

    /// A direction of incidence for this outgoing one, from two numbers uniform in [0, 1).
    fn sample(&self, outgoing: Vec3, uniform: [f64; 2]) -> Vec3;

    /// Density of [`Phase::sample`], sr⁻¹.
    fn pdf(&self, outgoing: Vec3, incident: Vec3) -> f64;

    /// ∫ p cosθ dω in [−1, 1]: 1 is all forward, 0 is balanced, −1 is all backward.
    fn mean_cosine(&self) -> f64;

    /// What the phase function is, with its parameters: enters the scene's hash.
    fn description(&self) -> String;
}
