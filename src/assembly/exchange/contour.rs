//! Exchange of two unoccluded polygons as a double contour integral, for pairs that are close or touch.
//!
//! ```text
//! T = ∫∫ cosθ cosθ' / r² dA dA' = ½ ∮∮ ln r  dx·dx'
//! ```
//!
//! The inner integral along an edge has a closed form; the outer one is cut where an edge of the other polygon comes closest and
//! done by tanh-sinh there, for touching edges leave logarithms at the cuts, and by Gauss elsewhere. Nothing is shifted apart.
//!
//! Source: Sparrow (1963), "A new and simpler formulation for radiative angle factors", eq. 9. Cost: O(edges²) nodes, some 10 to
//! 500 µs.

use super::rules::{EndNode, Rule, TANH_SINH, gauss_legendre};
use crate::geometry::Vec3;
use std::sync::LazyLock;

/// Relative rounding of a logarithm's term, a few ulp.
const ROUNDING: f64 = 1e-15;

static GAUSS: LazyLock<[Rule; 2]> = LazyLock::new(|| [gauss_legendre(12), gauss_legendre(18)]);

/// T of two convex polygons, each wholly in front of the other's plane, and an estimate of its error, both in m² sr.
pub fn exchange(a: &[Vec3], b: &[Vec3]) -> (f64, f64) {
    // Measure lengths in units of the distance scale: ln r is then small, and a constant in it drops out of the closed contour.
    let centre = |p: &[Vec3]| p.iter().copied().sum::<Vec3>() / p.len() as f64;
    let scale = a.iter().chain(b).map(|v| v.distance(centre(a))).fold(0.0, f64::max);
    if scale == 0.0 {
        return (0.0, 0.0);
    }
    let origin = centre(a);
    let a: Vec<Vec3> = a.iter().map(|v| (*v - origin) / scale).collect();
    let b: Vec<Vec3> = b.iter().map(|v| (*v - origin) / scale).collect();
    let edges = edges_of(&b);

    let (mut sum, mut error) = (0.0, 0.0);
    for (start, end) in corner_pairs(&a) {
        let length = start.distance(end);
        if length == 0.0 {
            continue;
        }
        let tangent = (end - start) / length;
        let facing: Vec<Edge> =
            edges.iter().map(|e| Edge { weight: tangent.dot(e.tangent), ..*e }).filter(|e| e.weight != 0.0).collect();
        // The inner integral, and the size of the terms that cancel in it.
        let inner = |x: Vec3| {
            let terms = facing.iter().map(|edge| edge.weight * edge.log_potential(x));
            terms.fold((0.0, 0.0), |(sum, size): (f64, f64), term| (sum + term, size + term.abs()))
        };

        // Cut the edge where it comes closest to the other contour.
        let mut cuts = vec![0.0, 1.0];
        cuts.extend(facing.iter().flat_map(|e| e.closest_approaches(start, tangent, length)));
        cuts.retain(|s| (0.0..=1.0).contains(s));
        cuts.sort_by(f64::total_cmp);
        cuts.dedup_by(|s, t| (*s - *t).abs() < 1e-12);

        for pair in cuts.windows(2) {
            let (from, piece) = (start + pair[0] * length * tangent, (pair[1] - pair[0]) * length);
            let to = start + pair[1] * length * tangent;
            let clearance = facing.iter().map(|e| e.distance_to(from, to)).fold(f64::INFINITY, f64::min);
            let along = |s: f64| inner(from + s * piece * tangent);
            let (value, left) = if clearance > piece {
                gauss(along)
            } else {
                // Step from the nearer end, so that nodes crowd an end without rounding onto it.
                let near_an_end = |node: &EndNode| {
                    if node.low < node.high { along(node.low) } else { inner(to - node.high * piece * tangent) }
                };
                tanh_sinh(near_an_end)
            };
            sum += piece * value;
            error += piece * left;
        }
    }
    ((0.5 * sum).max(0.0) * scale * scale, 0.5 * error * scale * scale)
}

/// ∫₀¹ of the first of the pair by Gauss, and what may be left of it; the second is the size of the terms that cancel in the first.
fn gauss(integrand: impl Fn(f64) -> (f64, f64)) -> (f64, f64) {
    let [coarse, fine] = &*GAUSS;
    let apply = |rule: &Rule| {
        rule.nodes.iter().zip(&rule.weights).fold((0.0, 0.0), |(sum, size), (s, w)| {
            let (value, terms) = integrand(*s);
            (sum + w * value, size + w * terms)
        })
    };
    let ((rough, _), (value, size)) = (apply(coarse), apply(fine));
    (value, left_after((value - rough).abs(), value) + ROUNDING * size)
}

/// The same by tanh-sinh, its step halved until no more than rounding is left.
fn tanh_sinh(integrand: impl Fn(&EndNode) -> (f64, f64)) -> (f64, f64) {
    let (mut value, mut size, mut left) = (0.0, 0.0, f64::INFINITY);
    for (level, nodes) in TANH_SINH.iter().enumerate() {
        let rough = value;
        let (added, terms) = nodes.iter().fold((0.0, 0.0), |(sum, size), node| {
            let (value, terms) = integrand(node);
            (sum + node.weight * value, size + node.weight * terms)
        });
        if level == 0 {
            (value, size) = (added, terms);
            continue;
        }
        (value, size) = (0.5 * value + added, 0.5 * size + terms);
        left = left_after((value - rough).abs(), value);
        if left <= ROUNDING * size {
            break;
        }
    }
    (value, left + ROUNDING * size)
}

/// Doubling the nodes squares the relative error, but for a power of 3/2 where another edge passes close by an end.
fn left_after(change: f64, value: f64) -> f64 {
    if change < value.abs() { change * (change / value.abs()).sqrt() } else { change }
}

/// One edge of the inner contour.
#[derive(Clone, Copy)]
struct Edge {
    start: Vec3,
    end: Vec3,
    tangent: Vec3,
    length: f64,
    /// Cosine between this edge and the outer one.
    weight: f64,
}

impl Edge {
    /// ∫ ln|x − y| dy along the edge: s ln √(h² + s²) − s + h atan(s/h) between its ends, h the distance of x from its line.
    fn log_potential(&self, x: Vec3) -> f64 {
        let (to_start, to_end) = (self.start - x, self.end - x);
        let (s0, s1) = (to_start.dot(self.tangent), to_end.dot(self.tangent));
        let h = self.tangent.cross(to_start).length();
        let part = |s: f64, r_squared: f64| if r_squared > 0.0 { 0.5 * s * r_squared.ln() } else { 0.0 };
        // atan(s1/h) − atan(s0/h) is the angle that the edge subtends.
        let angle = (h * self.length).atan2(h * h + s0 * s1);
        part(s1, h * h + s1 * s1) - part(s0, h * h + s0 * s0) - self.length + h * angle
    }

    /// Parameters in (0, length) ↦ (0, 1) of the line start + s tangent closest to this edge's ends and to the edge itself.
    fn closest_approaches(&self, start: Vec3, tangent: Vec3, length: f64) -> [f64; 3] {
        let s_of = |p: Vec3| (p - start).dot(tangent) / length;
        let sine_squared = 1.0 - self.weight * self.weight;
        let offset = start - self.start;
        let crossing = if sine_squared > 1e-12 {
            let s = (self.weight * offset.dot(self.tangent) - offset.dot(tangent)) / sine_squared;
            s / length
        } else {
            f64::NAN
        };
        [s_of(self.start), s_of(self.end), crossing]
    }

    /// A lower bound of the distance between this edge and the segment, good to its order: the closest of ends to lines.
    fn distance_to(&self, from: Vec3, to: Vec3) -> f64 {
        let segment = |p: Vec3, a: Vec3, b: Vec3| {
            let along = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            p.distance(a + along * (b - a))
        };
        let ends = [
            segment(from, self.start, self.end),
            segment(to, self.start, self.end),
            segment(self.start, from, to),
            segment(self.end, from, to),
        ];
        ends.into_iter().fold(f64::INFINITY, f64::min)
    }
}

fn corner_pairs(p: &[Vec3]) -> impl Iterator<Item = (Vec3, Vec3)> + '_ {
    (0..p.len()).map(|k| (p[k], p[(k + 1) % p.len()]))
}

fn edges_of(p: &[Vec3]) -> Vec<Edge> {
    corner_pairs(p)
        .filter(|(start, end)| start != end)
        .map(|(start, end)| {
            let length = start.distance(end);
            Edge { start, end, tangent: (end - start) / length, length, weight: 0.0 }
        })
        .collect()
}
