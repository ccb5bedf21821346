//! The straight lines in a part of A on which what is hidden of a target bends.

use super::cells::Line;
use super::flux::Edge;
use crate::geometry::Vec3;

/// Lines, each with the rate at which its function grows across it, where an edge passes a corner in view of the part.
pub fn find(part: &[Vec3], target: &[Vec3], edges: &[Edge], points: &mut Vec<Vec3>, lines: &mut Vec<(Line, f64)>) {
    lines.clear();
    if edges.is_empty() {
        return;
    }
    let (normal, size) = (normal_of(part), size_of(part));

    // Where an obstacle's edge passes a corner of the target.
    for (e, edge) in edges.iter().enumerate() {
        for &corner in target {
            let others = edges.iter().enumerate().filter(|(other, _)| *other != e).map(|(_, edge)| *edge);
            add(part, normal, size, edge, corner, others, lines);
        }
    }
    // Where an edge passes all of a side at once, or of another edge, because both lie in one plane.
    points.clear();
    for (e, edge) in edges.iter().enumerate() {
        for other in edges[e + 1..].iter().copied().filter(|other| other.owner != edge.owner).chain(sides_of(target)) {
            if edge.is_coplanar(&other) {
                add(part, normal, size, edge, edge.far_end(&other), std::iter::empty(), lines);
                points.extend(edge.crossing(&other));
            }
        }
    }
    if edges.len() == 1 {
        return;
    }

    // Where a corner between edges that take part, or a point in which two of them meet, passes a side of the target or another edge.
    for edge in edges {
        for point in [edge.from, edge.to] {
            if !points.contains(&point) {
                points.push(point);
            }
        }
    }
    for &point in points.iter() {
        let apart = |edge: &Edge| edge.from != point && edge.to != point && !edge.touches(point);
        let constraints = || sides_of(target).chain(edges.iter().copied()).filter(apart);
        for (k, edge) in constraints().enumerate() {
            let others = constraints().enumerate().filter(|(other, _)| *other != k).map(|(_, edge)| edge);
            add(part, normal, size, &edge, point, others, lines);
        }
    }
}

/// The sides of the target as edges that have it on their hidden side.
pub fn sides_of(target: &[Vec3]) -> impl Iterator<Item = Edge> + Clone + '_ {
    (0..target.len()).map(|k| Edge { from: target[(k + 1) % target.len()], to: target[k], owner: TARGET })
}

/// Owner of the sides of the target.
const TARGET: usize = usize::MAX;

/// Adds the line on which an edge passes a point, unless the point is out of sight there: outside one of the other edges all along.
fn add(
    part: &[Vec3],
    normal: Vec3,
    size: f64,
    edge: &Edge,
    point: Vec3,
    mut others: impl Iterator<Item = Edge>,
    lines: &mut Vec<(Line, f64)>,
) {
    let gradient = edge.height_of(point);
    let line = Line { normal: gradient, point: edge.from };
    let slope = (gradient - normal.dot(gradient) * normal).length();
    let Some(eyes) = line.chord(part, slope, size) else { return };
    if others.any(|other| other.is_short_of(&eyes, &[point])) {
        return;
    }
    lines.push((line, slope));
}

/// The longest extent of a polygon from its first corner.
pub fn size_of(polygon: &[Vec3]) -> f64 {
    polygon.iter().map(|v| v.distance_squared(polygon[0])).fold(0.0, f64::max).sqrt()
}

/// The unit normal of a polygon whose first corner is none between neighbours in line.
pub fn normal_of(polygon: &[Vec3]) -> Vec3 {
    (polygon[1] - polygon[0]).cross(polygon[2] - polygon[0]).normalize_or_zero()
}
