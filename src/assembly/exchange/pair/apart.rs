//! Two polygons in front of each other that may be far enough apart for product Gauss rules.

use super::double::Double;
use super::ladder::{LADDER, Ladder, Nodes};
use super::product::{Plane, Product};
use super::real::{Real, Vector};
use super::shape::{Shape, point};
use crate::geometry::Vec3;
use pulp::Arch;

/// The relative error of n points an axis on a patch with the circumradius r, the other one at the distance q r from its centre
/// or further, is at most CONSTANTS (2q)¹⁻²ⁿ: the ellipse through a pole at q r has half axes that add to 2q, nearly, and
/// heights take one of the 2n degrees. Measured on 2·10⁵ pairs of triangles, parallelograms and other quadrilaterals, slivers
/// and grazing pairs among them: 5, 7, 8, 10, 12, 14, 16, 17, 17 for up to twelve points; at least doubled here.
const CONSTANTS: [f64; LADDER.len()] = [12.0, 16.0, 20.0, 25.0, 30.0, 35.0, 40.0, 40.0, 40.0, 40.0, 40.0];

/// Relative rounding of a sum of positive products, and of a height for each unit of distance over it.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Rounding that is worth double-double heights.
const NOTABLE: f64 = 1e-14;

/// A pair of polygons that are wholly in front of each other's planes.
pub struct Apart<'a> {
    ladder: &'a Ladder,
    nodes: [&'a Nodes; 2],
    /// Of the other polygon, in each one's own coordinates.
    planes: [Plane; 2],
    /// From the coordinates of the second to those of the first.
    shift: Vec3,
    /// Distance from the centre of each to the other over its own radius, at least.
    ratios: [f64; 2],
    /// Relative rounding of the sum.
    rounding: f64,
}

impl<'a> Apart<'a> {
    /// `highest` are the heights of each one's highest corner above the other's plane, `shift` leads from the first's first
    /// corner to the second's.
    pub fn new(ladder: &'a Ladder, nodes: [&'a Nodes; 2], highest: [f64; 2], shift: Vector<Double>) -> Self {
        let [a, b] = nodes.map(|nodes| &nodes.shape);
        let exact_shift = shift;
        let shift = point(shift);
        let mut planes = [
            Plane { normal: b.normal, offset: -b.normal.dot(shift) },
            Plane { normal: a.normal, offset: a.normal.dot(shift) },
        ];
        let distance = (b.centre + shift).distance(a.centre);
        // The other polygon lies in a disk; no point of it is closer to the own centre than the disk.
        let ratio = |plane: &Plane, own: &Shape, other: &Shape| {
            let above = plane.normal.dot(own.centre) + plane.offset;
            let beside = ((distance * distance - above * above).max(0.0).sqrt() - other.radius).max(0.0);
            (above * above + beside * beside).sqrt() / own.radius
        };
        let ratios = [ratio(&planes[0], a, b), ratio(&planes[1], b, a)];
        let reach = distance + a.radius + b.radius;
        let rounding = |reaches: [f64; 2]| ROUNDING * (1.0 + reaches[0] / highest[0] + reaches[1] / highest[1]);
        let mut rounding_left = rounding([reach; 2]);
        if rounding_left > NOTABLE {
            // Low above each other's planes: take the height of one corner exactly; what others differ by is small.
            planes[0].offset = -b.exact_normal.dot(exact_shift).value();
            planes[1].offset = a.exact_normal.dot(exact_shift).value();
            rounding_left = rounding([2.0 * a.radius, 2.0 * b.radius]);
        }
        Self { ladder, nodes, planes, shift, ratios, rounding: rounding_left }
    }

    pub fn arch(&self) -> Arch {
        self.ladder.arch
    }

    /// The shortest rules that leave less than the tolerance, relative to T, if there are any among those up to `most` points
    /// an axis.
    pub fn rungs(&self, tolerance: f64, most: usize) -> Option<[usize; 2]> {
        let allowed = 0.5 * (tolerance - self.rounding);
        let mut shortest = [0; 2];
        for (rung, ratio) in shortest.iter_mut().zip(self.ratios) {
            *rung = (0..LADDER.len()).find(|rung| LADDER[*rung] <= most && truncation(*rung, ratio) <= allowed)?;
        }
        Some(shortest)
    }

    /// T and its error estimate.
    pub fn sum(&self, rungs: [usize; 2]) -> (f64, f64) {
        let points = [0, 1].map(|k| self.ladder.rung(self.nodes[k], rungs[k]));
        let product = Product { points: [&points[0], &points[1]], planes: self.planes, shift: self.shift };
        let value = product.sum(self.ladder.arch);
        let left = truncation(rungs[0], self.ratios[0]) + truncation(rungs[1], self.ratios[1]);
        (value, value * (left + self.rounding))
    }
}

/// Relative error of a rung, at most.
fn truncation(rung: usize, ratio: f64) -> f64 {
    if ratio <= 1.0 {
        return f64::INFINITY;
    }
    CONSTANTS[rung] * (2.0 * ratio).powi(1 - 2 * LADDER[rung] as i32)
}
