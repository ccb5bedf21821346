//! The form factor of a convex polygon cut by planes through the point that looks at it.
//!
//! ```text
//! F = (1/2π) Σ θₖ n·(vₖ × vₖ₊₁) / |vₖ × vₖ₊₁|,      θ / |v × w| = (1 / v·w) atan(t)/t,  t = |v × w| / v·w
//! ```
//!
//! (Lambert 1760.) The second form needs no root and no library arctangent where the angle is small, as between patches it is.

use super::body::Lie;
use crate::geometry::Vec3;
use std::f64::consts::TAU;

/// Rounding of a height over a plane through an edge and a point, relative to the lengths in it: a few ulp.
const FLAT: f64 = 4e-15;

/// Rounding of a point where bodies touch, relative to its coordinates: an ulp on either side.
const TOUCH: f64 = 2.0 * f64::EPSILON;

/// Sine of an angle between an edge and a plane in which it is to lie.
const COPLANAR: f64 = 1e-9;

/// An edge of an obstacle's outline. A point y is on its hidden side, seen from x, where (from − x) × (to − x) · (y − x) > 0.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    pub from: Vec3,
    pub to: Vec3,
    /// Number of the outline it is part of.
    pub owner: usize,
}

impl Edge {
    /// The plane through x and this edge, its normal to the hidden side, not of unit length.
    pub fn plane_from(&self, x: Vec3) -> Vec3 {
        (self.from - x).cross(self.to - x)
    }

    /// Height of y over the plane through x and this edge as a linear function of x: the normal of it, for x relative to `from`.
    pub fn height_of(&self, y: Vec3) -> Vec3 {
        (y - self.from).cross(self.to - self.from)
    }

    /// That end of another edge which is further from this one's start.
    pub fn far_end(&self, other: &Self) -> Vec3 {
        let is_start = other.from.distance_squared(self.from) > other.to.distance_squared(self.from);
        if is_start { other.from } else { other.to }
    }

    /// True if both lie in one plane.
    pub fn is_coplanar(&self, other: &Self) -> bool {
        let (normal, along) = (self.height_of(self.far_end(other)), other.to - other.from);
        normal.dot(along).abs() <= COPLANAR * normal.length() * along.length()
    }

    /// Where it meets another one of its plane, if both do so in an inner point or an end.
    pub fn crossing(&self, other: &Self) -> Option<Vec3> {
        let (side, along) = (self.to - self.from, other.to - other.from);
        let turn = side.cross(along);
        if turn.length() <= COPLANAR * side.length() * along.length() {
            return None;
        }
        let share = (other.from - self.from).cross(along).dot(turn) / turn.length_squared();
        let point = self.from + share * side;
        let is_within = |share: f64| (-COPLANAR..=1.0 + COPLANAR).contains(&share);
        (is_within(share) && is_within((point - other.from).dot(along) / along.length_squared())).then_some(point)
    }

    /// True if a point lies in its line within rounding.
    pub fn touches(&self, point: Vec3) -> bool {
        let grain = TOUCH * point.abs().max(self.from.abs()).max(self.to.abs()).max_element();
        let side = self.to - self.from;
        let flat = FLAT * point.distance(self.from) + 2.0 * grain;
        self.height_of(point).length_squared() <= flat * flat * side.length_squared()
    }

    /// On which side these points lie, seen from anywhere in the hull of `eyes`: above is hidden.
    pub fn lie(&self, eyes: &[Vec3], points: &[Vec3]) -> Lie {
        match self.sides(eyes, points) {
            (true, true) => Lie::Across,
            (true, false) => Lie::Above,
            (false, _) => Lie::Below,
        }
    }

    /// Whether some point is above from somewhere in the hull of `eyes`, and whether some is below; once both are known to be, it looks no
    /// further.
    fn sides(&self, eyes: &[Vec3], points: &[Vec3]) -> (bool, bool) {
        let (mut above, mut below) = (false, false);
        let length = (self.to - self.from).length_squared();
        let reach = eyes.iter().map(|x| x.distance_squared(self.from)).fold(0.0, f64::max);
        for y in points {
            let slope = self.height_of(*y);
            let grain = FLAT * y.distance(self.from) + TOUCH * y.abs().max(self.from.abs()).max_element();
            let flat = grain * (length * reach).sqrt();
            for x in eyes {
                let height = slope.dot(*x - self.from);
                above |= height > flat;
                below |= height < -flat;
            }
            if above && below {
                break;
            }
        }
        (above, below)
    }

    /// True if none of these points is on the hidden side from anywhere in the hull of `eyes`.
    pub fn never_hides(&self, eyes: &[Vec3], points: &[Vec3]) -> bool {
        self.lie(eyes, points) == Lie::Below
    }

    /// True if the hull of these points is beyond the edge from anywhere inside the hull of `eyes`: on the other side than what is hidden,
    /// and not all of it on the border.
    pub fn is_short_of(&self, eyes: &[Vec3], points: &[Vec3]) -> bool {
        self.sides(eyes, points) == (false, true)
    }
}

/// Corners of the polygon under way, as seen from x.
#[derive(Default)]
pub struct Scratch {
    polygon: Vec<Vec3>,
    spare: Vec<Vec3>,
}

/// F from x, with this normal, to the part of a polygon on the hidden side of all edges. The polygon shows its front to x.
pub fn hidden(x: Vec3, normal: Vec3, polygon: &[Vec3], edges: &[Edge], scratch: &mut Scratch) -> f64 {
    scratch.polygon.clear();
    scratch.polygon.extend(polygon.iter().map(|v| *v - x));
    for edge in edges {
        let plane = edge.plane_from(x);
        scratch.spare.clear();
        let Some(&last) = scratch.polygon.last() else { return 0.0 };
        let (mut from, mut below) = (last, plane.dot(last));
        for &to in &scratch.polygon {
            let height = plane.dot(to);
            if (below > 0.0 && height < 0.0) || (below < 0.0 && height > 0.0) {
                scratch.spare.push(from + (below / (below - height)) * (to - from));
            }
            if height >= 0.0 {
                scratch.spare.push(to);
            }
            (from, below) = (to, height);
        }
        std::mem::swap(&mut scratch.polygon, &mut scratch.spare);
    }
    let Some(&last) = scratch.polygon.last() else { return 0.0 };
    let mut from = last;
    let mut sum = 0.0;
    for &to in &scratch.polygon {
        sum += edge_flux(from, to, normal);
        from = to;
    }
    sum / TAU
}

/// θ n·(w × v) / |w × v| of one edge from v to w.
#[inline(always)]
pub fn edge_flux(from: Vec3, to: Vec3, normal: Vec3) -> f64 {
    let across = to.cross(from);
    let along = from.dot(to);
    let square = across.length_squared();
    let per_sine = if along > 0.0 && square <= SMALL * along * along {
        arctangent_ratio(square / (along * along)) / along
    } else if square > 0.0 {
        let length = square.sqrt();
        length.atan2(along) / length
    } else {
        // An edge seen end on subtends nothing.
        0.0
    };
    per_sine * normal.dot(across)
}

/// Largest t² that [`arctangent_ratio`] takes.
const SMALL: f64 = 0.25;

/// atan(t)/t as a polynomial of t² in [0, ¼]: interpolated in thirteen Chebyshev nodes (in fifty digits), off by 1e-17 at most.
#[inline(always)]
fn arctangent_ratio(square: f64) -> f64 {
    const COEFFICIENTS: [f64; 13] = [
        1.0,
        -0.333_333_333_333_327_8,
        0.199_999_999_998_755_42,
        -0.142_857_142_746_920_63,
        0.111_111_106_023_059_71,
        -0.090_908_950_580_923_12,
        0.076_920_579_899_766_18,
        -0.066_636_678_441_838_57,
        0.058_574_357_651_656_94,
        -0.051_185_319_386_479_54,
        0.041_775_850_326_747_944,
        -0.027_302_779_603_074_177,
        0.010_030_841_489_968_486,
    ];
    COEFFICIENTS.iter().rev().fold(0.0, |sum, c| sum * square + c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_polynomial_is_the_arctangent() {
        for k in 1..=1000 {
            let square = SMALL * f64::from(k) / 1000.0;
            let expected = square.sqrt().atan() / square.sqrt();
            // Two roundings of the library's and one of ours.
            assert!((arctangent_ratio(square) - expected).abs() < 4e-16, "{square}");
        }
        assert!((arctangent_ratio(0.0) - 1.0).abs() <= f64::EPSILON);
    }

    #[test]
    fn edges_subtend_their_angle_at_any_distance() {
        // From the origin under normal z, an edge across y at x = 1, height h: θ is 2 atan(1/|(1, h)|).
        for h in [1e-3, 0.1, 1.0, 10.0] {
            let (from, to) = (Vec3::new(1.0, -1.0, h), Vec3::new(1.0, 1.0, h));
            let distance = (1.0 + h * h).sqrt();
            let expected = 2.0 * (1.0 / distance).atan() / distance;
            let found = edge_flux(from, to, Vec3::Z);
            assert!((found.abs() / expected - 1.0).abs() < 4.0 * f64::EPSILON, "{h}: {found} {expected}");
        }
    }
}
