//! Do polygons of one plane, together, cut every line between two others?
//!
//! With a on one side of the plane and b on the other, the hull of a and b meets the plane in the hull Q of the points where the
//! lines between their corners do. Every line from a to b is cut if the polygons cover Q: if nothing of Q is left once each of them
//! is taken away from it.
//!
//! Whatever lies within a margin of rounding counts as covered. The margin is the rounding of the coordinates, divided by the sine at
//! which a line meets the plane: what it can leave open, seen along the lines, is a slit as wide as the rounding itself.

use super::{Frame, Vec2, Vec3, height, hull::chain};

/// A margin above this share of Q's size settles nothing.
const WIDEST_MARGIN: f64 = 1e-8;

/// Parts of Q that are followed before the question is left open.
const MOST_PARTS: usize = 32;

/// True if the convex polygons `facets` of one plane with this unit normal cut every line between the hulls of the corners `a` and
/// `b`, to within rounding. Cost O(|a| |b| + facets) where one of them does it alone.
pub(super) fn covers(normal: Vec3, facets: &[&[Vec3]], a: &[Vec3], b: &[Vec3]) -> bool {
    let point = facets[0][0];
    let sides = |corners: &[Vec3]| {
        corners.iter().map(|v| height(normal, point, *v)).fold((0.0, 0.0), |(low, high), h| (h.min(low), h.max(high)))
    };
    let ((low_a, high_a), (low_b, high_b)) = (sides(a), sides(b));
    let apart = (low_a >= 0.0 && high_a > 0.0 && high_b <= 0.0 && low_b < 0.0)
        || (high_a <= 0.0 && low_a < 0.0 && low_b >= 0.0 && high_b > 0.0);
    if !apart {
        return false;
    }

    // Find where the lines between corners cross the plane, and how well that is known.
    let frame = Frame::about(normal);
    let flat = |v: Vec3| Vec2::new(frame.x.dot(v - point), frame.y.dot(v - point));
    let mut crossings: Vec<Vec2> = Vec::with_capacity(a.len() * b.len() + 1);
    let size = a.iter().chain(b).map(|v| v.distance(point)).fold(0.0, f64::max);
    let largest = a.iter().chain(b).map(|v| v.abs().max_element()).fold(point.abs().max_element(), f64::max);
    let rounding = 16.0 * f64::EPSILON * (largest + size);
    let mut margin = rounding;
    for v in a {
        let from = height(normal, point, *v);
        for w in b {
            let to = height(normal, point, *w);
            if from == 0.0 && to == 0.0 {
                crossings.extend([flat(*v), flat(*w)]);
            } else {
                crossings.push(flat(*v + from / (from - to) * (*w - *v)));
                margin = margin.max(rounding * v.distance(*w) / (from - to).abs());
            }
        }
    }
    let extent = crossings.iter().map(|x| x.distance(crossings[0])).fold(0.0, f64::max);
    if margin > WIDEST_MARGIN * extent {
        return false;
    }

    // Ask each facet alone; then, if every corner of Q is in some facet, take all away together.
    let facets: Vec<Vec<Vec2>> =
        facets.iter().map(|facet| counter_clockwise(facet.iter().map(|v| flat(*v)).collect())).collect();
    let holds = |facet: &Vec<Vec2>, x: Vec2| edges(facet).all(|edge| edge.inward(x) >= -margin);
    if facets.iter().any(|facet| crossings.iter().all(|x| holds(facet, *x))) {
        return true;
    }
    facets.len() > 1
        && crossings.iter().all(|x| facets.iter().any(|facet| holds(facet, *x)))
        && nothing_left(chain(crossings.into_iter().map(|x| (x, x))), &facets, margin)
}

/// True if the facets cover the convex region, but for strips thinner than the margin.
fn nothing_left(region: Vec<Vec2>, facets: &[Vec<Vec2>], margin: f64) -> bool {
    let mut parts = vec![region];
    for facet in facets {
        let mut left = Vec::new();
        for part in parts {
            // A part beyond one edge is whole.
            if edges(facet).any(|edge| part.iter().all(|x| edge.inward(*x) <= margin)) {
                left.push(part);
                continue;
            }
            // Cut off what is beyond each edge in turn; what is inside of all is covered.
            let mut rest = part;
            for edge in edges(facet) {
                if rest.iter().any(|x| edge.inward(*x) < -margin) {
                    let (inside, outside) = edge.split(&rest);
                    left.push(outside);
                    rest = inside;
                }
            }
        }
        parts = left;
        if parts.is_empty() || parts.len() > MOST_PARTS {
            break;
        }
    }
    parts.is_empty()
}

/// A directed line with its unit normal to the left.
struct Edge {
    start: Vec2,
    left: Vec2,
}

impl Edge {
    /// Distance to the left.
    fn inward(&self, x: Vec2) -> f64 {
        self.left.dot(x - self.start)
    }

    /// The parts of a convex polygon to the left and to the right.
    fn split(&self, polygon: &[Vec2]) -> (Vec<Vec2>, Vec<Vec2>) {
        let (mut inside, mut outside) = (Vec::new(), Vec::new());
        for (k, from) in polygon.iter().enumerate() {
            let to = polygon[(k + 1) % polygon.len()];
            let (here, there) = (self.inward(*from), self.inward(to));
            if here >= 0.0 {
                inside.push(*from);
            }
            if here <= 0.0 {
                outside.push(*from);
            }
            if here * there < 0.0 {
                let crossing = *from + here / (here - there) * (to - *from);
                inside.push(crossing);
                outside.push(crossing);
            }
        }
        (inside, outside)
    }
}

fn edges(polygon: &[Vec2]) -> impl Iterator<Item = Edge> {
    polygon.iter().enumerate().map(|(k, start)| {
        let left = (polygon[(k + 1) % polygon.len()] - *start).perp();
        Edge { start: *start, left: left.normalize_or_zero() }
    })
}

/// Coplanar polygons may face either way.
fn counter_clockwise(mut polygon: Vec<Vec2>) -> Vec<Vec2> {
    let twice_area: f64 = polygon[1..].windows(2).map(|p| (p[0] - polygon[0]).perp_dot(p[1] - polygon[0])).sum();
    if twice_area < 0.0 {
        polygon.reverse();
    }
    polygon
}
