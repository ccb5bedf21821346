//! Running mean and variance, one number at a time, mergeable.

use serde::Serialize;

/// Count, mean and sum of squared deviations of a sample, updated without cancellation (Welford 1962).
///
/// Merging in a fixed order gives the same bits whoever computed the parts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Moments {
    n: u64,
    mean: f64,
    squared_deviations: f64,
}

impl Moments {
    pub fn push(&mut self, value: f64) {
        self.n += 1;
        let before = value - self.mean;
        self.mean += before / self.n as f64;
        self.squared_deviations += before * (value - self.mean);
    }

    /// The moments of both samples together (Chan, Golub & LeVeque 1979).
    pub fn merge(&mut self, other: &Self) {
        if self.n == 0 || other.n == 0 {
            if self.n == 0 {
                *self = *other;
            }
            return;
        }
        let n = self.n + other.n;
        let share = other.n as f64 / n as f64;
        let apart = other.mean - self.mean;
        self.squared_deviations += other.squared_deviations + apart * apart * self.n as f64 * share;
        self.mean += apart * share;
        self.n = n;
    }

    /// Takes the sample as one of `n` numbers, those not pushed being zero: for scores that rarely hit.
    pub fn pad_with_zeros(&mut self, n: u64) {
        let n_missing = n.saturating_sub(self.n);
        self.merge(&Self { n: n_missing, mean: 0.0, squared_deviations: 0.0 });
    }

    /// From count, mean and Σ (x − mean)².
    pub(super) fn from_sums(n: u64, mean: f64, squared_deviations: f64) -> Self {
        Self { n, mean, squared_deviations }
    }

    /// How many numbers.
    pub fn n(&self) -> u64 {
        self.n
    }

    /// 0 if there are none.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// Unbiased variance of one number, Σ (x − mean)² / (n − 1). NaN below two numbers: nothing is known.
    pub fn variance(&self) -> f64 {
        if self.n < 2 { f64::NAN } else { self.squared_deviations / (self.n - 1) as f64 }
    }

    /// variance / n. NaN below two numbers.
    pub fn variance_of_mean(&self) -> f64 {
        self.variance() / self.n as f64
    }

    /// √(variance / n). NaN below two numbers.
    pub fn standard_error(&self) -> f64 {
        self.variance_of_mean().sqrt()
    }
}

impl FromIterator<f64> for Moments {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        let mut moments = Self::default();
        values.into_iter().for_each(|v| moments.push(v));
        moments
    }
}

/// Many [`Moments`] side by side, each with its own count: one for every bundle and band, say.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MomentsBlock {
    n: Vec<u64>,
    mean: Vec<f64>,
    squared_deviations: Vec<f64>,
}

impl MomentsBlock {
    /// `len` empty samples.
    pub fn new(len: usize) -> Self {
        Self { n: vec![0; len], mean: vec![0.0; len], squared_deviations: vec![0.0; len] }
    }

    /// How many samples are kept side by side.
    pub fn len(&self) -> usize {
        self.n.len()
    }

    pub fn is_empty(&self) -> bool {
        self.n.is_empty()
    }

    /// Adds a number to one sample.
    pub fn push(&mut self, entry: usize, value: f64) {
        let mut moments = self.get(entry);
        moments.push(value);
        self.set(entry, moments);
    }

    /// Merges sample by sample.
    ///
    /// # Panics
    /// If the lengths differ.
    pub fn merge(&mut self, other: &Self) {
        assert_eq!(self.len(), other.len(), "blocks of moments to merge must have the same length");
        for entry in 0..self.len() {
            self.merge_entry(entry, &other.get(entry));
        }
    }

    /// Merges into one sample.
    pub fn merge_entry(&mut self, entry: usize, other: &Moments) {
        let mut moments = self.get(entry);
        moments.merge(other);
        self.set(entry, moments);
    }

    /// [`Moments::pad_with_zeros`] for every sample.
    pub fn pad_with_zeros(&mut self, n: u64) {
        for entry in 0..self.len() {
            let mut moments = self.get(entry);
            moments.pad_with_zeros(n);
            self.set(entry, moments);
        }
    }

    /// One sample's moments.
    pub fn get(&self, entry: usize) -> Moments {
        Moments { n: self.n[entry], mean: self.mean[entry], squared_deviations: self.squared_deviations[entry] }
    }

    /// The means, in order.
    pub fn means(&self) -> &[f64] {
        &self.mean
    }

    /// The variances of the means, in order.
    pub fn variances_of_mean(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.len()).map(|entry| self.get(entry).variance_of_mean())
    }

    fn set(&mut self, entry: usize, moments: Moments) {
        self.n[entry] = moments.n;
        self.mean[entry] = moments.mean;
        self.squared_deviations[entry] = moments.squared_deviations;
    }
}
