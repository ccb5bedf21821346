//! Where the integrand of a term is smooth, and how far from its singularities.

use super::flux::Edge;
use crate::geometry::Vec3;

/// A corner nearer to a singularity than this, relative to the extent of its cell, is one.
const AT: f64 = 1e-8;

/// About an apex, functions of direction are smooth at least as far as this, in units of half the side across.
const TURN: f64 = 1.5;

/// How far a term's singularities are from the centre of a cell with these corners, in units of the cell's radius.
///
/// Where the cell is a triangle whose two equal corners, first and last, are at a singularity, it is smooth in distance and direction from
/// there.
pub fn reach(corners: &[Vec3; 4], normal: Vec3, target: &[Vec3], edges: &[Edge]) -> f64 {
    let centre = corners.iter().copied().sum::<Vec3>() / corners.len() as f64;
    let square = corners.iter().map(|v| v.distance_squared(centre)).fold(0.0, f64::max);
    let apex = (corners[0] == corners[3]).then_some(corners[0]);
    let (mut nearest, mut limit) = (f64::INFINITY, f64::INFINITY);
    let mut add = |distance: &dyn Fn(Vec3) -> f64| match apex {
        Some(apex) if distance(apex) <= AT * AT * square => limit = limit.min(TURN),
        _ => nearest = nearest.min(distance(centre)),
    };

    // Keep away from the sides of the target, of one in the plane from its ends alone, and from the lines of edges.
    let side = |k: usize| [target[k], target[(k + 1) % target.len()]];
    let is_in_plane = |v: Vec3| normal.dot(v - centre).powi(2) <= AT * AT * square;
    for [from, to] in (0..target.len()).map(side) {
        if is_in_plane(from) && is_in_plane(to) {
            add(&|x| x.distance_squared(from));
            add(&|x| x.distance_squared(to));
        } else {
            add(&|x| distance_squared(x, from, to));
        }
    }
    for edge in edges {
        add(&|x| edge.plane_from(x).length_squared() / (edge.to - edge.from).length_squared());
    }

    // Keep away from where an edge that passes a side is parallel to it: their crossing moves ever faster.
    for edge in edges {
        for [from, to] in (0..target.len()).map(side) {
            let heights = [from, to].map(|y| edge.height_of(y).dot(centre - edge.from));
            if heights[0] * heights[1] < 0.0 {
                let gradient = edge.height_of(from) - edge.height_of(to);
                let along = (gradient - normal.dot(gradient) * normal).length_squared();
                let reach = ((heights[0] - heights[1]).powi(2) / (along * square)).sqrt();
                limit = limit.min(reach.max(TURN));
            }
        }
    }
    (nearest / square).sqrt().min(limit)
}

/// The corners of a piece at which the integrand of a term is singular: where edges or the target touch its plane.
pub fn singular_corners<'a>(
    piece: &'a [Vec3],
    normal: Vec3,
    target: &'a [Vec3],
    edges: &'a [Edge],
) -> impl Iterator<Item = usize> + 'a {
    let square = piece.iter().map(|v| v.distance_squared(piece[0])).fold(0.0, f64::max);
    let is_in_plane = move |from: Vec3, to: Vec3| normal.dot(to - from).abs() <= AT * (to - from).length();
    let touches = move |x: Vec3| {
        target.iter().any(|corner| corner.distance_squared(x) <= AT * AT * square)
            || edges.iter().any(|edge| {
                let distance = edge.plane_from(x).length_squared() / (edge.to - edge.from).length_squared();
                distance <= AT * AT * square && !is_in_plane(edge.from, edge.to)
            })
    };
    (0..piece.len()).filter(move |k| touches(piece[*k]))
}

/// Squared distance of a point from a segment.
pub fn distance_squared(point: Vec3, from: Vec3, to: Vec3) -> f64 {
    let (side, offset) = (to - from, point - from);
    let along = (offset.dot(side) / side.length_squared()).clamp(0.0, 1.0);
    (offset - along * side).length_squared()
}
