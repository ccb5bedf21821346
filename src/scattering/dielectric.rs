//! Smooth glass.

use super::Brdf;
use super::deltas::Deltas;
use super::fresnel::{self, refracted};
use super::glass::Glass;
use crate::geometry::Vec3;

/// A smooth interface between two media, Mitsuba 3's `dielectric`: weight F of the mirrored direction, 1 − F of the refracted one (in basic
/// radiance), from either side; beyond the critical angle the mirror alone.
#[derive(Clone, Debug, PartialEq)]
pub struct Dielectric {
    glass: Glass,
}

impl Dielectric {
    /// A polished surface of this glass.
    pub fn new(glass: Glass) -> Self {
        Self { glass }
    }
}

impl Brdf for Dielectric {
    fn n_bands(&self) -> usize {
        self.glass.n_bands()
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
        if outgoing.z == 0.0 {
            return Deltas::NONE;
        }
        let eta = self.glass.relative_index_from(outgoing);
        let interface = fresnel::dielectric(outgoing.z.abs().min(1.0), eta);
        let mirror = Deltas::mirror(outgoing, self.glass.reflected(band) * interface.reflectance);
        if interface.transmitted_cosine == 0.0 {
            return mirror;
        }
        let passed = self.glass.transmitted(band) * (1.0 - interface.reflectance);
        mirror.with(refracted(outgoing, eta, interface.transmitted_cosine), passed)
    }

    fn mirror_share(&self, outgoing: Vec3) -> f64 {
        if self.deltas(0, outgoing).is_empty() { 0.0 } else { 1.0 }
    }

    fn is_transmissive(&self) -> bool {
        true
    }

    fn relative_index(&self) -> f64 {
        self.glass.relative_index()
    }

    fn lambertian(&self) -> Option<&[f64]> {
        None
    }

    fn description(&self) -> String {
        format!("dielectric {}", self.glass.description())
    }
}
