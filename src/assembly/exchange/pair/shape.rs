//! A polygon as quadrature sees it: in coordinates of its own, so that no digit is lost far from the origin.

use super::double::Double;
use super::grid::Group;
use super::real::{Real, Vector};
use crate::geometry::Vec3;
use pulp::Simd;

/// A polygon relative to its first corner, its normal and areas right to the last bit even where it is a sliver.
pub struct Shape {
    pub corners: Vec<Vec3>,
    pub centre: Vec3,
    pub radius: f64,
    pub area: f64,
    pub perimeter: f64,
    pub normal: Vec3,
    pub exact_normal: Vector<Double>,
    pub cells: Vec<Cell>,
    /// Whether areas vary along s and along t, which costs a rule a degree.
    pub is_uneven: [bool; 2],
}

/// A bilinear quadrilateral: x = origin + s p + t q + s t r, and dA = (a₀ + s a₁ + t a₂) ds dt.
pub struct Cell {
    pub origin: Vec3,
    /// p, q, r.
    pub spans: [Vec3; 3],
    /// a₀, a₁, a₂.
    pub areas: [f64; 3],
    pub centre: Vec3,
    /// Along s and along t.
    pub axes: [Axis; 2],
}

/// The lines of a cell along one of its coordinates.
pub struct Axis {
    /// Half the length of the longest.
    pub half_length: f64,
    /// How far from the cell's centre their middles are, at most: along them, and beside.
    pub offsets: [f64; 2],
    /// Whether the area varies along them.
    pub is_uneven: bool,
}

impl Shape {
    /// The corners are relative to the first. Where they span no area there is no point of it either.
    pub fn new(corners: &[Vector<Double>]) -> Self {
        let nought = Double::default();
        let normal = Self::normal_of(corners).unwrap_or(Vector { x: nought, y: nought, z: nought });
        let origin = corners[0];

        // Triangles are collapsed squares; polygons of more than four corners are fans of triangles.
        let cells: Vec<Cell> = match *corners {
            [a, b, c, d] => vec![Cell::new([a, b, c, d], normal)],
            _ => corners[1..].windows(2).map(|pair| Cell::new([origin, pair[0], pair[1], origin], normal)).collect(),
        };
        let rounded: Vec<Vec3> = corners.iter().map(|v| point(*v)).collect();
        let centre = rounded.iter().sum::<Vec3>() / rounded.len() as f64;
        let edges = (0..rounded.len()).map(|k| rounded[(k + 1) % rounded.len()] - rounded[k]);
        Self {
            centre,
            radius: rounded.iter().map(|v| v.distance(centre)).fold(0.0, f64::max),
            area: cells.iter().map(|cell| cell.areas[0] + 0.5 * (cell.areas[1] + cell.areas[2])).sum(),
            perimeter: edges.map(Vec3::length).sum(),
            normal: point(normal),
            exact_normal: normal,
            is_uneven: [0, 1].map(|k| cells.iter().any(|cell| cell.axes[k].is_uneven)),
            cells,
            corners: rounded,
        }
    }

    /// The unit normal of a polygon, in double-double; `None` where it has no area.
    pub fn normal_of(corners: &[Vector<Double>]) -> Option<Vector<Double>> {
        // Sum the fan of triangles.
        let origin = *corners.first()?;
        let nought = Vector { x: Double::default(), y: Double::default(), z: Double::default() };
        let fan = corners[1..].windows(2).map(|pair| (pair[0] - origin, pair[1] - origin));
        let area = fan.fold(nought, |sum, (a, b)| sum + a.cross(b));
        let twice_area = area.length();
        (twice_area.value() > 0.0).then(|| area.scaled(Double::from(1.0) / twice_area))
    }
}

impl Cell {
    fn new([a, b, c, d]: [Vector<Double>; 4], normal: Vector<Double>) -> Self {
        let [p, q] = [b - a, d - a];
        let r = (c - d) - p;
        let area = |u: Vector<Double>, v: Vector<Double>| u.cross(v).dot(normal).value();
        let areas @ [even, along, across] = [area(p, q), area(p, r), area(r, q)];
        let [origin, p, q, r] = [a, p, q, r].map(point);
        let axis = |span: Vec3, other: Vec3, change: f64, side: f64| {
            let (to_middle, middle) = (0.5 * other + 0.25 * r, (span + 0.5 * r).normalize_or_zero());
            Axis {
                half_length: 0.5 * span.length().max((span + r).length()),
                offsets: [to_middle.dot(middle).abs(), to_middle.cross(middle).length()],
                is_uneven: [0.0, side].iter().any(|side| change.abs() > 1e-6 * (2.0 * (even + side) + change)),
            }
        };
        Self {
            origin,
            spans: [p, q, r],
            areas,
            centre: origin + 0.5 * (p + q) + 0.25 * r,
            axes: [axis(p, q, along, across), axis(q, p, across, along)],
        }
    }

    /// Points of a grid laid onto the cell, and their weights by area: some lanes of a group.
    #[inline(always)]
    pub fn lay<S: Simd>(&self, simd: S, [s, t, weight]: &[Group; 3], part: usize) -> (Several<S>, S::f64s) {
        let (s, t, weight) = (lanes::<S>(s, part), lanes::<S>(t, part), lanes::<S>(weight, part));
        let st = simd.mul_f64s(s, t);
        let [p, q, r] = &self.spans;
        let line = Several::splat(simd, self.origin).plus(simd, p, s);
        let at = line.plus(simd, q, t).plus(simd, r, st);
        let [even, along, across] = self.areas;
        let area = simd.mul_add_f64s(simd.splat_f64s(along), s, simd.splat_f64s(even));
        (at, simd.mul_f64s(simd.mul_add_f64s(simd.splat_f64s(across), t, area), weight))
    }
}

/// Points or vectors side by side.
pub struct Several<S: Simd> {
    pub x: S::f64s,
    pub y: S::f64s,
    pub z: S::f64s,
}

impl<S: Simd> Several<S> {
    #[inline(always)]
    pub fn splat(simd: S, v: Vec3) -> Self {
        Self { x: simd.splat_f64s(v.x), y: simd.splat_f64s(v.y), z: simd.splat_f64s(v.z) }
    }

    #[inline(always)]
    pub fn plus(&self, simd: S, v: &Vec3, times: S::f64s) -> Self {
        Self {
            x: simd.mul_add_f64s(simd.splat_f64s(v.x), times, self.x),
            y: simd.mul_add_f64s(simd.splat_f64s(v.y), times, self.y),
            z: simd.mul_add_f64s(simd.splat_f64s(v.z), times, self.z),
        }
    }

    #[inline(always)]
    pub fn minus(&self, simd: S, other: &Self) -> Self {
        Self { x: simd.sub_f64s(self.x, other.x), y: simd.sub_f64s(self.y, other.y), z: simd.sub_f64s(self.z, other.z) }
    }

    #[inline(always)]
    pub fn dot(&self, simd: S, other: &Self) -> S::f64s {
        let xy = simd.mul_add_f64s(self.y, other.y, simd.mul_f64s(self.x, other.x));
        simd.mul_add_f64s(self.z, other.z, xy)
    }

    #[inline(always)]
    pub fn cross(&self, simd: S, other: &Self) -> Self {
        Self {
            x: simd.negate_mul_add_f64s(self.z, other.y, simd.mul_f64s(self.y, other.z)),
            y: simd.negate_mul_add_f64s(self.x, other.z, simd.mul_f64s(self.z, other.x)),
            z: simd.negate_mul_add_f64s(self.y, other.x, simd.mul_f64s(self.x, other.y)),
        }
    }
}

/// Some lanes of a group.
#[inline(always)]
pub fn lanes<S: Simd>(group: &Group, part: usize) -> S::f64s {
    S::as_simd_f64s(group).0[part]
}

/// The nearest point of f64.
pub fn point(v: Vector<Double>) -> Vec3 {
    Vec3::new(v.x.value(), v.y.value(), v.z.value())
}
