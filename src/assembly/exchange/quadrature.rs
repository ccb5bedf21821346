//! Exchange of two unoccluded patches: product Gauss where they are apart, contours where they are not.

use super::clip::{Half, in_front_of};
use super::contour;
use super::rules::{Rule, gauss_legendre};
use crate::geometry::{Polygon, Vec3};

/// Gauss points an axis, tried in turn until two agree.
const LADDER: [usize; 5] = [2, 3, 4, 6, 8];

/// Points of one patch, for every rung of the ladder.
pub struct Nodes {
    centre: Vec3,
    radius: f64,
    rungs: [Rung; LADDER.len()],
}

/// Points and area weights, one array a coordinate.
#[derive(Default)]
struct Rung {
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
    weight: Vec<f64>,
}

/// The Gauss rules of the ladder.
pub struct Ladder([Rule; LADDER.len()]);

impl Ladder {
    pub fn new() -> Self {
        Self(LADDER.map(gauss_legendre))
    }

    /// Lays the points of every rung onto a patch. Triangles are collapsed squares; larger polygons are fans of triangles.
    pub fn nodes(&self, polygon: &Polygon) -> Nodes {
        let v = polygon.vertices();
        let corners: Vec<[Vec3; 4]> = match *v {
            [a, b, c, d] => vec![[a, b, c, d]],
            _ => v[1..].windows(2).map(|pair| [v[0], pair[0], pair[1], v[0]]).collect(),
        };
        let rungs = std::array::from_fn(|k| {
            let mut rung = Rung::default();
            for quad in &corners {
                rung.extend(quad, polygon.normal(), &self.0[k]);
            }
            rung
        });
        let centre = polygon.centroid();
        Nodes { centre, radius: v.iter().map(|p| p.distance(centre)).fold(0.0, f64::max), rungs }
    }
}

impl Rung {
    /// Adds the points of one bilinear quadrilateral, weighted by its Jacobian.
    fn extend(&mut self, [a, b, c, d]: &[Vec3; 4], normal: Vec3, rule: &Rule) {
        for (t, wt) in rule.nodes.iter().zip(&rule.weights) {
            for (s, ws) in rule.nodes.iter().zip(&rule.weights) {
                let point = (*a * (1.0 - s) + *b * *s) * (1.0 - t) + (*d * (1.0 - s) + *c * *s) * *t;
                let along = (*b - *a) * (1.0 - t) + (*c - *d) * *t;
                let across = (*d - *a) * (1.0 - s) + (*c - *b) * *s;
                self.x.push(point.x);
                self.y.push(point.y);
                self.z.push(point.z);
                self.weight.push(ws * wt * along.cross(across).dot(normal));
            }
        }
    }
}

/// T of two patches with nothing between them and an estimate of its error, m² sr; `None` where they do not face each other.
///
/// T = ∫∫ cosθ cosθ' / r² dA dA'. The tolerance is reached relative to T, or the contour's own estimate is returned.
pub fn unoccluded(ladder: &Ladder, a: (&Polygon, &Nodes), b: (&Polygon, &Nodes), tolerance: f64) -> Option<(f64, f64)> {
    // Keep of each what is in front of the other.
    match (in_front_of(a.0.vertices(), b.0), in_front_of(b.0.vertices(), a.0)) {
        (Half::Behind, _) | (_, Half::Behind) => None,
        (Half::InFront, Half::InFront) => climb(a, b, tolerance).or_else(|| contour(a.0.vertices(), b.0.vertices())),
        (of_a, of_b) => {
            let part = |half: Half, polygon: &Polygon| match half {
                Half::Part(part) => part,
                _ => polygon.vertices().to_vec(),
            };
            let (of_a, of_b) = (part(of_a, a.0), part(of_b, b.0));
            // Slivers too thin to be polygons are left to the contour.
            let climbed = match (Polygon::new(of_a.clone()), Polygon::new(of_b.clone())) {
                (Ok(p), Ok(q)) => climb((&p, &ladder.nodes(&p)), (&q, &ladder.nodes(&q)), tolerance),
                _ => None,
            };
            climbed.or_else(|| contour(&of_a, &of_b))
        }
    }
}

/// Product Gauss for polygons that are apart, where the kernel is smooth; `None` where the ladder is too short.
fn climb(a: (&Polygon, &Nodes), b: (&Polygon, &Nodes), tolerance: f64) -> Option<(f64, f64)> {
    if a.1.centre.distance(b.1.centre) <= 1.3 * (a.1.radius + b.1.radius) {
        return None;
    }
    let mut coarse = product_gauss(a, b, 0);
    for rung in 1..LADDER.len() {
        let fine = product_gauss(a, b, rung);
        let change = (fine - coarse).abs();
        if change <= tolerance * fine {
            return Some((fine, change));
        }
        coarse = fine;
    }
    None
}

fn contour(a: &[Vec3], b: &[Vec3]) -> Option<(f64, f64)> {
    let (value, error) = contour::exchange(a, b);
    (value > 0.0).then_some((value, error))
}

/// ∑ wᵢ wⱼ (nₐ·d)(−n_b·d) / |d|⁴ over the points of one rung, d from the one to the other.
fn product_gauss(a: (&Polygon, &Nodes), b: (&Polygon, &Nodes), rung: usize) -> f64 {
    let (na, nb) = (a.0.normal(), b.0.normal());
    let (p, q) = (&a.1.rungs[rung], &b.1.rungs[rung]);
    let n = q.x.len();
    let (qx, qy, qz, qw) = (&q.x[..n], &q.y[..n], &q.z[..n], &q.weight[..n]);
    let mut sum = 0.0;
    for i in 0..p.x.len() {
        let (px, py, pz) = (p.x[i], p.y[i], p.z[i]);
        let mut inner = 0.0;
        for j in 0..n {
            let (dx, dy, dz) = (qx[j] - px, qy[j] - py, qz[j] - pz);
            let r_squared = dx * dx + dy * dy + dz * dz;
            let cosines = (na.x * dx + na.y * dy + na.z * dz) * -(nb.x * dx + nb.y * dy + nb.z * dz);
            inner += qw[j] * cosines / (r_squared * r_squared);
        }
        sum += p.weight[i] * inner;
    }
    sum
}
