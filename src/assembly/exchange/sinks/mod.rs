//! What leaves a patch and never comes back: into the environment of an open scene, or onto the black back of a surface.
//!
//! Either as exchange with openings and backs, like that of any two patches; or counted by rays.

mod backs;
mod cut;
mod openings;

pub use backs::Backs;

use super::Entry;
use super::visibility::End;
use crate::geometry::{Frame, Polygon, Ray, Tracer, Vec3, height};
use crate::sampling::{Kronecker, mix, warp};
use openings::openings;

/// Étendue of a patch, m² sr.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lost {
    /// What leaves the scene.
    pub escaped: f64,
    /// What ends on black backs.
    pub darkened: f64,
    /// Variance of their sum.
    pub variance: f64,
}

/// A polygon that keeps all it receives.
pub struct Sink {
    pub polygon: Polygon,
    /// Number of the facet whose back it is, or the number after all facets for openings, one each.
    pub plane: usize,
    is_opening: bool,
}

impl Sink {
    /// The polygon, where it is an opening.
    pub fn opening(&self) -> Option<&Polygon> {
        self.is_opening.then_some(&self.polygon)
    }
}

/// The openings of a scene, and what is seen of its black backs.
pub fn of_scene(backs: &Backs, facets: &[&Polygon]) -> Vec<Sink> {
    let back = |facet| move |polygon| Sink { polygon, plane: facet, is_opening: false };
    let of_backs = backs.facets().flat_map(|facet| backs.seen(facet).into_iter().map(back(facet)));
    let openings = openings(facets).into_iter().enumerate();
    let openings = openings.map(|(k, polygon)| Sink { polygon, plane: facets.len() + k, is_opening: true });
    of_backs.chain(openings).collect()
}

/// Adds up the exchange of a patch with sinks. What has nothing in front of it loses all.
pub fn lost_to(sinks: &[Sink], facets: &[&Polygon], patch: End, lost: &[Entry]) -> Lost {
    let (normal, centroid) = (patch.polygon.normal(), patch.polygon.centroid());
    if lost.is_empty() && facets.iter().flat_map(|f| f.vertices()).all(|v| height(normal, centroid, *v) <= 0.0) {
        return Lost { escaped: patch.etendue, ..Lost::default() };
    }
    let mut sum = Lost::default();
    for entry in lost {
        let share = if sinks[entry.column as usize].is_opening { &mut sum.escaped } else { &mut sum.darkened };
        *share += entry.value;
        sum.variance += entry.variance;
    }
    sum
}

/// Follows `n_rays` rays uniform in étendue from the patch to where they first meet something.
///
/// The variance is binomial, an upper bound for points spread evenly, with half a ray added to each outcome, so that no finite number of
/// rays claims certainty.
pub fn lost_by_rays(backs: &Backs, tracer: &Tracer, patch: End, n_rays: usize, key: u64) -> Lost {
    let frame = Frame::about(patch.polygon.normal());
    let points = Kronecker::<4>::new(mix(&[key]));
    let (mut escaped, mut darkened) = (0usize, 0usize);
    for k in 0..n_rays {
        let [u0, u1, u2, u3] = points.point(k);
        let direction = frame.to_world(Vec3::from_array(warp::cosine_hemisphere([u2, u3])));
        let ray = Ray { origin: patch.polygon.sample([u0, u1]), direction };
        match tracer.closest(&ray, Some(patch.facet)) {
            None => escaped += 1,
            Some(hit) if !hit.front && backs.is_dark(hit.polygon, ray.origin + hit.t * direction) => darkened += 1,
            Some(_) => {}
        }
    }
    let n = n_rays as f64;
    let weight = patch.etendue / n;
    let hedged = ((escaped + darkened) as f64 + 0.5) / (n + 1.0);
    Lost {
        escaped: weight * escaped as f64,
        darkened: weight * darkened as f64,
        variance: hedged * (1.0 - hedged) * patch.etendue * weight,
    }
}
