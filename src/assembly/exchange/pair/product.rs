//! Product Gauss rules over two polygons that are apart.
//!
//! ```text
//! T = ∫∫ cosθ cosθ' / r² dA dA' = Σᵢ Σⱼ (wᵢ hᵢ) (wⱼ hⱼ) / r⁴ᵢⱼ,   h the height above the other's plane
//! ```
//!
//! for r cosθ is the height of the *other* point above the plane. Every term is positive: nothing cancels. Cost: one division
//! for four terms, as many lanes wide as the machine; products and sums are fused and in a fixed order, so that bits depend on
//! no machine. Of distances the sixteenth powers are taken: they have to be between 1e-19 and 1e19 metres.

use super::grid::{Grid, Group, LANES};
use super::shape::{Several, Shape};
use crate::geometry::Vec3;
use pulp::{Simd, WithSimd};

/// A plane above which heights are taken: normal · p + offset.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    pub normal: Vec3,
    pub offset: f64,
}

/// Two polygons, the rules laid onto them, and what their sum needs.
pub struct Product<'a> {
    pub shapes: [&'a Shape; 2],
    pub grids: [&'a Grid; 2],
    /// Of the *other* polygon, in each one's coordinates.
    pub planes: [Plane; 2],
    /// From the coordinates of the second to those of the first.
    pub shift: Vec3,
}

/// Points and their weights times heights, an array a coordinate.
type Weighted = [Group; 4];

/// Groups of points that need no heap.
const FEW: usize = 8;

impl WithSimd for Product<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let n_groups = self.shapes[0].cells.len() * self.grids[0].groups.len();
        if n_groups <= FEW {
            self.sum(simd, &mut [[[0.0; LANES]; 4]; FEW])
        } else {
            self.sum(simd, &mut vec![[[0.0; LANES]; 4]; n_groups])
        }
    }
}

impl Product<'_> {
    #[inline(always)]
    fn sum<S: Simd>(&self, simd: S, room: &mut [Weighted]) -> f64 {
        // Lay out the points of the first polygon.
        let n_parts = LANES / S::F64_LANES;
        let mut n_outer = 0;
        for cell in &self.shapes[0].cells {
            for group in &self.grids[0].groups {
                for part in 0..n_parts {
                    let (at, weight) = cell.lay(simd, group, part);
                    let weight = simd.mul_f64s(weight, self.planes[0].height(simd, &at));
                    let [x, y, z, w] = &mut room[n_outer];
                    S::as_mut_simd_f64s(x).0[part] = at.x;
                    S::as_mut_simd_f64s(y).0[part] = at.y;
                    S::as_mut_simd_f64s(z).0[part] = at.z;
                    S::as_mut_simd_f64s(w).0[part] = weight;
                }
                n_outer += 1;
            }
        }
        // Where the last four lanes of a cell's last group are filling they are left out.
        let per_cell = self.grids[0].groups.len();
        let is_short = 2 * per_cell != self.grids[0].n_points.div_ceil(4) && per_cell > 0;
        let outer = &room[..n_outer];

        let mut sums = [0.0; LANES];
        for (part, sum) in S::as_mut_simd_f64s(&mut sums).0.iter_mut().enumerate() {
            for cell in &self.shapes[1].cells {
                for group in &self.grids[1].groups {
                    let (at, weight) = cell.lay(simd, group, part);
                    let weight = simd.mul_f64s(weight, self.planes[1].height(simd, &at));
                    let at = at.plus(simd, &self.shift, simd.splat_f64s(1.0));
                    let mut inner = simd.splat_f64s(0.0);
                    for (k, from) in outer.iter().enumerate() {
                        let first = four(simd, &at, from, 0);
                        inner = simd.add_f64s(inner, first);
                        if !(is_short && (k + 1) % per_cell == 0) {
                            inner = simd.add_f64s(inner, four(simd, &at, from, 4));
                        }
                    }
                    *sum = simd.mul_add_f64s(weight, inner, *sum);
                }
            }
        }
        total(&sums)
    }
}

/// h₀/a + h₁/b + h₂/c + h₃/d over their common denominator, for four points of a group.
#[inline(always)]
fn four<S: Simd>(simd: S, at: &Several<S>, from: &Weighted, first: usize) -> S::f64s {
    let (a, h0) = one(simd, at, from, first);
    let (b, h1) = one(simd, at, from, first + 1);
    let (c, h2) = one(simd, at, from, first + 2);
    let (d, h3) = one(simd, at, from, first + 3);
    let (ab, cd) = (simd.mul_f64s(a, b), simd.mul_f64s(c, d));
    let left = simd.mul_add_f64s(h0, b, simd.mul_f64s(h1, a));
    let right = simd.mul_add_f64s(h2, d, simd.mul_f64s(h3, c));
    simd.div_f64s(simd.mul_add_f64s(left, cd, simd.mul_f64s(right, ab)), simd.mul_f64s(ab, cd))
}

/// r⁴ and h of a point of a group.
#[inline(always)]
fn one<S: Simd>(simd: S, at: &Several<S>, [x, y, z, h]: &Weighted, k: usize) -> (S::f64s, S::f64s) {
    let from = Several { x: simd.splat_f64s(x[k]), y: simd.splat_f64s(y[k]), z: simd.splat_f64s(z[k]) };
    let by = at.minus(simd, &from);
    let r_squared = by.dot(simd, &by);
    (simd.mul_f64s(r_squared, r_squared), simd.splat_f64s(h[k]))
}

impl Plane {
    #[inline(always)]
    fn height<S: Simd>(&self, simd: S, at: &Several<S>) -> S::f64s {
        simd.add_f64s(Several::splat(simd, self.normal).dot(simd, at), simd.splat_f64s(self.offset))
    }
}

/// The sum of lanes, in pairs.
#[inline(always)]
pub fn total([a, b, c, d, e, f, g, h]: &Group) -> f64 {
    ((a + b) + (c + d)) + ((e + f) + (g + h))
}
