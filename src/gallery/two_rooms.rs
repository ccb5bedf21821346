//! `two-rooms`: two bright closed rooms joined by a small door, a lamp in one of them. Light mixes slowly, and so
//! do solvers.
//!
//! # Geometry
//! The lit room is 0 ≤ x ≤ 3, the dim room 3 ≤ x ≤ 7; both have 0 ≤ y ≤ 2.5, 0 ≤ z ≤ 3. Between them, at x = 3,
//! stands a partition without thickness, reflecting on both sides, its front to the lit room: three rectangles
//! around a door of 0.5 × 1.25 that touches the floor in the middle of the wall. The lamp is the square 1.25 ≤ x, z
//! ≤ 1.75 cut out of the lit room's ceiling. All coordinates are dyadic, so abutting rectangles meet exactly,
//! though not corner to corner: their edges form T-junctions around the lamp and at the foot and the lintel of the
//! door.
//!
//! # Exact answer
//! The energy balance of every closed scene, Σ (1 − a) H A = Σ π e A = Φ; see [the corner box](mod@super::corner_box).
//!
//! # Why it is hard
//! Were each room well mixed, a fraction A_door/A_room of its light would leave it at every bounce, and K would act
//! on the two rooms' radiances as a ((1 − p, p), (q, 1 − q)) with p = 0.625/47.375 and q = 0.625/58.375:
//! eigenvalues a and a (1 − p − q) ≈ 0.976 a. The two leading eigenvalues of K lie within 2.4 % of each other, and
//! with a of 0.8 to 0.9 both lie near 1.

use super::matte::{film, matte, scene};
use super::shape::Outline;
use super::{Exact, emitted_power};
use crate::geometry::Vec3;
use crate::scattering::Lambert;
use crate::scene::{Camera, Scene, SceneError, Surface};
use std::sync::Arc;

const HEIGHT: f64 = 2.5;
const DEPTH: f64 = 3.0;
/// Where the partition stands.
const MIDDLE: f64 = 3.0;
const END: f64 = 7.0;
/// The door spans this range of z, and the lamp this range of x and z.
const OPENING: [f64; 2] = [1.25, 1.75];
const DOOR_HEIGHT: f64 = 1.25;

const WALL: [f64; 3] = [0.875, 0.85, 0.8];
const FLOOR: [f64; 3] = [0.85, 0.825, 0.8];
const CEILING: [f64; 3] = [0.9, 0.9, 0.9];
const DARK: [f64; 3] = [0.0; 3];

/// Two rooms and a door. Surfaces `lit-floor`, `lit-ceiling`, `lit-walls`, `lamp`, `partition` (front to the lit
/// room, back to the dim one), `dim-floor`, `dim-ceiling`, `dim-walls`.
pub fn two_rooms() -> Scene {
    build().expect("the two rooms' own numbers are valid")
}

fn build() -> Result<Scene, SceneError> {
    let [near, far] = OPENING;

    // Cut the lamp out of the lit ceiling: a strip on either side in x, and what is left between them.
    let lit_ceiling = [
        ceiling([0.0, near], [0.0, DEPTH]),
        ceiling([far, MIDDLE], [0.0, DEPTH]),
        ceiling(OPENING, [0.0, near]),
        ceiling(OPENING, [far, DEPTH]),
    ];
    let lamp = ceiling(OPENING, OPENING);

    // Leave the door out of the partition: a jamb on either side, and the wall above.
    let partition = [
        facing_low_x(MIDDLE, [0.0, HEIGHT], [0.0, near]),
        facing_low_x(MIDDLE, [0.0, HEIGHT], [far, DEPTH]),
        facing_low_x(MIDDLE, [DOOR_HEIGHT, HEIGHT], OPENING),
    ];
    let partition =
        Surface { back: Some(Arc::new(Lambert::new(WALL.to_vec()))), ..matte("partition", partition, &WALL, &DARK)? };

    // Close each room with the three walls that the partition leaves.
    let lit_end: Outline = facing_low_x(0.0, [0.0, HEIGHT], [0.0, DEPTH]).into_iter().rev().collect();
    let dim_end = facing_low_x(END, [0.0, HEIGHT], [0.0, DEPTH]);
    let lit_walls = side_walls([0.0, MIDDLE]).into_iter().chain([lit_end]);
    let dim_walls = side_walls([MIDDLE, END]).into_iter().chain([dim_end]);

    let surfaces = vec![
        matte("lit-floor", [floor([0.0, MIDDLE])], &FLOOR, &DARK)?,
        matte("lit-ceiling", lit_ceiling, &CEILING, &DARK)?,
        matte("lit-walls", lit_walls, &WALL, &DARK)?,
        matte("lamp", [lamp], &CEILING, &[50.0, 45.0, 40.0])?,
        partition,
        matte("dim-floor", [floor([MIDDLE, END])], &FLOOR, &DARK)?,
        matte("dim-ceiling", [ceiling([MIDDLE, END], [0.0, DEPTH])], &CEILING, &DARK)?,
        matte("dim-walls", dim_walls, &WALL, &DARK)?,
    ];
    let (eye, door) = (Vec3::new(6.5, 1.6, 1.0), Vec3::new(MIDDLE, 1.1, 1.5));
    let camera = Camera::look_at(eye, door, Vec3::Y, 70_f64.to_radians(), film());
    scene("two-rooms", 3, surfaces, camera)
}

/// A rectangle of the ceiling, facing down.
fn ceiling([x0, x1]: [f64; 2], [z0, z1]: [f64; 2]) -> Outline {
    [(x0, z0), (x1, z0), (x1, z1), (x0, z1)].map(|(x, z)| Vec3::new(x, HEIGHT, z)).to_vec()
}

/// The floor over a range of x, facing up.
fn floor([x0, x1]: [f64; 2]) -> Outline {
    [(x0, 0.0), (x0, DEPTH), (x1, DEPTH), (x1, 0.0)].map(|(x, z)| Vec3::new(x, 0.0, z)).to_vec()
}

/// A rectangle of a plane of constant x, facing low x.
fn facing_low_x(x: f64, [y0, y1]: [f64; 2], [z0, z1]: [f64; 2]) -> Outline {
    [(y0, z0), (y0, z1), (y1, z1), (y1, z0)].map(|(y, z)| Vec3::new(x, y, z)).to_vec()
}

/// The walls at z = 0 and z = DEPTH over a range of x, facing each other.
fn side_walls([x0, x1]: [f64; 2]) -> [Outline; 2] {
    let wall = |z, a, b| [(a, 0.0), (b, 0.0), (b, HEIGHT), (a, HEIGHT)].map(|(x, y)| Vec3::new(x, y, z)).to_vec();
    [wall(0.0, x0, x1), wall(DEPTH, x1, x0)]
}

/// The energy balance: what the rooms absorb is what the lamp emits.
pub(super) fn two_rooms_exact() -> Exact {
    Exact::AbsorbedPower { power: emitted_power(&two_rooms()) }
}
