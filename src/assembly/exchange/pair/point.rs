//! The share of what a point takes in that comes from a polygon: form factors of an element of no size.
//!
//! The polygon is cut off at the point's horizon and summed by Lambert's formula. Cost O(corners).
//!
//! Nothing is looked for that might stand between: that the polygon is seen is the caller's to know.

use super::clip::{Half, above};
use super::lambert::form_factor;
use crate::basis::Bundles;
use crate::geometry::{Polygon, Vec3};

/// F from a point with this unit normal to the front of a polygon; zero where the point is behind the polygon, or in its plane.
pub fn point_factor(point: Vec3, normal: Vec3, source: &Polygon) -> f64 {
    // The point must be in front of the source, above the rounding of the coordinates.
    let offset = point - source.centroid();
    let rounding = 16.0 * f64::EPSILON * (point.abs().max_element() + source.centroid().abs().max_element());
    if source.normal().dot(offset) <= rounding {
        return 0.0;
    }
    match above(source.vertices(), point, normal) {
        Half::Behind => 0.0,
        Half::InFront => lambert(source.vertices(), point, normal),
        Half::Part(part) => lambert(&part, point, normal),
    }
}

/// F from a point with this unit normal to every bundle of a surface basis: a row of G for an element of no size, so that
/// B(x) = E + albedo Σⱼ Fⱼ Bⱼ is the solved field's value at the point (the Sloan iterate).
pub fn point_factors(bundles: &Bundles, point: Vec3, normal: Vec3) -> Vec<f64> {
    let factor = |bundle| {
        let patch = bundles.patch(bundles.element_of(bundle).0);
        patch.map_or(0.0, |patch| point_factor(point, normal, &patch.polygon))
    };
    (0..bundles.n_bundles()).map(factor).collect()
}

/// Lambert's formula for corners in the scene's coordinates.
fn lambert(corners: &[Vec3], point: Vec3, normal: Vec3) -> f64 {
    let seen: Vec<Vec3> = corners.iter().map(|corner| *corner - point).collect();
    form_factor(&seen, normal).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// The square [−1, 1]² at height z, facing down.
    fn lamp(z: f64) -> Polygon {
        let corner = |x, y| Vec3::new(x, y, z);
        Polygon::new(vec![corner(-1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0)])
            .expect("a square is a polygon")
    }

    #[test]
    fn a_lamp_overhead_and_half_of_one_below_the_horizon() {
        // Four times F of a corner, (1/2π)(x/√(1+x²) atan(x/√(1+x²)) + the same) at x = 1 (Howell, B-4).
        let corner = 2.0 * (0.5f64.sqrt()) * 0.5f64.sqrt().atan() / TAU;
        let seen = point_factor(Vec3::ZERO, Vec3::Z, &lamp(1.0));
        // A few ulp for each of four edges.
        assert!((seen - 4.0 * corner).abs() < 1e-15, "{seen}");
        // By symmetry two normals that lie flat, turned against each other, share the lamp's light from the side.
        let sides = [Vec3::X, -Vec3::X].map(|normal| point_factor(Vec3::ZERO, normal, &lamp(1.0)));
        assert!(sides[0] > 0.0 && (sides[0] - sides[1]).abs() < 1e-15, "{sides:?}");
    }

    #[test]
    fn behind_or_in_the_plane_nothing_is_seen() {
        assert_eq!(point_factor(2.0 * Vec3::Z, -Vec3::Z, &lamp(1.0)), 0.0);
        assert_eq!(point_factor(Vec3::new(3.0, 0.0, 1.0), -Vec3::X, &lamp(1.0)), 0.0);
        assert_eq!(point_factor(Vec3::ZERO, -Vec3::Z, &lamp(1.0)), 0.0);
    }
}
