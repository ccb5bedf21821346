//! The black backs of a scene, as far as they are seen.
//!
//! From one side of a plane one thing is seen at every point of it. Patches exchange light whatever else lies in their plane, so where
//! facets lie in one plane and show there, to the same side, a black back and something else, the back gives way: it is cut away under every
//! side that has patches, and under black backs of lower number. Two sides with patches are a fault of the scene: what they overlap by
//! is exchanged twice, closure shows it, and [`overfull`](super::super::closure::overfull) refuses it where it is large.

use super::cut::{SEAM, uncovered};
use crate::geometry::{Polygon, Vec3, group_by_plane};
use crate::scene::{Scene, Side};
use std::cmp::Ordering;

/// Which facets have black backs, and what covers those.
pub struct Backs<'a> {
    facets: &'a [&'a Polygon],
    is_black: Vec<bool>,
    /// Of every facet with a black back, those that cover some of it, with whether the side they show there has patches.
    covers: Vec<Vec<(u32, bool)>>,
}

impl<'a> Backs<'a> {
    /// Looks up what overlaps in one plane. Cost O(n log n), for planes of n alike facets O(n √n).
    pub fn new(scene: &Scene, facets: &'a [&'a Polygon]) -> Self {
        let is_black: Vec<bool> = (0..facets.len()).map(|f| scene.surface_of(f).brdf(Side::Back).is_none()).collect();
        let mut backs = Self { facets, covers: vec![Vec::new(); facets.len()], is_black };

        // Sweep over the facets of every plane along the axis in which they extend furthest.
        let planes = group_by_plane(facets);
        let mut order: Vec<usize> = (0..facets.len()).collect();
        order.sort_by_key(|facet| planes[*facet]);
        for group in order.chunk_by(|a, b| planes[*a] == planes[*b]).filter(|group| group.len() > 1) {
            let mut boxes: Vec<(usize, Vec3, Vec3)> = group.iter().map(|f| bounds(*f, facets[*f])).collect();
            let (low, high) = boxes
                .iter()
                .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), (_, l, h)| (low.min(*l), high.max(*h)));
            let axis = (high - low).max_position();
            boxes.sort_by(|a, b| a.1[axis].partial_cmp(&b.1[axis]).unwrap_or(Ordering::Equal).then(a.0.cmp(&b.0)));
            for (k, (a, low, high)) in boxes.iter().enumerate() {
                let near = boxes[k + 1..].iter().take_while(|other| other.1[axis] <= high[axis]);
                for (b, ..) in near.filter(|other| other.1.cmple(*high).all() && other.2.cmpge(*low).all()) {
                    backs.note(*a, *b);
                    backs.note(*b, *a);
                }
            }
        }
        backs.covers.iter_mut().for_each(|covers| covers.sort_unstable());
        backs
    }

    /// The facets that have one.
    pub fn facets(&self) -> impl Iterator<Item = usize> {
        (0..self.facets.len()).filter(|facet| self.is_black[*facet])
    }

    /// What is seen of the black back of a facet: convex parts, fronts to where they are seen from.
    pub fn seen(&self, facet: usize) -> Vec<Polygon> {
        let covers = self.covers[facet].iter().map(|(other, _)| self.facets[*other as usize]);
        uncovered(&self.facets[facet].flipped(), covers, SEAM * self.facets[facet].area())
    }

    /// True if a ray that meets the back of a facet in this point ends in the black.
    pub fn is_dark(&self, facet: usize, point: Vec3) -> bool {
        let covers = || self.covers[facet].iter().filter(|(_, has_patches)| *has_patches);
        self.is_black[facet] && !covers().any(|(other, _)| holds(self.facets[*other as usize], point))
    }

    /// Takes down that `other`, in the plane of `facet`, covers some of its back, if it does.
    fn note(&mut self, facet: usize, other: usize) {
        if !self.is_black[facet] {
            return;
        }
        let shows_front = self.facets[facet].normal().dot(self.facets[other].normal()) < 0.0;
        let has_patches = shows_front || !self.is_black[other];
        if has_patches || other < facet {
            self.covers[facet].push((other as u32, has_patches));
        }
    }
}

/// A facet's number and the corners of its box.
fn bounds(facet: usize, polygon: &Polygon) -> (usize, Vec3, Vec3) {
    let v = polygon.vertices();
    (facet, v.iter().fold(v[0], |low, v| low.min(*v)), v.iter().fold(v[0], |high, v| high.max(*v)))
}

/// True if a point of the polygon's plane lies in it.
fn holds(polygon: &Polygon, point: Vec3) -> bool {
    let v = polygon.vertices();
    (0..v.len()).all(|k| (v[(k + 1) % v.len()] - v[k]).cross(point - v[k]).dot(polygon.normal()) >= 0.0)
}
