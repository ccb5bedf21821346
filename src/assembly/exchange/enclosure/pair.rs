//! J = ∫₀¹∫₀¹ ln|x(t) − y(τ)|² dτ dt over two edges, x(t) on the outer one, y(τ) on the inner one.
//!
//! Edges with a common corner have a closed form. Otherwise the inner integral is closed and the outer one is done by Gauss on panels,
//! each with a bound of its error. For one fixed y, with ρ + 1/ρ the sum of the distances from y to the ends of a panel in units of half
//! its length, the generating function of Chebyshev polynomials gives ln|x − y|² = const − Σ (4/k) Re(ζ⁻ᵏ) Tₖ with |ζ| = ρ. So the k-th
//! coefficient is at most 4/(k ρᵏ), and that of the inner integral no more than its integral over y. There are two ways to y:
//!
//!  * along the edge itself: ρ is that of the edge's point next to the panel;
//!  * along the rest of the line: the integral over the whole line is 2π η up to constants, η the distance from it, so minus that the
//!    integral over the edge is minus those over the two rays beyond its ends. η is the root of a quadratic, and has a closed integral.
//!
//! The one is good where the edges are apart, the other where they run past each other however closely; only next to a corner must
//! panels shrink, and what is left of them in the end is bounded by the modulus of continuity. The number of panels grows like the
//! logarithm of the smallest distance.

use super::ball::Ball;
use super::edge::Edge;
use super::rule::{RULES, Rule};
use crate::geometry::Vec3;
use std::f64::consts::PI;

/// Subtracted from sums of distances, relative: far above the rounding of the f64 they are computed in.
const SAFETY: f64 = 1e-10;

/// Ellipses thinner than this (ρ + 1/ρ, so ρ = 1.37) are not used.
const THINNEST: f64 = 2.1;

/// Truncation below this is lost in rounding.
const FINEST: f64 = 1e-32;

/// A panel is halved at most this often.
const DEEPEST: usize = 120;

/// J, its truncation error aimed at `tolerance`; what is reached is in the radius.
pub fn log_integral(one: &Edge, two: &Edge, tolerance: f64) -> Ball {
    // Edges from a common corner: r² is homogeneous in (t, τ), so each triangle of the square reduces to its far side.
    for (one, two) in [(*one, *two), (one.reversed(), *two), (*one, two.reversed()), (one.reversed(), two.reversed())] {
        if one.start.is_exactly(two.start) {
            return (one.potential(two.end, false) + two.potential(one.end, false)).scaled(0.5) - Ball::ONE;
        }
    }
    // Corners of the inner edge are what makes panels shrink: let it be the one whose corners keep away. An edge of uncertain direction
    // had better be the outer one.
    let is_one_inner = match (one.is_sharp(), two.is_sharp()) {
        (true, true) => clearance(one, two) >= clearance(two, one),
        (false, false) => one.length() >= two.length(),
        (is_sharp, _) => is_sharp,
    };
    let (inner, outer) = if is_one_inner { (one, two) } else { (two, one) };
    let tolerance = tolerance.max(FINEST);
    let mut sum = Ball::ZERO;
    let mut panels = vec![(Panel { low: Ball::ZERO, high: Ball::ONE }, 0)];
    while let Some((panel, depth)) = panels.pop() {
        let share = tolerance * panel.width().sqrt();
        let is_last = depth == DEEPEST || !inner.is_sharp();
        if let Some(plan) = panel.plan(inner, outer, share).filter(|_| !is_last) {
            sum = sum + panel.integrate(inner, outer, &plan);
        } else if let Some(value) = panel.bounded(inner, outer, if is_last { f64::INFINITY } else { share }) {
            sum = sum + value;
        } else if is_last {
            return Ball::ENTIRE;
        } else {
            let middle = (panel.low + panel.high).scaled(0.5).midpoint();
            panels.push((Panel { low: middle, ..panel }, depth + 1));
            panels.push((Panel { high: middle, ..panel }, depth + 1));
        }
    }
    sum
}

/// Distance of an edge's corners from another edge, roughly, in units of the latter's length.
fn clearance(edge: &Edge, other: &Edge) -> f64 {
    let (from, to, along) = (other.start.rounded(), other.end.rounded(), other.along.rounded());
    let distance = |p: Vec3| {
        let s = ((p - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        p.distance(if s < 0.5 { from + s * along } else { to - (1.0 - s) * along })
    };
    distance(edge.start.rounded()).min(distance(edge.end.rounded())) / other.length()
}

/// Part of the outer edge, by its parameter.
#[derive(Clone, Copy)]
struct Panel {
    low: Ball,
    high: Ball,
}

/// A rule that is good enough on a panel.
struct Plan {
    rule: &'static Rule,
    /// Whether 2π η is taken out and integrated in closed form.
    without_ridge: bool,
    /// Bound of the quadrature's error on [−1, 1].
    error: f64,
}

/// Bounds |aₖ| ≤ size · (4/k) ρ⁻ᵏ.
#[derive(Clone, Copy)]
struct Decay {
    rho: f64,
    size: f64,
}

impl Decay {
    /// Error of a rule, of coefficients from 2n on and of the moments below: Σ |aₖ| from k = 2 on is at most 2 size / (ρ² − 1), and a₀
    /// differs from half the rule's sum by as much again.
    fn error(&self, rule: &Rule) -> f64 {
        let n = rule.size() as f64;
        let tail = self.rho.powi(-2 * rule.size() as i32) / (1.0 - self.rho.powi(-2));
        self.size * (4.2 / n * tail + 5.0 / (self.rho * self.rho - 1.0) * rule.moment_error)
    }

    /// The same for |aₖ| ≤ size · ρ⁻ᵏ.
    fn error_without_k(&self, rule: &Rule) -> f64 {
        0.5 * rule.size() as f64 * self.error(rule)
    }
}

impl Panel {
    fn width(&self) -> f64 {
        (self.high - self.low).high
    }

    /// The smallest rule whose error is within the tolerance; `None` if there is none.
    fn plan(&self, inner: &Edge, outer: &Edge, tolerance: f64) -> Option<Plan> {
        let half = 0.5 * self.width() * (1.0 + 4.0 * f64::EPSILON);
        let length = 2.0 * half * outer.along.longest();
        let ends = [self.low, self.high].map(|t| outer.start + outer.along.times(t));
        let [from, to] = ends.map(|end| (end - inner.start).rounded());
        let [from_end, to_end] = ends.map(|end| (end - inner.end).rounded());
        // What the corners themselves are uncertain by moves distances by no more.
        let doubt = 4.0 * ends.map(|end| (end - inner.start).doubt() + (end - inner.end).doubt()).iter().sum::<f64>();
        let along = inner.along.rounded();
        let inner_length = inner.along.shortest();
        let tangent = along.normalize();

        // Along the edge, and along the two rays that leave it.
        let here = [nearest(from, to, tangent), nearest(from_end, to_end, -tangent)];
        let there = [nearest(from, to, -tangent), nearest(from_end, to_end, tangent)];
        let line = line_distance(from, to, tangent).max(line_distance(from_end, to_end, tangent));
        let segment = here[0].unwrap_or_else(|| here[1].unwrap_or(line));
        let rays = there[0].unwrap_or(line).min(there[1].unwrap_or(line));
        let segment = rho((segment - doubt) / (0.5 * length)).map(|rho| Decay { rho, size: 1.0 });
        let rays = rho((rays - doubt) / (0.5 * length)).map(|rho| {
            let reach = 0.5 * ((from + to).length() + (from_end + to_end).length());
            Decay { rho, size: 1.001 * (reach + 0.5 * length * (2.0 * rho + 1.0)) / inner_length }
        });

        // η on the panel.
        let [v0, v1] = ends.map(|end| (end - inner.start).cross(inner.along));
        let slope = outer.along.cross(inner.along).longest();
        let most = 1.001 * (v0.longest() + v1.longest()) / (inner_length * inner_length);
        let ridge =
            rho((v0.shortest() + v1.shortest()) / (slope * half)).map(|rho| Decay { rho, size: 4.0 * PI * most });
        // |aₖ| ≤ 2 · 2π · (η at both ends) ρ⁻ᵏ; and both the integral and the rule's sum are within 0 … 4π max η.
        let ridge_error = |rule: &Rule| {
            let bound = 13.0 * most;
            ridge.map_or(bound, |decay| decay.error_without_k(rule).min(bound))
        };

        let allowed = tolerance / half;
        for rule in RULES.iter() {
            let plan = |error: f64, without_ridge| (error <= allowed).then_some(Plan { rule, without_ridge, error });
            let over_segment = segment.and_then(|segment| plan(segment.error(rule), false));
            let over_rays = |rays: Decay| {
                plan(rays.error(rule) + ridge_error(rule), false).or_else(|| plan(rays.error(rule), true))
            };
            let found = over_segment.or_else(|| rays.and_then(over_rays));
            if found.is_some() {
                return found;
            }
        }
        None
    }

    fn integrate(&self, inner: &Edge, outer: &Edge, plan: &Plan) -> Ball {
        let middle = (self.low + self.high).scaled(0.5);
        let half = (self.high - self.low).scaled(0.5);
        let centre = outer.start + outer.along.times(middle);
        let step = outer.along.times(half);
        // Take out a constant: no rule's weights sum to 2 exactly.
        let potential = |x| inner.potential(x, plan.without_ridge);
        let constant = potential(centre).midpoint();
        let mut sum = Ball::ZERO;
        for (node, weight) in &plan.rule.nodes {
            let offset = step.times(*node);
            let pair = (potential(centre + offset) - constant) + (potential(centre - offset) - constant);
            sum = sum + *weight * pair;
        }
        let error = plan.error + plan.rule.moment_error * sum.magnitude();
        let value = half * (sum.widened(error) + constant.scaled(2.0));
        if plan.without_ridge { value + inner.ridge(outer, (self.low, self.high)) } else { value }
    }

    /// Width times the value in the middle, if the modulus of continuity allows no more than the tolerance.
    fn bounded(&self, inner: &Edge, outer: &Edge, tolerance: f64) -> Option<Ball> {
        let width = self.high - self.low;
        let modulus = inner.modulus(0.5 * width.magnitude() * outer.along.longest());
        (width.magnitude() * modulus <= tolerance).then(|| {
            let middle = outer.start + outer.along.times((self.low + self.high).scaled(0.5));
            width * inner.potential(middle, false).widened(modulus)
        })
    }
}

/// ρ of the ellipse with this sum of distances to its foci ±1, if it is thick enough.
fn rho(sum: f64) -> Option<f64> {
    let sum = sum * (1.0 - SAFETY);
    // Beyond 1e9 a larger ρ helps no more.
    (sum > THINNEST).then(|| (0.5 * (sum + (sum * sum - 4.0).sqrt())).min(1e9))
}

/// The least sum of distances from a point on a ray to two others, where that is the ray's origin (the sum is convex); both are given
/// relative to the origin.
fn nearest(from: Vec3, to: Vec3, direction: Vec3) -> Option<f64> {
    let (a, b) = (from.length(), to.length());
    // The origin may be one of the points: the sum cannot fall. A slope of rounding's size costs less than safety takes off.
    let slope = |v: Vec3, length: f64| if length == 0.0 { 1.0 } else { -v.dot(direction) / length };
    (slope(from, a) + slope(to, b) >= -1e-12).then_some((a + b) * (1.0 - SAFETY))
}

/// A lower bound of the same on the whole line: the straight way to the mirrored point.
fn line_distance(from: Vec3, to: Vec3, direction: Vec3) -> f64 {
    let heights = from.cross(direction).length() + to.cross(direction).length();
    let along = (to - from).dot(direction);
    heights.hypot(along) - 1e-14 * (from.length() + to.length())
}

#[cfg(test)]
mod tests {
    use super::super::elementary::{angle, ln};
    use super::super::point::Point;
    use super::*;

    fn edge(from: [f64; 3], to: [f64; 3]) -> Edge {
        let point = |p: [f64; 3]| Point::new(Vec3::from_array(p), Vec3::ZERO, 1.0);
        Edge::new(point(from), point(to))
    }

    /// P(a + 1) + P(a − 1) − 2 P(a), P(x) = ½ (x² − h²) ln(x² + h²) + 2 h x arctan(x/h) − 3/2 x²: J of unit edges side by side, one
    /// shifted by a along and by h across.
    fn parallel(a: f64, h: f64) -> Ball {
        let [half, h] = [0.5, h].map(Ball::exact);
        let antiderivative = |x: f64| {
            let size = Ball::exact(x.abs());
            let square = size * size;
            let r_square = square + h * h;
            if r_square.is_zero() {
                return Ball::ZERO;
            }
            half * (square - h * h) * ln(r_square) + Ball::exact(2.0) * h * size * angle(size, h)
                - Ball::exact(1.5) * square
        };
        antiderivative(a + 1.0) + antiderivative(a - 1.0) - Ball::exact(2.0) * antiderivative(a)
    }

    /// Aimed at, and reached to a few times.
    const TOLERANCE: f64 = 1e-24;

    #[test]
    fn edges_side_by_side_match_the_closed_form() {
        // Far, next to each other, overlapping; apart, close, all but and wholly collinear. All dyadic.
        for a in [8.0, 2.0, 1.0 + f64::powi(2.0, -30), 1.0, 0.75, 0.25, f64::powi(2.0, -40), 0.0, -0.5] {
            for h in [2.0, 0.25, f64::powi(2.0, -10), f64::powi(2.0, -40), f64::powi(2.0, -60), 0.0] {
                let one = edge([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
                let two = edge([a, h, 0.0], [a + 1.0, h, 0.0]);
                let expected = parallel(a, h);
                for (one, two) in [(one, two), (two, one), (one.reversed(), two), (one, two.reversed())] {
                    let left = log_integral(&one, &two, TOLERANCE) - expected;
                    assert!(left.mignitude() == 0.0, "shifted by {a}, {h}: {left:?}");
                    assert!(left.radius < 20.0 * TOLERANCE, "shifted by {a}, {h}: {left:?}");
                }
            }
        }
    }

    /// A cross of skew edges, cut at the crossing into corners, whose closed form is another route.
    #[test]
    fn crossing_edges_are_the_sum_of_their_corners() {
        for (x, y) in [([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]), ([3.0, 1.0, 0.5], [-1.0, 2.0, 0.25])] {
            let times = |v: [f64; 3], t: f64| v.map(|v| v * t);
            let (one, two) = (edge(times(x, -1.0), times(x, 3.0)), edge(times(y, -0.5), times(y, 1.5)));
            let mut sum = Ball::ZERO;
            for (s, share) in [(-1.0, 0.25), (3.0, 0.75)] {
                for (t, other) in [(-0.5, 0.25), (1.5, 0.75)] {
                    let corner = log_integral(&edge([0.0; 3], times(x, s)), &edge([0.0; 3], times(y, t)), TOLERANCE);
                    sum = sum + Ball::exact(share * other) * corner;
                }
            }
            let left = log_integral(&one, &two, TOLERANCE) - sum;
            assert!(left.mignitude() == 0.0 && left.radius < 20.0 * TOLERANCE, "{left:?}");
        }
    }

    /// Skew edges at any distance: the bounds of halves, added, meet those of the whole, whichever edge is halved.
    #[test]
    fn halves_add_up_to_the_whole() {
        for exponent in [0, -3, -8, -20, -35, -52] {
            let h = f64::powi(2.0, exponent);
            for slope in [1.0, 0.25, f64::powi(2.0, -20)] {
                let (from, to) = ([-1.0, -slope, h], [0.5, 0.5 * slope, h]);
                let middle = [0, 1, 2].map(|k| 0.5 * (from[k] + to[k]));
                let one = edge([-0.75, 0.0, 0.0], [1.25, 0.0, 0.0]);
                let whole = log_integral(&one, &edge(from, to), TOLERANCE);
                let parts = [edge(from, middle), edge(middle, to)].map(|part| log_integral(&one, &part, TOLERANCE));
                let left = (parts[0] + parts[1]).scaled(0.5) - whole;
                assert!(left.mignitude() == 0.0 && left.radius < 40.0 * TOLERANCE, "{h} {slope}: {left:?}");
            }
        }
    }
}
