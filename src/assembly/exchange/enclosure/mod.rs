//! The exchange of two polygons between proven bounds.
//!
//! ```text
//! T = ∫∫ cosθ cosθ′ / r² dA dA′ = ½ ∮∮ ln r dx·dx′ = ¼ Σₑ Σ_f (e·f) ∫₀¹∫₀¹ ln|x(t) − y(τ)|² dτ dt
//! ```
//!
//! over the edges of the parts in front of each other's plane. Everything is computed in balls of some 32 digits, so that the
//! cancellation between edges costs nothing, and every quadrature comes with a bound of its error. No code is shared with the fast path,
//! nor any formula but the contour integral itself, and no function of the platform's mathematical library is believed.
//!
//! | file | holds |
//! |---|---|
//! | `ball` | arithmetic with proven rounding |
//! | `elementary` | logarithm and angle |
//! | `point` | vectors |
//! | `rule` | Gauss rules with proven moments |
//! | `edge` | the logarithm's integral along an edge |
//! | `pair` | that integrated along another |
//! | `front` | cutting by a plane |

mod ball;
mod edge;
mod elementary;
mod front;
mod pair;
mod point;
mod rule;

use crate::geometry::{Polygon, Vec3};
use ball::Ball;
use edge::Edge;
use front::{MOST, Plane, area_vector};
use point::Point;

/// Relative width that is aimed at: four ulp.
const WIDTH: f64 = 1e-15;

/// A number known to lie between two others, m² sr.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enclosure {
    pub low: f64,
    pub high: f64,
}

impl Enclosure {
    /// (high − low) / high; 0 if both are 0.
    pub fn relative_width(&self) -> f64 {
        if self.high > 0.0 { (self.high - self.low) / self.high } else { 0.0 }
    }

    /// True if the value lies between the bounds, widened by `tolerance` relative.
    pub fn holds(&self, value: f64, tolerance: f64) -> bool {
        self.low * (1.0 - tolerance) <= value && value <= self.high * (1.0 + tolerance)
    }
}

/// Encloses the unoccluded exchange T = ∫∫ cosθ cosθ′ / r² dA dA′ of two convex polygons, m² sr, of the parts that are in front of each
/// other's plane. Symmetric up to the width.
///
/// What is enclosed is ½ ∮∮ ln r dx·dx′ over the contours through the *exact* f64 vertices, cut by the plane through the other polygon's
/// first vertex normal to its area vector. For triangles, and for other polygons whose vertices are exactly planar, that is T. A polygon
/// of more vertices that is planar to rounding only has no T; by Stokes' theorem the contour integral is then that of *any* surface that
/// spans its contour, the fan of triangles from any vertex for one. Whoever uses the unit normal and the vertices as if they were planar
/// differs by the planarity defect over the polygon's size, relative (some 1e-16 if it was only rotated).
///
/// The relative width is below 1e-15, for pairs far, near, touching, slivers alike, unless the exchange is so small that the balls'
/// digits (1e-29 of the pair's extent squared) show. Polygons in one plane give exactly 0 where that can be told from the vertices
/// (equal coordinates), else bounds that hold 0.
///
/// Lengths from 1e-150 to 1e150. Cost: 0.1 ms for most pairs, whether apart or with a common edge or corner, and up to some ms where an
/// edge touches another in between.
pub fn enclose(a: &Polygon, b: &Polygon) -> Enclosure {
    // Move the pair to the origin and scale it to one by a power of two, exactly.
    let origin = a.vertices()[0];
    let corners = || a.vertices().iter().chain(b.vertices());
    let extent = corners().map(|v| (*v - origin).abs().max_element()).fold(0.0, f64::max);
    let power = 2.0f64.powi(-extent.log2().ceil().clamp(-500.0, 500.0) as i32);
    let place = |p: &Polygon| p.vertices().iter().map(|v| Point::new(*v, origin, power)).collect::<Vec<_>>();
    let (whole_a, whole_b) = (place(a), place(b));

    // Keep what is in front.
    let (front_a, front_b) = (Plane::of(&whole_b).front_of(&whole_a), Plane::of(&whole_a).front_of(&whole_b));
    let (part_a, part_b) = (front_a.corners, front_b.corners);
    let area = |corners: &[Point]| 0.5 * area_vector(corners).longest();
    let doubt = front_a.doubtful + front_b.doubtful;
    let most = MOST * area(&whole_a).min(area(&whole_b));

    // Refine until the truncation is small beside the value.
    let mut value = Ball::ZERO;
    if part_a.len() >= 3 && part_b.len() >= 3 {
        let mut tolerance = 0.1 * WIDTH * guess(&part_a, &part_b).max(1e-24 * most).min(most);
        for _ in 0..4 {
            value = contour(&part_a, &part_b, tolerance);
            let wanted = 0.1 * WIDTH * value.high.max(0.1 * value.radius);
            let is_wide = value.radius > WIDTH * value.high;
            if !is_wide || wanted >= tolerance {
                break;
            }
            tolerance = wanted;
        }
    }
    let value = if doubt > 0.0 { value.widened(doubt) } else { value };
    let unit = power.recip();
    let [value, most] = [value, Ball::exact(most)].map(|x| x.scaled(unit).scaled(unit));
    let [low, high] = if value.is_finite() { [value.lower(), value.upper()] } else { [0.0, f64::INFINITY] };
    Enclosure { low: low.max(0.0), high: high.max(0.0).min(most.upper()) }
}

/// ¼ Σ (e·f) J over all pairs of edges.
fn contour(a: &[Point], b: &[Point], tolerance: f64) -> Ball {
    let edges = |corners: &[Point]| -> Vec<Edge> {
        let ends = (0..corners.len()).map(|k| (corners[k], corners[(k + 1) % corners.len()]));
        ends.filter(|(start, end)| !start.is_exactly(*end)).map(|(start, end)| Edge::new(start, end)).collect()
    };
    let (edges_a, edges_b) = (edges(a), edges(b));
    let share = 4.0 * tolerance / (a.len() * b.len()) as f64;
    let mut sum = Ball::ZERO;
    for one in &edges_a {
        for two in &edges_b {
            let weight = one.along.dot(two.along);
            if !weight.is_zero() {
                sum = sum + weight * pair::log_integral(one, two, share / weight.magnitude());
            }
        }
    }
    sum.scaled(0.25)
}

/// T from one point each, to aim at.
fn guess(a: &[Point], b: &[Point]) -> f64 {
    let centre = |corners: &[Point]| corners.iter().map(|p| p.rounded()).sum::<Vec3>() / corners.len() as f64;
    let d = centre(b) - centre(a);
    let flow = area_vector(a).rounded().dot(d) * -area_vector(b).rounded().dot(d);
    0.25 * flow.max(0.0) / d.length_squared().powi(2).max(f64::MIN_POSITIVE)
}
