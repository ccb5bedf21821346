//! A medium that is the same everywhere.

use super::Phase;
use std::sync::Arc;
use thiserror::Error;

/// A homogeneous medium: how much light it takes away per metre, how much of that it scatters, and where to.
#[derive(Clone, Debug)]
pub struct Homogeneous {
    extinction: Vec<f64>,
    single_scattering_albedo: Vec<f64>,
    phase: Arc<dyn Phase>,
}

/// A coefficient no medium has.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum MediumError {
    #[error("extinction has {n_extinction} bands, single-scattering albedo has {n_albedo}")]
    BandCount { n_extinction: usize, n_albedo: usize },
    #[error("{quantity} in band {band} is {value:e}, must be finite and within [0, {high:e}]")]
    OutOfRange { quantity: &'static str, band: usize, value: f64, high: f64 },
}

impl Homogeneous {
    /// Extinction σ_t (m⁻¹) and single-scattering albedo σ_s/σ_t, one value a band each, and the phase function of all bands.
    ///
    /// # Errors
    /// Band counts that differ, an extinction that is negative or not finite, an albedo outside [0, 1].
    pub fn new(
        extinction: Vec<f64>,
        single_scattering_albedo: Vec<f64>,
        phase: Arc<dyn Phase>,
    ) -> Result<Self, MediumError> {
        let (n_extinction, n_albedo) = (extinction.len(), single_scattering_albedo.len());
        if n_extinction != n_albedo {
            return Err(MediumError::BandCount { n_extinction, n_albedo });
        }
        let quantities =
            [("extinction", &extinction, f64::MAX), ("single-scattering albedo", &single_scattering_albedo, 1.0)];
        for (quantity, values, high) in quantities {
            if let Some((band, &value)) = values.iter().enumerate().find(|(_, v)| !(0.0..=high).contains(*v)) {
                return Err(MediumError::OutOfRange { quantity, band, value, high });
            }
        }
        Ok(Self { extinction, single_scattering_albedo, phase })
    }

    pub fn n_bands(&self) -> usize {
        self.extinction.len()
    }

    /// σ_t in m⁻¹: the rate at which light is absorbed or scattered.
    pub fn extinction(&self, band: usize) -> f64 {
        self.extinction[band]
    }

    /// The fraction of what is taken away that is scattered, not absorbed.
    pub fn single_scattering_albedo(&self, band: usize) -> f64 {
        self.single_scattering_albedo[band]
    }

    /// Where scattered light goes.
    pub fn phase(&self) -> &dyn Phase {
        &*self.phase
    }

    /// τ = σ_t · distance, the optical thickness of a stretch of `distance` metres.
    pub fn optical_thickness(&self, band: usize, distance: f64) -> f64 {
        self.extinction[band] * distance
    }

    /// exp(−τ): the fraction of light that crosses the stretch (Beer & Lambert).
    pub fn transmittance(&self, band: usize, distance: f64) -> f64 {
        (-self.optical_thickness(band, distance)).exp()
    }

    /// 1 − exp(−τ): the fraction taken away on the stretch, to full accuracy in thin air.
    pub fn opacity(&self, band: usize, distance: f64) -> f64 {
        -(-self.optical_thickness(band, distance)).exp_m1()
    }
}
