//! Where the integrand of a term is smooth, and how far from its singularities.

use super::flux::Edge;
use crate::geometry::Vec3;

/// A corner nearer to a singularity than this, relative to the extent of its cell, is one.
const AT: f64 = 1e-8;

/// Singularities further away than this, as a sum of distances from the ends of a line in units of its length, speed rules up by no more than
/// they start with anyway.
const FAR: f64 = 5.05;

/// What of a cell tells how far singularities are along its axes.
struct Axes {
    /// Corners in turn, then the middles of the sides that begin in them.
    points: [Vec3; 8],
    centre: Vec3,
    radius: f64,
    has_apex: bool,
    /// Smallest sum of distances from the ends of a line along either axis, in units of its length.
    sums: [f64; 2],
}

/// Lines along the first axis, from the first corner to the second, and along the other one: by numbers of points.
const LINES: [[[usize; 2]; 3]; 2] = [[[0, 1], [3, 2], [7, 5]], [[0, 3], [1, 2], [4, 6]]];

impl Axes {
    fn new(&[a, b, c, d]: &[Vec3; 4]) -> Self {
        let middle = |p: Vec3, q: Vec3| 0.5 * (p + q);
        let points = [a, b, c, d, middle(a, b), middle(b, c), middle(c, d), middle(d, a)];
        let centre = 0.25 * (a + b + c + d);
        let radius = points[..4].iter().map(|v| v.distance_squared(centre)).fold(0.0, f64::max).sqrt();
        Self { points, centre, radius, has_apex: a == d, sums: [FAR; 2] }
    }

    /// Takes note of singularities where a linear function with values in space, or complex ones, has a square of zero. It grows no faster than
    /// `slope`.
    ///
    /// On a line, in units of half its length, that is at the complex z with (|z + 1| + |z − 1|) / 2 = (|g(−1)| + |g(1)|) / |g(1) − g(−1)|.
    fn avoid(&mut self, slope: f64, function: impl Fn(Vec3) -> Vec3) {
        let nearest = (1.0 + self.sums[0].max(self.sums[1])) * slope * self.radius;
        if function(self.centre).length_squared() > nearest * nearest {
            return;
        }
        let values = self.points.map(function);
        let lengths = values.map(Vec3::length);
        // About an apex, functions of direction are smooth in distance.
        let is_of_direction = self.has_apex && lengths[0] <= AT * (lengths[1] + lengths[2]);
        let axes = self.sums.iter_mut().zip(LINES).skip(usize::from(is_of_direction));
        for (least, lines) in axes {
            for [from, to] in lines {
                let sum = (lengths[from] + lengths[to]) / (values[to] - values[from]).length();
                *least = least.min(sum);
            }
        }
    }
}

/// By how much the error of Gauss rules for a term falls with every point along either axis of a cell with these corners: by ρ⁻², ρ the sum
/// of the axes of the ellipse about a line's ends that reaches the nearest singularity.
///
/// Where the cell is a triangle whose two equal corners, first and last, are at a singularity, it is smooth in distance and direction from
/// there.
pub fn decays(corners: &[Vec3; 4], normal: Vec3, target: &[Vec3], edges: &[Edge]) -> [f64; 2] {
    let mut axes = Axes::new(corners);
    let centre = axes.centre;
    let flat = AT * axes.radius;
    let is_in_plane = |v: Vec3| normal.dot(v - centre).abs() <= flat;

    // Keep away from the corners of the target, from those of its sides that are not in the plane, and from the lines of edges.
    let side = |k: usize| [target[k], target[(k + 1) % target.len()]];
    for [from, to] in (0..target.len()).map(side) {
        let is_in_plane = is_in_plane(from) && is_in_plane(to);
        axes.avoid(1.0, |x| from - x);
        let along = to - from;
        let shares = corners.map(|x| (x - from).dot(along) / along.length_squared());
        let passes_by = shares.iter().any(|s| *s > 0.0) && shares.iter().any(|s| *s < 1.0);
        if passes_by && !is_in_plane {
            let along = along.normalize();
            axes.avoid(1.0, |x| along.cross(from - x));
        }
    }
    for edge in edges {
        let along = (edge.to - edge.from).normalize();
        axes.avoid(1.0, |x| along.cross(edge.from - x));
    }

    // Keep away from where the way to the crossing of an edge and a side, or another edge, has a square of zero: as the heights h of its ends
    // over the edge's plane, in the directions v and w, h(v) w − h(w) v.
    for (e, edge) in edges.iter().enumerate() {
        let others =
            edges[e + 1..].iter().filter(|other| other.owner != edge.owner).map(|other| [other.from, other.to]);
        for [from, to] in (0..target.len()).map(side).chain(others) {
            let slopes = [from, to].map(|y| edge.height_of(y));
            let heights = slopes.map(|slope| slope.dot(centre - edge.from));
            if heights[0] * heights[1] < 0.0 {
                let (v, w) = (from - centre, to - centre);
                let (along, across) = (v.dot(w), v.cross(w).length());
                let (one, two) = (w.length_squared() * slopes[0] - along * slopes[1], across * slopes[1]);
                let slope = one.length() + two.length();
                axes.avoid(slope, |x| Vec3::new(one.dot(x - edge.from), two.dot(x - edge.from), 0.0));
            }
        }
    }
    axes.sums.map(|sum| (sum - (sum * sum - 1.0).max(0.0).sqrt()).powi(2))
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
