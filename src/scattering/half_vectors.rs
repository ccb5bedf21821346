//! Quadrature over half vectors: directional albedos of surfaces whose lobe is a function of the half vector's slope.
//!
//! With the small normal's slope p = (−m_x/m_z, −m_y/m_z) and the outgoing direction o, light comes from i = 2(o·m)m − o. It comes from
//! above the horizon, i_z > 0, exactly if 2(o_z − o_xy·p) > o_z (1 + p²), which is
//!
//! ```text
//! |p + o_xy/o_z| < 1/o_z:      a disk, which holds p = 0
//! f cosθᵢ dωᵢ = f i_z 4(o·m) dω_m,   dω_m = m_z³ dp,   o·m = m_z (o_z − o_xy·p)
//! ```
//!
//! (for D G₂ F/(4 o_z i_z) that is P(p) G₂ F (o_z − o_xy·p)/o_z dp). In polar coordinates p = (α_x r cosφ, α_y r sinφ) the rim lies at
//! the positive root of |p|² + 2 p·o_xy/o_z = 1, and everything is analytic: in r = sinh τ where the lobe falls as a power, in r itself where
//! it falls as a Gaussian. Gauss' rule then converges exponentially. Only where the rim passes from one side of the lobe to the
//! other, near the azimuths at right angles to o, does it bend sharply, over an angle δ ∝ 1/tanθ, and along the axis of lesser roughness,
//! over δ = α_x/α_y: there φ = φ₀ + δ sinh s.

use super::microfacet::GAUSSIAN_REACH;
use super::quadrature::{Quadrature, SIZES, doubled, rule};
use crate::geometry::Vec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// How a lobe falls off with the slope, in units of its roughness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Tail {
    /// exp(−r²)
    Gaussian,
    /// A power of 1 + r².
    Algebraic,
}

/// Roughness along both axes, and how the lobe falls off.
pub(super) type Lobe = ([f64; 2], Tail);

/// Which small mirrors count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Rim {
    /// Those that mirror the outgoing direction above the horizon.
    Mirrored,
    /// Those that face it: p·o_xy < o_z.
    Facing,
}

/// One small mirror.
pub(super) struct Facet {
    pub normal: Vec3,
    /// Where the light comes from that it mirrors toward the outgoing direction.
    pub incident: Vec3,
    /// m_z
    pub cosine: f64,
    /// o·m
    pub facing: f64,
    /// r²
    pub r_squared: f64,
}

/// Slopes beyond this many α carry 1e-12 of the light under GGX.
const ALGEBRAIC_REACH: f64 = 1e12;
/// The width, in radians, of a bend that is none.
const WIDEST: f64 = 10.0;
/// Where the slopes of a half plane are integrated for a table, a few more digits than can be seen are enough.
const N_TABLE_LEVELS: usize = 4;

/// ∫ g dp over the slopes within the rim, for a lobe of roughness `alpha` and an outgoing direction above the horizon.
///
/// Cost: 12² evaluations of g for a half of the circle, four times as many for each doubling; commonly two or three doublings.
pub(super) fn integrate(outgoing: Vec3, lobe: Lobe, rim: Rim, g: impl Fn(&Facet) -> f64) -> Quadrature {
    let n_levels = match rim {
        Rim::Mirrored => SIZES.len(),
        Rim::Facing => N_TABLE_LEVELS,
    };
    doubled(n_levels, |level| with_rule(outgoing, lobe, rim, level, &g))
}

fn with_rule(outgoing: Vec3, (alpha, tail): Lobe, rim: Rim, level: usize, g: &impl Fn(&Facet) -> f64) -> f64 {
    let [ax, ay] = alpha;
    let (tx, ty) = (outgoing.x / outgoing.z, outgoing.y / outgoing.z);
    let mut sum = 0.0;
    for arc in arcs(alpha, [tx, ty], rim) {
        for (u, weight_u) in rule(level) {
            let (angle, stretch) = arc.at(*u);
            let (sin, cos) = angle.sin_cos();
            let (ux, uy) = (ax * cos, ay * sin);

            // The rim: the positive root of u² r² + 2 t·u r − 1.
            let (square, cross) = (ux * ux + uy * uy, tx * ux + ty * uy);
            let root = (cross * cross + square).sqrt();
            let last = match rim {
                Rim::Mirrored if cross > 0.0 => 1.0 / (cross + root),
                Rim::Mirrored => (root - cross) / square,
                Rim::Facing => 1.0 / cross.max(0.0),
            };
            let end = match tail {
                Tail::Algebraic => last.min(ALGEBRAIC_REACH).asinh(),
                Tail::Gaussian => last.min(GAUSSIAN_REACH),
            };

            let mut line = 0.0;
            for (v, weight_v) in rule(level) {
                let x = end * v;
                let (r, slope) = match tail {
                    Tail::Algebraic => (x.sinh(), x.cosh()),
                    Tail::Gaussian => (x, 1.0),
                };
                let (px, py) = (r * ux, r * uy);
                let lift = 1.0 / (1.0 + px * px + py * py).sqrt();
                let normal = Vec3::new(-px * lift, -py * lift, lift);
                let facing = lift * outgoing.z * (1.0 - r * cross);
                let incident = 2.0 * facing * normal - outgoing;
                if incident.z > 0.0 || rim == Rim::Facing {
                    line += weight_v
                        * end
                        * slope
                        * r
                        * g(&Facet { normal, incident, cosine: lift, facing, r_squared: r * r });
                }
            }
            sum += weight_u * stretch * line;
        }
    }
    sum * ax * ay
}

/// A piece of the circle of azimuths, φ = focus + width sinh s, with nodes crowded about its focus.
struct Arc {
    focus: f64,
    width: f64,
    /// Range of s.
    range: [f64; 2],
    /// How many such arcs it stands for.
    weight: f64,
}

impl Arc {
    /// The angle at a fraction of the range, and its derivative.
    fn at(&self, fraction: f64) -> (f64, f64) {
        let [low, high] = self.range;
        let s = low + (high - low) * fraction;
        (self.focus + self.width * s.sinh(), self.weight * (high - low) * self.width * s.cosh())
    }
}

/// Cuts the circle into arcs about the azimuths where the rim bends sharply: at right angles to the outgoing direction (t is its tangent),
/// and, where the roughness differs, along the axis of the lesser one.
fn arcs([ax, ay]: [f64; 2], [tx, ty]: [f64; 2], rim: Rim) -> Vec<Arc> {
    let toward = (ay * ty).atan2(ax * tx);
    let across = toward + FRAC_PI_2;
    let bend = ((ax * across.cos()).hypot(ay * across.sin()) / (ax * tx).hypot(ay * ty)).min(WIDEST);

    // A half circle serves for both, if the lobe is isotropic.
    if ax == ay {
        let reach = (FRAC_PI_2 / bend).asinh();
        let arc = |range| Arc { focus: across, width: bend, range, weight: 2.0 };
        return match rim {
            Rim::Mirrored => vec![arc([-reach, reach])],
            // A half plane has no rim on one side.
            Rim::Facing => vec![arc([-reach, 0.0]), arc([0.0, reach])],
        };
    }

    // Else cut midway between the four, and let none be wider than another is near.
    let (lesser, ratio) = if ax < ay { (0.0, ax / ay) } else { (FRAC_PI_2, ay / ax) };
    let mut foci = [(across, bend), (across + PI, bend), (lesser, ratio), (lesser + PI, ratio)];
    foci.iter_mut().for_each(|focus| focus.0 = focus.0.rem_euclid(TAU));
    foci.sort_by(|a, b| a.0.total_cmp(&b.0));
    let distance = |a: f64, b: f64| (a - b).abs().min(TAU - (a - b).abs());
    let mut arcs = Vec::with_capacity(2 * foci.len());
    for (k, &(focus, _)) in foci.iter().enumerate() {
        let width = foci.iter().map(|(other, width)| width + distance(focus, *other)).fold(WIDEST, f64::min);
        let next = foci[(k + 1) % foci.len()].0;
        let before = foci[(k + foci.len() - 1) % foci.len()].0;
        let reach = |gap: f64| (0.5 * gap.rem_euclid(TAU) / width).asinh();
        arcs.push(Arc { focus, width, range: [-reach(focus - before), 0.0], weight: 1.0 });
        arcs.push(Arc { focus, width, range: [0.0, reach(next - focus)], weight: 1.0 });
    }
    arcs
}
