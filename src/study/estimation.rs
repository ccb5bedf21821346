//! Random answers at growing sample counts, against the discrete truth.

use super::outcome::{EstimatorRun, SamplePoint};
use super::{StudyError, StudySettings};
use crate::assembly::System;
use crate::compare::{compare_blocks, pooled, relative_rms};
use crate::estimator::{Estimate, Estimator, estimate_watched};
use crate::linalg::{Block, max_abs};
use crate::stats::fit_power_law;
use std::time::Instant;

/// Estimates with 1, 4, 16, … samples a bundle, each run holding the ones before.
pub(super) fn estimate_growing(
    estimator: &dyn Estimator,
    most: u64,
    settings: &StudySettings,
    truth: &Block,
    system: &System,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<(EstimatorRun, Estimate), StudyError> {
    let start = Instant::now();
    let weights = system.etendue();
    let mut total: Option<Estimate> = None;
    let mut points = Vec::new();
    let (mut samples, mut from) = (1, 0);
    while from < most {
        let share = |done: f64| progress((from as f64 + done * (samples - from) as f64) / most as f64);
        let part = estimate_watched(estimator, from..samples, settings.seed, &share);
        let merged = match total {
            None => part,
            Some(sofar) => sofar.merge(&part)?,
        };
        if samples > 1 {
            let error = relative_rms(&merged.mean, truth, weights);
            points.push(SamplePoint {
                samples_per_bundle: samples,
                error,
                standard_error: predicted(&merged, truth, weights),
            });
        }
        total = Some(merged);
        (from, samples) = (samples, (4 * samples).min(most));
    }
    let estimate = total.ok_or(StudyError::NoEstimator)?;
    // The brightest bundle: all bounces together outshine the lamp, and no score is much above that.
    let largest: Vec<f64> = truth.columns().map(max_abs).collect();
    let [reference, mean, variance] =
        pooled(truth, &estimate.mean, &estimate.variance_of_mean, weights, estimate.n_samples, &largest);
    let verdict = compare_blocks(&reference, &mean, &variance, settings.significance);
    let (n, errors): (Vec<f64>, Vec<f64>) = points.iter().map(|p| (p.samples_per_bundle as f64, p.error)).unzip();
    let run = EstimatorRun {
        estimator: estimator.name().to_string(),
        truth: estimator.truth().to_string(),
        worst_z: verdict.worst_z,
        n_comparisons: verdict.n_comparisons,
        p_value: verdict.p_value,
        slope: fit_power_law(&n, &errors).map_or(f64::NAN, |line| line.slope),
        points,
        seconds: start.elapsed().as_secs_f64(),
    };
    Ok((run, estimate))
}

/// The error that the estimate's own error bars predict, on the scale of [`relative_rms`].
fn predicted(estimate: &Estimate, truth: &Block, weights: &[f64]) -> f64 {
    let weigh = |block: &Block, power: i32| -> f64 {
        block.columns().map(|c| c.iter().zip(weights).map(|(v, w)| w * v.powi(power)).sum::<f64>()).sum()
    };
    (weigh(&estimate.variance_of_mean, 1) / weigh(truth, 2)).sqrt()
}
