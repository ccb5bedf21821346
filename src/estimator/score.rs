//! What samples add up to.

use crate::stats::Moments;
use std::ops::Range;

/// The running totals of one sample, and the moments of the samples before it, for every bundle in reach of a start.
///
/// Contributions of one sample are summed before they are squared: the variance is that of whole samples.
#[derive(Clone, Debug)]
pub struct Score {
    /// The first bundle in reach.
    first: usize,
    n_columns: usize,
    /// Totals of the sample, bundle by bundle, one a column.
    totals: Vec<f64>,
    /// Moments of the samples that have ended, likewise.
    moments: Vec<Moments>,
    n_samples: u64,
    n_steps: u64,
    is_touched: Vec<bool>,
    /// The bundles that the sample has scored, counted from `first`.
    touched: Vec<usize>,
}

impl Score {
    pub(super) fn new(reach: Range<usize>, n_columns: usize) -> Self {
        let n_bundles = reach.len();
        Self {
            first: reach.start,
            n_columns,
            totals: vec![0.0; n_bundles * n_columns],
            moments: vec![Moments::default(); n_bundles * n_columns],
            n_samples: 0,
            n_steps: 0,
            is_touched: vec![false; n_bundles],
            touched: Vec::new(),
        }
    }

    /// Adds to one bundle and column.
    ///
    /// # Panics
    /// If the bundle is out of the start's reach.
    #[inline]
    pub fn add(&mut self, bundle: usize, column: usize, value: f64) {
        self.totals(bundle)[column] += value;
    }

    /// This sample's totals for one bundle, one a column, to be added to.
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
        &mut self.totals[local * self.n_columns..][..self.n_columns]
    }

    /// Counts what samples cost: steps of a walk, rays of a path.
    #[inline]
    pub fn count_steps(&mut self, n_steps: u64) {
        self.n_steps += n_steps;
    }

    /// Ends one sample: its totals become numbers to average, and start again from zero.
    #[inline]
    pub fn end_sample(&mut self) {
        self.n_samples += 1;
        for local in self.touched.drain(..) {
            self.is_touched[local] = false;
            let here = local * self.n_columns..(local + 1) * self.n_columns;
            for (total, moments) in self.totals[here.clone()].iter_mut().zip(&mut self.moments[here]) {
                moments.push(*total);
                *total = 0.0;
            }
        }
    }

    pub(super) fn n_steps(&self) -> u64 {
        self.n_steps
    }

    /// The moments of all samples that have ended, those counted as zero that did not score a bundle.
    pub(super) fn into_moments(mut self) -> Vec<Moments> {
        self.moments.iter_mut().for_each(|moments| moments.pad_with_zeros(self.n_samples));
        self.moments
    }
}
