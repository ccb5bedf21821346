//! A Gauss rule over one polygon of the form factor of the other, which is known in closed form (see [`lambert`](super::lambert)).
//!
//! ```text
//! T = ½ ∫ Σₖ n·(vₖ₊₁ × vₖ) θₖ / |vₖ × vₖ₊₁| dA,   vₖ the other's corners as seen from the point, θₖ the angle between neighbours
//! ```
//!
//! With the edge eₖ = vₖ₊₁ − vₖ that is vₖ·(n × eₖ) θₖ / |vₖ × eₖ|. Where θ ≤ π/4 no root is needed: θ / sin θ is a series in the
//! square of t = |vₖ × eₖ| / vₖ·vₖ₊₁, over cos θ. Terms cancel the more the smaller the other polygon looks. Cost: one division and
//! some thirty operations an edge and a point, as many lanes wide as the machine; in a fixed order, so that bits depend on no machine.

use super::angle::{self, arc};
use super::grid::{Grid, LANES};
use super::product::total;
use super::shape::{Several, Shape};
use crate::geometry::Vec3;
use pulp::{Arch, Simd, WithSimd};

/// One polygon by points, the other by its edges.
pub struct Factors<'a> {
    outer: &'a Shape,
    inner: &'a Shape,
    /// From the coordinates of `inner` to those of `outer`.
    shift: Vec3,
    grid: &'a Grid,
}

/// An edge as all points of the other polygon see it.
#[derive(Clone, Copy, Default)]
struct Edge {
    from: Vec3,
    along: Vec3,
    /// n × e.
    across: Vec3,
    length_squared: f64,
}

/// Edges that need no heap.
const FEW: usize = 4;

/// How long edges look, at most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Widest {
    /// π/8.
    Narrow,
    /// π/4.
    Middle,
    /// Anything.
    Wide,
}

impl<'a> Factors<'a> {
    pub fn new(outer: &'a Shape, inner: &'a Shape, shift: Vec3, grid: &'a Grid) -> Self {
        Self { outer, inner, shift, grid }
    }

    /// T.
    pub fn sum(self, arch: Arch) -> f64 {
        let n_edges = self.inner.corners.len();
        if n_edges <= FEW {
            self.over(arch, &mut [Edge::default(); FEW][..n_edges])
        } else {
            self.over(arch, &mut vec![Edge::default(); n_edges])
        }
    }

    fn over(self, arch: Arch, edges: &mut [Edge]) -> f64 {
        let Self { outer, inner, shift, grid } = self;
        let from = outer.centre - shift;
        let mut widest = Widest::Narrow;
        for (k, edge) in edges.iter_mut().enumerate() {
            let here = inner.corners[k];
            let along = inner.corners[if k + 1 < inner.corners.len() { k + 1 } else { 0 }] - here;
            let length_squared = along.length_squared();
            *edge = Edge { from: here + shift, along, across: outer.normal.cross(along), length_squared };
            // Of half length m, from no point nearer to its middle than b, it looks no longer than 2 arctan m/b.
            let half = 0.5 * length_squared.sqrt();
            let away = (here + 0.5 * along).distance_squared(from);
            if away < (outer.radius + COT_PI_16 * half).powi(2) {
                let is_middle = away >= (outer.radius + COT_PI_8 * half).powi(2);
                widest = if is_middle && widest != Widest::Wide { Widest::Middle } else { Widest::Wide };
            }
        }
        0.5 * match widest {
            Widest::Narrow => arch.dispatch(Narrow { outer, edges, grid, series: &angle::TO_PI_8 }),
            Widest::Middle => arch.dispatch(Narrow { outer, edges, grid, series: &angle::TO_PI_4 }),
            Widest::Wide => arch.dispatch(Wide { outer, edges, grid }),
        }
    }
}

const COT_PI_16: f64 = 5.027_339_492_125_846;
const COT_PI_8: f64 = 2.414_213_562_373_095;

/// Edges that look short.
struct Narrow<'a, const N: usize> {
    outer: &'a Shape,
    edges: &'a [Edge],
    grid: &'a Grid,
    series: &'a [f64; N],
}

impl<const N: usize> WithSimd for Narrow<'_, N> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        over_points(simd, self.outer, self.grid, &self)
    }
}

impl<S: Simd, const N: usize> Seen<S> for Narrow<'_, N> {
    #[inline(always)]
    fn from(&self, simd: S, at: &Several<S>) -> S::f64s {
        let mut sum = simd.splat_f64s(0.0);
        for edge in self.edges {
            let v = Several::splat(simd, edge.from).minus(simd, at);
            let square = v.dot(simd, &v);
            let forward = v.dot(simd, &Several::splat(simd, edge.along));
            let cosine = simd.add_f64s(square, forward);
            let length_squared = simd.splat_f64s(edge.length_squared);
            let sine_squared = simd.negate_mul_add_f64s(forward, forward, simd.mul_f64s(square, length_squared));
            let inverse = simd.div_f64s(simd.splat_f64s(1.0), cosine);
            let tangent_squared = simd.mul_f64s(simd.mul_f64s(sine_squared, inverse), inverse);
            let mut series = simd.splat_f64s(self.series[N - 1]);
            for coefficient in self.series[..N - 1].iter().rev() {
                series = simd.mul_add_f64s(series, tangent_squared, simd.splat_f64s(*coefficient));
            }
            let share = simd.mul_f64s(v.dot(simd, &Several::splat(simd, edge.across)), inverse);
            sum = simd.mul_add_f64s(share, series, sum);
        }
        sum
    }
}

/// Edges of any length.
struct Wide<'a> {
    outer: &'a Shape,
    edges: &'a [Edge],
    grid: &'a Grid,
}

impl WithSimd for Wide<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        over_points(simd, self.outer, self.grid, &self)
    }
}

impl<S: Simd> Seen<S> for Wide<'_> {
    #[inline(always)]
    fn from(&self, simd: S, at: &Several<S>) -> S::f64s {
        let mut sum = simd.splat_f64s(0.0);
        let Some(first) = self.edges.first() else { return sum };
        let first = Several::splat(simd, first.from).minus(simd, at);
        let mut v = Several { x: first.x, y: first.y, z: first.z };
        for (k, edge) in self.edges.iter().enumerate() {
            let next = match self.edges.get(k + 1) {
                Some(next) => Several::splat(simd, next.from).minus(simd, at),
                None => Several { x: first.x, y: first.y, z: first.z },
            };
            let cross = v.cross(simd, &Several::splat(simd, edge.along));
            let sine = simd.sqrt_f64s(cross.dot(simd, &cross));
            let sine = simd.max_f64s(sine, simd.splat_f64s(f64::MIN_POSITIVE));
            let angle = arc(simd, sine, v.dot(simd, &next));
            let share = simd.mul_f64s(v.dot(simd, &Several::splat(simd, edge.across)), angle);
            sum = simd.add_f64s(sum, simd.div_f64s(share, sine));
            v = next;
        }
        sum
    }
}

/// What is seen from points.
trait Seen<S: Simd> {
    /// 2π times the form factor from points side by side.
    fn from(&self, simd: S, at: &Several<S>) -> S::f64s;
}

/// The integral over a polygon of what is seen from its points.
#[inline(always)]
fn over_points<S: Simd>(simd: S, outer: &Shape, grid: &Grid, seen: &impl Seen<S>) -> f64 {
    let mut sums = [0.0; LANES];
    for (part, sum) in S::as_mut_simd_f64s(&mut sums).0.iter_mut().enumerate() {
        for cell in &outer.cells {
            for group in &grid.groups {
                let (at, weight) = cell.lay(simd, group, part);
                *sum = simd.mul_add_f64s(weight, seen.from(simd, &at), *sum);
            }
        }
    }
    total(&sums)
}
