//! Blinn and Phong's lobe about the half vector.

use super::Brdf;
use super::half_vectors::{Rim, Tail, integrate};
use super::parameter::{Examination, ParameterError};
use super::quadrature::Quadrature;
use crate::geometry::Vec3;
use crate::sampling::warp;
use std::f64::consts::PI;

/// The reciprocal, energy-normalised lobe
///
/// ```text
/// f = reflectance (n + 2)(n + 4) / (8π (n + 2^{−n/2})) (h_z)ⁿ,      h = (i + o)/|i + o|
/// ```
///
/// whose albedo is the reflectance at normal incidence, where it is largest. An exponent of 0 is Lambert's law. Samples h from
/// (h_z)ⁿ; what is mirrored below the horizon is absorbed. Sources: Blinn 1977; the constant is ∫ (h_z)ⁿ i_z dωᵢ at normal incidence,
/// done by hand.
#[derive(Clone, Debug, PartialEq)]
pub struct BlinnPhong {
    reflectance: Vec<f64>,
    exponent: f64,
}

impl BlinnPhong {
    /// One reflectance (the albedo at normal incidence) a band, and the exponent of the lobe.
    ///
    /// # Errors
    /// A reflectance outside [0, 1], an exponent outside [0, 10⁶].
    pub fn new(reflectance: Vec<f64>, exponent: f64) -> Result<Self, ParameterError> {
        let examine = Examination("blinn-phong");
        examine.fractions("reflectance", &reflectance)?;
        examine.within("exponent", exponent, 0.0..=1e6, "within [0, 1e6]")?;
        Ok(Self { reflectance, exponent })
    }

    /// The directional albedo with its error, by quadrature over slopes (some 0.1 ms).
    pub fn albedo_with_error(&self, band: usize, outgoing: Vec3) -> Quadrature {
        if outgoing.z <= 0.0 {
            return Quadrature::ZERO;
        }
        let width = (2.0 / (self.exponent + 2.0)).sqrt();
        let scale = self.reflectance[band] * self.constant();
        integrate(outgoing, ([width; 2], Tail::Algebraic), Rim::Mirrored, |facet| {
            scale * facet.cosine.powf(self.exponent + 3.0) * facet.incident.z * 4.0 * facet.facing
        })
    }

    fn constant(&self) -> f64 {
        let n = self.exponent;
        (n + 2.0) * (n + 4.0) / (8.0 * PI * (n + (-0.5 * n).exp2()))
    }
}

impl Brdf for BlinnPhong {
    fn n_bands(&self) -> usize {
        self.reflectance.len()
    }

    fn eval(&self, band: usize, incident: Vec3, outgoing: Vec3) -> f64 {
        if incident.z <= 0.0 || outgoing.z <= 0.0 {
            return 0.0;
        }
        let sum = incident + outgoing;
        self.reflectance[band] * self.constant() * (sum.z / sum.length()).powf(self.exponent)
    }

    fn sample(&self, outgoing: Vec3, uniform: [f64; 2]) -> Option<Vec3> {
        if outgoing.z <= 0.0 {
            return None;
        }
        let normal = Vec3::from(warp::phong_lobe(self.exponent, uniform));
        let incident = (2.0 * outgoing.dot(normal) * normal - outgoing).normalize();
        (incident.z > 0.0).then_some(incident)
    }

    fn pdf(&self, outgoing: Vec3, incident: Vec3) -> f64 {
        if incident.z <= 0.0 || outgoing.z <= 0.0 {
            return 0.0;
        }
        let sum = incident + outgoing;
        let length = sum.length();
        warp::phong_lobe_pdf(self.exponent, sum.z / length) / (2.0 * length)
    }

    fn albedo(&self, band: usize, outgoing: Vec3) -> f64 {
        self.albedo_with_error(band, outgoing).value
    }

    fn lambertian(&self) -> Option<&[f64]> {
        None
    }

    fn description(&self) -> String {
        format!("blinn-phong reflectance={:?} exponent={:?}", self.reflectance, self.exponent)
    }
}
