//! Window glass.

use super::Brdf;
use super::deltas::Deltas;
use super::fresnel;
use super::glass::Glass;
use crate::geometry::Vec3;

/// A pane too thin to shift what is behind it, Mitsuba 3's `thindielectric`. With the light that goes to and fro inside,
///
/// ```text
/// reflected F + (1 − F)² F (1 + F² + …) = 2F/(1 + F),      passed straight through (1 − F)/(1 + F)
/// ```
///
/// There is the same medium on both sides.
#[derive(Clone, Debug, PartialEq)]
pub struct ThinDielectric {
    glass: Glass,
}

impl ThinDielectric {
    /// A pane of this glass: `int_ior` inside, `ext_ior` on both sides.
    pub fn new(glass: Glass) -> Self {
        Self { glass }
    }
}

impl Brdf for ThinDielectric {
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
        let once = fresnel::dielectric(outgoing.z.abs().min(1.0), self.glass.relative_index()).reflectance;
        let reflected = self.glass.reflected(band) * 2.0 * once / (1.0 + once);
        let passed = self.glass.transmitted(band) * (1.0 - once) / (1.0 + once);
        Deltas::mirror(outgoing, reflected).with(-outgoing, passed)
    }

    fn mirror_share(&self, outgoing: Vec3) -> f64 {
        if self.deltas(0, outgoing).is_empty() { 0.0 } else { 1.0 }
    }

    fn is_transmissive(&self) -> bool {
        true
    }

    fn lambertian(&self) -> Option<&[f64]> {
        None
    }

    fn description(&self) -> String {
        format!("thindielectric {}", self.glass.description())
    }
}
