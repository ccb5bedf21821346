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
mod integrand;
mod kinks;
mod nature;
mod outline;
mod union;

pub use bodies::Bodies;

use crate::geometry::{Polygon, Vec3};
use body::{Lie, Plane};
use cells::{Line, Pieces};
use cubature::Cell;
use flux::{Edge, Scratch};
use integrand::Integrand;
use kinks::Kink;
use nature::distance_squared;
use outline::Outline;
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
    kinks: Vec<Kink>,
    is_front: Vec<bool>,
    faces: Vec<usize>,
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

        self.n_cells += self.cells.len();
        self.kinks.clear();
        let Self { cells, terms, targets, active, scratch, kinks, .. } = self;
        let normal = stage.floor.normal;
        let mut integrand = Integrand { normal, terms, targets, active, scratch, kinks, n_points: 0 };
        let sum = cubature::integrate(cells, tolerance / PI, &mut integrand);
        self.n_points += integrand.n_points;
        Shadow::Partial { blocked: PI * sum.value.max(0.0), error: PI * sum.error }
    }
}

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
