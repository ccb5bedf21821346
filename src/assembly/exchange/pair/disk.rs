//! The form factor of a disk seen from a point, in closed form.
//!
//! ```text
//! F = (1/2π) ∮ n·(dv × v) / v²,    v(φ) = d + R (e₁ cosφ + e₂ sinφ),    v² = D + E cosφ
//! ```
//!
//! around what is above the receiver's horizon: the whole circle, or an arc of it and its chord. e₁ points away from the
//! receiver in the disk's plane; D = z² + a² + R² and E = 2aR, z the receiver's height above that plane and a its distance from
//! the axis. Source: contour integral of Sparrow (1963) for a differential receiver; whole disks agree with Howell's catalogue,
//! B-11 to B-14.

use crate::geometry::{Frame, Vec3};
use std::f64::consts::TAU;

/// F from a point with this unit normal to the front of a disk, zero where the point is behind the disk or in its plane. Whole
/// disks are right to some ulp; where the horizon cuts the disk, to some 1e-16. Nothing is looked for that might stand between.
/// Cost O(1).
pub fn point_to_disk(point: Vec3, normal: Vec3, centre: Vec3, disk_normal: Vec3, radius: f64) -> f64 {
    let to_centre = centre - point;
    let z = -to_centre.dot(disk_normal);
    if z <= 0.0 {
        return 0.0;
    }
    // Turn the first axis of the disk away from the point.
    let beside = to_centre + z * disk_normal;
    let a = beside.length();
    let e1 = if a > 0.0 { beside / a } else { Frame::about(disk_normal).x };
    let e2 = disk_normal.cross(e1);
    let seen = Seen { z, a, radius, cosines: Vec3::new(normal.dot(e1), normal.dot(e2), normal.dot(disk_normal)) };

    // See how the horizon lies to the circle.
    let [across, swing] = [normal.dot(to_centre), radius * seen.cosines.x.hypot(seen.cosines.y)];
    if across >= swing {
        return seen.whole();
    }
    if across <= -swing {
        return 0.0;
    }
    let (middle, half) = (seen.cosines.y.atan2(seen.cosines.x), (-across / swing).acos());
    let [from, to] = [middle - half, middle + half];
    let end = |phi: f64| to_centre + radius * (phi.cos() * e1 + phi.sin() * e2);
    let (start, stop) = (end(from), end(to));
    let chord = start.cross(stop);
    let angle = chord.length().atan2(start.dot(stop)) * normal.dot(chord).signum();
    ((seen.along(from, to) + angle) / TAU).max(0.0)
}

/// A circle as the receiver sees it; the cosines are the receiver's normal along e₁, e₂ and the disk's normal.
struct Seen {
    z: f64,
    a: f64,
    radius: f64,
    cosines: Vec3,
}

impl Seen {
    /// D, E and √(D² − E²).
    fn letters(&self) -> (f64, f64, f64) {
        let (z, a, r) = (self.z, self.a, self.radius);
        let w = (z.hypot(a - r)) * (z.hypot(a + r));
        (z * z + a * a + r * r, 2.0 * a * r, w)
    }

    /// F of the whole disk. The part along the disk's normal is ½ (1 − Q/w), Q = z² + a² − R²; where that cancels, w² − Q² =
    /// 4z²R².
    fn whole(&self) -> f64 {
        let (z, a, r) = (self.z, self.a, self.radius);
        let (d, _, w) = self.letters();
        let q = z * z + a * a - r * r;
        let axial = if q > 0.0 { 2.0 * (z * r).powi(2) / (w * (w + q)) } else { 0.5 * (w - q) / w };
        let radial = 2.0 * a * z * r * r / (w * (w + d));
        (radial * self.cosines.x - axial * self.cosines.z).max(0.0)
    }

    /// ∫ n·(dv × v)/v² along an arc: the elementary integrals of 1, cosφ and sinφ over D + E cosφ, in forms that stand E = 0.
    fn along(&self, from: f64, to: f64) -> f64 {
        let (z, a, r) = (self.z, self.a, self.radius);
        let (d, e, w) = self.letters();
        let q = e / (d + w);
        let bend = |phi: f64| {
            let y = q * phi.sin() / (1.0 + q * phi.cos());
            let ratio = if y == 0.0 { 1.0 } else { y.atan() / y };
            (y.atan(), ratio * phi.sin() / ((1.0 + q * phi.cos()) * (d + w)))
        };
        let ((angle_from, share_from), (angle_to, share_to)) = (bend(from), bend(to));
        let one = (to - from - 2.0 * (angle_to - angle_from)) / w;
        let cosine = (2.0 * d * (share_to - share_from) - q * (to - from)) / w;
        let start = d + e * from.cos();
        let change = e * (to.cos() - from.cos()) / start;
        let ratio = if change == 0.0 { 1.0 } else { change.ln_1p() / change };
        let sine = -ratio * (to.cos() - from.cos()) / start;
        let n = self.cosines;
        -(r * r * n.z * one + r * (z * n.x + a * n.z) * cosine + r * z * n.y * sine)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assembly::point_factor;
    use crate::geometry::Polygon;
    use crate::sampling::Stream;

    /// Disks about the z axis, facing down; the cases `element_disk` of the reference collection, rounded to f64.
    #[test]
    fn whole_disks_match_the_catalogue() {
        let cases = [
            ("A-ED-PAR2", [0.0, 0.0, 1.0], 0.0, 0.25, 1.0, 0.9411764705882353),
            ("A-ED-PAR4", [0.0, 0.0, 1.0], 2.0, 1.0, 1.0, 0.05278640450004206),
            ("A-ED-PAR5", [0.0, 0.0, 1.0], 1.0, 2.0, 0.5, 0.03918231243096735),
            ("A-ED-PERP1", [-1.0, 0.0, 0.0], 2.0, 1.0, 1.0, 0.08541019662496846),
            ("A-ED-PERP3", [-1.0, 0.0, 0.0], 4.0, 3.0, 2.0, 0.07462591288588065),
        ];
        for (id, normal, offset, height, radius, expected) in cases {
            let found =
                point_to_disk(Vec3::X * offset, Vec3::from_array(normal), Vec3::Z * height, Vec3::NEG_Z, radius);
            // A dozen operations.
            assert!((found / expected - 1.0).abs() < 8.0 * f64::EPSILON, "{id}: {found} for {expected}");
        }
    }

    /// A polygon between the inscribed and the circumscribed one is as large as the disk to a fourth-order term in its corners.
    #[test]
    fn any_disk_is_the_limit_of_polygons() {
        let n_corners = 2000;
        let step = TAU / f64::from(n_corners);
        let equal_area = (step / step.sin()).sqrt();
        let mut stream = Stream::new(0x6469_736b, 0, 0);
        let mut n_cut = 0;
        for _ in 0..400 {
            let mut point = || Vec3::from_array(std::array::from_fn(|_| 2.0 * stream.uniform() - 1.0));
            let (at, normal, facing) = (2.0 * point(), point().normalize(), point().normalize());
            let radius = 0.2 + point().x.abs();
            let frame = Frame::about(facing);
            let corner = |k: i32| {
                let phi = step * f64::from(k);
                radius * equal_area * (phi.cos() * frame.x + phi.sin() * frame.y)
            };
            let polygon = Polygon::new((0..n_corners).map(corner).collect()).unwrap();
            let (found, expected) =
                (point_to_disk(at, normal, Vec3::ZERO, facing, radius), point_factor(at, normal, &polygon));
            n_cut += usize::from(found > 0.0 && normal.dot(at).abs() < radius);
            // The sides leave the circle by an eighth of a squared step, and by turns to both sides.
            assert!((found - expected).abs() < step * step, "{at} {normal} {facing} {radius}: {found} {expected}");
        }
        assert!(n_cut > 50, "{n_cut}");
    }
}
