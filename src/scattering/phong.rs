//! The modified Phong lobe: the simplest glossy surface that is reciprocal and conserves energy.

use super::Brdf;
use super::deltas::mirrored;
use crate::geometry::Vec3;
use crate::sampling::warp;
use crate::stats::special::{gamma_ratio_half, regularised_incomplete_beta};
use std::f64::consts::{PI, TAU};
use thiserror::Error;

/// Lafortune & Willems' (1994) modified Phong lobe,
///
/// ```text
/// f_r = reflectance (n + 2)/(2π) cosⁿα,      cosα = incident · mirrored outgoing > 0
/// ```
///
/// Its albedo is the reflectance at normal incidence, and less elsewhere: what the lobe loses below the horizon is absorbed, never
/// given back. For n → ∞ the albedo tends to reflectance · cosθ.
#[derive(Clone, Debug, PartialEq)]
pub struct Phong {
    reflectance: Vec<f64>,
    exponent: f64,
}

/// An exponent that makes no lobe.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PhongError {
    #[error("the Phong exponent is {exponent:e}, must be finite and not negative")]
    Exponent { exponent: f64 },
}

impl Phong {
    /// One reflectance (the albedo at normal incidence) a band, and the exponent n ≥ 0 of the lobe. The range of the reflectances is checked
    /// where a scene is made, which can name the surface.
    ///
    /// # Errors
    /// An exponent that is negative or not finite.
    pub fn new(reflectance: Vec<f64>, exponent: f64) -> Result<Self, PhongError> {
        if !(exponent.is_finite() && exponent >= 0.0) {
            return Err(PhongError::Exponent { exponent });
        }
        Ok(Self { reflectance, exponent })
    }

    /// Albedo of a lobe of reflectance 1. With c = cosθ, s = sinθ and I the regularised incomplete beta function
    ///
    /// ```text
    /// albedo(θ) = c (1 − ½ I_{s²}(n/2 + 1, ½)) + s^{n+2}/(2√π) Γ(n/2 + ½)/Γ(n/2 + 1)
    /// ```
    ///
    /// Derived about the mirror direction: the part of the lobe whose full circles lie above the horizon is elementary; in the rest, the
    /// arc above the horizon is an arccosine, removed by parts, and ∫ sinⁿ⁺²t / (1 − s² sin²t) dt over [0, π/2] remains, a hypergeometric
    /// function that Euler's transformation turns into I.
    fn unit_albedo(&self, cosine: f64) -> f64 {
        let c = cosine.clamp(0.0, 1.0);
        let sine_squared = (1.0 - c) * (1.0 + c);
        let half = 0.5 * self.exponent;
        let lost = 0.5 * regularised_incomplete_beta(half + 1.0, 0.5, sine_squared);
        c * (1.0 - lost) + sine_squared.powf(half + 1.0) * gamma_ratio_half(half) / (2.0 * PI.sqrt())
    }
}

impl Brdf for Phong {
    fn n_bands(&self) -> usize {
        self.reflectance.len()
    }

    fn eval(&self, band: usize, incident: Vec3, outgoing: Vec3) -> f64 {
        if incident.z <= 0.0 || outgoing.z <= 0.0 {
            return 0.0;
        }
        let cosine = incident.dot(mirrored(outgoing));
        if cosine > 0.0 {
            self.reflectance[band] * (self.exponent + 2.0) / TAU * cosine.powf(self.exponent)
        } else {
            0.0
        }
    }

    /// Draws from cosⁿα about the mirror direction; what falls below the horizon is absorbed.
    fn sample(&self, outgoing: Vec3, uniform: [f64; 2]) -> Option<Vec3> {
        if outgoing.z <= 0.0 {
            return None;
        }
        let axis = mirrored(outgoing);
        let (x, y) = axis.any_orthonormal_pair();
        let [a, b, c] = warp::phong_lobe(self.exponent, uniform);
        let incident = (a * x + b * y + c * axis).normalize();
        (incident.z > 0.0).then_some(incident)
    }

    fn pdf(&self, outgoing: Vec3, incident: Vec3) -> f64 {
        if incident.z <= 0.0 || outgoing.z <= 0.0 {
            return 0.0;
        }
        warp::phong_lobe_pdf(self.exponent, incident.dot(mirrored(outgoing)))
    }

    /// In closed form; relative error below 1e-12 for exponents up to 1000.
    fn albedo(&self, band: usize, outgoing: Vec3) -> f64 {
        if outgoing.z > 0.0 { self.reflectance[band] * self.unit_albedo(outgoing.z) } else { 0.0 }
    }

    fn lambertian(&self) -> Option<&[f64]> {
        None
    }

    fn description(&self) -> String {
        format!("phong reflectance={:?} exponent={:?}", self.reflectance, self.exponent)
    }
}
