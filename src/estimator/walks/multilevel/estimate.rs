//! All levels together.

use super::Multilevel;
use crate::estimator::{Estimate, Estimator, estimate};
use crate::linalg::Block;
use crate::sampling::mix_seed;

/// What one level took and brought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelReport {
    pub n_bundles: usize,
    /// Samples a bundle.
    pub n_samples: u64,
    /// Steps of all walks, the pilot's left out.
    pub n_steps: u64,
    /// Variance of one sample, averaged over étendue, in the worst band.
    pub variance: f64,
}

/// Means of the finest bundles.
#[derive(Clone, Debug, PartialEq)]
pub struct MultilevelEstimate {
    /// n × bands, W m⁻² sr⁻¹.
    pub mean: Block,
    /// n × bands. Bundles with a coarser one in common share its error: they are not independent.
    pub variance_of_mean: Block,
    /// Coarsest first.
    pub levels: Vec<LevelReport>,
}

impl Multilevel<'_> {
    /// Radiance of the finest bundles with a root-mean-square standard error of about `error` (over étendue, in the worst band), after
    /// `n_pilot` ≥ 2 samples a bundle and level that find out the variances.
    pub fn estimate(&self, error: f64, n_pilot: u64, seed: u64) -> MultilevelEstimate {
        // N = ε⁻² √(V/C) Σ √(V C), with C the steps of one sample of every bundle and at least one a bundle.
        let pilots: Vec<(f64, f64)> = (0..self.n_levels())
            .map(|k| {
                let pilot = self.level(k, n_pilot.max(2), mix_seed(seed, 2 * k as u64));
                let n_samples = pilot.n_samples as f64;
                let cost = pilot.n_steps as f64 / n_samples + self.levels[k].n_bundles() as f64;
                (self.variance(k, &pilot), cost)
            })
            .collect();
        let sum: f64 = pilots.iter().map(|(variance, cost)| (variance * cost).sqrt()).sum();
        let n_samples =
            |(variance, cost): (f64, f64)| ((variance / cost).sqrt() * sum / (error * error)).ceil().max(2.0) as u64;
        let samples: Vec<u64> = pilots.into_iter().map(n_samples).collect();
        self.estimate_with(&samples, seed)
    }

    /// The same with given numbers of samples, one a level, coarsest first.
    ///
    /// # Panics
    /// If there is not one number a level.
    pub fn estimate_with(&self, samples: &[u64], seed: u64) -> MultilevelEstimate {
        assert_eq!(samples.len(), self.n_levels(), "one number of samples a level");
        let mut levels = Vec::with_capacity(samples.len());
        let mut sums: Option<[Block; 2]> = None;
        for (k, n_samples) in samples.iter().enumerate() {
            let drawn = self.level(k, *n_samples, mix_seed(seed, 2 * k as u64 + 1));
            let (n_bundles, n_steps) = (self.levels[k].n_bundles(), drawn.n_steps);
            levels.push(LevelReport { n_bundles, n_samples: *n_samples, n_steps, variance: self.variance(k, &drawn) });

            // Hand down what the coarser levels have found, and add what this one puts right.
            let handed_down = |coarse: &Block, added: &Block| match self.levels[k].parents() {
                Some(parents) => {
                    let value = |i: usize, band| coarse.get(parents[i] as usize, band) + added.get(i, band);
                    Block::from_fn(added.n_rows(), added.n_columns(), value)
                }
                None => added.clone(),
            };
            sums = Some(match sums {
                Some([mean, variance]) => {
                    [handed_down(&mean, &drawn.mean), handed_down(&variance, &drawn.variance_of_mean)]
                }
                None => [drawn.mean, drawn.variance_of_mean],
            });
        }
        let [mean, variance_of_mean] = sums.unwrap_or_default();
        MultilevelEstimate { mean, variance_of_mean, levels }
    }

    fn level(&self, k: usize, n_samples: u64, seed: u64) -> Estimate {
        estimate(&self.levels[k] as &dyn Estimator, n_samples, seed)
    }

    /// Variance of one sample of a level, averaged over étendue, in the worst band.
    fn variance(&self, k: usize, drawn: &Estimate) -> f64 {
        let etendue = self.levels[k].etendue();
        let total: f64 = etendue.iter().sum();
        let bands = drawn.variance_of_mean.columns();
        let mean = |column: &[f64]| column.iter().zip(etendue).map(|(v, mu)| v * mu).sum::<f64>() / total;
        bands.map(mean).fold(0.0, f64::max) * drawn.n_samples as f64
    }
}
