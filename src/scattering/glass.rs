//! What dielectrics are made of.

use super::fresnel::index;
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
