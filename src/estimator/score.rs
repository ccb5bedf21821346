//! What one sample adds up to.

use crate::stats::Moments;
use std::ops::Range;

/// The running totals of one sample, for every bundle in its reach.
///
/// Contributions of one sample are summed before they are squared: the variance is that of whole samples.
#[derive(Clone, Debug)]
pub struct Score {
    /// The first bundle in reach.
    first: usize,
    n_bands: usize,
    /// Totals, bundle by bundle, one a band.
    totals: Vec<f64>,
    is_touched: Vec<bool>,
    /// The bundles in reach that this sample has scored, counted from `first`.
    touched: Vec<usize>,
}

impl Score {
    pub(super) fn new(n_bands: usize) -> Self {
        Self { first: 0, n_bands, totals: Vec::new(), is_touched: Vec::new(), touched: Vec::new() }
    }

    /// Adds to one bundle and band.
    ///
    /// # Panics
    /// If the bundle is out of the start's reach.
    #[inline]
    pub fn add(&mut self, bundle: usize, band: usize, value: f64) {
        self.totals(bundle)[band] += value;
    }

    /// This sample's totals for one bundle, one a band, to be added to.
    ///
    /// # Panics
    /// If the bundle is out of the start's reach.
    #[inline]
    pub fn totals(&mut self, bundle: usize) -> &mut [f64] {
        let local = bundle.wrapping_sub(self.first);
        if !self.is_touched[local] {
            self.is_touched[local] = true;
            self.touched.push(local);
        }
        &mut self.totals[local * self.n_bands..][..self.n_bands]
    }

    /// Turns to other bundles, with all totals zero.
    pub(super) fn aim(&mut self, reach: Range<usize>) {
        self.first = reach.start;
        self.totals.resize(reach.len() * self.n_bands, 0.0);
        self.is_touched.resize(reach.len(), false);
    }

    /// Ends the sample: hands its totals on, and starts again from zero. Bundles that were not scored are not pushed.
    pub(super) fn flush(&mut self, moments: &mut [Moments]) {
        for local in self.touched.drain(..) {
            self.is_touched[local] = false;
            let here = local * self.n_bands..(local + 1) * self.n_bands;
            for (total, moments) in self.totals[here.clone()].iter_mut().zip(&mut moments[here]) {
                moments.push(*total);
                *total = 0.0;
            }
        }
    }
}
