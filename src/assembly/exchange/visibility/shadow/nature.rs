//! Where the integrand of a term is smooth, and how far from its singularities.

use super::cubature::Nature;
use super::flux::Edge;
use super::kinks::is_kinked;
use crate::geometry::Vec3;

/// What the integrand of a term is like on a cell with these corners.
pub fn nature(corners: &[Vec3; 4], target: &[Vec3], edges: &[Edge], is_cut: bool) -> Nature {
    let centre = corners.iter().copied().sum::<Vec3>() / corners.len() as f64;
    if !is_cut {
        return Nature::Kinked;
    }
    if edges.len() > 1 && is_kinked(*corners, target, edges) {
        return Nature::Kinked;
    }
    let radius = corners.iter().map(|v| v.distance_squared(centre)).fold(0.0, f64::max).sqrt();
    Nature::Smooth { reach: clearance(centre, target, edges) / radius }
}

/// Distance of a point from whatever makes F(x → target ∩ hidden sides) singular: the edges' lines and the sides of the target.
fn clearance(x: Vec3, target: &[Vec3], edges: &[Edge]) -> f64 {
    let mut from = target[target.len() - 1];
    let mut nearest = f64::INFINITY;
    for &to in target {
        nearest = nearest.min(distance_squared(x, from, to));
        from = to;
    }
    for edge in edges {
        nearest = nearest.min(edge.plane_from(x).length_squared() / (edge.to - edge.from).length_squared());
    }
    nearest.sqrt()
}

/// Squared distance of a point from a segment.
pub fn distance_squared(point: Vec3, from: Vec3, to: Vec3) -> f64 {
    let (side, offset) = (to - from, point - from);
    let along = (offset.dot(side) / side.length_squared()).clamp(0.0, 1.0);
    (offset - along * side).length_squared()
}
