//! Exchange of two unoccluded polygons: Gauss rules over both, or over one and the other in closed form, where they are apart;
//! contours where they are not, and contours in double-double arithmetic where too much cancels in those.

mod angle;
mod apart;
mod clip;
mod close;
mod contour;
mod disk;
mod double;
mod factor;
mod grid;
mod ladder;
mod lambert;
mod point;
mod product;
mod real;
mod rules;
mod shape;
mod single;

pub use clip::{Half, above, in_front_of};
pub use disk::point_to_disk;
pub use ladder::{Ladder, Nodes};
pub use point::{point_factor, point_factors};
pub use rules::{Rule, gauss_legendre};
pub use single::exchange_of_pair;

use crate::geometry::{Polygon, Vec3, height};
use apart::Apart;
use clip::cut;
use close::Close;
use double::Double;
use real::Vector;
use shape::Shape;

/// Nanoseconds that rules may take before contours are tried: as dear as those are.
const CHEAP: usize = 4_000;
/// The same before contours in double-double.
const DEAR: usize = 60_000;

/// T of two polygons with nothing between them, each with its nodes, and an estimate of its error, both in m² sr; `None` where
/// they do not face each other.
///
/// ```text
/// T = ∫∫ cosθ cosθ' / r² dA dA'
/// ```
///
/// What of either lies behind the other's plane is cut off. The tolerance is relative to T and reached down to 1e-13 wherever T
/// exceeds 1e-12 of both étendues; the estimate says so where it is not. Swapping the two changes no bit. Cost: 0.1 to 3 µs for
/// polygons that are apart, 2 to 20 µs for others, 50 to 500 µs for those in whose contour integrals more cancels than the
/// tolerance allows.
pub fn unoccluded(ladder: &Ladder, a: (&Polygon, &Nodes), b: (&Polygon, &Nodes), tolerance: f64) -> Option<(f64, f64)> {
    // Put them in an order of their own.
    let [a, b] = if precedes(b.0, a.0) { [b, a] } else { [a, b] };
    let (origin_a, origin_b) = (a.0.vertices()[0], b.0.vertices()[0]);

    // See which side of each other's plane they are on.
    let side_a = Side::of(a.0, b.1.shape.normal, b.0);
    let side_b = Side::of(b.0, a.1.shape.normal, a.0);
    if side_a.highest <= 0.0 || side_b.highest <= 0.0 {
        return None;
    }
    if side_a.is_whole && side_b.is_whole {
        let pair = Apart::new(ladder, [a.1, b.1], Vector::difference(origin_a, origin_b))?;
        let corners = || [a.0, b.0].map(|p| Vector::from_point(origin_a, p.vertices()));
        return exchange(&pair, corners, tolerance);
    }

    // Keep of each what is in front of the other, as little as it may be right to the last digit.
    let corners_a = Vector::from_point(origin_a, a.0.vertices());
    let corners_b = Vector::from_point(origin_a, b.0.vertices());
    let part_a = side_a.part(&corners_a, &corners_b)?;
    let part_b = side_b.part(&corners_b, &corners_a)?;
    let nodes = [ladder.bare(&part_a), ladder.bare(&part_b)];
    let pair = Apart::new(ladder, [&nodes[0], &nodes[1]], part_b[0] - part_a[0])?;
    exchange(&pair, || [part_a, part_b], tolerance)
}

/// T of a pair whose parts see each other wholly, by the cheapest way that reaches the tolerance.
fn exchange(pair: &Apart, corners: impl FnOnce() -> [Vec<Vector<Double>>; 2], tolerance: f64) -> Option<(f64, f64)> {
    if let Some(found) = pair.exchange(tolerance, CHEAP) {
        return Some(found);
    }
    // The middles tell what it is about.
    let guess = pair.guess();
    let close = Close::new(pair.arch(), corners());
    if let Some(found) = close.in_single(guess, tolerance) {
        return Some(found);
    }
    pair.exchange(tolerance, DEAR).or_else(|| close.in_double(guess, tolerance))
}

/// The same for two that are known to be in front of each other's planes, all but perhaps some corners that lie in those.
pub fn facing(ladder: &Ladder, a: (&Polygon, &Nodes), b: (&Polygon, &Nodes), tolerance: f64) -> Option<(f64, f64)> {
    let [first, second] = if precedes(b.0, a.0) { [b, a] } else { [a, b] };
    let pair =
        Apart::new(ladder, [first.1, second.1], Vector::difference(first.0.vertices()[0], second.0.vertices()[0]))?;
    if pair.is_high()
        && let Some(found) = pair.exchange(tolerance, CHEAP)
    {
        return Some(found);
    }
    unoccluded(ladder, a, b, tolerance)
}

/// An order of polygons that does not depend on which comes first.
fn precedes(a: &Polygon, b: &Polygon) -> bool {
    let (a, b) = (a.vertices(), b.vertices());
    let differ = a.iter().zip(b).find(|(p, q)| p != q);
    differ.map_or(a.len() < b.len(), |(p, q)| p.to_array() < q.to_array())
}

/// How a polygon lies to the plane of another.
struct Side {
    highest: f64,
    /// Nothing of it is behind, and none of its corners so near the plane that rounding hides on which side.
    is_whole: bool,
}

impl Side {
    fn of(polygon: &Polygon, normal: Vec3, plane: &Polygon) -> Self {
        let on_plane = plane.vertices()[0];
        let mut side = Self { highest: 0.0, is_whole: true };
        for v in polygon.vertices() {
            let height = height(normal, on_plane, *v);
            side.highest = side.highest.max(height);
            let is_on = || normal.dot(*v - on_plane) == 0.0 || plane.vertices().contains(v);
            side.is_whole &= height > 0.0 || (height == 0.0 && is_on());
        }
        side
    }

    /// The part in front; both polygons' corners exactly.
    fn part(&self, corners: &[Vector<Double>], plane: &[Vector<Double>]) -> Option<Vec<Vector<Double>>> {
        if self.is_whole {
            return Some(corners.to_vec());
        }
        let normal = Shape::normal_of(plane)?;
        // The corners of a triangle are in its plane, whatever rounding says.
        let is_on = |corner: &Vector<Double>| plane.len() == 3 && plane.contains(corner);
        let exact =
            |corner: &Vector<Double>| if is_on(corner) { Double::default() } else { normal.dot(*corner - plane[0]) };
        let heights: Vec<Double> = corners.iter().map(exact).collect();
        let part = cut(corners, &heights);
        (part.len() >= 3).then_some(part)
    }
}
