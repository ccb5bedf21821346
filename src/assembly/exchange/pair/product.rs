//! Product Gauss rules over two polygons that are apart.
//!
//! ```text
//! T = ∫∫ cosθ cosθ' / r² dA dA' = Σᵢ Σⱼ (wᵢ hᵢ) (wⱼ hⱼ) / r⁴ᵢⱼ,   h the height above the other's plane
//! ```
//!
//! for r cosθ is the height of the *other* point above the plane. Every term is positive: nothing cancels. Cost: one division
//! for four terms, as many lanes wide as the machine; products and sums are fused and in a fixed order, so that bits depend on
//! no machine. Of distances the sixteenth powers are taken: they have to be between 1e-19 and 1e19 metres.

use crate::geometry::Vec3;
use pulp::{Arch, Simd, WithSimd};

/// Lanes that are summed side by side.
const LANES: usize = 8;

/// Points with their weights, an array a coordinate, in groups of lanes; what fills the last has weight zero.
#[derive(Clone, Debug, Default)]
pub struct Points {
    groups: Vec<[[f64; LANES]; 4]>,
    n_points: usize,
}

impl Points {
    pub fn push(&mut self, at: Vec3, weight: f64) {
        let lane = self.n_points % LANES;
        if lane == 0 {
            let [x, y, z] = at.to_array();
            self.groups.push([[x; LANES], [y; LANES], [z; LANES], [0.0; LANES]]);
        }
        if let Some([x, y, z, w]) = self.groups.last_mut() {
            (x[lane], y[lane], z[lane], w[lane]) = (at.x, at.y, at.z, weight);
            self.n_points += 1;
        }
    }
}

/// A plane above which heights are taken: normal · p + offset.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    pub normal: Vec3,
    pub offset: f64,
}

/// Two polygons' points and what their sum needs.
pub struct Product<'a> {
    pub points: [&'a Points; 2],
    /// Of the *other* polygon, in each one's coordinates.
    pub planes: [Plane; 2],
    /// From the coordinates of the second to those of the first.
    pub shift: Vec3,
}

impl Product<'_> {
    /// Σᵢ Σⱼ over the points of both.
    pub fn sum(self, arch: Arch) -> f64 {
        arch.dispatch(self)
    }
}

impl WithSimd for Product<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f64 {
        lanes(&self)
    }
}

#[inline(always)]
fn lanes(product: &Product) -> f64 {
    let Product { points: [outer, inner], planes, shift } = product;
    let mut sum = [0.0; LANES];
    for group in &inner.groups {
        // Move a group of points to the coordinates of the first polygon, its weights times its heights.
        let weights = weighted(group, &planes[1]);
        let (x, y, z) = (moved(&group[0], shift.x), moved(&group[1], shift.y), moved(&group[2], shift.z));
        let mut inner_sum = [0.0; LANES];
        for from in &outer.groups {
            let heights = weighted(from, &planes[0]);
            for k in (0..LANES).step_by(4) {
                let [h0, h1, h2, h3] = [heights[k], heights[k + 1], heights[k + 2], heights[k + 3]];
                for l in 0..LANES {
                    let r4 = |k: usize| {
                        let (dx, dy, dz) = (x[l] - from[0][k], y[l] - from[1][k], z[l] - from[2][k]);
                        let r_squared = dz.mul_add(dz, dy.mul_add(dy, dx * dx));
                        r_squared * r_squared
                    };
                    // h₀/a + h₁/b + h₂/c + h₃/d over their common denominator.
                    let [a, b, c, d] = [r4(k), r4(k + 1), r4(k + 2), r4(k + 3)];
                    let (ab, cd) = (a * b, c * d);
                    let (left, right) = (h0.mul_add(b, h1 * a), h2.mul_add(d, h3 * c));
                    inner_sum[l] += left.mul_add(cd, right * ab) / (ab * cd);
                }
            }
        }
        for l in 0..LANES {
            sum[l] += weights[l] * inner_sum[l];
        }
    }
    let [a, b, c, d, e, f, g, h] = sum;
    ((a + b) + (c + d)) + ((e + f) + (g + h))
}

#[inline(always)]
fn moved(coordinates: &[f64; LANES], by: f64) -> [f64; LANES] {
    let mut sum = *coordinates;
    for at in &mut sum {
        *at += by;
    }
    sum
}

/// The weights of a group times its heights.
#[inline(always)]
fn weighted([x, y, z, weight]: &[[f64; LANES]; 4], Plane { normal, offset }: &Plane) -> [f64; LANES] {
    let mut heights = [0.0; LANES];
    for l in 0..LANES {
        heights[l] = weight[l] * x[l].mul_add(normal.x, y[l].mul_add(normal.y, z[l].mul_add(normal.z, *offset)));
    }
    heights
}
