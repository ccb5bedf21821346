//! `furnace-cube`: a closed unit cube of one albedo and one emission.
//!
//! # Geometry
//! Six one-sided unit squares around [0, 1]³, facing inward.
//!
//! # Exact answer
//! Every surface emits radiance e and has albedo a. Try L = const: a closed scene shows every bundle nothing but L,
//! so its irradiance is πL, and what it sends out is e + a L. Hence
//!
//! ```text
//! L = e + a L,      L = e / (1 − a).
//! ```
//!
//! The solution of a second-kind equation with ‖K‖ = a < 1 is unique, so this is it. In the assembled system K 1 =
//! a 1 by closure, at any mesh and any number of direction bins: the same L is exact there too. The Neumann series
//! cut after k bounces is e (1 − a^{k+1}) / (1 − a).

use super::matte::{film, matte, scene};
use super::{Exact, shape};
use crate::geometry::Vec3;
use crate::scene::{Camera, Scene, SceneError};

/// The default albedo of both furnaces, a band each.
pub const ALBEDO: [f64; 3] = [0.5, 0.75, 0.9];
/// The default emission of both furnaces, W m⁻² sr⁻¹. With [`ALBEDO`], L = (2, 2, 2.5).
pub const EMISSION: [f64; 3] = [1.0, 0.5, 0.25];

/// The unit cube [0, 1]³ seen from inside, every wall of this albedo and emitting this radiance, one value a band.
///
/// Surfaces `right` (x = 1), `left`, `ceiling` (y = 1), `floor`, `front` (z = 1), `back`. The answer is
/// [`furnace_exact`].
///
/// # Errors
/// An albedo outside [0, 1], a negative or infinite emission, no emission at all, lists of different length or empty.
pub fn furnace_cube(albedo: &[f64], emission: &[f64]) -> Result<Scene, SceneError> {
    let names = ["right", "left", "ceiling", "floor", "front", "back"];
    let walls = names
        .into_iter()
        .zip(shape::room(Vec3::ZERO, Vec3::ONE))
        .map(|(name, wall)| matte(name, [wall], albedo, emission))
        .collect::<Result<_, _>>()?;
    let camera = Camera::look_at(Vec3::new(0.5, 0.5, 0.9), Vec3::splat(0.5), Vec3::Y, 75_f64.to_radians(), film());
    scene("furnace-cube", albedo.len(), walls, camera)
}

/// L = e / (1 − a) in every bundle of a closed scene of uniform albedo and emission. Infinite where a = 1 and e > 0: no
/// steady state exists there.
pub fn furnace_exact(albedo: &[f64], emission: &[f64]) -> Exact {
    Exact::Uniform { radiance: albedo.iter().zip(emission).map(|(a, e)| e / (1.0 - a)).collect() }
}
