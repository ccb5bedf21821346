//! `corner-box`: a closed box with a block in it: every kind of pair (hidden, partly hidden, open), and no hole.
//!
//! # Geometry
//! The box 0 ≤ x ≤ 1, 0 ≤ y ≤ 0.8, 0 ≤ z ≤ 1.2, facing inward, its ceiling glowing. On the floor stands a block of
//! 0.34 × 0.45 × 0.44 (x, y, z) centred on (0.45, 0.55), turned by 25° about the vertical, facing outward. The
//! block has no bottom, and the floor is four quadrilaterals that leave the block's footprint out: the scene is one
//! closed polyhedral surface, no part of it covered by another, every edge shared by exactly two polygons, vertex
//! for vertex, bit for bit.
//!
//! # Exact answer
//! The field has no closed form; its energy balance does. Whatever leaves a side of area A is the emitted πeA
//! and the reflected part a H A of what arrives, and in a closed scene all of it arrives somewhere:
//!
//! ```text
//! Σ H A = Σ (π e + a H) A,      hence      Σ (1 − a) H A = Σ π e A = Φ.
//! ```
//!
//! The assembled system has the same balance on any mesh: sum M L = M E + M K L over the bundles and use closure,
//! Σᵢ Tᵢⱼ = μⱼ. It is therefore a test of the laws and says nothing about the discretisation error.

use super::matte::{film, matte, scene};
use super::shape::{Outline, reversed};
use super::{Exact, emitted_power};
use crate::geometry::Vec3;
use crate::scene::{Camera, Scene, SceneError};

const SIZE: Vec3 = Vec3::new(1.0, 0.8, 1.2);
const BLOCK_CENTRE: Vec3 = Vec3::new(0.45, 0.0, 0.55);
const BLOCK_HALF_X: f64 = 0.17;
const BLOCK_HALF_Z: f64 = 0.22;
const BLOCK_HEIGHT: f64 = 0.45;
const BLOCK_TURN_DEGREES: f64 = 25.0;
const DARK: [f64; 3] = [0.0; 3];

/// The closed box with a block. Surfaces `floor` (four quadrilaterals), `ceiling` (emits), `left` (x = 0), `front` (z =
/// 1.2), `right`, `back`, and `block` (five faces).
pub fn corner_box() -> Scene {
    build().expect("the corner box's own numbers are valid")
}

fn build() -> Result<Scene, SceneError> {
    // Walk around the room and the block, counter-clockwise seen from above, starting at low x and low z.
    let around = |centre: Vec3, x: Vec3, z: Vec3| [centre - x - z, centre - x + z, centre + x + z, centre + x - z];
    let (sin, cos) = BLOCK_TURN_DEGREES.to_radians().sin_cos();
    let block_x = BLOCK_HALF_X * Vec3::new(cos, 0.0, -sin);
    let block_z = BLOCK_HALF_Z * Vec3::new(sin, 0.0, cos);
    let footprint = around(BLOCK_CENTRE, block_x, block_z);
    let block_top = footprint.map(|v| v + BLOCK_HEIGHT * Vec3::Y);
    let floor = around(
        Vec3::new(0.5 * SIZE.x, 0.0, 0.5 * SIZE.z),
        Vec3::new(0.5 * SIZE.x, 0.0, 0.0),
        Vec3::new(0.0, 0.0, 0.5 * SIZE.z),
    );
    let ceiling = floor.map(|v| v + SIZE.y * Vec3::Y);

    // Span the sides between the walks: outward for the block, inward for the room, upward for the floor around the
    // block.
    let floor_parts = band(&floor, &footprint);
    let block_sides = band(&footprint, &block_top);
    let [left, front, right, back] = band(&floor, &ceiling).map(reversed);
    let block = block_sides.into_iter().chain([block_top.to_vec()]);

    let surfaces = vec![
        matte("floor", floor_parts, &[0.6, 0.55, 0.5], &DARK)?,
        matte("ceiling", [reversed(ceiling.to_vec())], &[0.8, 0.8, 0.8], &[2.0, 1.5, 1.0])?,
        matte("left", [left], &[0.7, 0.3, 0.25], &DARK)?,
        matte("front", [front], &[0.7, 0.7, 0.7], &DARK)?,
        matte("right", [right], &[0.25, 0.5, 0.7], &DARK)?,
        matte("back", [back], &[0.75, 0.75, 0.7], &DARK)?,
        matte("block", block, &[0.4, 0.6, 0.35], &DARK)?,
    ];
    let eye = Vec3::new(0.9, 0.7, 1.1);
    let camera = Camera::look_at(eye, Vec3::new(0.4, 0.25, 0.45), Vec3::Y, 75_f64.to_radians(), film());
    scene("corner-box", 3, surfaces, camera)
}

/// The quadrilaterals between two closed walks of four corners; with the first below the second, fronts outward.
fn band(low: &[Vec3; 4], high: &[Vec3; 4]) -> [Outline; 4] {
    std::array::from_fn(|k| {
        let next = (k + 1) % 4;
        vec![low[k], low[next], high[next], high[k]]
    })
}

/// The energy balance: what the box absorbs is what its ceiling emits.
pub(super) fn corner_box_exact() -> Exact {
    Exact::AbsorbedPower { power: emitted_power(&corner_box()) }
}
