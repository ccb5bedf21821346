//! One number a band.

use std::ops::{Deref, DerefMut};

/// Bands kept in place.
const N_INLINE: usize = 4;

/// One number a band, e.g. what a path still carries. Up to four bands need no allocation.
#[derive(Clone, Debug)]
pub(super) struct Bands {
    n_bands: usize,
    few: [f64; N_INLINE],
    many: Vec<f64>,
}

impl Bands {
    /// The same value in every band.
    #[inline]
    pub fn all(value: f64, n_bands: usize) -> Self {
        let many = if n_bands > N_INLINE { vec![value; n_bands] } else { Vec::new() };
        Self { n_bands, few: [value; N_INLINE], many }
    }

    /// The largest of them, or 0.
    #[inline]
    pub fn max(&self) -> f64 {
        self.iter().copied().fold(0.0, f64::max)
    }
}

impl Deref for Bands {
    type Target = [f64];

    #[inline]
    fn deref(&self) -> &[f64] {
        if self.n_bands <= N_INLINE { &self.few[..self.n_bands] } else { &self.many }
    }
}

impl DerefMut for Bands {
    #[inline]
    fn deref_mut(&mut self) -> &mut [f64] {
        if self.n_bands <= N_INLINE { &mut self.few[..self.n_bands] } else { &mut self.many }
    }
}
