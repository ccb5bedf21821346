//! Quadrature over facets that both reflect and refract.
//!
//! In the plane of slopes p (see `half_vectors`) with t = o_xy/o_z, a facet
//!
//! ```text
//! faces o                         where   p·t < 1
//! mirrors o above the horizon     where   |p + t| < 1/o_z
//! reflects totally                where   (o·m)² < 1 − η²:  a conic
//! bends o onto the horizon        where   |p + t| = η/o_z   (i_xy = −(o_xy + o_z p)/η there)
//! ```
//!
//! Along each ray from p = 0 these are roots of quadratics, and the integrand is smooth between them, with square roots at the conic; rays that
//! touch conic and circle, which both do at the angle asin(η/sinθ) from −t if o lies beyond the critical angle, split the azimuth, and so do
//! rays through a point where the conic crosses the first circle. Gauss' rule in a variable that removes the roots integrates along a ray,
//! a tanh-sinh rule (Takahasi & Mori 1974) over azimuths.

use super::fresnel::{Interface, dielectric};
use super::half_vectors::{Lobe, Tail};
use super::microfacet::GAUSSIAN_REACH;
use super::quadrature::{Quadrature, doubled, rule};
use crate::geometry::Vec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// What a facet does to the outgoing direction.
pub(super) struct RefractingFacet {
    pub interface: Interface,
    pub reflected: Vec3,
    /// On the other side, unit length; meaningless where reflection is total.
    pub refracted: Vec3,
    /// m_z
    pub cosine: f64,
    /// o·m
    pub facing: f64,
    pub r_squared: f64,
}

impl RefractingFacet {
    /// η is the index beyond over the index on the side of `outgoing`, which is above the surface.
    pub fn new(outgoing: Vec3, normal: Vec3, r_squared: f64, eta: f64) -> Self {
        let facing = outgoing.dot(normal).min(1.0);
        let interface = dielectric(facing, eta);
        let bend = facing / eta - interface.transmitted_cosine;
        Self {
            interface,
            reflected: 2.0 * facing * normal - outgoing,
            refracted: bend * normal - outgoing / eta,
            cosine: normal.z,
            facing,
            r_squared,
        }
    }
}

/// Slopes beyond this many α carry 1e-12 of the light under GGX.
const ALGEBRAIC_REACH: f64 = 1e12;
/// Steps of the tanh-sinh rules, each half of the one before.
const STEPS: [f64; 5] = [0.4, 0.2, 0.1, 0.05, 0.025];
/// Abscissae beyond this lie within 1e-15 of the ends.
const LAST_ABSCISSA: f64 = 3.1;

/// ∫ g dp over the facets that face an outgoing direction above the surface; g is zero where it does not apply.
pub(super) fn integrate(outgoing: Vec3, lobe: Lobe, eta: f64, g: impl Fn(&RefractingFacet) -> f64) -> Quadrature {
    doubled(STEPS.len(), |level| with_level(outgoing, lobe, eta, level, &g))
}

fn with_level(
    outgoing: Vec3,
    ([ax, ay], tail): Lobe,
    eta: f64,
    level: usize,
    g: &impl Fn(&RefractingFacet) -> f64,
) -> f64 {
    let (turns, steps) = (tanh_sinh(STEPS[level]), rule(level));
    let (tx, ty) = (outgoing.x / outgoing.z, outgoing.y / outgoing.z);
    let mut sum = 0.0;
    for (from, to) in sectors([ax, ay], [tx, ty], outgoing.z, eta) {
        for (u, weight_u) in &turns {
            let (sin, cos) = (from + (to - from) * u).sin_cos();
            let (ux, uy) = (ax * cos, ay * sin);
            let ray = Ray { square: ux * ux + uy * uy, cross: tx * ux + ty * uy, tail };
            let mut line = 0.0;
            for pair in ray.breaks(outgoing.z, eta).windows(2) {
                for (v, weight_v) in steps {
                    // (3 − 2v)v² makes a square root at either end a polynomial.
                    let x = pair[0] + (pair[1] - pair[0]) * (3.0 - 2.0 * v) * v * v;
                    let width = weight_v * (pair[1] - pair[0]) * 6.0 * v * (1.0 - v);
                    let (r, slope) = match tail {
                        Tail::Algebraic => (x.sinh(), x.cosh()),
                        Tail::Gaussian => (x, 1.0),
                    };
                    let lift = 1.0 / (1.0 + r * r * ray.square).sqrt();
                    let normal = Vec3::new(-r * ux * lift, -r * uy * lift, lift);
                    let facet = RefractingFacet::new(outgoing, normal, r * r, eta);
                    if facet.facing > 0.0 {
                        line += width * slope * r * g(&facet);
                    }
                }
            }
            sum += weight_u * (to - from) * line;
        }
    }
    sum * ax * ay * if ax == ay { 2.0 } else { 1.0 }
}

/// A ray of slopes p = r u from the origin.
struct Ray {
    /// |u|²
    square: f64,
    /// t·u
    cross: f64,
    tail: Tail,
}

impl Ray {
    /// Where along the ray something ends, in the variable in which the lobe is integrated, from 0 to where the facets cease to face o.
    fn breaks(&self, cosine: f64, eta: f64) -> Vec<f64> {
        let (square, cross) = (self.square, self.cross);
        let reach = match self.tail {
            Tail::Algebraic => ALGEBRAIC_REACH,
            Tail::Gaussian => GAUSSIAN_REACH,
        };
        let end = if cross * reach > 1.0 { 1.0 / cross } else { reach };

        // |p + t|² = ν²/o_z² for both circles, with |t|² = 1/o_z² − 1; and (1 − r t·u)² o_z² = (1 − η²)(1 + r² u²).
        let squared = cosine * cosine;
        let mirror = roots(square, cross, -1.0);
        let horizon = roots(square, cross, (1.0 - eta * eta) / squared - 1.0);
        let conic = if eta < 1.0 {
            let critical = (1.0 - eta * eta) / squared;
            roots(cross * cross - critical * square, -cross, 1.0 - critical)
        } else {
            [f64::NAN; 2]
        };
        let mut breaks: Vec<f64> = [mirror, horizon, conic].concat();
        breaks.retain(|r| *r > 0.0 && *r < end);
        breaks.extend([0.0, end]);
        breaks.sort_by(f64::total_cmp);
        if self.tail == Tail::Algebraic {
            breaks.iter_mut().for_each(|r| *r = r.asinh());
        }
        breaks
    }
}

/// Roots of a r² + 2 b r + c, without cancellation; not numbers where there are none.
fn roots(a: f64, b: f64, c: f64) -> [f64; 2] {
    let q = -(b + (b * b - a * c).sqrt().copysign(b));
    [q / a, c / q]
}

/// Sectors of azimuth within which rays meet the same boundaries; half a circle if the lobe is isotropic, for the other is its image.
fn sectors([ax, ay]: [f64; 2], [tx, ty]: [f64; 2], cosine: f64, eta: f64) -> Vec<(f64, f64)> {
    let toward = (ay * ty).atan2(ax * tx);
    let mut edges: Vec<f64> = (0..4).map(|k| toward + FRAC_PI_2 * f64::from(k)).collect();
    if ax != ay {
        edges.extend((0..4).map(|k| FRAC_PI_2 * f64::from(k)));
    }

    // Rays that touch the conic and the circle, in the plane of slopes, then in the stretched plane.
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    let stretched = |angle: f64| (angle.sin() / ay).atan2(angle.cos() / ax);
    if eta < sine {
        let middle = (-ty).atan2(-tx);
        let half = (eta / sine).asin();
        edges.extend([stretched(middle + half), stretched(middle - half)]);
    }

    // Rays that meet the conic at infinity, where (t·u)² o_z² = (1 − η²)|u|².
    if eta < 1.0 && 1.0 - eta * eta < sine * sine {
        let middle = (-ty).atan2(-tx);
        let half = ((1.0 - eta * eta).sqrt() / sine).acos();
        edges.extend([stretched(middle + half), stretched(middle - half)]);
    }

    // Points where the conic crosses the circle of the mirrored horizon: |p|² = 4 (1 − η²)/o_z² − 1 there, and p·t = (1 − |p|²)/2.
    let square = 4.0 * (1.0 - eta * eta) / (cosine * cosine) - 1.0;
    let turn = 0.5 * (1.0 - square) / (square.sqrt() * tx.hypot(ty));
    if square > 0.0 && turn.abs() < 1.0 {
        let middle = ty.atan2(tx);
        edges.extend([stretched(middle + turn.acos()), stretched(middle - turn.acos())]);
    }
    edges.iter_mut().for_each(|edge| *edge = (*edge - toward).rem_euclid(TAU));
    let last = if ax == ay { PI } else { TAU };
    edges.retain(|edge| *edge > 0.0 && *edge < last);
    edges.extend([0.0, last]);
    edges.sort_by(f64::total_cmp);
    edges.windows(2).filter(|pair| pair[1] - pair[0] > 1e-14).map(|pair| (toward + pair[0], toward + pair[1])).collect()
}

/// The tanh-sinh rule of this step on [0, 1].
fn tanh_sinh(step: f64) -> Vec<(f64, f64)> {
    let n = (LAST_ABSCISSA / step).floor() as i32;
    (-n..=n)
        .map(|k| {
            let t = f64::from(k) * step;
            let node = 1.0 / (1.0 + (-PI * t.sinh()).exp());
            (node, step * PI * t.cosh() * node / (1.0 + (PI * t.sinh()).exp()))
        })
        .collect()
}
