//! Smooth glass: an interface that refracts, and a thin pane.

use super::Brdf;
use super::deltas::Deltas;
use super::fresnel::{self, index, refracted};
use super::parameter::{Examination, ParameterError};
use crate::geometry::Vec3;

/// The two media an interface joins, and the shares of Fresnel's light that it lets be.
#[derive(Clone, Debug, PartialEq)]
pub struct Glass {
    int_ior: f64,
    ext_ior: f64,
    specular_reflectance: Vec<f64>,
    specular_transmittance: Vec<f64>,
}

impl Glass {
    /// Clear glass: refractive index below the surface, index above it.
    ///
    /// # Errors
    /// An index that is not positive and finite.
    pub fn clear(int_ior: f64, ext_ior: f64, n_bands: usize) -> Result<Self, ParameterError> {
        Self::new(int_ior, ext_ior, vec![1.0; n_bands], vec![1.0; n_bands])
    }

    /// Shares other than 1, a value a band each, are not physical: Mitsuba has them.
    ///
    /// # Errors
    /// An index that is not positive and finite, a share outside [0, 1], different numbers of bands.
    pub fn new(
        int_ior: f64,
        ext_ior: f64,
        specular_reflectance: Vec<f64>,
        specular_transmittance: Vec<f64>,
    ) -> Result<Self, ParameterError> {
        let examine = Examination("dielectric");
        examine.index("int_ior", int_ior)?;
        examine.index("ext_ior", ext_ior)?;
        examine.index("int_ior/ext_ior", int_ior / ext_ior)?;
        examine.bands("number of specular_transmittance", specular_transmittance.len(), specular_reflectance.len())?;
        examine.fractions("specular_reflectance", &specular_reflectance)?;
        examine.fractions("specular_transmittance", &specular_transmittance)?;
        Ok(Self { int_ior, ext_ior, specular_reflectance, specular_transmittance })
    }

    /// Mitsuba's: borosilicate crown glass in air.
    pub fn bk7(n_bands: usize) -> Self {
        let clear = vec![1.0; n_bands];
        let (int_ior, ext_ior) = (index::BK7, index::AIR);
        Self { int_ior, ext_ior, specular_reflectance: clear.clone(), specular_transmittance: clear }
    }

    /// Number of colour bands.
    pub fn n_bands(&self) -> usize {
        self.specular_reflectance.len()
    }

    /// Index below over index above.
    pub fn relative_index(&self) -> f64 {
        self.int_ior / self.ext_ior
    }

    /// Index beyond the surface over the index on the side this direction is on.
    pub(super) fn relative_index_from(&self, direction: Vec3) -> f64 {
        if direction.z > 0.0 { self.int_ior / self.ext_ior } else { self.ext_ior / self.int_ior }
    }

    pub(super) fn reflected(&self, band: usize) -> f64 {
        self.specular_reflectance[band]
    }

    pub(super) fn transmitted(&self, band: usize) -> f64 {
        self.specular_transmittance[band]
    }

    pub(super) fn description(&self) -> String {
        let Self { int_ior, ext_ior, specular_reflectance, specular_transmittance } = self;
        format!(
            "int_ior={int_ior:?} ext_ior={ext_ior:?} specular_reflectance={specular_reflectance:?} \
             specular_transmittance={specular_transmittance:?}"
        )
    }
}

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
