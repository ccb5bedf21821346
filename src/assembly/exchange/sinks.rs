//! What leaves a patch and never comes back: into the environment of an open scene, or onto the black back of a surface.

use super::visibility::End;
use crate::geometry::{Frame, Ray, Tracer, Vec3};
use crate::sampling::{Kronecker, mix};
use crate::scene::{Scene, Side};
use std::f64::consts::TAU;

/// Shares of a patch's étendue.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lost {
    /// Share that leaves the scene.
    pub escaped: f64,
    /// Share that ends on black backs.
    pub darkened: f64,
    /// Variance of their sum, binomial: an upper bound for points spread evenly.
    pub variance: f64,
}

/// Follows `n_rays` rays uniform in étendue from the patch to where they first meet something.
pub fn lost_from(scene: &Scene, tracer: &Tracer, patch: End, n_rays: usize, key: u64) -> Lost {
    let frame = Frame::about(patch.polygon.normal());
    let points = Kronecker::<4>::new(mix(&[key]));
    let (mut escaped, mut darkened) = (0usize, 0usize);
    for k in 0..n_rays {
        let [u0, u1, u2, u3] = points.point(k);
        // Uniform in projected solid angle: a point of the unit disk, lifted.
        let (sine, azimuth) = (u2.sqrt(), TAU * u3);
        let local = Vec3::new(sine * azimuth.cos(), sine * azimuth.sin(), (1.0 - u2).sqrt());
        let ray = Ray { origin: patch.polygon.sample([u0, u1]), direction: frame.to_world(local) };
        match tracer.closest(&ray, Some(patch.facet)) {
            None => escaped += 1,
            Some(hit) if !hit.front && scene.surface_of(hit.polygon).brdf(Side::Back).is_none() => darkened += 1,
            Some(_) => {}
        }
    }
    let n = n_rays as f64;
    let lost = (escaped + darkened) as f64 / n;
    Lost { escaped: escaped as f64 / n, darkened: darkened as f64 / n, variance: lost * (1.0 - lost) / n }
}
