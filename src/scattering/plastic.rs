//! Smooth plastic: paint under a clear, smooth coat.

use super::Brdf;
use super::deltas::Deltas;
use super::fresnel::{self, index};
use super::parameter::{Examination, ParameterError};
use crate::geometry::Vec3;
use crate::sampling::warp;
use std::f64::consts::FRAC_1_PI;

/// A coat of relative index η over a diffuse base of albedo d,
///
/// ```text
/// mirror F(o_z),      f = (1 − F(i_z)) (1 − F(o_z)) d / (π η² (1 − d' F_int))
/// ```
///
/// F_int is the diffuse reflectance of the coat from inside; d' = d where the colour of what goes to and fro under the coat saturates
/// (`nonlinear`), 1 where it does not. Mitsuba 3's `plastic`. Reciprocal; and since (1 − F_ext)/η² = 1 − F_int, the albedo is
///
/// ```text
/// F(o_z) + (1 − F(o_z)) d (1 − F_int)/(1 − d' F_int) ≤ 1,      1 for d = 1
/// ```
///
/// so white plastic is a furnace either way. Samples the cosine.
#[derive(Clone, Debug, PartialEq)]
pub struct Plastic {
    base: Base,
    specular_reflectance: Vec<f64>,
}

/// What lies under a clear coat.
#[derive(Clone, Debug, PartialEq)]
pub struct Base {
    pub(super) diffuse_reflectance: Vec<f64>,
    pub(super) relative_index: f64,
    /// Diffuse reflectance of the smooth coat from inside.
    pub(super) internal: f64,
    pub(super) nonlinear: bool,
}

impl Base {
    /// A diffuse albedo a band under a coat of index `int_ior` in `ext_ior`; whether colours saturate.
    ///
    /// # Errors
    /// An albedo outside [0, 1], or a coat that is not denser than what is around it.
    pub fn new(
        diffuse_reflectance: Vec<f64>,
        int_ior: f64,
        ext_ior: f64,
        nonlinear: bool,
    ) -> Result<Self, ParameterError> {
        let examine = Examination("plastic");
        examine.fractions("diffuse_reflectance", &diffuse_reflectance)?;
        examine.index("int_ior", int_ior)?;
        examine.index("ext_ior", ext_ior)?;
        let relative_index = int_ior / ext_ior;
        examine.within("int_ior/ext_ior", relative_index, 1.0..=1e3, "within [1, 1000]")?;
        let internal = fresnel::diffuse_reflectance(relative_index.recip());
        Ok(Self { diffuse_reflectance, relative_index, internal, nonlinear })
    }

    /// Mitsuba's: polypropylene in air, linear.
    ///
    /// # Errors
    /// An albedo outside [0, 1].
    pub fn polypropylene(diffuse_reflectance: Vec<f64>) -> Result<Self, ParameterError> {
        Self::new(diffuse_reflectance, index::POLYPROPYLENE, index::AIR, false)
    }

    /// The share of the light that is mirrored by a coat of this reflectance, roughly, kept within [0.1, 0.9].
    pub(super) fn mirror_share(&self, mirrored: f64) -> f64 {
        let base = self.diffuse_reflectance.iter().sum::<f64>() / self.diffuse_reflectance.len().max(1) as f64;
        (mirrored / (mirrored + (1.0 - mirrored) * base)).clamp(0.1, 0.9)
    }

    /// d/(1 − d' R) of a coat that reflects the share R back to the base.
    pub(super) fn gain(&self, band: usize, internal: f64) -> f64 {
        let d = self.diffuse_reflectance[band];
        d / (1.0 - if self.nonlinear { d } else { 1.0 } * internal)
    }

    pub(super) fn description(&self) -> String {
        let Self { diffuse_reflectance, relative_index, nonlinear, .. } = self;
        format!("diffuse_reflectance={diffuse_reflectance:?} relative_index={relative_index:?} nonlinear={nonlinear}")
    }
}

impl Plastic {
    /// A smooth coat over this base, and a share (1 where physics is meant) of what it mirrors, a value a band.
    ///
    /// # Errors
    /// A share outside [0, 1], different numbers of bands.
    pub fn new(base: Base, specular_reflectance: Vec<f64>) -> Result<Self, ParameterError> {
        let examine = Examination("plastic");
        examine.bands("number of specular_reflectance", specular_reflectance.len(), base.diffuse_reflectance.len())?;
        examine.fractions("specular_reflectance", &specular_reflectance)?;
        Ok(Self { base, specular_reflectance })
    }

    fn reflectance(&self, cosine: f64) -> f64 {
        fresnel::dielectric(cosine.min(1.0), self.base.relative_index).reflectance
    }
}

impl Brdf for Plastic {
    fn n_bands(&self) -> usize {
        self.specular_reflectance.len()
    }

    fn eval(&self, band: usize, incident: Vec3, outgoing: Vec3) -> f64 {
        if incident.z <= 0.0 || outgoing.z <= 0.0 {
            return 0.0;
        }
        let through = (1.0 - self.reflectance(incident.z)) * (1.0 - self.reflectance(outgoing.z));
        let eta = self.base.relative_index;
        through * self.base.gain(band, self.base.internal) * FRAC_1_PI / (eta * eta)
    }

    fn sample(&self, outgoing: Vec3, uniform: [f64; 2]) -> Option<Vec3> {
        (outgoing.z > 0.0).then(|| warp::cosine_hemisphere(uniform).into())
    }

    fn pdf(&self, outgoing: Vec3, incident: Vec3) -> f64 {
        if outgoing.z > 0.0 { warp::cosine_hemisphere_pdf(incident.to_array()) } else { 0.0 }
    }

    fn albedo(&self, band: usize, outgoing: Vec3) -> f64 {
        if outgoing.z <= 0.0 {
            return 0.0;
        }
        let mirror = self.reflectance(outgoing.z);
        let internal = self.base.internal;
        let base = (1.0 - mirror) * (1.0 - internal) * self.base.gain(band, internal);
        (self.specular_reflectance[band] * mirror + base).min(1.0)
    }

    fn deltas(&self, band: usize, outgoing: Vec3) -> Deltas {
        if outgoing.z <= 0.0 {
            return Deltas::NONE;
        }
        Deltas::mirror(outgoing, self.specular_reflectance[band] * self.reflectance(outgoing.z))
    }

    fn mirror_share(&self, outgoing: Vec3) -> f64 {
        if outgoing.z > 0.0 { self.base.mirror_share(self.reflectance(outgoing.z)) } else { 0.0 }
    }

    fn lambertian(&self) -> Option<&[f64]> {
        None
    }

    fn description(&self) -> String {
        format!("plastic {} specular_reflectance={:?}", self.base.description(), self.specular_reflectance)
    }
}
