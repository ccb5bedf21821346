//! One edge of a contour, and the closed form of the logarithm's integral along it.

use super::ball::Ball;
use super::elementary::{angle, ln, pi};
use super::point::Point;

/// Relative uncertainty of the squared length up to which an edge counts as sharp: half the digits of a ball.
const SHARP: f64 = 1e-16;

/// The segment from `start` to `start + along`.
#[derive(Clone, Copy)]
pub struct Edge {
    pub start: Point,
    pub end: Point,
    pub along: Point,
    /// 1 / |along|².
    inverse_square: Ball,
}

impl Edge {
    pub fn new(start: Point, end: Point) -> Self {
        let along = end - start;
        Self { start, end, along, inverse_square: Ball::ONE.over(along.dot(along)) }
    }

    pub fn reversed(&self) -> Self {
        Self { start: self.end, end: self.start, along: -self.along, inverse_square: self.inverse_square }
    }

    /// True if the edge's direction is known to many digits, as that of an edge that a cut has made very short is not.
    pub fn is_sharp(&self) -> bool {
        self.inverse_square.radius <= SHARP * self.inverse_square.high
    }

    /// Length rounded to f64.
    pub fn length(&self) -> f64 {
        self.along.rounded().length()
    }

    /// ∫₀¹ ln|x − y(τ)|² dτ along the edge, or that less 2π η, η the distance of x from the edge's line in units of its length.
    ///
    /// With c the foot of x on the line (0 at the start, 1 at the end), r₀ and r₁ the distances to the ends and θ the angle between
    /// them: (1 − c) ln r₁² + c ln r₀² − 2 + 2 η θ. Less 2π η, θ becomes θ − π.
    pub fn potential(&self, x: Point, less_ridge: bool) -> Ball {
        let (to_start, to_end) = (x - self.start, x - self.end);
        let foot = to_start.dot(self.along) * self.inverse_square;
        let across = to_start.cross(self.along);
        let across = across.dot(across).sqrt();
        let straight = to_start.dot(to_end);
        let turn = if less_ridge { -angle(across, -straight) } else { angle(across, straight) };
        self.logarithm(Ball::ONE - foot, to_end)
            + self.logarithm(foot, to_start)
            + (across * self.inverse_square * turn).scaled(2.0)
            - Ball::exact(2.0)
    }

    /// c ln r², where |c| is no more than r over the edge's length.
    fn logarithm(&self, foot: Ball, offset: Point) -> Ball {
        let square = offset.dot(offset);
        if square.is_zero() {
            return Ball::ZERO;
        }
        let value = foot * ln(square);
        if value.is_finite() {
            return value;
        }
        // r |ln r²| rises up to r = 1/e.
        let r = square.upper().sqrt().next_up();
        if r.is_nan() || r >= 0.3 {
            return Ball::ENTIRE;
        }
        let bound = r * (2.0 * r.ln().abs()) * self.inverse_square.magnitude().sqrt();
        Ball::around(0.0, 1.001 * bound)
    }

    /// How much the potential can change over a distance: 8 d (1 + ln(1 + 1/(2d))), d that distance in units of the length.
    ///
    /// For |x − x′| ≤ d, |ln|x − y|² − ln|x′ − y|²| ≤ 2 ln(1 + d/s) for the nearer of both; summed over both and at worst about the
    /// middle of the edge, 8 ∫₀^½ ln(1 + d/s) ds.
    pub fn modulus(&self, distance: f64) -> f64 {
        let d = distance * self.inverse_square.magnitude().sqrt();
        8.01 * d * (1.0 + (0.5 / d).ln_1p())
    }

    /// 2π ∫ η over the part of `outer` between parameters a and b; η as in [`Self::potential`].
    ///
    /// η = |v| / |along|², v = (x − start) × along = v₀ + t v₁. With s = v·v₁/|v₁|² and κ = |v₀ × v₁|/|v₁|²,
    /// ∫|v| = ½ s |v| + ½ |v₁| κ² arsinh(s/κ) between its ends.
    pub fn ridge(&self, outer: &Edge, (a, b): (Ball, Ball)) -> Ball {
        let slope = outer.along.cross(self.along);
        let at = |t: Ball| (outer.start - self.start + outer.along.times(t)).cross(self.along);
        let (from, to) = (at(a), at(b));
        let factor = pi().scaled(2.0) * self.inverse_square;

        // |v| is convex: no more than at the ends.
        let width = (b - a).magnitude();
        let most = 0.5 * width * from.longest().max(to.longest());
        let anything = Ball::around(most, 1.000_001 * most);

        let square = slope.dot(slope);
        let length = square.sqrt();
        let across = from.cross(slope);
        let kappa_square = across.dot(across).over(square * square);
        let end = |v: Point| {
            let s = v.dot(slope).over(square);
            let distance = v.dot(v).sqrt();
            (s, distance, s * distance)
        };
        let ((s0, d0, p0), (s1, d1, p1)) = (end(from), end(to));
        let magnitude = |s: Ball| if s.high < 0.0 { -s } else { s };
        let arsinh = |s: Ball, d: Ball| {
            // arsinh(s/κ) = ± (ln(|s| + √(s² + κ²)) − ln κ).
            let value = ln(magnitude(s) + d.over(length)) - ln(kappa_square).scaled(0.5);
            if s.high < 0.0 { -value } else { value }
        };
        let mut curved = kappa_square * length * (arsinh(s1, d1) - arsinh(s0, d0));
        if !curved.is_finite() {
            // κ² arsinh(s/κ) ≤ κ |s|.
            let kappa = kappa_square.upper().max(0.0).sqrt();
            let bound = 1.001 * kappa * (s0.magnitude() + s1.magnitude()) * length.magnitude();
            curved = Ball::around(0.0, bound);
        }
        let exact = (p1 - p0 + curved).scaled(0.5);
        factor * if exact.radius < anything.radius { exact } else { anything }
    }
}
