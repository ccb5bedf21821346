//! Paper, a lampshade: diffuse on both sides.

use super::Brdf;
use super::choice::{Choice, choose};
use super::parameter::{Examination, ParameterError};
use crate::geometry::Vec3;
use crate::sampling::warp;
use std::f64::consts::FRAC_1_PI;

/// Reflects and transmits the same radiance in every direction: f = reflectance/π on one side, transmittance/π across, the same medium on
/// both sides.
///
/// Samples the side by its share of the light (of all bands together), then the cosine.
#[derive(Clone, Debug, PartialEq)]
pub struct DiffuseTransmission {
    reflectance: Vec<f64>,
    transmittance: Vec<f64>,
    /// Chance of a sample on the side of the outgoing direction.
    share: f64,
}

impl DiffuseTransmission {
    /// One value a band each.
    ///
    /// # Errors
    /// Different numbers of bands, a value outside [0, 1], or two that sum to more than 1.
    pub fn new(reflectance: Vec<f64>, transmittance: Vec<f64>) -> Result<Self, ParameterError> {
        let examine = Examination("difftrans");
        examine.bands("number of transmittance", transmittance.len(), reflectance.len())?;
        examine.fractions("reflectance", &reflectance)?;
        examine.fractions("transmittance", &transmittance)?;
        for (r, t) in reflectance.iter().zip(&transmittance) {
            examine.within("reflectance + transmittance", r + t, 0.0..=1.0 + f64::EPSILON, "within [0, 1]")?;
        }
        let [back, through] = [&reflectance, &transmittance].map(|side| side.iter().sum::<f64>());
        let share = if back + through > 0.0 { back / (back + through) } else { 1.0 };
        Ok(Self { reflectance, transmittance, share })
    }
}

impl Brdf for DiffuseTransmission {
    fn n_bands(&self) -> usize {
        self.reflectance.len()
    }

    fn eval(&self, band: usize, incident: Vec3, outgoing: Vec3) -> f64 {
        let product = incident.z * outgoing.z;
        let side = if product > 0.0 { &self.reflectance } else { &self.transmittance };
        if product == 0.0 { 0.0 } else { side[band] * FRAC_1_PI }
    }

    fn sample(&self, outgoing: Vec3, [u, v]: [f64; 2]) -> Option<Vec3> {
        if outgoing.z == 0.0 {
            return None;
        }
        let (u, side) = match choose(self.share, u) {
            Choice::First(u) => (u, outgoing.z.signum()),
            Choice::Second(u) => (u, -outgoing.z.signum()),
        };
        let [x, y, z] = warp::cosine_hemisphere([u, v]);
        Some(Vec3::new(x, y, side * z))
    }

    fn pdf(&self, outgoing: Vec3, incident: Vec3) -> f64 {
        let product = incident.z * outgoing.z;
        let share = if product > 0.0 { self.share } else { 1.0 - self.share };
        if product == 0.0 { 0.0 } else { share * incident.z.abs() * FRAC_1_PI }
    }

    fn albedo(&self, band: usize, outgoing: Vec3) -> f64 {
        if outgoing.z == 0.0 { 0.0 } else { (self.reflectance[band] + self.transmittance[band]).min(1.0) }
    }

    fn is_transmissive(&self) -> bool {
        true
    }

    fn lambertian(&self) -> Option<&[f64]> {
        None
    }

    fn description(&self) -> String {
        format!("difftrans reflectance={:?} transmittance={:?}", self.reflectance, self.transmittance)
    }
}
