//! Bodies as a part of the patch sees them.

use super::body::{Body, Lie, Plane};
use super::cells::{Line, Pieces, grain};
use super::events;
use super::flux::Edge;
use super::{Desk, Stage};
use crate::geometry::Vec3;
use std::ops::Range;

/// A part that crosses more faces of a body than this sees them one by one: it would have to be cut along each of them.
const MOST_CUTS: usize = 2;

/// What hides as one: a body, or one of its faces.
#[derive(Clone)]
pub struct Outline {
    pub body: u32,
    /// What is below this sees nothing of it.
    pub cut: Option<Plane>,
    pub edges: Range<usize>,
    pub fronts: Range<usize>,
}

impl Desk {
    /// Adds what these bodies hide from a convex part of the patch.
    pub(super) fn look_from(&mut self, stage: &Stage, part: &[Vec3], list: &[u32], is_whole: bool) {
        // Cut the part where it crosses the plane of a face of a body that it crosses few of.
        for &body in list {
            let body = stage.bodies.get(body);
            if is_in_facets(body, part) {
                continue;
            }
            for face in &body.faces {
                if face.lie(part) == Lie::Across {
                    let mut halves = Pieces::default();
                    let line = Line { normal: face.normal, point: face.point };
                    let grain = grain(part);
                    line.keep(part, 1.0, grain, &mut halves);
                    line.keep(part, -1.0, grain, &mut halves);
                    if line.chord(part, 1.0, events::size_of(part)).is_none() {
                        continue;
                    }
                    for half in halves.iter() {
                        self.look_from(stage, half, list, false);
                    }
                    return;
                }
            }
        }

        // Outline every body as all of the part sees it.
        let (first_edge, first_front) = (self.edges.len(), self.fronts.len());
        self.outlines.clear();
        for &body in list {
            let obstacle = stage.bodies.get(body);
            let is_in_facets = is_in_facets(obstacle, part);
            if is_in_facets && self.outline_faces(stage, body, part) {
                continue;
            }
            if is_in_facets || !self.outline(stage, body, part) {
                // From inside, a body is no more than its facets.
                let mut facets: Vec<u32> = list.iter().copied().filter(|other| *other != body).collect();
                let of_body = stage.candidates.iter().filter(|handle| stage.bodies.body_of(**handle) == body);
                facets.extend(of_body.map(|handle| stage.bodies.facet_of(*handle)));
                self.edges.truncate(first_edge);
                self.fronts.truncate(first_front);
                self.look_from(stage, part, &facets, false);
                return;
            }
        }
        self.chain.clear();
        self.add_union(part, 0..self.n_target, 0..0, 1.0, self.outlines.len(), is_whole);
    }

    /// Pushes the outline of a body that this part sees from outside; false where it does not.
    fn outline(&mut self, stage: &Stage, number: u32, part: &[Vec3]) -> bool {
        let body = stage.bodies.get(number);
        let (first_edge, first_front) = (self.edges.len(), self.fronts.len());
        self.is_front.clear();
        for face in &body.faces {
            let is_front = face.lie(part) == Lie::Above;
            self.is_front.push(is_front);
            if is_front {
                self.fronts.push(*face);
            }
        }
        let sees_front = self.fronts.len() > first_front;
        let is_flat = body.faces.len() == 2;
        let reaches_out = || body.excludes(&self.targets[..self.n_target], stage.target_normal);
        if !sees_front && !is_flat {
            // From inside a closed body nothing outside is seen.
            if body.opening.is_some() || !reaches_out() {
                return false;
            }
            let (edges, fronts) = (first_edge..first_edge, first_front..first_front);
            self.outlines.push(Outline { body: number, cut: None, edges, fronts });
            return true;
        }
        if body.opening.is_some_and(|opening| self.is_front[opening]) && !reaches_out() {
            return false;
        }
        let owner = self.outlines.len();
        for rim in &body.rims {
            match rim.faces.map(|face| self.is_front[face as usize]) {
                [true, false] => self.edges.push(Edge { from: rim.to, to: rim.from, owner }),
                [false, true] => self.edges.push(Edge { from: rim.from, to: rim.to, owner }),
                _ => {}
            }
        }
        if sees_front {
            let (edges, fronts) = (first_edge..self.edges.len(), first_front..self.fronts.len());
            self.outlines.push(Outline { body: number, cut: None, edges, fronts });
        }
        true
    }

    /// Pushes the outlines of those faces of a body that may be in the way, each from the part in front of it: together the front faces hide
    /// what the body does, and none of them what another does. False where the target may be seen inside the body.
    fn outline_faces(&mut self, stage: &Stage, number: u32, part: &[Vec3]) -> bool {
        let body = stage.bodies.get(number);
        let sees_into = body.opening.is_some_and(|opening| body.faces[opening].lie(part) != Lie::Below);
        if sees_into && !body.excludes(&self.targets[..self.n_target], stage.target_normal) {
            return false;
        }
        let handles = stage.candidates.iter().filter(|handle| stage.bodies.body_of(**handle) == number);
        self.faces.clear();
        self.faces.extend(handles.map(|handle| stage.bodies.face_of(*handle) as usize).chain(body.opening));
        self.faces.sort_unstable();
        self.faces.dedup();
        for &face in &self.faces {
            let plane = body.faces[face];
            let cut = match plane.lie(part) {
                Lie::Below => continue,
                Lie::Above => None,
                Lie::Across => Some(plane),
            };
            let (owner, first) = (self.outlines.len(), self.edges.len());
            self.edges.extend(body.edges_of(face).map(|(from, to)| Edge { from: to, to: from, owner }));
            self.fronts.push(plane);
            let fronts = self.fronts.len() - 1..self.fronts.len();
            self.outlines.push(Outline { body: number, cut, edges: first..self.edges.len(), fronts });
        }
        true
    }
}

/// True for a body whose faces are better looked at one by one: the part crosses many of them, and is not inside.
fn is_in_facets(body: &Body, part: &[Vec3]) -> bool {
    if body.faces.len() <= MOST_CUTS {
        return false;
    }
    let n_across = body.faces.iter().filter(|face| face.lie(part) == Lie::Across).count();
    n_across > MOST_CUTS && !body.holds(part)
}
