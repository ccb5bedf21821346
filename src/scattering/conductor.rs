//! Smooth reflectors: the ideal mirror and polished metal.

use super::Brdf;
use super::deltas::Deltas;
use super::metal::Metal;
use super::parameter::ParameterError;
use crate::geometry::Vec3;

/// A mirror of metal, Mitsuba 3's `conductor`: one mirror-like term of weight F(cosθ), no smooth part.
///
/// Of [`Metal::ideal`] it is the ideal mirror, which reflects the same share at every angle.
#[derive(Clone, Debug, PartialEq)]
pub struct Conductor {
    metal: Metal,
}

impl Conductor {
    /// A polished surface of this metal.
    pub fn new(metal: Metal) -> Self {
        Self { metal }
    }

    /// Reflects this share in each band, at every angle.
    ///
    /// # Errors
    /// A reflectance outside [0, 1].
    pub fn mirror(reflectance: Vec<f64>) -> Result<Self, ParameterError> {
        Ok(Self::new(Metal::ideal(reflectance)?))
    }
}

impl Brdf for Conductor {
    fn n_bands(&self) -> usize {
        self.metal.n_bands()
    }

    fn eval(&self, _band: usize, _incident: Vec3, _outgoing: Vec3) -> f64 {
        0.0
    }

    fn sample(&self, _outgoing: Vec3, _uniform: [f64; 2]) -> Option<Vec3> {
        None
    }

    fn pdf(&self, _outgoing: Vec3, _incident: Vec3) -> f64 {
        0.0
    }

    fn albedo(&self, band: usize, outgoing: Vec3) -> f64 {
        self.deltas(band, outgoing).weight()
    }

    fn deltas(&self, band: usize, outgoing: Vec3) -> Deltas {
        if outgoing.z <= 0.0 {
            return Deltas::NONE;
        }
        Deltas::mirror(outgoing, self.metal.reflectance(band, outgoing.z.min(1.0)))
    }

    fn mirror_share(&self, outgoing: Vec3) -> f64 {
        if self.deltas(0, outgoing).is_empty() { 0.0 } else { 1.0 }
    }

    fn lambertian(&self) -> Option<&[f64]> {
        None
    }

    fn description(&self) -> String {
        format!("conductor {}", self.metal.description())
    }
}
