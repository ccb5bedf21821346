//! The part of a polygon in front of a plane.

use crate::geometry::{Polygon, Vec3};

/// How a polygon lies to a plane.
#[derive(Clone, Debug, PartialEq)]
pub enum Half {
    /// No point in front (on the plane counts as behind).
    Behind,
    /// No point behind (on the plane counts as in front).
    InFront,
    /// This part is in front.
    Part(Vec<Vec3>),
}

/// Cuts `polygon` by the plane of `plane` (Sutherland and Hodgman 1974). Corners within the rounding of their coordinates lie on
/// the plane.
pub fn in_front_of(polygon: &[Vec3], plane: &Polygon) -> Half {
    above(polygon, plane.centroid(), plane.normal())
}

/// The same for the plane through a point with this unit normal.
pub fn above(polygon: &[Vec3], origin: Vec3, normal: Vec3) -> Half {
    let heights: Vec<f64> = polygon.iter().map(|v| height(origin, normal, *v)).collect();
    if heights.iter().all(|h| *h <= 0.0) {
        return Half::Behind;
    }
    if heights.iter().all(|h| *h >= 0.0) {
        return Half::InFront;
    }
    let mut part = Vec::with_capacity(polygon.len() + 1);
    for k in 0..polygon.len() {
        let next = (k + 1) % polygon.len();
        if heights[k] >= 0.0 {
            part.push(polygon[k]);
        }
        if heights[k] * heights[next] < 0.0 {
            let s = heights[k] / (heights[k] - heights[next]);
            part.push(polygon[k] + s * (polygon[next] - polygon[k]));
        }
    }
    Half::Part(part)
}

fn height(origin: Vec3, normal: Vec3, point: Vec3) -> f64 {
    let offset = point - origin;
    let height = normal.dot(offset);
    let rounding = 16.0 * f64::EPSILON * (point.abs().max_element() + origin.abs().max_element() + offset.length());
    if height.abs() <= rounding { 0.0 } else { height }
}
