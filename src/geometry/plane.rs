//! Which polygons lie in one plane.

use super::{DisjointSets, Polygon, Vec3};
use std::f64::consts::FRAC_1_SQRT_2;

/// Signed height of a point above the plane through `on_plane`; zero within the rounding of the coordinates.
pub fn height(normal: Vec3, on_plane: Vec3, point: Vec3) -> f64 {
    let offset = point - on_plane;
    let height = normal.dot(offset);
    let rounding = 16.0 * f64::EPSILON * (point.abs().max_element() + on_plane.abs().max_element() + offset.length());
    if height.abs() <= rounding { 0.0 } else { height }
}

/// Keys nearer than this may be of one plane.
const KEY_RESOLUTION: f64 = 1e-8;

/// A number for every polygon, equal where two lie in one plane (facing alike or opposite) to within the rounding of their
/// coordinates: the least number of those in it.
///
/// Among planes that nearly coincide, every polygon is held against the largest of each plane found so far, whose normal is known
/// best. Cost O(n log n), unless very many planes nearly coincide.
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

    // Among neighbours, largest first, join each to the planes that it lies in.
    let mut joined = DisjointSets::new(polygons.len());
    for run in keys.chunk_by_mut(|a, b| b.0 - a.0 < KEY_RESOLUTION) {
        run.sort_by(|a, b| polygons[b.1].area().total_cmp(&polygons[a.1].area()).then(a.1.cmp(&b.1)));
        let mut planes: Vec<Plane> = Vec::new();
        for &(_, i) in run.iter() {
            let mut is_new = true;
            for plane in planes.iter().filter(|plane| plane.holds(polygons[i])) {
                is_new = false;
                joined.join(i, plane.of);
            }
            if is_new {
                planes.push(Plane::of(i, polygons[i]));
            }
        }
    }
    (0..polygons.len()).map(|i| joined.least(i) as u32).collect()
}

/// The plane of a polygon, and how far it can be trusted.
pub(super) struct Plane {
    /// The polygon's number.
    pub of: usize,
    pub normal: Vec3,
    pub point: Vec3,
    /// Length over which the corners fix the normal: the polygon's width.
    width: f64,
}

impl Plane {
    pub fn of(number: usize, polygon: &Polygon) -> Self {
        let v = polygon.vertices();
        let diameter = v.iter().map(|v| v.distance(polygon.centroid())).fold(0.0, f64::max);
        Self { of: number, normal: polygon.normal(), point: polygon.centroid(), width: polygon.area() / diameter }
    }

    /// Signed height of a point above the plane; zero within 64 ulp of the coordinates involved near the polygon that the plane is
    /// of, and within what those make of its normal further away.
    pub fn height(&self, point: Vec3) -> f64 {
        let offset = point - self.point;
        let distance = offset.length();
        let coordinates = point.abs().max_element() + self.point.abs().max_element() + distance;
        let rounding = 64.0 * f64::EPSILON * coordinates * (distance / self.width).max(1.0);
        let height = self.normal.dot(offset);
        if height.abs() <= rounding { 0.0 } else { height }
    }

    fn holds(&self, polygon: &Polygon) -> bool {
        polygon.vertices().iter().all(|v| self.height(*v) == 0.0)
    }
}

/// The largest polygon of every plane that a polygon has a number of, by [`group_by_plane`]; in the order of those numbers.
pub(super) fn largest_of_planes(polygons: &[&Polygon], planes: &[u32]) -> Vec<Plane> {
    let mut largest: Vec<Option<usize>> = vec![None; polygons.len()];
    for (i, &plane) in planes.iter().enumerate() {
        let best = &mut largest[plane as usize];
        if best.is_none_or(|best| polygons[i].area() > polygons[best].area()) {
            *best = Some(i);
        }
    }
    largest.into_iter().flatten().map(|i| Plane::of(i, polygons[i])).collect()
}
