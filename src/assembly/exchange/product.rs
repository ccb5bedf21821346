//! Product Gauss rules over two polygons that are apart.
//!
//! ```text
//! T = ∫∫ cosθ cosθ' / r² dA dA' = Σᵢ Σⱼ (wᵢ hᵢ) (wⱼ hⱼ) / r⁴ᵢⱼ,   h the height above the other's plane
//! ```
//!
//! for r cosθ is the height of the *other* point above the plane. Every term is positive: nothing cancels. Cost: one division for two
//! terms, eight lanes wide where the machine is; the order of every sum is fixed, so that bits depend on no machine's width.

use crate::geometry::Vec3;
use pulp::Arch;

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

/// Σᵢ Σⱼ over the points of both, `planes` those of the *other* polygon in each one's coordinates, `shift` what leads from the
/// coordinates of the second to those of the first.
pub fn sum(arch: Arch, points: [&Points; 2], planes: [Plane; 2], shift: Vec3) -> f64 {
    arch.dispatch(
        #[inline(always)]
        || lanes(points, planes, shift),
    )
}

/// Points of the first that share a division.
const SHARED: usize = 2;

#[inline(always)]
fn lanes([outer, inner]: [&Points; 2], planes: [Plane; 2], shift: Vec3) -> f64 {
    let weighted = |group: &[[f64; LANES]; 4], plane: &Plane| -> [f64; LANES] {
        let [x, y, z, w] = group;
        let Plane { normal, offset } = *plane;
        std::array::from_fn(
            #[inline(always)]
            |l| w[l] * (normal.x * x[l] + normal.y * y[l] + normal.z * z[l] + offset),
        )
    };
    let mut sum = [0.0; LANES];
    for group in &inner.groups {
        // Move a group of points to the coordinates of the first polygon, its weights times its heights.
        let weights = weighted(group, &planes[1]);
        let x: [f64; LANES] = std::array::from_fn(|l| group[0][l] + shift.x);
        let y: [f64; LANES] = std::array::from_fn(|l| group[1][l] + shift.y);
        let z: [f64; LANES] = std::array::from_fn(|l| group[2][l] + shift.z);
        let mut inner_sum = [0.0; LANES];
        for from in &outer.groups {
            let heights = weighted(from, &planes[0]);
            for k in (0..LANES).step_by(SHARED) {
                let r4 = |k: usize, l: usize| {
                    let (dx, dy, dz) = (x[l] - from[0][k], y[l] - from[1][k], z[l] - from[2][k]);
                    let r_squared = dx * dx + dy * dy + dz * dz;
                    r_squared * r_squared
                };
                for l in 0..LANES {
                    let (one, other) = (r4(k, l), r4(k + 1, l));
                    inner_sum[l] += (heights[k] * other + heights[k + 1] * one) / (one * other);
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
