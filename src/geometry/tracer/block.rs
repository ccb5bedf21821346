//! Up to eight polygons side by side, tested at once in f32 with a bound on what rounding can have done.
//!
//! In affine coordinates u, v of its plane a triangle is 0 ≤ u, 0 ≤ v, u + v ≤ 1, and a parallelogram 0 ≤ u, v ≤ 1; any other
//! polygon lies in such a parallelogram. With the plane n·p + c = 0 (n a unit vector) and u = nᵤ·p + cᵤ, a line o + t d meets the
//! plane at t = −(n·o + c)/(n·d), and there
//!
//! ```text
//! u · n·d = (nᵤ·o + cᵤ) (n·d) − (n·o + c) (nᵤ·d),
//! ```
//!
//! so that no division is needed to compare u with 0 and 1. Let all polygons lie within 1 of the coordinates' origin,
//! R = |o| + 1, and ε = 2⁻²⁴. Rounding data to f32 and four rounded operations err by at most 6ε|nᵤ|R in nᵤ·o + cᵤ and in n·o + c, and
//! by 5ε|nᵤ||d| in products with d; so 28ε|nᵤ|R|d| in u·n·d, 36ε(|nᵤ| + |nᵥ| + 1)R|d| in every difference that is compared, those of t
//! included as long as t|d| ≤ 2R. [`DOUBT`] leaves room for what f64 rounds off before.

use super::eight::Eight;
use super::local::LocalRay;
use crate::geometry::Vec3;
use pulp::{f32x8, u32x8};

/// Rounding of a comparison over (|nᵤ| + |nᵥ| + 1) R |d|: forty f32 roundings.
const DOUBT: f32 = 40.0 * (0.5 * f32::EPSILON);

/// |nᵤ| + |nᵥ| above which a lane's test would be of no use.
const THINNEST: f64 = 1e9;

/// Lanes of polygons.
#[derive(Clone)]
#[repr(C, align(64))]
pub(super) struct Block {
    normal: [f32x8; 3],
    offset: f32x8,
    u_normal: [f32x8; 3],
    u_offset: f32x8,
    v_normal: [f32x8; 3],
    v_offset: f32x8,
    /// 1 for triangles, 0 for parallelograms.
    shear: f32x8,
    /// What rounding can do to a comparison, over R |d|; below zero where there is no polygon.
    doubt: f32x8,
    /// Planes of the polygons.
    planes: u32x8,
    /// Number of the first polygon; the others follow.
    pub first: u32,
    pub n_polygons: u32,
    /// Bit k is set if polygon k is a triangle or a parallelogram: what passes its test surely passes through it.
    outlined: u32,
}

/// Lanes of a block: bit k is lane k.
#[derive(Clone, Copy)]
pub(super) struct Candidates {
    /// May be met.
    pub possible: u32,
    /// Of these, surely met.
    pub inside: u32,
}

/// A ray, eight times.
pub(super) struct LaneRay {
    origin: [f32x8; 3],
    direction: [f32x8; 3],
    t_max: f32x8,
    /// R |d|, and what f64 rounding adds.
    doubt: f32x8,
}

impl LaneRay {
    #[inline(always)]
    pub fn new(simd: impl Eight, ray: &LocalRay) -> Self {
        Self {
            origin: simd.splat3(ray.origin),
            direction: simd.splat3(ray.direction),
            t_max: simd.splat_f32s(ray.t_max),
            doubt: simd.splat_f32s(ray.doubt),
        }
    }

    #[inline(always)]
    pub fn shorten(&mut self, simd: impl Eight, t_max: f32) {
        self.t_max = simd.splat_f32s(t_max);
    }
}

impl Block {
    /// A block of at most eight polygons, given as corners in coordinates where all lie within 1 of the origin, unit normal, and plane.
    pub fn new(first: u32, polygons: impl Iterator<Item = (Vec<Vec3>, Vec3, u32)>) -> Self {
        let mut lanes = [Lane::EMPTY; 8];
        let mut planes = [u32::MAX; 8];
        let (mut n_polygons, mut outlined) = (0, 0);
        for (corners, normal, plane) in polygons {
            lanes[n_polygons] = Lane::of(&corners, normal);
            planes[n_polygons] = plane;
            outlined |= u32::from(lanes[n_polygons].outlined) << n_polygons;
            n_polygons += 1;
        }
        let gather =
            |value: &dyn Fn(&Lane) -> f64| -> f32x8 { pulp::cast(lanes.each_ref().map(|lane| value(lane) as f32)) };
        let vectors = |value: &dyn Fn(&Lane) -> Vec3| [0, 1, 2].map(|axis| gather(&|lane| value(lane)[axis]));
        Self {
            normal: vectors(&|lane| lane.plane.0),
            offset: gather(&|lane| lane.plane.1),
            u_normal: vectors(&|lane| lane.u.0),
            u_offset: gather(&|lane| lane.u.1),
            v_normal: vectors(&|lane| lane.v.0),
            v_offset: gather(&|lane| lane.v.1),
            shear: gather(&|lane| lane.shear),
            doubt: gather(&|lane| lane.doubt),
            planes: pulp::cast(planes),
            first,
            n_polygons: n_polygons as u32,
            outlined,
        }
    }

    /// The polygons, but for those in one of the planes `without`, that the ray may meet at 0 < t ≤ t_max: no other does.
    #[inline(always)]
    pub fn candidates<const N: usize>(&self, simd: impl Eight, ray: &LaneRay, without: [u32; N]) -> Candidates {
        let approach = simd.dot(&self.normal, &ray.direction);
        let height = simd.turn(simd.dot_add(&self.normal, &ray.origin, self.offset), approach);
        let steep = simd.abs_f32s(approach);
        let (u_start, u_change) =
            (simd.dot_add(&self.u_normal, &ray.origin, self.u_offset), simd.dot(&self.u_normal, &ray.direction));
        let (v_start, v_change) =
            (simd.dot_add(&self.v_normal, &ray.origin, self.v_offset), simd.dot(&self.v_normal, &ray.direction));
        let u = simd.negate_mul_add_e_f32s(height, u_change, simd.mul_f32s(u_start, steep));
        let v = simd.negate_mul_add_e_f32s(height, v_change, simd.mul_f32s(v_start, steep));

        // The least of everything that must not be negative.
        let far = simd.max_f32s(simd.mul_add_e_f32s(self.shear, v, u), simd.mul_add_e_f32s(self.shear, u, v));
        let margin = simd.min_f32s(simd.min_f32s(u, v), simd.sub_f32s(steep, far));
        let ahead = simd.min_f32s(simd.neg_f32s(height), simd.mul_add_e_f32s(ray.t_max, steep, height));
        let margin = simd.min_f32s(margin, ahead);
        let doubt = simd.mul_f32s(self.doubt, ray.doubt);
        let mut miss = simd.signs(simd.add_f32s(margin, doubt));
        for plane in without {
            miss |= simd.equals(self.planes, plane);
        }
        let possible = !miss & 0xff;
        let inside = !simd.signs(simd.sub_f32s(margin, doubt)) & possible & self.outlined;
        Candidates { possible, inside }
    }
}

/// A linear function of position: normal and offset.
type Linear = (Vec3, f64);

/// What a block keeps of one polygon.
#[derive(Clone, Copy)]
struct Lane {
    plane: Linear,
    u: Linear,
    v: Linear,
    shear: f64,
    doubt: f64,
    outlined: bool,
}

impl Lane {
    const ZERO: Linear = (Vec3::ZERO, 0.0);

    /// Never met.
    const EMPTY: Self =
        Self { plane: Self::ZERO, u: Self::ZERO, v: Self::ZERO, shear: 0.0, doubt: -1.0, outlined: false };

    /// Always doubtful: for polygons too thin for f32.
    const DOUBTFUL: Self = Self { doubt: 1.0, ..Self::EMPTY };

    fn of(corners: &[Vec3], normal: Vec3) -> Self {
        let [start, next, .., last] = corners else { return Self::DOUBTFUL };
        let (mut start, mut along, mut up, mut shear, mut outlined) =
            (*start, *next - *start, *last - *start, 1.0, true);
        if corners.len() > 3 {
            let fourth = start + along + up;
            // A corner off by a hundredth of an f32 rounding changes nothing.
            shear = 0.0;
            outlined = corners.len() == 4 && corners[2].distance(fourth) <= 1e-9;
            if !outlined {
                (start, along, up) = around(corners, normal);
            }
        }
        let area = along.cross(up).dot(normal);
        let (u, v) = (up.cross(normal) / area, normal.cross(along) / area);
        let size = u.length() + v.length();
        if size.is_nan() || size > THINNEST {
            return Self::DOUBTFUL;
        }
        Self {
            plane: (normal, -normal.dot(start)),
            u: (u, -u.dot(start)),
            v: (v, -v.dot(start)),
            shear,
            doubt: f64::from(DOUBT) * (size + 1.0),
            outlined,
        }
    }
}

/// The rectangle along the polygon's longest edge that holds it: a corner and two sides.
fn around(corners: &[Vec3], normal: Vec3) -> (Vec3, Vec3, Vec3) {
    let edge = |k: usize| corners[(k + 1) % corners.len()] - corners[k];
    let longest = (0..corners.len()).map(edge).max_by(|p, q| p.length_squared().total_cmp(&q.length_squared()));
    let x = longest.unwrap_or(Vec3::X).normalize_or_zero();
    let y = normal.cross(x);
    let range = |axis: Vec3| {
        let along = corners.iter().map(|v| axis.dot(*v - corners[0]));
        along.fold((0.0, 0.0), |(low, high): (f64, f64), value| (low.min(value), high.max(value)))
    };
    let ((x_low, x_high), (y_low, y_high)) = (range(x), range(y));
    (corners[0] + x_low * x + y_low * y, (x_high - x_low) * x, (y_high - y_low) * y)
}
