//! Two polygons in front of each other that may be far enough apart for Gauss rules.

use super::double::Double;
use super::factor::Factors;
use super::grid::{LANES, MOST};
use super::ladder::{Ladder, Nodes};
use super::product::{Plane, Product};
use super::real::{Real, Vector};
use super::shape::{Shape, point};
use crate::geometry::Vec3;
use pulp::Arch;

/// The relative error of n points along an axis is at most CONSTANTS ρ¹⁻²ⁿ, ρ the sum of half axes of an ellipse without a pole.
/// Measured on 2·10⁴ pairs of triangles, parallelograms and other quadrilaterals, slivers and grazing pairs among them; at least doubled.
const CONSTANTS: [f64; MOST - 1] = {
    let mut constants = [30.0; MOST - 1];
    (constants[0], constants[1], constants[2]) = (5.0, 18.0, 40.0);
    (constants[3], constants[4], constants[5]) = (60.0, 72.0, 60.0);
    constants
};

/// Relative rounding of a sum of positive products, and of a height for each unit of distance over it.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Rounding that is worth double-double heights.
const NOTABLE: f64 = 1e-14;

/// Height over distance from which rounding of coordinates is no more than rounding of T.
const HIGH: f64 = 1e-2;

/// Rounding of the closed form over the size of its terms.
const CANCELLATION: f64 = 0.5 * f64::EPSILON;

/// A pair of polygons that are wholly in front of each other's planes.
pub struct Apart<'a> {
    ladder: &'a Ladder,
    shapes: [&'a Shape; 2],
    /// From the coordinates of the second to those of the first.
    shift: Vec3,
    exact_shift: Vector<Double>,
    /// Of the other polygon, in each one's own coordinates.
    planes: [Plane; 2],
    /// Heights of the centres above those.
    heights: [f64; 2],
    /// Between the centres.
    distance: f64,
    /// What quadrature over either one meets.
    near: [Near; 2],
}

/// What quadrature over a polygon meets of the other.
#[derive(Clone, Copy)]
struct Near {
    /// Along s and t: the sum of half axes of the ellipse about the polygon's lines that no pole is in.
    ellipses: [f64; 2],
    /// From the middle to the other polygon, at least.
    away: f64,
}

/// Points along s and t of a polygon, and what they leave of T, relatively.
#[derive(Clone, Copy, Debug)]
struct Rung {
    n: [usize; 2],
    left: f64,
}

/// How to integrate a pair.
#[derive(Clone, Copy, Debug)]
struct Way {
    kind: Kind,
    /// About the nanoseconds it takes.
    cost: usize,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    /// Over both by points; whether the heights above each other's planes have to be exact.
    Product { rungs: [Rung; 2], is_low: bool },
    /// Over this one by points, over the other in closed form.
    Factors { outer: usize, rung: Rung },
}

impl<'a> Apart<'a> {
    /// `exact_shift` leads from the first's first corner to the second's. `None` where their middles are not in front of each other.
    pub fn new(ladder: &'a Ladder, nodes: [&'a Nodes; 2], exact_shift: Vector<Double>) -> Option<Self> {
        let shapes @ [a, b] = nodes.map(|nodes| &nodes.shape);
        let shift = point(exact_shift);
        let planes = [
            Plane { normal: b.normal, offset: -b.normal.dot(shift) },
            Plane { normal: a.normal, offset: a.normal.dot(shift) },
        ];
        let heights = [0, 1].map(|k| planes[k].normal.dot(shapes[k].centre) + planes[k].offset);
        if heights[0] <= 0.0 || heights[1] <= 0.0 {
            return None;
        }
        let distance = (b.centre + shift).distance(a.centre);
        let near = [Near::of(a, b, planes[0], b.centre + shift), Near::of(b, a, planes[1], a.centre - shift)];
        Some(Self { ladder, shapes, shift, exact_shift, planes, heights, distance, near })
    }

    pub fn arch(&self) -> Arch {
        self.ladder.arch
    }

    /// Both are so high above each other's planes that it does not matter whether a corner is in one, or below it by rounding.
    pub fn is_high(&self) -> bool {
        self.heights[0].min(self.heights[1]) > HIGH * (self.distance + self.shapes[0].radius + self.shapes[1].radius)
    }

    /// About T, from the middles.
    pub fn guess(&self) -> f64 {
        let [a, b] = self.shapes;
        let square = self.distance * self.distance;
        a.area * b.area * (self.heights[0] / square) * (self.heights[1] / square)
    }

    /// T and its error estimate where that is within the tolerance, relative to T, by the cheapest way; if there is any no dearer
    /// than `most`.
    pub fn exchange(&self, tolerance: f64, most: usize) -> Option<(f64, f64)> {
        let mut guess = self.guess();
        for _ in 0..2 {
            let (value, error) = self.sum(self.way(tolerance, most, guess)?);
            if error <= tolerance * value {
                return Some((value, error));
            }
            // There is less to be right about than it seemed.
            guess = value.max(0.0);
        }
        None
    }

    /// The cheapest way that leaves less than the tolerance of T, which is about `guess`.
    fn way(&self, tolerance: f64, most: usize, guess: f64) -> Option<Way> {
        let factors = [0, 1].map(|outer| {
            let rung = self.rung(outer, 0.5 * (tolerance - self.rounding_of_factors(outer) / guess))?;
            Some(Way { kind: Kind::Factors { outer, rung }, cost: self.cost_of_factors(outer, rung) })
        });
        let product = || {
            let reach = self.distance + self.shapes[0].radius + self.shapes[1].radius;
            let is_low = self.rounding_of_product([reach; 2]) > NOTABLE;
            let rounding = self.rounding_of_product(self.reaches(is_low));
            let [a, b] = [0, 1].map(|k| self.rung(k, 0.25 * (tolerance - rounding)));
            let rungs = [a?, b?];
            Some(Way { kind: Kind::Product { rungs, is_low }, cost: self.cost_of_product(rungs) })
        };
        let [first, second] = factors;
        let ways = [first, second, product()].into_iter().flatten();
        ways.filter(|way| way.cost <= most).min_by_key(|way| way.cost)
    }

    /// T and its error estimate.
    fn sum(&self, way: Way) -> (f64, f64) {
        let [a, b] = self.shapes;
        let grids = &self.ladder.grids;
        match way.kind {
            Kind::Factors { outer, rung } => {
                let (own, other, shift) = if outer == 0 { (a, b, self.shift) } else { (b, a, -self.shift) };
                let value = Factors::new(own, other, shift, grids.of(rung.n)).sum(self.ladder.arch);
                (value, value.abs() * rung.left + self.rounding_of_factors(outer))
            }
            Kind::Product { rungs, is_low } => {
                let mut planes = self.planes;
                if is_low {
                    // Low above each other's planes: take the height of one corner exactly; what others differ by is small.
                    planes[0].offset = -b.exact_normal.dot(self.exact_shift).value();
                    planes[1].offset = a.exact_normal.dot(self.exact_shift).value();
                }
                let product =
                    Product { shapes: [a, b], grids: rungs.map(|rung| grids.of(rung.n)), planes, shift: self.shift };
                let value = self.ladder.arch.dispatch(product);
                let left = rungs[0].left + rungs[1].left;
                (value, value * (left + self.rounding_of_product(self.reaches(is_low))))
            }
        }
    }

    /// The fewest points of a polygon that leave less than so much of T along each of its axes.
    fn rung(&self, of: usize, allowed: f64) -> Option<Rung> {
        let mut rung = Rung { n: [0; 2], left: 0.0 };
        for (axis, ellipse) in self.near[of].ellipses.into_iter().enumerate() {
            let (n, left) = fewest(ellipse, 0.5 * allowed)?;
            rung.n[axis] = n + usize::from(self.shapes[of].is_uneven[axis]);
            rung.left += left;
        }
        Some(rung)
    }

    /// What rounding does to the closed form, m² sr: terms are as large as the edges look.
    fn rounding_of_factors(&self, outer: usize) -> f64 {
        let [own, other] = [self.shapes[outer], self.shapes[1 - outer]];
        let away = self.near[outer].away;
        let reach = self.distance + own.radius + other.radius;
        CANCELLATION * own.area * (other.perimeter / away) * (reach / away)
    }

    /// Relative rounding of a sum of positive products, whose heights are taken of points so far from where they are known.
    fn rounding_of_product(&self, reaches: [f64; 2]) -> f64 {
        ROUNDING * (1.0 + reaches[0] / self.heights[0] + reaches[1] / self.heights[1])
    }

    fn reaches(&self, is_low: bool) -> [f64; 2] {
        let radii = self.shapes.map(|shape| shape.radius);
        if is_low { radii.map(|radius| 2.0 * radius) } else { [self.distance + radii[0] + radii[1]; 2] }
    }

    fn cost_of_factors(&self, outer: usize, rung: Rung) -> usize {
        let n_groups = (rung.n[0] * rung.n[1]).div_ceil(LANES) * self.shapes[outer].cells.len();
        8 * n_groups * self.shapes[1 - outer].corners.len()
    }

    fn cost_of_product(&self, rungs: [Rung; 2]) -> usize {
        let [a, b] = rungs.map(|rung| rung.n[0] * rung.n[1]);
        let n_cells = self.shapes[0].cells.len() * self.shapes[1].cells.len();
        10 + 8 * a.div_ceil(4) * b.div_ceil(LANES) * n_cells
    }
}

impl Near {
    /// The other polygon, with this centre, lies in a disk: no point of it is closer to the own centre than the disk. What holds for
    /// every cell holds for all.
    fn of(own: &Shape, other: &Shape, plane: Plane, centre: Vec3) -> Self {
        let mut near = Self { ellipses: [f64::INFINITY; 2], away: f64::INFINITY };
        for cell in &own.cells {
            let above = plane.normal.dot(cell.centre) + plane.offset;
            let square = cell.centre.distance_squared(centre);
            let beside = ((square - above * above).max(0.0).sqrt() - other.radius).max(0.0);
            let away = (above * above + beside * beside).sqrt();
            near.away = near.away.min(away);
            for (least, axis) in near.ellipses.iter_mut().zip(&cell.axes) {
                let inverse = 1.0 / axis.half_length;
                // Nearest are poles on the line of the cell's rim, and those straight beside its middle.
                let [z, offset] = [away - axis.offsets[0], axis.offsets[1]].map(|length| length * inverse);
                let (square, beside) = (z * z - offset * offset, z - offset);
                if beside <= 0.0 || square <= 1.0 {
                    *least = 1.0;
                    continue;
                }
                let along = square.sqrt() + (square - 1.0).sqrt();
                let across = beside + (beside * beside + 1.0).sqrt();
                *least = least.min(along.min(across));
            }
        }
        near
    }
}

/// The fewest points whose error is at most so much, and that error.
fn fewest(ellipse: f64, allowed: f64) -> Option<(usize, f64)> {
    let inverse = 1.0 / ellipse;
    let square = inverse * inverse;
    let mut power = inverse;
    for (k, constant) in CONSTANTS.iter().enumerate() {
        let left = constant * power;
        if left <= allowed {
            return Some((k + 1, left));
        }
        power *= square;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assembly::exchange::pair::close::Close;
    use crate::geometry::Polygon;
    use crate::sampling::Stream;

    /// Quadrature errors below this are rounding.
    const NOISE: f64 = 1e-11;

    /// A random pair: triangles, parallelograms or trapezoids, one of them up to a sliver, the other as large or up to a twentieth.
    fn pair(stream: &mut Stream) -> Option<[Polygon; 2]> {
        let mut point = || Vec3::from_array(std::array::from_fn(|_| 2.0 * stream.uniform() - 1.0));
        let [a, b, c, d, e, f, by] = [(); 7].map(|()| point());
        let [kind, thinness, size, away] = [(); 4].map(|()| stream.uniform());
        let outline = |p: Vec3, q: Vec3, r: Vec3| match (3.0 * kind) as usize {
            0 => vec![p, q, r],
            1 => vec![p, q, q + (r - p), r],
            _ => vec![p, q, q + 0.4 * (r - p), r],
        };
        let by = by.normalize_or_zero() * (1.0 + 8.0 * away * away);
        let size = (-3.0 * size).exp();
        let one = Polygon::new(outline(a, b, a + (-6.0 * thinness).exp() * (c - a))).ok()?;
        let other = Polygon::new(outline(d, e, f).into_iter().map(|v| by + size * v).collect()).ok()?;
        let is_above =
            |p: &Polygon, q: &Polygon| p.vertices().iter().all(|v| q.normal().dot(*v - q.vertices()[0]) > 1e-6);
        (is_above(&one, &other) && is_above(&other, &one)).then_some([one, other])
    }

    #[test]
    fn no_rule_leaves_more_than_half_of_its_bound() {
        let ladder = Ladder::new();
        let mut stream = Stream::new(0x6d65_6173, 0, 0);
        let (mut n_measured, mut n_rounded) = (0, 0);
        for turn in 0..20_000 {
            let Some([one, other]) = pair(&mut stream) else { continue };
            let nodes = [&one, &other].map(|polygon| ladder.nodes(polygon));
            let shift = Vector::difference(one.vertices()[0], other.vertices()[0]);
            let Some(apart) = Apart::new(&ladder, [&nodes[0], &nodes[1]], shift) else { continue };
            for outer in [0, 1] {
                let ellipses = apart.near[outer].ellipses;
                let sum = |n| apart.sum(Way { kind: Kind::Factors { outer, rung: Rung { n, left: 0.0 } }, cost: 0 });
                if ellipses[0].min(ellipses[1]) < 2.0 {
                    continue;
                }
                let (best, rounding) = sum([MOST; 2]);
                let noise = NOISE + 100.0 * rounding / best;

                // Shorten the rule along one axis.
                for (axis, ellipse) in ellipses.into_iter().enumerate() {
                    for k in 1..=16 {
                        let mut n = [MOST; 2];
                        n[axis] = k + usize::from(apart.shapes[outer].is_uneven[axis]);
                        let error = (sum(n).0 / best - 1.0).abs();
                        let bound = CONSTANTS[k - 1] * ellipse.powi(1 - 2 * k as i32);
                        assert!(
                            error <= (0.5 * bound).max(noise),
                            "{k} points: {error:e} of {bound:e}; {one:?} {other:?}"
                        );
                        n_measured += usize::from(error > noise);
                    }
                }

                // Hold what rounding leaves against double-double.
                if turn % 16 == 0 && ellipses[0].min(ellipses[1]) > 2.5 {
                    let corners = [&one, &other].map(|p| Vector::from_point(one.vertices()[0], p.vertices()));
                    let (exact, left) =
                        Close::new(ladder.arch, corners).in_double(best, FINEST).expect("a facing pair");
                    assert!((best - exact).abs() <= rounding + left, "{best} for {exact}; {one:?} {other:?}");
                    n_rounded += 1;
                }
            }
        }
        assert!(n_measured > 10_000 && n_rounded > 100, "{n_measured} errors, {n_rounded} roundings");
    }

    /// As fine as f64 can be asked for.
    const FINEST: f64 = 1e-15;
}
