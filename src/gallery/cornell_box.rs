//! `cornell-box`: the Cornell box that the renderer Mitsuba 3 carries inside, so that the two can be run side by side.
//!
//! # Geometry
//! The cube [−1, 1]³, open at z = +1; white floor (y = −1), ceiling (y = 1), back (z = −1) and boxes; green wall at
//! x = +1, red wall at x = −1. A lamp of 0.46 m × 0.38 m hangs 0.01 m under the ceiling and faces down. Two boxes,
//! turned about the vertical, stand on the floor. Everything is one-sided: walls face inward, boxes outward; backs
//! are black.
//!
//! Two things to mind. The small box's bottom lies in the plane of the floor (y = −1), and the large box's reaches
//! 0.01 m below it (centre −0.4, half-height 0.61): its sides cross the floor. Nothing under or inside the boxes
//! receives light, so the floor they cover is black, and a patch that the outline of a box cuts is partly so.
//!
//! # Exact answer
//! None in closed form. Known exactly: emitted power π e A, and every area.

use super::matte::{film, matte, scene};
use super::shape::{parallelepiped, parallelogram};
use crate::geometry::Vec3;
use crate::scene::{Camera, Scene, SceneError};

const WHITE: [f64; 3] = [0.885809, 0.698859, 0.666422];
const GREEN: [f64; 3] = [0.105421, 0.37798, 0.076425];
const RED: [f64; 3] = [0.570068, 0.0430135, 0.0443706];
const LAMP_RADIANCE: [f64; 3] = [18.387, 13.9873, 6.75357];
const DARK: [f64; 3] = [0.0; 3];
const FIELD_OF_VIEW_DEGREES: f64 = 39.3077;

/// The Cornell box. Surfaces `floor`, `ceiling`, `back`, `green-wall`, `red-wall`, `light`, `small-box`,
/// `large-box`; each box has six faces.
pub fn cornell_box() -> Scene {
    build().expect("the Cornell box's own numbers are valid")
}

fn build() -> Result<Scene, SceneError> {
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    let light = parallelogram(Vec3::new(0.0, 0.99, 0.01), 0.23 * x, 0.19 * z);
    let small_box = parallelepiped(
        Vec3::new(0.335, -0.7, 0.38),
        Vec3::new(0.286891, 0.0, 0.0877115),
        Vec3::new(0.0, 0.3, 0.0),
        Vec3::new(-0.0877115, 0.0, 0.286891),
    );
    let large_box = parallelepiped(
        Vec3::new(-0.33, -0.4, -0.28),
        Vec3::new(0.28491, 0.0, -0.0939491),
        Vec3::new(0.0, 0.61, 0.0),
        Vec3::new(0.0939491, 0.0, 0.28491),
    );
    let surfaces = vec![
        matte("floor", [parallelogram(-y, z, x)], &WHITE, &DARK)?,
        matte("ceiling", [parallelogram(y, x, z)], &WHITE, &DARK)?,
        matte("back", [parallelogram(-z, x, y)], &WHITE, &DARK)?,
        matte("green-wall", [parallelogram(x, z, y)], &GREEN, &DARK)?,
        matte("red-wall", [parallelogram(-x, y, z)], &RED, &DARK)?,
        matte("light", [light], &WHITE, &LAMP_RADIANCE)?,
        matte("small-box", small_box, &WHITE, &DARK)?,
        matte("large-box", large_box, &WHITE, &DARK)?,
    ];
    let camera = Camera::look_at(3.9 * z, Vec3::ZERO, y, FIELD_OF_VIEW_DEGREES.to_radians(), film());
    scene("cornell-box", 3, surfaces, camera)
}
