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
    let heights: Vec<f64> = polygon.iter().map(|v| height(plane, *v)).collect();
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

fn height(plane: &Polygon, point: Vec3) -> f64 {
    let offset = point - plane.centroid();
    let height = plane.normal().dot(offset);
    let rounding =
        16.0 * f64::EPSILON * (point.abs().max_element() + plane.centroid().abs().max_element() + offset.length());
    if height.abs() <= rounding { 0.0 } else { height }
}
