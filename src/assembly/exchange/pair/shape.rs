//! A polygon as quadrature sees it: in coordinates of its own, so that no digit is lost far from the origin.

use super::double::Double;
use super::product::Points;
use super::real::{Real, Vector};
use super::rules::Rule;
use crate::geometry::Vec3;

/// A polygon relative to its first corner, its normal and areas right to the last bit even where it is a sliver.
pub struct Shape {
    pub centre: Vec3,
    pub radius: f64,
    pub normal: Vec3,
    pub exact_normal: Vector<Double>,
    cells: Vec<Cell>,
}

/// A bilinear quadrilateral, its corners and what an element of its unit square is worth there.
struct Cell {
    corners: [Vec3; 4],
    areas: [f64; 4],
}

impl Shape {
    /// The corners are relative to the first. Where they span no area there is no point of it either.
    pub fn new(corners: &[Vector<Double>]) -> Self {
        let nought = Double::default();
        let normal = Self::normal_of(corners).unwrap_or(Vector { x: nought, y: nought, z: nought });
        let origin = corners[0];

        // Triangles are collapsed squares; polygons of more than four corners are fans of triangles.
        let cell = |quad: [Vector<Double>; 4]| {
            let area = |k: usize| {
                let [before, here, after] = [quad[(k + 3) % 4], quad[k], quad[(k + 1) % 4]];
                (after - here).cross(before - here).dot(normal).value()
            };
            Cell { corners: quad.map(point), areas: std::array::from_fn(area) }
        };
        let cells: Vec<Cell> = match *corners {
            [a, b, c, d] => vec![cell([a, b, c, d])],
            _ => corners[1..].windows(2).map(|pair| triangle(cell([origin, pair[0], pair[1], origin]))).collect(),
        };
        let centre = corners.iter().map(|v| point(*v)).sum::<Vec3>() / corners.len() as f64;
        let radius = corners.iter().map(|v| point(*v).distance(centre)).fold(0.0, f64::max);
        Self { centre, radius, normal: point(normal), exact_normal: normal, cells }
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

    /// The points of a product rule, weighted by area. An area that varies along an axis costs the rule a degree there: such
    /// cells take `longer` by one point, so that every shape is integrated alike.
    pub fn points(&self, rule: &Rule, longer: &Rule) -> Points {
        let mut points = Points::default();
        for Cell { corners: [a, b, c, d], areas } in &self.cells {
            let varies = |pairs: [[f64; 2]; 2]| pairs.iter().any(|[p, q]| (p - q).abs() > 1e-6 * (p + q));
            let [first, second, third, fourth] = *areas;
            let along = if varies([[first, second], [fourth, third]]) { longer } else { rule };
            let across = if varies([[first, fourth], [second, third]]) { longer } else { rule };
            for (t, wt) in across.nodes.iter().zip(&across.weights) {
                for (s, ws) in along.nodes.iter().zip(&along.weights) {
                    let [near, far] = [1.0 - s, *s];
                    let at = (*a * near + *b * far) * (1.0 - t) + (*d * near + *c * far) * *t;
                    let area = (first * near + second * far) * (1.0 - t) + (fourth * near + third * far) * t;
                    points.push(at, ws * wt * area);
                }
            }
        }
        points
    }
}

/// The square collapsed onto a triangle's first corner: nothing there, and twice the area at the others.
fn triangle(cell: Cell) -> Cell {
    let [_, twice_area, _, _] = cell.areas;
    Cell { areas: [0.0, twice_area, twice_area, 0.0], ..cell }
}

/// The nearest point of f64.
pub fn point(v: Vector<Double>) -> Vec3 {
    Vec3::new(v.x.value(), v.y.value(), v.z.value())
}
