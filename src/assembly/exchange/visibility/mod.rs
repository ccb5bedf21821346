//! How much of the exchange of two patches gets through what stands between them.

mod cluster;
mod shadow;

pub use cluster::{Clusters, View};
pub use shadow::Desk;

use super::Occlusion;
use crate::geometry::{Polygon, Shaft, Tracer, Vec3};
use crate::sampling::{Kronecker, mix};
use shadow::{Bodies, Shadow};
use std::f64::consts::PI;

/// The visible share of a pair's exchange.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Visibility {
    /// Proved: nothing between.
    Full,
    /// Proved: cut off.
    None,
    /// Sampled by rays, with the variance of the share.
    Sampled { share: f64, variance: f64 },
    /// Integrated: T that is taken away, and its error estimate, m² sr.
    Integrated { blocked: f64, error: f64 },
}

/// What light can leave or end on: a piece of a facet.
#[derive(Clone, Copy)]
pub struct End<'a> {
    pub polygon: &'a Polygon,
    /// Number of the facet.
    pub facet: usize,
    /// Its étendue, m² sr.
    pub etendue: f64,
}

impl<'a> End<'a> {
    pub fn new(polygon: &'a Polygon, facet: usize) -> Self {
        Self { polygon, facet, etendue: PI * polygon.area() }
    }
}

/// What may stand between patches: single polygons for rays, whole bodies for shadows.
pub struct Obstacles {
    pub tracer: Tracer,
    bodies: Bodies,
}

impl Obstacles {
    /// Builds the tree and joins facets into bodies. Cost O(n log n) for scenes of bodies of bounded size.
    pub fn new(polygons: &[&Polygon]) -> Self {
        let tracer = Tracer::occluders(polygons);
        let bodies = Bodies::new(&tracer, polygons);
        Self { tracer, bodies }
    }
}

/// Classifies the pair among these candidates, `None` standing for all, and where that does not settle it integrates what is blocked, or casts
/// rays between points spread evenly over both.
///
/// The share is Σ k V / Σ k, k the kernel cosθ cosθ'/r² of each ray and V whether it gets through. Its variance is that of the
/// weighted mean with half a ray added to each outcome, so that no finite number of rays claims certainty.
///
/// `desk` is room to work in, and leaves no trace in the result.
pub fn between(
    obstacles: &Obstacles,
    desk: &mut Desk,
    candidates: Option<&[u32]>,
    [a, b]: [End; 2],
    occlusion: Occlusion,
    key: u64,
) -> Visibility {
    let occluders = &obstacles.tracer;
    let (one, other) = ((a.polygon, a.facet), (b.polygon, b.facet));
    let shaft = match candidates {
        None => Shaft::between(occluders, one, other),
        Some(candidates) => Shaft::among(occluders, candidates, one, other),
    };
    let handles = match shaft {
        Shaft::Clear => return Visibility::Full,
        Shaft::Blocked => return Visibility::None,
        Shaft::Undecided(handles) => handles,
    };
    match occlusion {
        Occlusion::Exact { tolerance } => integrated(obstacles, desk, &handles, [a, b], tolerance),
        Occlusion::Sampled { rays, .. } => sampled(occluders, &handles, [a, b], rays, key),
    }
}

fn integrated(obstacles: &Obstacles, desk: &mut Desk, handles: &[u32], [a, b]: [End; 2], tolerance: f64) -> Visibility {
    let tolerance = tolerance * a.etendue.min(b.etendue);
    match desk.shadow(&obstacles.bodies, a.polygon, b.polygon, handles, tolerance) {
        Shadow::Clear => Visibility::Full,
        Shadow::Total => Visibility::None,
        Shadow::Partial { blocked, error } => Visibility::Integrated { blocked, error },
    }
}

fn sampled(occluders: &Tracer, handles: &[u32], [a, b]: [End; 2], n_rays: usize, key: u64) -> Visibility {
    let points = Kronecker::<4>::new(mix(&[key]));
    let (mut through, mut total, mut squares) = (0.0, 0.0, 0.0);
    for k in 0..n_rays {
        let [u0, u1, u2, u3] = points.point(k);
        let (x, y) = (a.polygon.sample([u0, u1]), b.polygon.sample([u2, u3]));
        let kernel = kernel(a.polygon.normal(), b.polygon.normal(), y - x);
        if kernel <= 0.0 {
            continue;
        }
        total += kernel;
        squares += kernel * kernel;
        // With many candidates the tree is faster than the list.
        let blocked = if handles.len() <= 12 {
            occluders.blocked_by(handles, x, y)
        } else {
            occluders.occluded(x, y, [a.facet, b.facet])
        };
        if !blocked {
            through += kernel;
        }
    }
    if total == 0.0 {
        return Visibility::Sampled { share: 0.5, variance: 0.25 };
    }
    let share = through / total;
    let effective = total * total / squares;
    let hedged = (share * effective + 0.5) / (effective + 1.0);
    Visibility::Sampled { share, variance: hedged * (1.0 - hedged) / effective }
}

/// cosθ cosθ' / r², zero where either side faces away.
fn kernel(normal_a: Vec3, normal_b: Vec3, d: Vec3) -> f64 {
    let r_squared = d.length_squared();
    normal_a.dot(d).max(0.0) * (-normal_b.dot(d)).max(0.0) / (r_squared * r_squared)
}
