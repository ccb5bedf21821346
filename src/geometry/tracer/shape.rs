//! Where a line meets a polygon, in f64, with exact signs at its edges.

use super::Hit;
use crate::geometry::{Ray, Vec3};
use robust::{Coord3D, orient3d};

/// A polygon as the tracer keeps it; its corners are in a list of all corners.
#[derive(Clone)]
pub(super) struct Shape {
    pub id: u32,
    pub plane: u32,
    pub normal: Vec3,
    /// A corner.
    pub anchor: Vec3,
    pub first: u32,
    pub n_corners: u32,
}

impl Shape {
    pub fn corners<'a>(&self, all: &'a [Vec3]) -> &'a [Vec3] {
        &all[self.first as usize..][..self.n_corners as usize]
    }

    /// Where the ray meets the polygon's plane, at 0 < t ≤ `nearest`.
    #[inline]
    pub fn meet_plane(&self, ray: &Ray, nearest: f64) -> Option<Hit> {
        let approach = self.normal.dot(ray.direction);
        let t = self.normal.dot(self.anchor - ray.origin) / approach;
        (t > 0.0 && t <= nearest).then_some(Hit { polygon: self.id as usize, t, front: approach < 0.0 })
    }

    /// Where the ray meets the polygon, at 0 < t ≤ `nearest`.
    #[inline]
    pub fn meet(&self, all: &[Vec3], probe: &Probe, nearest: f64) -> Option<Hit> {
        let corners = self.corners(all);
        let approach = self.normal.dot(probe.ray.direction);
        if approach.abs() > probe.grazing {
            return self.meet_plane(&probe.ray, nearest).filter(|_| probe.passes(corners));
        }
        // Along the plane t has few digits or none: hold it to where the ray passes the polygon's box.
        let (enter, leave) = probe.stay(corners)?;
        let t = self.normal.dot(self.anchor - probe.ray.origin) / approach;
        let t = if t.is_nan() { enter } else { t.clamp(enter, leave) };
        let hit = Hit { polygon: self.id as usize, t, front: approach < 0.0 };
        (t > 0.0 && t <= nearest && probe.passes(corners)).then_some(hit)
    }
}

/// A ray with what its sign tests need.
#[derive(Clone, Copy)]
pub(super) struct Probe {
    ray: Ray,
    /// The direction, lengthened or shortened by a power of two to the size of the scene.
    along: Vec3,
    /// The second point of the ray's line, origin + along: it stands for the direction wherever a sign must be exact.
    beyond: Vec3,
    /// What rounding can have done to along · (a × b), a and b the corners of any polygon of the scene as seen from the origin.
    doubt: f64,
    /// |n · d| up to which rounding can move the point where the ray meets a plane by a millionth of the scene.
    grazing: f64,
    /// What rounding can have done to a coordinate.
    rounding: f64,
}

impl Probe {
    /// A ray among polygons all within `radius` of `centre`.
    pub fn new(ray: &Ray, centre: Vec3, radius: f64) -> Self {
        let largest = |v: Vec3| v.abs().max_element();
        // Stretch the direction exactly, so that the line's second point is rounded no worse than the corners are.
        let reach = radius + largest(ray.origin - centre);
        let along = ray.direction * power_of_two_below(reach / largest(ray.direction));
        let beyond = ray.origin + along;
        // Corners are at most `reach` away, and off by an ulp of their coordinates; `beyond` is off by an ulp of its own.
        let coordinates = reach + largest(centre) + largest(ray.origin);
        let length = largest(along);
        let doubt = 32.0 * f64::EPSILON * reach * (reach * (length + largest(beyond)) + 2.0 * coordinates * length);
        // Polygons are planar to 1e-12 of the scene, or to some ulp of their coordinates.
        let grazing = (1e-6 + 1e-9 * coordinates / radius) * ray.direction.length();
        Self { ray: *ray, along, beyond, doubt, grazing, rounding: 64.0 * f64::EPSILON * coordinates }
    }

    /// The parameters at which the line enters and leaves the box of these corners, grown by rounding.
    #[cold]
    fn stay(&self, corners: &[Vec3]) -> Option<(f64, f64)> {
        let (mut enter, mut leave) = (f64::MIN, f64::MAX);
        for axis in 0..3 {
            let (origin, direction) = (self.ray.origin[axis], self.ray.direction[axis]);
            let bounds = corners.iter().map(|v| v[axis] - origin);
            let (low, high) = bounds.fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)));
            let (low, high) = (low - self.rounding, high + self.rounding);
            if direction == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return None;
                }
                continue;
            }
            let (one, other) = (low / direction, high / direction);
            enter = enter.max(one.min(other));
            leave = leave.min(one.max(other));
        }
        (enter <= leave).then_some((enter, leave))
    }

    /// True if the line passes every edge of the polygon on the same side, or meets it.
    fn passes(&self, corners: &[Vec3]) -> bool {
        let (mut left, mut right) = (false, false);
        let mut from = corners[corners.len() - 1];
        let mut a = from - self.ray.origin;
        for to in corners {
            let b = *to - self.ray.origin;
            let mut side = self.along.dot(a.cross(b));
            if side.abs() <= self.doubt {
                side = self.exact_side(from, *to);
            }
            left |= side > 0.0;
            right |= side < 0.0;
            if left && right {
                return false;
            }
            (from, a) = (*to, b);
        }
        true
    }

    /// The exact sign of d · (a × b): on which side the ray passes the edge; antisymmetric in the edge's ends.
    #[cold]
    fn exact_side(&self, from: Vec3, to: Vec3) -> f64 {
        let coord = |v: Vec3| Coord3D { x: v.x, y: v.y, z: v.z };
        // orient3d(p, q, r, s) is the sign of (p − s) · ((q − s) × (r − s)).
        orient3d(coord(self.beyond), coord(from), coord(to), coord(self.ray.origin))
    }
}

/// The largest power of two not above x, for normal x > 0: x without the digits of its mantissa.
pub(super) fn power_of_two_below(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & f64::INFINITY.to_bits())
}
