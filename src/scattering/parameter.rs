//! Parameters that make no surface.

use std::ops::RangeInclusive;
use thiserror::Error;

/// A parameter out of its range: which, of what, and the range.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{brdf}: {parameter} is {value:e}, must be {expected}")]
pub struct ParameterError {
    pub brdf: &'static str,
    pub parameter: &'static str,
    pub value: f64,
    pub expected: &'static str,
}

/// The parameters of one BRDF under examination.
pub(super) struct Examination(pub &'static str);

impl Examination {
    /// Fails unless the value lies in the range.
    pub fn within(
        &self,
        parameter: &'static str,
        value: f64,
        range: RangeInclusive<f64>,
        expected: &'static str,
    ) -> Result<(), ParameterError> {
        if range.contains(&value) { Ok(()) } else { Err(ParameterError { brdf: self.0, parameter, value, expected }) }
    }

    /// Fails unless every fraction of light lies in [0, 1].
    pub fn fractions(&self, parameter: &'static str, values: &[f64]) -> Result<(), ParameterError> {
        values.iter().try_for_each(|v| self.within(parameter, *v, 0.0..=1.0, "within [0, 1]"))
    }

    /// Fails unless the refractive index is positive and finite.
    pub fn index(&self, parameter: &'static str, value: f64) -> Result<(), ParameterError> {
        self.within(parameter, value, f64::MIN_POSITIVE..=f64::MAX, "positive and finite")
    }

    /// Fails unless there are as many values as bands.
    pub fn bands(&self, parameter: &'static str, n: usize, n_bands: usize) -> Result<(), ParameterError> {
        let (value, range) = (n as f64, n_bands as f64..=n_bands as f64);
        self.within(parameter, value, range, "the number of bands of the first parameter")
    }
}
