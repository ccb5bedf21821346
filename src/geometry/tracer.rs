//! Where a ray first meets a polygon, and whether a segment is free.
//!
//! Boxes are culled in f32 on an `obvhs` tree, in coordinates centred on and scaled to the scene; polygons are met in f64. A ray
//! starts *on* a polygon and leaves out that polygon's whole plane by identity, so there is no epsilon. The inside test looks at
//! the exact sign of the ray's side of each edge, so that two polygons which share an edge never both let a ray through.

use super::{Polygon, Ray, Vec3, plane::group_by_plane};
use glam::Vec3A;
use obvhs::{BvhBuildParams, aabb::Aabb, bvh2::Bvh2, bvh2::builder::build_bvh2, ray::Ray as BoxRay, ray::RayHit};
use robust::{Coord3D, orient3d};
use std::time::Duration;

/// Half-width by which boxes of the normalised scene (radius 1) are grown: f32 rounding of origin, direction and box (3 × 6e-8)
/// along a chord of length 4, and a margin of five.
const BOX_MARGIN: f32 = 4e-6;

/// Finds what rays meet among a fixed set of convex polygons. Results do not depend on the number of threads.
#[derive(Clone)]
pub struct Tracer {
    shapes: Vec<Shape>,
    /// Polygons of one plane (either orientation) share a number.
    planes: Vec<u32>,
    tree: Bvh2,
    centre: Vec3,
    radius: f64,
}

#[derive(Clone)]
struct Shape {
    id: u32,
    plane: u32,
    normal: Vec3,
    vertices: Vec<Vec3>,
}

/// Where a ray ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Number of the polygon in the list the tracer was made from.
    pub polygon: usize,
    /// Ray parameter of the point.
    pub t: f64,
    /// True if the ray arrives on the front.
    pub front: bool,
}

impl Tracer {
    /// Builds the tree. Cost O(n log n).
    pub fn new(polygons: &[&Polygon]) -> Self {
        let planes = group_by_plane(polygons);
        let everything: Vec<usize> = (0..polygons.len()).collect();
        Self::over(polygons, planes, &everything)
    }

    /// A tracer over those polygons alone that can block a segment between two points of the scene: a polygon with all vertices
    /// of the scene on one side of its plane (a wall of a convex room) never does. Polygons keep their numbers.
    pub fn occluders(polygons: &[&Polygon]) -> Self {
        let planes = group_by_plane(polygons);
        let blocking: Vec<usize> = (0..polygons.len()).filter(|&i| !is_supporting(polygons[i], polygons)).collect();
        Self::over(polygons, planes, &blocking)
    }

    fn over(polygons: &[&Polygon], planes: Vec<u32>, chosen: &[usize]) -> Self {
        // Centre and scale, so that f32 boxes are as good for a pin as for a planet.
        let corners = || chosen.iter().flat_map(|&i| polygons[i].vertices());
        let (low, high) =
            corners().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)));
        let (centre, radius) = if chosen.is_empty() {
            (Vec3::ZERO, 1.0)
        } else {
            (0.5 * (low + high), (0.5 * low.distance(high)).max(f64::MIN_POSITIVE))
        };
        let to_box = |v: &Vec3| Vec3A::from(((*v - centre) / radius).as_vec3());
        let boxes: Vec<Aabb> = chosen
            .iter()
            .map(|&i| {
                let mut bounds = Aabb::empty();
                polygons[i].vertices().iter().for_each(|v| {
                    bounds.extend(to_box(v));
                });
                bounds.min -= Vec3A::splat(BOX_MARGIN);
                bounds.max += Vec3A::splat(BOX_MARGIN);
                bounds
            })
            .collect();
        let mut build_time = Duration::ZERO;
        let tree = build_bvh2(&boxes, BvhBuildParams::medium_build(), &mut build_time);

        // Lay the polygons out in the order of the leaves.
        let shapes = tree
            .primitive_indices
            .iter()
            .map(|&k| {
                let id = chosen[k as usize];
                let polygon = polygons[id];
                Shape {
                    id: id as u32,
                    plane: planes[id],
                    normal: polygon.normal(),
                    vertices: polygon.vertices().to_vec(),
                }
            })
            .collect();
        Self { shapes, planes, tree, centre, radius }
    }

    /// Number of polygons that can be met.
    pub fn n_polygons(&self) -> usize {
        self.shapes.len()
    }

    /// The first polygon met at t > 0. A ray that starts on polygon `start` meets none of that polygon's plane.
    pub fn closest(&self, ray: &Ray, start: Option<usize>) -> Option<Hit> {
        if self.shapes.is_empty() {
            return None;
        }
        let plane = start.map_or(u32::MAX, |id| self.planes[id]);
        let mut best: Option<Hit> = None;
        let BoxedRay { ray: box_ray, entry, speed } = self.box_ray(ray, f64::INFINITY)?;
        let probe = self.probe(ray);
        self.tree.ray_traverse(box_ray, &mut RayHit::none(), |_, k| {
            let shape = &self.shapes[k];
            let nearest = best.map_or(f64::INFINITY, |hit| hit.t);
            if shape.plane == plane {
                return f32::INFINITY;
            }
            let Some(hit) = shape.meet(&probe, nearest) else { return f32::INFINITY };
            // Of two polygons met at one point take the lower number, whatever the order of the boxes.
            if hit.t < nearest || best.is_none_or(|b| hit.polygon < b.polygon) {
                best = Some(hit);
            }
            round_up((hit.t - entry) * speed)
        });
        best
    }

    /// True if some polygon crosses the open segment between the two points, those in the planes of the polygons `ends` left out.
    pub fn occluded(&self, from: Vec3, to: Vec3, ends: [usize; 2]) -> bool {
        if self.shapes.is_empty() {
            return false;
        }
        let ray = Ray { origin: from, direction: to - from };
        let planes = ends.map(|id| self.planes[id]);
        let Some(boxed) = self.box_ray(&ray, 1.0) else { return false };
        let probe = self.probe(&ray);
        !self.tree.ray_traverse_miss(boxed.ray, |_, k| {
            let shape = &self.shapes[k];
            let blocks = !planes.contains(&shape.plane) && shape.meet(&probe, 1.0).is_some_and(|hit| hit.t < 1.0);
            if blocks { 0.0 } else { f32::INFINITY }
        })
    }

    /// Calls `visit(handle)` for every polygon whose box meets the box of these points, each once.
    pub(super) fn near(&self, points: impl IntoIterator<Item = Vec3>, mut visit: impl FnMut(u32)) {
        let mut bounds = Aabb::empty();
        for p in points {
            // Grown by what rounding to f32 may have moved the point: a shaft can be far larger than what stands in it.
            let point = Vec3A::from(((p - self.centre) / self.radius).as_vec3());
            let slack = point.abs() * (2.0 * f32::EPSILON);
            bounds.extend(point - slack);
            bounds.extend(point + slack);
        }
        self.tree.aabb_traverse(bounds, |tree, node| {
            let node = &tree.nodes[node as usize];
            (node.first_index..node.first_index + node.prim_count).for_each(&mut visit);
            true
        });
    }

    /// Unit normal of a polygon, by handle.
    pub(super) fn normal_of(&self, handle: u32) -> Vec3 {
        self.shapes[handle as usize].normal
    }

    /// Number of a polygon's plane, by handle.
    pub(super) fn plane_of(&self, handle: u32) -> u32 {
        self.shapes[handle as usize].plane
    }

    /// Number of the plane of polygon `id` of the list the tracer was made from.
    pub(super) fn plane_number(&self, id: usize) -> u32 {
        self.planes[id]
    }

    /// Corners of a polygon, by handle.
    pub fn corners_of(&self, handle: u32) -> &[Vec3] {
        &self.shapes[handle as usize].vertices
    }

    /// Number of a polygon in the list the tracer was made from, by handle.
    pub fn polygon_of(&self, handle: u32) -> usize {
        self.shapes[handle as usize].id as usize
    }

    /// True if one of these polygons (see [`Shaft::Undecided`](super::Shaft::Undecided)) crosses the open segment.
    pub fn blocked_by(&self, handles: &[u32], from: Vec3, to: Vec3) -> bool {
        let ray = Ray { origin: from, direction: to - from };
        let probe = self.probe(&ray);
        handles.iter().any(|&k| self.shapes[k as usize].meet(&probe, 1.0).is_some_and(|hit| hit.t < 1.0))
    }

    /// True if the two polygons lie in one plane, facing alike or opposite.
    pub fn coplanar(&self, a: usize, b: usize) -> bool {
        self.planes[a] == self.planes[b]
    }

    /// The ray in the coordinates of the boxes, moved up to the scene where it starts far outside. Its direction has unit length there,
    /// for obvhs cuts inverse directions off at 1/ε: of a short direction, that would bend the ray by more than a box's margin.
    fn box_ray(&self, ray: &Ray, t_max: f64) -> Option<BoxedRay> {
        let origin = (ray.origin - self.centre) / self.radius;
        let length = ray.direction.length();
        let (direction, speed) = (ray.direction / length, length / self.radius);
        let mut advance = 0.0;
        if origin.length_squared() > 4.0 {
            advance = (-origin.dot(direction) - 1.5).max(0.0);
        }
        let start = (origin + advance * direction).as_vec3();
        let entry = advance / speed;
        let t_max = if t_max.is_finite() { round_up((t_max - entry) * speed) } else { f32::INFINITY };
        let reaches = t_max > 0.0 && direction.is_finite();
        reaches.then(|| BoxedRay {
            ray: BoxRay::new(start.into(), direction.as_vec3().into(), 0.0, t_max),
            entry,
            speed,
        })
    }
}

/// A ray among the boxes: its parameter there is (t − entry) · speed.
struct BoxedRay {
    ray: BoxRay,
    entry: f64,
    speed: f64,
}

/// f32 at or above t, so that the boxes of equal hits are still looked at.
fn round_up(t: f64) -> f32 {
    (t * (1.0 + 1e-6)) as f32
}

/// A ray with what its sign tests need.
#[derive(Clone, Copy)]
struct Probe {
    ray: Ray,
    /// The direction, lengthened or shortened by a power of two to the size of the scene.
    along: Vec3,
    /// The second point of the ray's line, origin + along: it stands for the direction wherever a sign must be exact.
    beyond: Vec3,
    /// What rounding can have done to along · (a × b), a and b the corners of any polygon of the scene as seen from the origin.
    doubt: f64,
}

impl Tracer {
    fn probe(&self, ray: &Ray) -> Probe {
        let largest = |v: Vec3| v.abs().max_element();
        // Stretch the direction exactly, so that the line's second point is rounded no worse than the corners are.
        let reach = self.radius + largest(ray.origin - self.centre);
        let along = ray.direction * power_of_two_below(reach / largest(ray.direction));
        let beyond = ray.origin + along;
        // Corners are at most `reach` away, and off by an ulp of their coordinates; `beyond` is off by an ulp of its own.
        let coordinates = reach + largest(self.centre) + largest(ray.origin);
        let length = largest(along);
        let doubt = 32.0 * f64::EPSILON * reach * (reach * (length + largest(beyond)) + 2.0 * coordinates * length);
        Probe { ray: *ray, along, beyond, doubt }
    }
}

/// The largest power of two not above x, for normal x > 0: x without the digits of its mantissa.
fn power_of_two_below(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & f64::INFINITY.to_bits())
}

impl Shape {
    /// Where the ray meets this polygon, at 0 < t ≤ `nearest`.
    fn meet(&self, probe: &Probe, nearest: f64) -> Option<Hit> {
        let ray = &probe.ray;
        let approach = self.normal.dot(ray.direction);
        let t = self.normal.dot(self.vertices[0] - ray.origin) / approach;
        if !(t > 0.0 && t <= nearest) {
            return None;
        }

        // Inside: the ray passes every edge on the same side.
        let (mut left, mut right) = (false, false);
        let mut from = self.vertices[self.vertices.len() - 1];
        let mut a = from - ray.origin;
        for to in &self.vertices {
            let b = *to - ray.origin;
            let mut side = probe.along.dot(a.cross(b));
            if side.abs() <= probe.doubt {
                side = exact_side(probe, from, *to);
            }
            left |= side > 0.0;
            right |= side < 0.0;
            if left && right {
                return None;
            }
            (from, a) = (*to, b);
        }
        Some(Hit { polygon: self.id as usize, t, front: approach < 0.0 })
    }
}

/// The exact sign of d · (a × b): on which side the ray passes the edge; antisymmetric in the edge's ends.
#[cold]
fn exact_side(probe: &Probe, from: Vec3, to: Vec3) -> f64 {
    let coord = |v: Vec3| Coord3D { x: v.x, y: v.y, z: v.z };
    // orient3d(p, q, r, s) is the sign of (p − s) · ((q − s) × (r − s)).
    orient3d(coord(probe.beyond), coord(from), coord(to), coord(probe.ray.origin))
}

/// True if no vertex of the scene lies strictly on one of the polygon's sides.
fn is_supporting(polygon: &Polygon, all: &[&Polygon]) -> bool {
    let (origin, normal) = (polygon.centroid(), polygon.normal());
    let (mut above, mut below) = (false, false);
    for v in all.iter().flat_map(|p| p.vertices()) {
        let offset = *v - origin;
        let height = normal.dot(offset);
        // A vertex counts as on the plane within the rounding of its own coordinates.
        let rounding = 16.0 * f64::EPSILON * (v.abs().max_element() + offset.length());
        above |= height > rounding;
        below |= height < -rounding;
        if above && below {
            return false;
        }
    }
    true
}
