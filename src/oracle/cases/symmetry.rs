//! Isometries that may carry a shape into itself.

use crate::geometry::{Affine3, Mat3, Vec3};
use std::f64::consts::TAU;

/// The turn about the z axis that carries each of n equal sectors into the next.
pub fn turn(n: usize) -> Affine3 {
    Affine3::from_mat3(Mat3::from_rotation_z(TAU / n as f64))
}

/// The symmetries of n equal sectors from the x axis on: the turn, and the reflection that leaves the first sector where it is.
pub fn of_sectors(n: usize) -> Vec<Affine3> {
    let (sine, cosine) = (0.5 * TAU / n as f64).sin_cos();
    vec![turn(n), mirror(Vec3::ZERO, Vec3::new(-sine, cosine, 0.0))]
}

/// The reflection at the plane through a point with this unit normal: x ↦ x − 2 n (n·(x − p)).
pub fn mirror(point: Vec3, normal: Vec3) -> Affine3 {
    let image = |v: Vec3| v - 2.0 * normal.dot(v) * normal;
    let matrix = Mat3::from_cols(image(Vec3::X), image(Vec3::Y), image(Vec3::Z));
    Affine3::from_mat3_translation(matrix, 2.0 * normal.dot(point) * normal)
}

/// The reflections of a box with this centre and two of its edges along these unit vectors; the last is one if the two are equally long.
pub fn of_a_box(centre: Vec3, first: Vec3, second: Vec3) -> Vec<Affine3> {
    [first, second, (first - second).normalize_or(first)].map(|normal| mirror(centre, normal)).to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mirrors_and_turns_undo_themselves() {
        let point = Vec3::new(0.3, -0.7, 1.1);
        let mirror = mirror(Vec3::new(0.1, 0.2, 0.3), Vec3::new(0.6, 0.0, 0.8));
        // Some ulp of coordinates near 1.
        assert!(mirror.transform_point3(mirror.transform_point3(point)).distance(point) < 1e-15);
        let mut turned = point;
        (0..7).for_each(|_| turned = turn(7).transform_point3(turned));
        assert!(turned.distance(point) < 1e-14);
    }
}
