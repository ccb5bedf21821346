//! What a path still carries, one number a band.

use std::ops::{Deref, DerefMut};

/// Bands kept on the stack.
const N_INLINE: usize = 4;

/// One number a band: no allocation for up to four bands.
#[derive(Clone, Debug)]
pub(super) struct Throughput {
    n_bands: usize,
    few: [f64; N_INLINE],
    many: Vec<f64>,
}

impl Throughput {
    /// 1 in every band.
    #[inline]
    pub fn ones(n_bands: usize) -> Self {
        let many = if n_bands > N_INLINE { vec![1.0; n_bands] } else { Vec::new() };
        Self { n_bands, few: [1.0; N_INLINE], many }
    }

    /// The largest band's.
    #[inline]
    pub fn max(&self) -> f64 {
        self.iter().copied().fold(0.0, f64::max)
    }
}

impl Deref for Throughput {
    type Target = [f64];

    #[inline]
    fn deref(&self) -> &[f64] {
        if self.n_bands <= N_INLINE { &self.few[..self.n_bands] } else { &self.many }
    }
}

impl DerefMut for Throughput {
    #[inline]
    fn deref_mut(&mut self) -> &mut [f64] {
        if self.n_bands <= N_INLINE { &mut self.few[..self.n_bands] } else { &mut self.many }
    }
}
