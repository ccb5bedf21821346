//! Exchange that obstacles take away from a pair of patches, by exact geometry inside and adaptive quadrature outside.
//!
//! ```text
//! T_blocked = π ∫_A F(x → hidden part of B) dA
//! ```
//!
//! From a point x a convex body hides what lies behind its front faces and inside the planes through x and its silhouette. Cutting
//! B by those leaves a convex polygon with Lambert's exact form factor. Several bodies hide the union of what each of them does:
//! the sum, less what is hidden twice, and so on.
//!
//! On a part of A that lies on one side of every face the silhouette does not change. There every plane's height over a corner of B is
//! linear in x, so whether an edge takes part at all is settled by corners alone, and the integrand bends on straight lines only:
//! where an edge passes a corner of B or of another body, or a corner of a body a side of B. The part is cut along them; in each
//! cell the integrand is analytic and Gauss rules converge geometrically. The one exception, three edges of different outlines in one
//! line of sight, is left to refinement.
//!
//! The unoccluded exchange is not integrated here, so its singularities at touching edges do not matter.

mod bodies;
mod body;
mod cells;
mod cover;
mod cubature;
mod events;
mod flux;
mod kinks;
mod nature;

pub use bodies::Bodies;

use crate::geometry::{Polygon, Vec3};
use body::{Body, Lie, Plane};
use cells::{Line, Pieces};
use cover::cover;
use cubature::Cell;
use flux::{Edge, Scratch};
use nature::{distance_squared, nature, singular_corners};
use std::f64::consts::PI;
use std::ops::Range;

/// What stands between two patches does to their exchange.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shadow {
    /// Takes nothing away.
    Clear,
    /// Takes everything away.
    Total,
    /// Takes this much away, with an error estimate, m² sr.
    Partial { blocked: f64, error: f64 },
}

/// An obstacle as one part of A sees it.
#[derive(Clone)]
struct Outline {
    edges: Range<usize>,
    fronts: Range<usize>,
}

/// One product of the sum over unions: F(x → target ∩ hidden sides of edges), with a sign.
struct Term {
    sign: f64,
    target: Range<usize>,
    edges: Range<usize>,
    /// False if it bends on more lines than cells were cut along.
    is_cut: bool,
}

/// Room to work in, kept between pairs so that none of them allocates.
#[derive(Default)]
pub struct Desk {
    bodies: Vec<u32>,
    outlines: Vec<Outline>,
    edges: Vec<Edge>,
    fronts: Vec<Plane>,
    targets: Vec<Vec3>,
    active: Vec<Edge>,
    terms: Vec<Term>,
    lines: Vec<(Line, f64)>,
    points: Vec<Vec3>,
    chain: Vec<usize>,
    singular: Vec<usize>,
    cells: Vec<Cell>,
    pieces: Pieces,
    spare: Pieces,
    scratch: Scratch,
    is_front: Vec<bool>,
    stands: [Vec<Vec3>; 2],
    n_target: usize,
    is_total: bool,
    /// Points of quadrature since the desk was made.
    pub n_points: usize,
    pub n_cells: usize,
}

/// The pair under work.
struct Stage<'a> {
    bodies: &'a Bodies,
    candidates: &'a [u32],
    /// Plane of the patch stood on, front up.
    floor: Plane,
    /// Normal of the other one.
    target_normal: Vec3,
}

impl Desk {
    /// What is taken away from the exchange of `a` and `b` by the polygons of these handles, to an absolute `tolerance` in m² sr.
    ///
    /// Cost: about a µs where corners settle it, some ten µs for one edge across small patches.
    pub fn shadow(&mut self, bodies: &Bodies, a: &Polygon, b: &Polygon, candidates: &[u32], tolerance: f64) -> Shadow {
        // Only what is in front of both can take part.
        let planes = [a, b].map(|p| Plane { normal: p.normal(), point: p.centroid() });
        self.bodies.clear();
        for &handle in candidates {
            let body = bodies.body_of(handle);
            if !self.bodies.contains(&body) && !planes.iter().any(|plane| bodies.get(body).is_behind(plane)) {
                self.bodies.push(body);
            }
        }
        if self.bodies.is_empty() {
            return Shadow::Clear;
        }
        let (mut on_a, mut on_b) = (std::mem::take(&mut self.stands[0]), std::mem::take(&mut self.stands[1]));
        let shadow = if front(a.vertices(), &planes[1], &mut on_a) && front(b.vertices(), &planes[0], &mut on_b) {
            // Stand where the silhouettes change less, and further from what hides.
            if self.strain(bodies, &on_a) <= self.strain(bodies, &on_b) {
                let stage = Stage { bodies, candidates, floor: planes[0], target_normal: planes[1].normal };
                self.cast(&stage, &on_a, &on_b, tolerance)
            } else {
                let stage = Stage { bodies, candidates, floor: planes[1], target_normal: planes[0].normal };
                self.cast(&stage, &on_b, &on_a, tolerance)
            }
        } else {
            Shadow::Clear
        };
        self.stands = [on_a, on_b];
        shadow
    }

    /// How badly bodies look from a polygon: faces that it crosses, and its size beside its distance from them.
    fn strain(&self, bodies: &Bodies, polygon: &[Vec3]) -> f64 {
        let centre = polygon.iter().copied().sum::<Vec3>() / polygon.len() as f64;
        let radius = polygon.iter().map(|v| v.distance_squared(centre)).fold(0.0, f64::max);
        let of_body = |body: &u32| {
            let body = bodies.get(*body);
            // A plane beyond the ball about the polygon is not crossed.
            let reached = |face: &&Plane| face.normal.dot(centre - face.point).powi(2) <= radius;
            let n_across = body.faces.iter().filter(reached).filter(|face| face.lie(polygon) == Lie::Across).count();
            let nearest =
                body.rims.iter().map(|rim| distance_squared(centre, rim.from, rim.to)).fold(f64::INFINITY, f64::min);
            n_across as f64 + (radius / nearest).sqrt()
        };
        self.bodies.iter().map(of_body).fold(0.0, f64::max)
    }

    /// The shadow on a target as seen from a convex part of a plane, both in front of each other.
    fn cast(&mut self, stage: &Stage, outer: &[Vec3], target: &[Vec3], tolerance: f64) -> Shadow {
        self.terms.clear();
        self.targets.clear();
        self.active.clear();
        self.cells.clear();
        self.edges.clear();
        self.fronts.clear();
        self.is_total = false;
        self.targets.extend_from_slice(target);
        self.n_target = target.len();
        let list = std::mem::take(&mut self.bodies);
        self.look_from(stage, outer, &list, true);
        self.bodies = list;
        if self.is_total {
            return Shadow::Total;
        }
        if self.terms.is_empty() {
            return Shadow::Clear;
        }

        let Self { cells, terms, targets, active, scratch, .. } = self;
        self.n_cells += cells.len();
        let nature = |term: usize, corners: &[Vec3; 4]| {
            let Term { target, edges, is_cut, .. } = &terms[term];
            nature(corners, &targets[target.clone()], &active[edges.clone()], *is_cut)
        };
        let normal = stage.floor.normal;
        let sum = cubature::integrate(cells, normal, tolerance / PI, &nature, |term, x| {
            let Term { sign, target, edges, .. } = &terms[term];
            sign * flux::hidden(x, normal, &targets[target.clone()], &active[edges.clone()], scratch)
        });
        self.n_points += sum.n_points;
        Shadow::Partial { blocked: PI * sum.value.max(0.0), error: PI * sum.error }
    }

    /// Adds what these bodies hide from a convex part of the patch.
    fn look_from(&mut self, stage: &Stage, part: &[Vec3], list: &[u32], is_whole: bool) {
        // Cut the part where it crosses the plane of a face.
        for &body in list {
            for face in &stage.bodies.get(body).faces {
                if face.lie(part) == Lie::Across {
                    let mut halves = Pieces::default();
                    let line = Line { normal: face.normal, point: face.point };
                    let grain = cells::grain(part);
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
            if !self.outline(stage, obstacle, part) {
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
    fn outline(&mut self, stage: &Stage, body: &Body, part: &[Vec3]) -> bool {
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
            self.outlines.push(Outline { edges: first_edge..first_edge, fronts: first_front..first_front });
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
            self.outlines.push(Outline { edges: first_edge..self.edges.len(), fronts: first_front..self.fronts.len() });
        }
        true
    }

    /// Adds sign · F(target ∩ hidden sides of the active edges ∩ (what the first n outlines hide)): the union of sets is the sum of each
    /// less its intersection with those before it.
    fn add_union(
        &mut self,
        part: &[Vec3],
        target: Range<usize>,
        active: Range<usize>,
        sign: f64,
        n: usize,
        is_whole: bool,
    ) {
        for k in 0..n {
            let (n_targets, n_active) = (self.targets.len(), self.active.len());
            let Some(target) = self.restrict(part, target.clone(), active.clone(), k) else {
                self.targets.truncate(n_targets);
                self.active.truncate(n_active);
                continue;
            };
            let active = n_active..self.active.len();
            if is_whole && self.chain.is_empty() && active.is_empty() && target == (0..self.n_target) {
                self.is_total = true;
                return;
            }
            self.terms.push(Term { sign, target: target.clone(), edges: active.clone(), is_cut: true });
            self.cut_into_cells(part);
            self.chain.push(k);
            self.add_union(part, target, active, -sign, k, false);
            self.chain.pop();
            if self.is_total {
                return;
            }
        }
    }

    /// The target cut by the front faces of an outline, and its edges that take part added to those that do already; `None` where
    /// nothing is hidden.
    fn restrict(
        &mut self,
        part: &[Vec3],
        target: Range<usize>,
        active: Range<usize>,
        k: usize,
    ) -> Option<Range<usize>> {
        let outline = self.outlines[k].clone();
        // Bodies side by side hide nothing together.
        for &other in &self.chain {
            let other = self.outlines[other].edges.clone();
            let apart = |one: Range<usize>, two: Range<usize>| {
                let outside =
                    |edge: &Edge| self.edges[two.clone()].iter().all(|corner| edge.never_hides(part, &[corner.from]));
                !two.is_empty() && self.edges[one].iter().any(outside)
            };
            if apart(outline.edges.clone(), other.clone()) || apart(other, outline.edges.clone()) {
                return None;
            }
        }

        // What lies before a front face is not hidden.
        let mut target = target;
        for front in self.fronts[outline.fronts.clone()].iter() {
            match front.lie(&self.targets[target.clone()]) {
                Lie::Below => {}
                Lie::Above => return None,
                Lie::Across => {
                    let line = Line { normal: -front.normal, point: front.point };
                    self.spare.clear();
                    let whole = &self.targets[target.clone()];
                    line.keep(whole, 1.0, cells::grain(whole), &mut self.spare);
                    let start = self.targets.len();
                    self.targets.extend_from_slice(self.spare.iter().next()?);
                    target = start..self.targets.len();
                }
            }
        }

        // Keep the edges that pass through what is left.
        let corners = &self.targets[target.clone()];
        for k in active.clone().chain(outline.edges.start + active.end..outline.edges.end + active.end) {
            let edge = if k < active.end { self.active[k] } else { self.edges[k - active.end] };
            match edge.lie(part, corners) {
                Lie::Below => return None,
                Lie::Above => {}
                Lie::Across => self.active.push(edge),
            }
        }
        Some(target)
    }

    /// Cuts the part along the lines on which the last term bends, and covers what is left with cells.
    fn cut_into_cells(&mut self, part: &[Vec3]) {
        let Self { terms, targets, active, lines, pieces, spare, cells, points, singular, .. } = self;
        let number = terms.len() - 1;
        let (target, edges) = (&targets[terms[number].target.clone()], &active[terms[number].edges.clone()]);
        events::find(part, target, edges, points, lines);
        pieces.clear();
        pieces.add(part);
        let (size, normal) = (events::size_of(part), events::normal_of(part));
        for (line, slope) in lines.iter().take(MOST_LINES) {
            spare.clear();
            for piece in pieces.iter() {
                line.split(piece, *slope, size, spare);
            }
            std::mem::swap(pieces, spare);
        }
        let is_cut = lines.len() <= MOST_LINES;
        let nature = |corners: &[Vec3; 4]| nature(corners, target, edges, is_cut);
        for piece in pieces.iter() {
            singular.clear();
            singular.extend(singular_corners(piece, normal, target, edges));
            cover(piece, singular, number, &nature, cells);
        }
        terms[number].is_cut = is_cut;
    }
}

/// More lines than this are left to refinement.
const MOST_LINES: usize = 24;

/// Lays out the part of a polygon in front of a plane; false if there is none.
fn front(polygon: &[Vec3], plane: &Plane, part: &mut Vec<Vec3>) -> bool {
    part.clear();
    match plane.lie(polygon) {
        Lie::Below => return false,
        Lie::Above => part.extend_from_slice(polygon),
        Lie::Across => {
            let mut half = Pieces::default();
            Line { normal: plane.normal, point: plane.point }.keep(polygon, 1.0, cells::grain(polygon), &mut half);
            part.extend(half.iter().next().into_iter().flatten());
        }
    }
    part.len() >= 3
}
