//! Which polygons lie in one plane.

use super::{Polygon, Vec3};
use std::f64::consts::FRAC_1_SQRT_2;

/// Signed height of a point above the plane through `on_plane`; zero within the rounding of the coordinates.
pub fn height(normal: Vec3, on_plane: Vec3, point: Vec3) -> f64 {
    let offset = point - on_plane;
    let height = normal.dot(offset);
    let rounding = 16.0 * f64::EPSILON * (point.abs().max_element() + on_plane.abs().max_element() + offset.length());
    if height.abs() <= rounding { 0.0 } else { height }
}

/// A number for every polygon, equal where two lie in one plane (facing alike or opposite) to within the rounding of their
/// coordinates. Cost O(n log n) unless many planes nearly coincide.
pub fn group_by_plane(polygons: &[&Polygon]) -> Vec<u32> {
    let scale =
        polygons.iter().flat_map(|p| p.vertices()).map(|v| v.abs().max_element()).fold(f64::MIN_POSITIVE, f64::max);

    // Sort both orientations of every plane by one generic linear key: equal planes become neighbours.
    let generic = Vec3::new(0.6180339887498949, 0.7548776662466927, 0.8191725133961645);
    let mut keys: Vec<(f64, usize)> = Vec::with_capacity(2 * polygons.len());
    for (i, p) in polygons.iter().enumerate() {
        let key = p.normal().dot(generic) + FRAC_1_SQRT_2 * p.normal().dot(p.centroid()) / scale;
        keys.push((key, i));
        keys.push((-key, i));
    }
    keys.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));

    // Join neighbours that are truly coplanar.
    let mut parent: Vec<usize> = (0..polygons.len()).collect();
    for (k, &(key, i)) in keys.iter().enumerate() {
        for &(other, j) in keys[k + 1..].iter().take_while(|(other, _)| other - key < 1e-8) {
            debug_assert!(other >= key);
            let (a, b) = (root(&mut parent, i), root(&mut parent, j));
            if a != b && coplanar(polygons[i], polygons[j]) {
                parent[a.max(b)] = a.min(b);
            }
        }
    }
    (0..polygons.len()).map(|i| root(&mut parent, i) as u32).collect()
}

fn root(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
}

/// True if every vertex of each lies in the plane of the other, to 64 ulp of the coordinates involved.
fn coplanar(a: &Polygon, b: &Polygon) -> bool {
    let lies_in = |plane: &Polygon, p: &Polygon| {
        p.vertices().iter().all(|v| {
            let offset = *v - plane.centroid();
            let rounding =
                64.0 * f64::EPSILON * (v.abs().max_element() + plane.centroid().abs().max_element() + offset.length());
            plane.normal().dot(offset).abs() <= rounding
        })
    };
    lies_in(a, b) && lies_in(b, a)
}
