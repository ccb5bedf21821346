//! The perfectly diffuse surface.

use super::Brdf;
use crate::geometry::Vec3;
use crate::sampling::warp;
use std::f64::consts::FRAC_1_PI;

/// f_r = albedo/π: the same radiance in every direction, whatever the direction of incidence.
#[derive(Clone, Debug, PartialEq)]
pub struct Lambert {
    albedo: Vec<f64>,
}

impl Lambert {
    /// One albedo a band. Their range is checked where a scene is made, which can name the surface.
    pub fn new(albedo: Vec<f64>) -> Self {
        Self { albedo }
    }

    /// The same albedo in every band.
    pub fn grey(albedo: f64, n_bands: usize) -> Self {
        Self::new(vec![albedo; n_bands])
    }

    /// Reflects nothing in any band.
    pub fn black(n_bands: usize) -> Self {
        Self::grey(0.0, n_bands)
    }
}

impl Brdf for Lambert {
    fn n_bands(&self) -> usize {
        self.albedo.len()
    }

    fn eval(&self, band: usize, incident: Vec3, outgoing: Vec3) -> f64 {
        if incident.z > 0.0 && outgoing.z > 0.0 { self.albedo[band] * FRAC_1_PI } else { 0.0 }
    }

    fn sample(&self, outgoing: Vec3, uniform: [f64; 2]) -> Option<Vec3> {
        (outgoing.z > 0.0).then(|| warp::cosine_hemisphere(uniform).into())
    }

    fn pdf(&self, outgoing: Vec3, incident: Vec3) -> f64 {
        if outgoing.z > 0.0 { warp::cosine_hemisphere_pdf(incident.to_array()) } else { 0.0 }
    }

    fn albedo(&self, band: usize, _outgoing: Vec3) -> f64 {
        self.albedo[band]
    }

    fn lambertian(&self) -> Option<&[f64]> {
        Some(&self.albedo)
    }

    fn description(&self) -> String {
        format!("lambert albedo={:?}", self.albedo)
    }
}
