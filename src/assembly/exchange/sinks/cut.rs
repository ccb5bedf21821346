//! What of a polygon others in its plane leave uncovered.

use crate::assembly::exchange::pair::{Half, above};
use crate::geometry::{Polygon, Vec3};

/// Parts smaller than this share of the whole are seams between surfaces that meet within the rounding of their corners.
pub const SEAM: f64 = 1e-12;

/// The parts of a polygon that none of `covers`, convex polygons in its plane facing either way, covers: convex, facing as it does, each
/// larger than `smallest`, m². Cost O(parts · corners) for every cover.
pub fn uncovered<'a>(whole: &Polygon, covers: impl Iterator<Item = &'a Polygon>, smallest: f64) -> Vec<Polygon> {
    let mut left = vec![whole.vertices().to_vec()];
    for cover in covers {
        left = left.into_iter().flat_map(|part| outside(part, cover)).collect();
    }
    left.into_iter().filter_map(|part| Polygon::new(part).ok()).filter(|part| part.area() > smallest).collect()
}

/// What of a convex part lies outside a polygon in its plane.
fn outside(part: Vec<Vec3>, cover: &Polygon) -> Vec<Vec<Vec3>> {
    let v = cover.vertices();
    let mut left = Vec::new();
    let mut rest = part;
    for k in 0..v.len() {
        let outward = (v[(k + 1) % v.len()] - v[k]).cross(cover.normal()).normalize();
        match above(&rest, v[k], outward) {
            Half::Behind => {}
            Half::InFront => {
                left.push(rest);
                return left;
            }
            Half::Part(beyond) => {
                left.push(beyond);
                match above(&rest, v[k], -outward) {
                    Half::Part(within) => rest = within,
                    Half::Behind | Half::InFront => return left,
                }
            }
        }
    }
    left
}
