//! `floating-block`: a closed block that hangs in a closed cube, one half of the race against View3D.
//!
//! # Geometry
//! The inside of the cube [0, 1]³, its ceiling (z = 1) glowing. In it a closed block, facing outward: footprint 0.3 × 0.3 turned by
//! 0.3 rad about z, centred on (0.45, 0.5), between z = 0.05 and z = 0.6. Here z is up.
//!
//! For a race between programs that take facets and cut nothing, the cube's faces come as n × n squares and the block's as
//! max(1, n/3)² rectangles: 6 n² + 6 max(1, n/3)² facets, 654 at n = 10 and 1 686 at n = 16. Neighbours share corners bit for bit.
//!
//! # Exact answer
//! The energy balance of every closed scene, Σ (1 − a) H A = Σ π e A = Φ; see [the corner box](mod@super::corner_box). No ray
//! escapes and none meets a black back, so closure of T is an error measure that needs no reference.

use super::matte::{film, matte, scene};
use super::shape::{Outline, parallelepiped, room};
use super::{Exact, emitted_power};
use crate::geometry::Vec3;
use crate::scene::{Camera, Scene, SceneError};

const CENTRE: Vec3 = Vec3::new(0.45, 0.5, 0.325);
const HALF_SIZE: Vec3 = Vec3::new(0.15, 0.15, 0.275);
const TURN: f64 = 0.3;
const DARK: [f64; 3] = [0.0; 3];

/// The block in the cube, the cube's faces in n × n facets. Surfaces `right` (x = 1), `left`, `back` (y = 1), `front`, `ceiling` (z = 1,
/// emits), `floor`, `block`.
///
/// # Errors
/// n = 0: surfaces of no polygons.
pub fn floating_block(n: usize) -> Result<Scene, SceneError> {
    let (sin, cos) = TURN.sin_cos();
    let (x, y) = (HALF_SIZE.x * Vec3::new(cos, sin, 0.0), HALF_SIZE.y * Vec3::new(-sin, cos, 0.0));
    let block = parallelepiped(CENTRE, x, y, HALF_SIZE.z * Vec3::Z);
    let n_block = (n / 3).max(1);

    let names = ["right", "left", "back", "front", "ceiling", "floor"];
    let albedos =
        [[0.25, 0.5, 0.7], [0.7, 0.3, 0.25], [0.75, 0.75, 0.7], [0.7, 0.7, 0.7], [0.8, 0.8, 0.8], [0.6, 0.55, 0.5]];
    let mut surfaces = Vec::new();
    for ((name, wall), albedo) in names.into_iter().zip(room(Vec3::ZERO, Vec3::ONE)).zip(albedos) {
        let emission = if name == "ceiling" { [2.0, 1.5, 1.0] } else { DARK };
        surfaces.push(matte(name, cut(&wall, n), &albedo, &emission)?);
    }
    surfaces.push(matte("block", block.iter().flat_map(|face| cut(face, n_block)), &[0.4, 0.6, 0.35], &DARK)?);
    let camera = Camera::look_at(Vec3::new(0.95, 0.05, 0.8), CENTRE, Vec3::Z, 75_f64.to_radians(), film());
    scene("floating-block", 3, surfaces, camera)
}

/// A quadrilateral in n × n. Corners are weighted sums of the whole's with integer weights, so those on an edge have the same bits in
/// the faces on both its sides.
fn cut(outline: &Outline, n: usize) -> Vec<Outline> {
    let corner = |i: usize, j: usize| {
        let weights = [(n - i) * (n - j), i * (n - j), i * j, (n - i) * j];
        let sum: Vec3 = outline.iter().zip(weights).map(|(v, weight)| *v * weight as f64).sum();
        sum / (n * n) as f64
    };
    let piece = |i, j| vec![corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
    (0..n).flat_map(|j| (0..n).map(move |i| (i, j))).map(|(i, j)| piece(i, j)).collect()
}

/// The energy balance: what the box absorbs is what its ceiling emits.
pub(super) fn floating_block_exact() -> Exact {
    let power = floating_block(1).map(|scene| emitted_power(&scene)).unwrap_or_default();
    Exact::AbsorbedPower { power }
}
