//! Exchange that occluders take away from a pair of patches, by exact geometry inside and adaptive quadrature outside.
//!
//! ```text
//! T_blocked = π ∫_A (F(x → B) − F(x → visible part of B)) dA
//! ```
//!
//! From a point the visible part of B is what is left of it once the pyramid over every occluder is cut away: convex pieces, each
//! with Lambert's exact form factor. As x moves the integrand bends where a corner of an occluder crosses an edge of B or the
//! other way round: on straight lines in the plane of A. A is cut along them first, so that quadrature sees smooth pieces, and
//! where it does not (three edges meeting) it is refined until its own estimate is small enough.
//!
//! The unoccluded exchange is not integrated here, so its singularities at touching edges do not matter.

use super::clip::{Half, in_front_of};
use super::lambert::form_factor;
use super::rules::{Rule, gauss_legendre};
use crate::geometry::{Polygon, Vec3};
use std::f64::consts::PI;
use std::sync::LazyLock;

/// Rules tried on a cell: the last two must agree.
static RULES: LazyLock<[Rule; 3]> = LazyLock::new(|| [gauss_legendre(3), gauss_legendre(5), gauss_legendre(8)]);

/// Cells are quartered at most this often; what is left then is below 1e-7 of the patch.
const DEEPEST: usize = 12;

/// Cells that a patch is cut into before quadrature, at most; adaptivity does the rest.
const CELLS: usize = 24;

/// T_blocked of two patches by convex occluders, and its error estimate, m² sr, to an absolute `tolerance`.
///
/// Cost: some hundred to some ten thousand points, each a few µs.
pub fn blocked(a: &Polygon, b: &Polygon, occluders: &[&[Vec3]], tolerance: f64) -> (f64, f64) {
    // Only what is in front of both can take part.
    let part = |polygon: &[Vec3], plane: &Polygon| match in_front_of(polygon, plane) {
        Half::Behind => None,
        Half::InFront => Some(polygon.to_vec()),
        Half::Part(part) => Some(part),
    };
    let (Some(on_a), Some(on_b)) = (part(a.vertices(), b), part(b.vertices(), a)) else { return (0.0, 0.0) };
    let between: Vec<Vec<Vec3>> = occluders.iter().filter_map(|occluder| part(&part(occluder, a)?, b)).collect();

    // Stand on the patch that fewer bends cross.
    let crossing = |plane: &Polygon, outer: &[Vec3], target: &[Vec3]| -> Vec<Line> {
        let mut lines = bends(plane, target, &between);
        lines.retain(|line| crosses(outer, *line));
        lines
    };
    let (from_a, from_b) = (crossing(a, &on_a, &on_b), crossing(b, &on_b, &on_a));
    let (normal, outer, target, lines) =
        if from_a.len() <= from_b.len() { (a.normal(), on_a, on_b, from_a) } else { (b.normal(), on_b, on_a, from_b) };

    let mut cells = vec![outer];
    for line in lines {
        if cells.len() < CELLS {
            cells = cells.into_iter().flat_map(|cell| split(cell, line)).collect();
        }
    }
    let mut view =
        View { normal, target: &target, occluders: &between, pieces: Pieces::default(), spare: Pieces::default() };
    let area: f64 = cells.iter().map(|cell| area_of(cell)).sum();
    let (mut sum, mut error) = (0.0, 0.0);
    for cell in &cells {
        for pair in cell[1..].windows(2) {
            let triangle = [cell[0], pair[0], pair[1]];
            let share = tolerance / PI * area_of(&triangle) / area;
            let (value, estimate) = view.integrate(triangle, share, 0);
            sum += value;
            error += estimate;
        }
    }
    (PI * sum, PI * error)
}

/// True if the polygon has corners on both sides of the line.
fn crosses(polygon: &[Vec3], (normal, offset): Line) -> bool {
    let heights = || polygon.iter().map(|v| normal.dot(*v) - offset);
    heights().any(|h| h > 0.0) && heights().any(|h| h < 0.0)
}

/// Convex polygons in one allocation.
#[derive(Default)]
struct Pieces {
    corners: Vec<Vec3>,
    ends: Vec<usize>,
}

impl Pieces {
    fn clear(&mut self) {
        self.corners.clear();
        self.ends.clear();
    }

    /// Closes the piece whose corners have been pushed since the last; drops it if it is none.
    fn close(&mut self) {
        let start = self.ends.last().copied().unwrap_or(0);
        if self.corners.len() - start >= 3 {
            self.ends.push(self.corners.len());
        } else {
            self.corners.truncate(start);
        }
    }

    fn iter(&self) -> impl Iterator<Item = &[Vec3]> {
        let start = |k: usize| if k == 0 { 0 } else { self.ends[k - 1] };
        self.ends.iter().enumerate().map(move |(k, end)| &self.corners[start(k)..*end])
    }
}

/// What one point of A sees of B.
struct View<'a> {
    normal: Vec3,
    target: &'a [Vec3],
    occluders: &'a [Vec<Vec3>],
    pieces: Pieces,
    spare: Pieces,
}

impl View<'_> {
    /// F(x → B) − F(x → visible part of B).
    fn blocked_from(&mut self, x: Vec3) -> f64 {
        self.pieces.clear();
        self.pieces.corners.extend(self.target.iter().map(|v| *v - x));
        self.pieces.close();
        let whole = form_factor(&self.pieces.corners, self.normal);
        for occluder in self.occluders {
            self.spare.clear();
            for piece in self.pieces.iter() {
                cut_away(piece, occluder, x, &mut self.spare);
            }
            std::mem::swap(&mut self.pieces, &mut self.spare);
        }
        whole - self.pieces.iter().map(|piece| form_factor(piece, self.normal)).sum::<f64>()
    }

    /// ∫ over a triangle of A, and an estimate of its error.
    fn integrate(&mut self, triangle: [Vec3; 3], tolerance: f64, depth: usize) -> (f64, f64) {
        let mut coarse = self.gauss(&triangle, &RULES[0]);
        for rule in &RULES[1..] {
            let fine = self.gauss(&triangle, rule);
            let change = (fine - coarse).abs();
            if change <= tolerance || (depth == DEEPEST && rule.nodes.len() == RULES[2].nodes.len()) {
                return (fine, change);
            }
            coarse = fine;
        }
        // Quarter it.
        let [a, b, c] = triangle;
        let (ab, bc, ca) = (0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a));
        let (mut sum, mut error) = (0.0, 0.0);
        for part in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
            let (value, estimate) = self.integrate(part, 0.25 * tolerance, depth + 1);
            sum += value;
            error += estimate;
        }
        (sum, error)
    }

    /// The square collapsed onto the triangle's first corner.
    fn gauss(&mut self, [a, b, c]: &[Vec3; 3], rule: &Rule) -> f64 {
        let twice_area = (*b - *a).cross(*c - *a).length();
        if twice_area == 0.0 {
            return 0.0;
        }
        let mut sum = 0.0;
        for (s, ws) in rule.nodes.iter().zip(&rule.weights) {
            for (t, wt) in rule.nodes.iter().zip(&rule.weights) {
                let x = *a + *s * ((*b - *a) + *t * (*c - *b));
                sum += ws * wt * s * self.blocked_from(x);
            }
        }
        twice_area * sum
    }
}

/// Pushes what is left of `piece` (corners relative to x) outside the pyramid with apex x over the occluder.
fn cut_away(piece: &[Vec3], occluder: &[Vec3], x: Vec3, out: &mut Pieces) {
    // The pyramid is inside all planes through x and an edge; turn them to its inside.
    let corner = |k: usize| occluder[k % occluder.len()] - x;
    let volume: f64 = (1..occluder.len() - 1).map(|k| corner(0).dot(corner(k).cross(corner(k + 1)))).sum();
    if volume == 0.0 {
        out.corners.extend_from_slice(piece);
        out.close();
        return;
    }
    let plane = |k: usize| corner(k).cross(corner(k + 1)) * volume.signum();

    // A piece wholly outside one plane is whole.
    if (0..occluder.len()).any(|k| {
        let normal = plane(k);
        piece.iter().all(|v| normal.dot(*v) <= 0.0)
    }) {
        out.corners.extend_from_slice(piece);
        out.close();
        return;
    }

    // Cut off what is outside each plane in turn; what is inside all of them is hidden.
    let mut rest: [Vec3; CORNERS] = [Vec3::ZERO; CORNERS];
    let mut n_rest = piece.len().min(CORNERS);
    rest[..n_rest].copy_from_slice(&piece[..n_rest]);
    for k in 0..occluder.len() {
        let normal = plane(k);
        let mut inside: [Vec3; CORNERS] = [Vec3::ZERO; CORNERS];
        let mut n_inside = 0;
        let mut keep = |v: Vec3| {
            if n_inside < CORNERS {
                inside[n_inside] = v;
                n_inside += 1;
            }
        };
        for i in 0..n_rest {
            let (from, to) = (rest[i], rest[(i + 1) % n_rest]);
            let (h, next) = (normal.dot(from), normal.dot(to));
            if h >= 0.0 {
                keep(from);
            }
            if h <= 0.0 {
                out.corners.push(from);
            }
            if (h > 0.0 && next < 0.0) || (h < 0.0 && next > 0.0) {
                let crossing = from + (h / (h - next)) * (to - from);
                keep(crossing);
                out.corners.push(crossing);
            }
        }
        out.close();
        if n_inside < 3 {
            return;
        }
        (rest, n_rest) = (inside, n_inside);
    }
}

/// Corners that a piece can have: a cut adds one at most, and each occluder makes at most its number of cuts in a row.
const CORNERS: usize = 32;

/// A line in a plane, as the plane through it: signed distances are normal·p − offset.
type Line = (Vec3, f64);

/// The lines in the plane of A on which the integrand bends.
fn bends(a: &Polygon, target: &[Vec3], occluders: &[Vec<Vec3>]) -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    let edges = |p: &[Vec3]| (0..p.len()).map(|k| (p[k], p[(k + 1) % p.len()])).collect::<Vec<_>>();
    let mut add = |(from, to): (Vec3, Vec3), apex: Vec3| {
        let normal = (to - from).cross(apex - from);
        let length = normal.length();
        if length <= 1e-12 * (to - from).length() * (apex - from).length() || length == 0.0 {
            return;
        }
        // A plane parallel to A's makes no line in it.
        let normal = normal / length;
        if normal.cross(a.normal()).length() < 1e-12 {
            return;
        }
        let line = (normal, normal.dot(from));
        let same = |other: &Line| {
            let turned = other.0.dot(line.0).signum();
            (other.0 * turned - line.0).abs().max_element() < 1e-12
                && (other.1 * turned - line.1).abs() < 1e-12 * (1.0 + line.1.abs())
        };
        if !lines.iter().any(same) {
            lines.push(line);
        }
    };
    for occluder in occluders {
        for edge in edges(occluder) {
            target.iter().for_each(|corner| add(edge, *corner));
        }
        for edge in edges(target) {
            occluder.iter().for_each(|corner| add(edge, *corner));
        }
    }
    lines
}

/// The one or two parts of a convex cell on both sides of a line.
fn split(cell: Vec<Vec3>, (normal, offset): Line) -> Vec<Vec<Vec3>> {
    let size = cell.iter().map(|v| v.distance(cell[0])).fold(0.0, f64::max);
    let heights: Vec<f64> = cell
        .iter()
        .map(|v| {
            let height = normal.dot(*v) - offset;
            // Corners within 1e-10 of the cell's size lie on the line: thinner slivers carry nothing.
            if height.abs() <= 1e-10 * size { 0.0 } else { height }
        })
        .collect();
    let (above, below) = (heights.iter().any(|h| *h > 0.0), heights.iter().any(|h| *h < 0.0));
    if !(above && below) {
        return vec![cell];
    }
    let (mut upper, mut lower) = (Vec::new(), Vec::new());
    for i in 0..cell.len() {
        let next = (i + 1) % cell.len();
        if heights[i] >= 0.0 {
            upper.push(cell[i]);
        }
        if heights[i] <= 0.0 {
            lower.push(cell[i]);
        }
        if heights[i] * heights[next] < 0.0 {
            let crossing = cell[i] + heights[i] / (heights[i] - heights[next]) * (cell[next] - cell[i]);
            upper.push(crossing);
            lower.push(crossing);
        }
    }
    vec![upper, lower]
}

fn area_of(polygon: &[Vec3]) -> f64 {
    let fan = polygon[1..].windows(2).map(|pair| (pair[0] - polygon[0]).cross(pair[1] - polygon[0]));
    0.5 * fan.sum::<Vec3>().length()
}
