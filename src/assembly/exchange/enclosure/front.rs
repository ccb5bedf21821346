//! The part of a polygon in front of another's plane, cut in balls.

use super::ball::Ball;
use super::point::Point;
use crate::geometry::Vec3;

/// Heights below this, in units of the pair's size, count as zero; what that may cost in exchange is charged.
const ON_PLANE: f64 = 1e-26;

/// Crossings less certain than this, in units of the edge, are chosen, and the choice charged; others carry their uncertainty on.
const UNCERTAIN: f64 = 1e-28;

/// ∫ |cosθ| dω over any half of the directions is π: no point exchanges more with any polygon.
pub const MOST: f64 = 3.15;

/// The oriented plane of a polygon: through its first corner, normal to its area vector.
pub struct Plane<'a> {
    corners: &'a [Point],
    normal: Point,
    length: f64,
}

/// What lies in front of a plane.
pub struct Front {
    /// Fewer than three: nothing.
    pub corners: Vec<Point>,
    /// Bound of the exchange with the plane's polygon that may be counted wrongly.
    pub doubtful: f64,
}

impl<'a> Plane<'a> {
    pub fn of(corners: &'a [Point]) -> Self {
        let normal = area_vector(corners);
        Self { corners, normal, length: normal.longest() }
    }

    /// Height of a point times the normal's length; exactly zero for the corners of a triangle.
    fn height(&self, point: Point) -> Ball {
        let is_corner = |corner: &Point| corner.is_exactly(point);
        let own = if self.corners.len() == 3 { self.corners } else { &self.corners[..1] };
        if own.iter().any(is_corner) {
            return Ball::ZERO;
        }
        self.normal.dot(point - self.corners[0])
    }

    /// Bound of ∫ |cosθ cosθ′| / r² dA′ over the polygon from any point next to a segment.
    fn most_seen(&self, from: Point, to: Point) -> f64 {
        let centre = self.corners.iter().map(|p| p.rounded()).sum::<Vec3>() / self.corners.len() as f64;
        let radius = self.corners.iter().map(|p| p.rounded().distance(centre)).fold(0.0, f64::max);
        let (from, along) = (from.rounded(), (to - from).rounded());
        let s = ((centre - from).dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        // A millionth of safety for rounding and for what lies next to the segment.
        let gap = (1.0 - 1e-6) * centre.distance(from + s * along) - (1.0 + 1e-6) * radius;
        if gap > 0.0 { (0.501 * self.length / (gap * gap)).min(MOST) } else { MOST }
    }

    /// The part of a convex polygon in front (Sutherland and Hodgman 1974).
    ///
    /// Corners whose height has no certain sign, or next to none, are taken to lie in the plane. With ε the largest of those and H the
    /// greatest height of any corner, all of the polygon between −ε and ε is at most 4ε/H of its area, for its width is a
    /// concave function of height: that much is doubtful. An edge that hardly leaves the plane crosses it at an uncertain place, but on
    /// a line that is certain: the place is chosen, and the triangles that it may sweep up to the cut's other end are doubtful.
    pub fn front_of(&self, polygon: &[Point]) -> Front {
        let threshold = ON_PLANE * self.length;
        let heights: Vec<Ball> = polygon.iter().map(|p| self.height(*p)).collect();
        if !heights.iter().all(|h| h.is_finite()) {
            return Front { corners: Vec::new(), doubtful: f64::INFINITY };
        }
        let is_level = |h: &Ball| h.mignitude() <= threshold;
        let sign = |h: &Ball| {
            if is_level(h) {
                0
            } else if h.high > 0.0 {
                1
            } else {
                -1
            }
        };
        let doubt = heights.iter().filter(|h| is_level(h)).map(|h| if h.is_zero() { 0.0 } else { h.magnitude() });
        let doubt = doubt.fold(0.0, f64::max);
        let extent = heights.iter().map(|h| h.mignitude()).fold(0.0, f64::max);
        let share = if doubt == 0.0 { 0.0 } else { (4.01 * doubt / extent).min(1.0) };
        let mut doubtful = if share > 0.0 { MOST * 0.501 * share * area_vector(polygon).longest() } else { 0.0 };
        if !heights.iter().any(|h| sign(h) > 0) {
            return Front { corners: Vec::new(), doubtful };
        }

        // Keep the corners in front and those on the cut, a crossing with the way it may be off.
        let mut corners = Vec::with_capacity(polygon.len() + 1);
        let mut cut = Vec::new();
        for (k, (corner, h)) in polygon.iter().zip(&heights).enumerate() {
            let next = (k + 1) % polygon.len();
            if sign(h) >= 0 {
                corners.push(*corner);
            }
            if sign(h) == 0 {
                cut.push((*corner, None));
            }
            if sign(h) * sign(&heights[next]) < 0 {
                let s = h.over(*h - heights[next]);
                let edge = polygon[next] - *corner;
                let is_chosen = s.radius > UNCERTAIN;
                let crossing = *corner + edge.times(if is_chosen { s.midpoint() } else { s });
                corners.push(crossing);
                cut.push((crossing, is_chosen.then(|| edge.times(Ball::exact(s.radius)))));
            }
        }
        for (from, step) in &cut {
            let Some(step) = step else { continue };
            let swept =
                cut.iter().map(|(to, _)| 0.501 * step.cross(*to - *from).longest() * self.most_seen(*from, *to));
            doubtful += swept.fold(0.0, f64::max);
        }
        Front { corners, doubtful }
    }
}

/// Twice the area of a polygon, along its normal: the sum over the fan of triangles from its first corner.
pub fn area_vector(corners: &[Point]) -> Point {
    let zero = Point { x: Ball::ZERO, y: Ball::ZERO, z: Ball::ZERO };
    let cross = |pair: &[Point]| (pair[0] - corners[0]).cross(pair[1] - corners[0]);
    corners.get(1..).map_or(zero, |rest| rest.windows(2).map(cross).fold(zero, |sum, v| sum + v))
}
