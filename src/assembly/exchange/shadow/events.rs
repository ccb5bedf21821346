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
    let normal = (part[1] - part[0]).cross(part[2] - part[0]).normalize_or_zero();
    let size = size_of(part);
    let sides =
        || (0..target.len()).map(|k| Edge { from: target[(k + 1) % target.len()], to: target[k], owner: TARGET });

    // Where an obstacle's edge passes a corner of the target.
    for (e, edge) in edges.iter().enumerate() {
        for &corner in target {
            let others = edges.iter().enumerate().filter(|(other, _)| *other != e).map(|(_, edge)| *edge);
            add(part, normal, size, edge, corner, others, lines);
        }
    }
    if edges.len() == 1 {
        return;
    }

    // Where a corner between edges that take part passes a side of the target or another edge.
    points.clear();
    for edge in edges {
        for point in [edge.from, edge.to] {
            if !points.contains(&point) {
                points.push(point);
            }
        }
    }
    for &point in points.iter() {
        let apart = |edge: &Edge| edge.from != point && edge.to != point;
        let constraints = || sides().chain(edges.iter().copied().filter(|edge| apart(edge)));
        for (k, edge) in constraints().enumerate() {
            let others = constraints().enumerate().filter(|(other, _)| *other != k).map(|(_, edge)| edge);
            add(part, normal, size, &edge, point, others, lines);
        }
    }
}

/// True if, seen from somewhere in a cell with these corners, three edges of different outlines may pass each other in one direction: on a
/// curve, where what is hidden bends inside the cell. The planes through x and the edges then share a line.
pub fn is_kinked(corners: [Vec3; 4], target: &[Vec3], edges: &[Edge]) -> bool {
    let owner = edges[0].owner;
    if edges.iter().all(|edge| edge.owner == owner) {
        return false;
    }
    let [a, b, c, d] = corners;
    let centre = 0.25 * (a + b + c + d);
    let paths = [(a, b), (b, c), (c, d), (d, a), (a, centre), (b, centre), (c, centre), (d, centre)];
    let middle = target.iter().copied().sum::<Vec3>() / target.len() as f64;
    let sides = (0..target.len()).map(|k| Edge { from: target[(k + 1) % target.len()], to: target[k], owner: TARGET });
    let all = || edges.iter().copied().chain(sides.clone());
    let n_edges = edges.len();
    let is_event = |i: usize, j: usize, k: usize, third: &Edge| {
        let crossing = |x: Vec3| edges[i].plane_from(x).cross(edges[j].plane_from(x));
        let twist = |x: Vec3| third.plane_from(x).dot(crossing(x));
        let heights = [a, b, c, d, centre].map(twist);
        if heights.iter().all(|h| *h >= 0.0) || heights.iter().all(|h| *h <= 0.0) {
            return false;
        }
        // Where the curve meets the sides and diagonals of the cell, the crossing may be out of view, outside some other edge.
        let is_met = |(from, to): &&(Vec3, Vec3)| twist(*from) * twist(*to) <= 0.0;
        let meeting = |(from, to): &(Vec3, Vec3)| root(*from, *to, &twist);
        let is_outside = |other: &Edge| {
            paths.iter().filter(is_met).map(meeting).all(|x| {
                let crossing = crossing(x);
                let plane = other.plane_from(x);
                let towards = crossing.dot(middle - x).signum();
                towards * plane.dot(crossing) < -CLEARLY * plane.length() * crossing.length()
            })
        };
        !all().enumerate().any(|(l, other)| l != i && l != j && l != k && is_outside(&other))
    };
    (0..n_edges).any(|i| {
        (i + 1..n_edges).filter(|j| edges[*j].owner != edges[i].owner).any(|j| {
            let apart = |third: &Edge| third.owner != edges[i].owner && third.owner != edges[j].owner;
            all().enumerate().any(|(k, third)| k > j && apart(&third) && is_event(i, j, k, &third))
        })
    })
}

/// A zero of a function between two points where it differs in sign: a few steps of the regula falsi.
fn root(mut from: Vec3, mut to: Vec3, function: &impl Fn(Vec3) -> f64) -> Vec3 {
    let (mut low, mut high) = (function(from), function(to));
    let mut middle = from;
    for _ in 0..3 {
        middle = if low == high { from } else { from + low / (low - high) * (to - from) };
        let value = function(middle);
        if value * low > 0.0 {
            (from, low) = (middle, value);
        } else {
            (to, high) = (middle, value);
        }
    }
    middle
}

/// Sine of the angle by which a crossing must lie outside for the few points looked at to speak for the whole cell.
const CLEARLY: f64 = 0.02;

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
    let Some(ends) = line.chord(part, slope, size) else { return };
    if others.any(|other| other.never_hides(&ends, &[point])) {
        return;
    }
    lines.push((line, slope));
}

/// The longest extent of a polygon from its first corner.
pub fn size_of(polygon: &[Vec3]) -> f64 {
    polygon.iter().map(|v| v.distance_squared(polygon[0])).fold(0.0, f64::max).sqrt()
}
