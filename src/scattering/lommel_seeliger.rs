//! Lommel and Seeliger's law: light scattered once in a deep cloud of dark grains.

use super::Brdf;
use super::parameter::{Examination, ParameterError};
use crate::geometry::Vec3;
use crate::sampling::warp;
use std::f64::consts::PI;

/// f = w/(4π (i_z + o_z)) for single-scattering albedo w: reciprocal, not Lambertian, and its albedo a closed form,
///
/// ```text
/// a(μ) = w/2 (1 − μ ln((1 + μ)/μ)) ≤ ½
/// ```
///
/// Samples the cosine. Source: Seeliger 1888; Chandrasekhar 1960, §47.
#[derive(Clone, Debug, PartialEq)]
pub struct LommelSeeliger {
    single_scattering_albedo: Vec<f64>,
}

impl LommelSeeliger {
    /// One single-scattering albedo a band.
    ///
    /// # Errors
    /// An albedo outside [0, 1].
    pub fn new(single_scattering_albedo: Vec<f64>) -> Result<Self, ParameterError> {
        Examination("lommel-seeliger").fractions("single_scattering_albedo", &single_scattering_albedo)?;
        Ok(Self { single_scattering_albedo })
    }
}

impl Brdf for LommelSeeliger {
    fn n_bands(&self) -> usize {
        self.single_scattering_albedo.len()
    }

    fn eval(&self, band: usize, incident: Vec3, outgoing: Vec3) -> f64 {
        if incident.z <= 0.0 || outgoing.z <= 0.0 {
            return 0.0;
        }
        self.single_scattering_albedo[band] / (4.0 * PI * (incident.z + outgoing.z))
    }

    fn sample(&self, outgoing: Vec3, uniform: [f64; 2]) -> Option<Vec3> {
        (outgoing.z > 0.0).then(|| warp::cosine_hemisphere(uniform).into())
    }

    fn pdf(&self, outgoing: Vec3, incident: Vec3) -> f64 {
        if outgoing.z > 0.0 { warp::cosine_hemisphere_pdf(incident.to_array()) } else { 0.0 }
    }

    fn albedo(&self, band: usize, outgoing: Vec3) -> f64 {
        let cosine = outgoing.z;
        if cosine <= 0.0 {
            return 0.0;
        }
        0.5 * self.single_scattering_albedo[band] * (1.0 - cosine * cosine.recip().ln_1p())
    }

    fn lambertian(&self) -> Option<&[f64]> {
        None
    }

    fn description(&self) -> String {
        format!("lommel-seeliger single_scattering_albedo={:?}", self.single_scattering_albedo)
    }
}
