//! A sphere that stands between two coaxial surfaces of revolution, as polygons.
//!
//! What it hides is settled by the lines that graze it from one surface to the other. They touch it where its tangent plane meets both, so its
//! rings are laid there and nowhere else: a point below all tangent planes of a cap sees nothing of it, and no line from there enters through
//! it. Along the polar angle θ the measure of those lines bends at some angles, in which rings end: sums over rings then run in the
//! powers of their width.

use super::revolution::{arc, joined};
use std::f64::consts::{PI, TAU};

/// Parts between bends are not narrower: each has a ring a level, and shadows of many rings are dear.
const NARROW: f64 = 0.5;

/// A ring narrower than this is none.
const NOTHING: f64 = 1e-9;

/// A sphere about the origin, and at which polar angles, from the +z axis, its rings begin and end.
#[derive(Clone, Debug)]
pub struct Blocker {
    radius: f64,
    ends: Vec<f64>,
}

/// A circle about the z axis as points of the sphere see it.
#[derive(Clone, Copy, Debug)]
struct Rim {
    radius: f64,
    height: f64,
    /// Polar angle of its points.
    bearing: f64,
    /// Its points see the cap of the sphere within this angle of their own.
    reach: f64,
    /// Length of its tangents to the sphere.
    tangent: f64,
}

impl Rim {
    /// Points on the sphere or in it see none of it.
    fn new([radius, height]: [f64; 2], sphere: f64) -> Self {
        let distance = radius.hypot(height).max(sphere);
        let tangent = (distance * distance - sphere * sphere).sqrt();
        Self { radius, height, bearing: radius.atan2(height), reach: (sphere / distance).acos(), tangent }
    }

    /// Polar angles at which tangent planes touch it: between them they cut it.
    fn touched(&self) -> [f64; 2] {
        [(self.bearing - self.reach).abs(), (self.bearing + self.reach).min(TAU - self.bearing - self.reach)]
    }
}

impl Blocker {
    /// Two surfaces are given by the ends, (radius, height), of their profiles: disks, annuli, zones of a sphere about the origin.
    pub fn new(radius: f64, surfaces: [[[f64; 2]; 2]; 2]) -> Self {
        let rims = surfaces.map(|ends| ends.map(|end| Rim::new(end, radius)));

        // Lay rings where tangent planes meet both surfaces.
        let (mut from, mut to) = (0.0f64, PI);
        for [one, two] in rims {
            from = from.max((one.bearing - one.reach).min(two.bearing - two.reach));
            to = to.min((one.bearing + one.reach).max(two.bearing + two.reach));
        }
        if to - from < NOTHING {
            // No line grazes it: it hides all or nothing.
            return Self { radius, ends: vec![0.0, PI] };
        }

        // End them where tangent planes begin to cut a surface, and where lines that graze the sphere touch two rims.
        let is_round = |rim: &&Rim| rim.radius > 0.0;
        let mut bends: Vec<f64> = rims.iter().flatten().filter(is_round).flat_map(Rim::touched).collect();
        for one in rims[0].iter().filter(is_round) {
            bends.extend(rims[1].iter().filter(is_round).filter_map(|two| touching_both(radius, one, two)));
        }
        bends.sort_by(f64::total_cmp);
        let mut ends = vec![from];
        for bend in bends {
            if bend > ends[ends.len() - 1] + NARROW && bend < to - NARROW {
                ends.push(bend);
            }
        }
        ends.push(to);
        Self { radius, ends }
    }

    /// Its closed profile: so many rings for every part, as a function of the part's angle, and a pyramid on either pole.
    ///
    /// Pyramids hide no more than the sphere; flat caps would have as many corners as there are sectors, and shadows of faces cost by them.
    pub fn profile(&self, n_rings: impl Fn(f64) -> usize) -> Vec<[f64; 2]> {
        let parts = self.ends.windows(2).map(|pair| arc(self.radius, [pair[0], pair[1]], n_rings(pair[1] - pair[0])));
        let (from, to) = (self.ends.first(), self.ends.last());
        let north = from.filter(|from| **from > 0.0).map(|from| arc(self.radius, [0.0, *from], 1));
        let south = to.filter(|to| **to < PI).map(|to| arc(self.radius, [*to, PI], 1));
        joined(north.into_iter().chain(parts).chain(south))
    }
}

/// The polar angle of the point in which a line that touches both rims grazes the sphere, between them, if there is one.
///
/// The line makes the angle α with the meridian: with t the tangent's length from a rim at height z, t cos α = |z − R cos θ| / sin θ. The
/// same α on both sides of the point leaves t₁ (z₂ − R cos θ) = t₂ (R cos θ − z₁).
fn touching_both(radius: f64, one: &Rim, two: &Rim) -> Option<f64> {
    let cosine = (one.tangent * two.height + two.tangent * one.height) / (radius * (one.tangent + two.tangent));
    let angle = (cosine.abs() < 1.0).then(|| cosine.acos())?;
    ((one.height - radius * cosine).abs() <= one.tangent * angle.sin()).then_some(angle)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Between equal disks all is symmetric: grazing lines touch both rims at the equator.
    #[test]
    fn rings_end_where_lines_touch_both_rims() {
        let disk = |height: f64| [[0.0, height], [1.0, height]];
        let blocker = Blocker::new(0.2, [disk(1.0), disk(-1.0)]);
        // A rim sees the sphere down to bearing + reach, π/4 + acos(0.2 / √2).
        let low = 0.25 * PI + 0.02f64.sqrt().acos();
        let expected = [PI - low, 0.5 * PI, low];
        assert_eq!(blocker.ends.len(), expected.len());
        assert!(blocker.ends.iter().zip(expected).all(|(end, expected)| (end - expected).abs() < 1e-12), "{blocker:?}");
        // Poles close it.
        let profile = blocker.profile(|_| 1);
        assert_eq!((profile.len(), profile[0][0], profile[4][0]), (5, 0.0, 0.0));
    }

    #[test]
    fn what_hides_everything_is_a_whole_sphere() {
        let zone = |from: f64, to: f64| [from, to].map(|degrees| degrees.to_radians().sin_cos()).map(|(s, c)| [s, c]);
        let blocker = Blocker::new(0.5, [zone(0.0, 20.0), zone(160.0, 180.0)]);
        assert_eq!(blocker.ends, [0.0, PI]);
    }
}
