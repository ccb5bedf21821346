//! Where a ray first meets a polygon, and whether a segment is free.
//!
//! A tree of boxes, eight to a node, and the polygons in it, eight to a block, are tested in f32 in coordinates centred on and scaled
//! to the scene. That finds which polygons a ray may meet, and of most whether it does; where f32 leaves a doubt, f64 and exact
//! signs decide. So results are those of f64 tests of every polygon, bit for bit, whatever the tree and the width of the vectors. A ray
//! starts *on* a polygon and leaves out that polygon's whole plane by identity, so there is no epsilon. The inside test looks at the
//! exact sign of the ray's side of each edge, so that two polygons which share an edge never both let a ray through.

mod block;
mod boxes;
mod eight;
mod joined;
mod local;
mod shape;
mod supporting;
mod tree;
mod walk;

use super::{Polygon, Ray, Vec3, plane::group_by_plane};
use block::Block;
use boxes::Boxes;
use glam::Vec3A;
use joined::joined;
use local::{Local, Reach};
use obvhs::aabb::Aabb;
use shape::{Probe, Shape};
use std::borrow::Cow;
use supporting::supporting;
use tree::Tree;
use walk::{Any, Closest, Near};

/// Up to this many polygons all blocks are tested, without boxes: measured, the two break even at some eighty.
const BRUTE: usize = 64;

/// Finds what rays meet among a fixed set of convex polygons. Results do not depend on the number of threads, nor on the machine's
/// vector instructions.
#[derive(Clone)]
pub struct Tracer {
    shapes: Vec<Shape>,
    /// Corners of all shapes.
    corners: Vec<Vec3>,
    /// Polygons of one plane (either orientation) share a number.
    planes: Vec<u32>,
    tree: Tree,
    local: Local,
    radius: f64,
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
        let everything: Vec<(usize, Cow<Polygon>)> =
            polygons.iter().enumerate().map(|(id, polygon)| (id, Cow::Borrowed(*polygon))).collect();
        Self::over(planes, &everything)
    }

    /// A tracer over those polygons alone that can block a segment between two points of the scene: a polygon with all vertices
    /// of the scene on one side of its plane (a wall of a convex room) never does. Those that make a convex polygon together are one, under
    /// the number of the first of them; others keep their numbers.
    pub fn occluders(polygons: &[&Polygon]) -> Self {
        let planes = group_by_plane(polygons);
        let is_supporting = supporting(polygons, &planes);
        let blocking: Vec<usize> = (0..polygons.len()).filter(|&i| !is_supporting[planes[i] as usize]).collect();
        let blocking = joined(polygons, &planes, &blocking);
        Self::over(planes, &blocking)
    }

    /// A tracer over these polygons, each with its number; `planes` are those of all numbers.
    fn over(planes: Vec<u32>, chosen: &[(usize, Cow<Polygon>)]) -> Self {
        let boxes = Boxes::around(chosen.iter().map(|(_, polygon)| polygon.as_ref()));
        let local = boxes.local;

        // Lay the polygons out in the order of the blocks.
        let mut order: Vec<(usize, &Polygon)> = Vec::with_capacity(chosen.len());
        let block = |primitives: &[u32]| {
            let first = order.len() as u32;
            order.extend(primitives.iter().map(|&k| (chosen[k as usize].0, chosen[k as usize].1.as_ref())));
            Block::new(
                first,
                order[first as usize..].iter().map(|&(id, polygon)| {
                    let corners = polygon.vertices().iter().map(|v| local.point(*v)).collect();
                    (corners, polygon.normal(), planes[id])
                }),
            )
        };
        let tree =
            if chosen.len() <= BRUTE { Tree::flat(chosen.len(), block) } else { Tree::collapse(&boxes.tree(), block) };
        let mut corners = Vec::new();
        let shapes = order
            .iter()
            .map(|&(id, polygon)| {
                let vertices = polygon.vertices();
                let first = corners.len() as u32;
                corners.extend_from_slice(vertices);
                Shape {
                    id: id as u32,
                    plane: planes[id],
                    normal: polygon.normal(),
                    anchor: vertices[0],
                    first,
                    n_corners: vertices.len() as u32,
                }
            })
            .collect();
        Self { shapes, corners, planes, tree, local, radius: boxes.radius }
    }

    /// Number of polygons that can be met.
    pub fn n_polygons(&self) -> usize {
        self.shapes.len()
    }

    /// The first polygon met at t > 0. A ray that starts on polygon `start` meets none of that polygon's plane.
    pub fn closest(&self, ray: &Ray, start: Option<usize>) -> Option<Hit> {
        let plane = start.map_or(u32::MAX, |id| self.planes[id]);
        match self.local.ray(ray, f64::MAX) {
            Reach::Nothing => None,
            Reach::Boxes(local) => eight::run(Closest { tracer: self, ray, local, plane }),
            Reach::Anything => self.closest_of_all(ray, plane),
        }
    }

    /// True if some polygon crosses the open segment between the two points, those in the planes of the polygons `ends` left out.
    pub fn occluded(&self, from: Vec3, to: Vec3, ends: [usize; 2]) -> bool {
        let ray = Ray { origin: from, direction: to - from };
        let planes = ends.map(|id| self.planes[id]);
        match self.local.ray(&ray, 1.0) {
            Reach::Nothing => false,
            Reach::Boxes(local) => eight::run(Any { tracer: self, ray: &ray, local, planes }),
            Reach::Anything => self.any_of_all(&ray, planes),
        }
    }

    /// Calls `visit(handle)` for every polygon whose box meets the box of these points, and for some others, each once.
    pub(super) fn near(&self, points: impl IntoIterator<Item = Vec3>, visit: impl FnMut(u32)) {
        let mut bounds = Aabb::empty();
        for p in points {
            // Grown by what rounding to f32 may have moved the point: a shaft can be far larger than what stands in it.
            let point = Vec3A::from(self.local.point(p).as_vec3());
            let slack = point.abs() * (2.0 * f32::EPSILON);
            bounds.extend(point - slack);
            bounds.extend(point + slack);
        }
        eight::run(Near { tree: &self.tree, low: bounds.min.to_array(), high: bounds.max.to_array(), visit });
    }

    /// Unit normal of a polygon, by handle.
    pub fn normal_of(&self, handle: u32) -> Vec3 {
        self.shapes[handle as usize].normal
    }

    /// Number of a polygon's plane, by handle.
    pub(super) fn plane_of(&self, handle: u32) -> u32 {
        self.shapes[handle as usize].plane
    }

    /// Number of the plane of polygon `id` of the list the tracer was made from, by [`group_by_plane`](super::group_by_plane).
    pub fn plane_number(&self, id: usize) -> u32 {
        self.planes[id]
    }

    /// Number of a polygon in the list the tracer was made from, by handle.
    pub fn polygon_of(&self, handle: u32) -> usize {
        self.shapes[handle as usize].id as usize
    }

    /// Corners of a polygon, by handle.
    pub fn corners_of(&self, handle: u32) -> &[Vec3] {
        self.shapes[handle as usize].corners(&self.corners)
    }

    /// True if one of these polygons (see [`Shaft::Undecided`](super::Shaft::Undecided)) crosses the open segment.
    pub fn blocked_by(&self, handles: &[u32], from: Vec3, to: Vec3) -> bool {
        let probe = self.probe(&Ray { origin: from, direction: to - from });
        handles.iter().any(|&k| self.blocks(&probe, &self.shapes[k as usize]))
    }

    /// True if the two polygons lie in one plane, facing alike or opposite.
    pub fn coplanar(&self, a: usize, b: usize) -> bool {
        self.planes[a] == self.planes[b]
    }

    /// [`Tracer::closest`] by f64 tests of every polygon: the definition, and what is done where boxes cannot tell.
    #[cold]
    fn closest_of_all(&self, ray: &Ray, without: u32) -> Option<Hit> {
        let probe = self.probe(ray);
        let others = self.shapes.iter().filter(|shape| shape.plane != without);
        let hits = others.filter_map(|shape| shape.meet(&self.corners, &probe, f64::MAX));
        hits.min_by(|a, b| a.t.total_cmp(&b.t).then(a.polygon.cmp(&b.polygon)))
    }

    /// [`Tracer::occluded`] by f64 tests of every polygon.
    #[cold]
    fn any_of_all(&self, ray: &Ray, without: [u32; 2]) -> bool {
        let probe = self.probe(ray);
        let mut others = self.shapes.iter().filter(|shape| !without.contains(&shape.plane));
        others.any(|shape| self.blocks(&probe, shape))
    }

    fn probe(&self, ray: &Ray) -> Probe {
        Probe::new(ray, self.local.centre, self.radius)
    }

    /// True if the shape crosses the segment.
    fn blocks(&self, probe: &Probe, shape: &Shape) -> bool {
        shape.meet(&self.corners, probe, 1.0).is_some_and(|hit| hit.t < 1.0)
    }

    /// Where f32 leaves a doubt.
    #[inline(never)]
    fn meet(&self, ray: &Ray, shape: &Shape, nearest: f64) -> Option<Hit> {
        shape.meet(&self.corners, &self.probe(ray), nearest)
    }
}

#[cfg(test)]
mod tests;
