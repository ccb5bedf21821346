//! What conductors are made of.

use super::fresnel;
use super::parameter::{Examination, ParameterError};

/// What a metal is made of: n − ik against the medium above, a pair a band, and a share of what Fresnel's equations reflect.
#[derive(Clone, Debug, PartialEq)]
pub struct Metal {
    eta: Vec<f64>,
    k: Vec<f64>,
    specular_reflectance: Vec<f64>,
}

impl Metal {
    /// One value a band each; `specular_reflectance` is 1 where physics is meant.
    ///
    /// # Errors
    /// Different numbers of bands, an index that is not positive, an extinction that is negative, a reflectance outside [0, 1].
    pub fn new(eta: Vec<f64>, k: Vec<f64>, specular_reflectance: Vec<f64>) -> Result<Self, ParameterError> {
        let examine = Examination("conductor");
        examine.bands("number of k", k.len(), eta.len())?;
        examine.bands("number of specular_reflectance", specular_reflectance.len(), eta.len())?;
        examine.fractions("specular_reflectance", &specular_reflectance)?;
        eta.iter().try_for_each(|v| examine.within("eta", *v, 0.0..=f64::MAX, "finite and not negative"))?;
        k.iter().try_for_each(|v| examine.within("k", *v, 0.0..=f64::MAX, "finite and not negative"))?;
        Ok(Self { eta, k, specular_reflectance })
    }

    /// Reflects this share at every angle: Fresnel's reflectance is 1 (Mitsuba's material `none`).
    ///
    /// # Errors
    /// A reflectance outside [0, 1].
    pub fn ideal(specular_reflectance: Vec<f64>) -> Result<Self, ParameterError> {
        let n_bands = specular_reflectance.len();
        Self::new(vec![0.0; n_bands], vec![1.0; n_bands], specular_reflectance)
    }

    /// Number of colour bands.
    pub fn n_bands(&self) -> usize {
        self.eta.len()
    }

    /// The share of light that a facet reflects at this cosine of incidence.
    pub fn reflectance(&self, band: usize, cosine: f64) -> f64 {
        self.specular_reflectance[band] * fresnel::conductor(cosine, self.eta[band], self.k[band])
    }

    pub(super) fn description(&self) -> String {
        let Self { eta, k, specular_reflectance } = self;
        format!("eta={eta:?} k={k:?} specular_reflectance={specular_reflectance:?}")
    }
}
