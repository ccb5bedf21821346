//! Random answers at growing sample counts, against the discrete truth and against their own forecast.

use super::agreement::{Batches, Verdict, against_batches, against_variances, variance_agreement};
use super::estimators::{Approach, Member, REPLICATES, Roster};
use super::outcome::{EstimatorRun, SamplePoint};
use super::refinement::{self, SurfaceSample};
use super::{StudyError, StudySettings};
use crate::compare::relative_rms;
use crate::estimator::{Estimate, EstimatorError, Prediction, estimate_watched};
use crate::linalg::Block;
use crate::stats::fit_power_law;
use std::time::Instant;

/// Parts that the last and largest range of samples is drawn in where one sample scores many bundles: what their error bars rest on.
const N_BATCHES: u64 = 48;

/// Relative errors below this are what rounding leaves of no variance at all.
const ROUNDING: f64 = 1e-12;

/// A method's record, and the surface means of one that estimates the continuous truth.
pub(super) struct Estimated {
    pub run: EstimatorRun,
    pub surfaces: Option<SurfaceSample>,
}

/// All that was drawn.
struct Drawn {
    estimate: Estimate,
    points: Vec<SamplePoint>,
    /// Empty where the errors of bundles are independent.
    batches: Batches,
}

/// One method at 1, 4, 16, … samples a bundle, each run holding the ones before.
///
/// # Errors
/// What the method refuses.
pub(super) fn estimate_growing(
    roster: &Roster<'_>,
    name: &str,
    settings: &StudySettings,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Estimated, StudyError> {
    let member = roster.member(name)?;
    let most = member.most(settings.walk_samples, settings.path_samples);

    // Say what the error bars will be, then draw.
    let (prediction, prediction_refusal) = match roster.predict(&member) {
        Some(Ok(prediction)) => (Some(prediction), None),
        Some(Err(refusal)) => (None, Some(refusal)),
        None => (None, None),
    };
    let draw = Draw { roster, member: &member, prediction: prediction.as_ref(), seed: settings.seed, progress };
    let Drawn { estimate, points, batches } =
        if let Member::Quasi(_) = &member { draw.replicates(most)? } else { draw.samples(most)? };

    // Hold it against the truth, by batches where one sample scores many bundles.
    let largest = roster.largest_scores(&member);
    let n_particles = member.n_particles(most);
    let Verdict { worst_z, n_degrees_of_freedom, n_comparisons, p_value } = if member.is_joint() {
        against_batches(roster, &batches, n_particles, &largest)
    } else {
        let n_degrees_of_freedom = matches!(member, Member::Quasi(_)).then_some((REPLICATES - 1) as f64);
        against_variances(roster, &estimate, n_particles, &largest, n_degrees_of_freedom)
    };
    let is_continuous = Approach::of(name) == Approach::Paths;
    let surfaces = is_continuous.then(|| surface_sample(roster, &estimate, &batches));

    let last = points.last().copied();
    let of_last = |value: &dyn Fn(SamplePoint) -> f64| last.map_or(f64::NAN, value);
    let slopes = |abscissa: &dyn Fn(&SamplePoint) -> f64| {
        let (x, y): (Vec<f64>, Vec<f64>) = points.iter().map(|p| (abscissa(p), p.error)).unzip();
        // Rounding has no slope.
        let is_exact = y.iter().all(|error| *error < ROUNDING);
        if is_exact { f64::NAN } else { fit_power_law(&x, &y).map_or(f64::NAN, |line| line.slope) }
    };
    let slope = slopes(&|p| p.samples_per_bundle as f64);
    let run = EstimatorRun {
        estimator: name.to_string(),
        approach: Approach::of(name),
        truth: estimate.truth.to_string(),
        refusal: None,
        worst_z,
        n_degrees_of_freedom,
        n_comparisons,
        p_value,
        slope,
        seconds_slope: slopes(&|p| p.seconds),
        efficiency: of_last(&|p| 1.0 / (p.standard_error.powi(2) * p.seconds)),
        samples_for_percent: of_last(&|p| samples_for(0.01, p, slope, matches!(member, Member::Quasi(_)))),
        variance: prediction
            .as_ref()
            .and_then(|prediction| variance_agreement(roster, &estimate, &batches, prediction)),
        prediction_refusal,
        mesh: None,
        seconds: of_last(&|p| p.seconds),
        points,
    };
    Ok(Estimated { run, surfaces })
}

impl EstimatorRun {
    /// A method that could not claim the scene, in its own words.
    pub(super) fn refused(name: &str, refusal: &EstimatorError) -> Self {
        let approach = Approach::of(name);
        let truth = if approach == Approach::Paths { "continuous" } else { "discrete" };
        Self {
            estimator: name.to_string(),
            approach,
            truth: truth.to_string(),
            refusal: Some(refusal.to_string()),
            points: Vec::new(),
            worst_z: f64::NAN,
            n_degrees_of_freedom: None,
            n_comparisons: 0,
            p_value: f64::NAN,
            slope: f64::NAN,
            seconds_slope: f64::NAN,
            efficiency: f64::NAN,
            samples_for_percent: f64::NAN,
            variance: None,
            prediction_refusal: None,
            mesh: None,
            seconds: 0.0,
        }
    }
}

/// What is drawn from, and who watches.
struct Draw<'a> {
    roster: &'a Roster<'a>,
    member: &'a Member<'a>,
    prediction: Option<&'a Prediction>,
    seed: u64,
    progress: &'a (dyn Fn(f64) + Sync),
}

impl Draw<'_> {
    /// Independent samples: every count holds the samples of the ones before.
    fn samples(&self, most: u64) -> Result<Drawn, StudyError> {
        let (member, estimator) = (self.member, self.member.estimator());
        let unit = member.samples_a_bundle();
        let (mut total, mut seconds): (Option<Estimate>, f64) = (None, 0.0);
        let (mut points, mut batches) = (Vec::new(), Batches::default());
        let mut from = 0;
        for samples in counts(1, most) {
            let drawn = from * unit..samples * unit;
            let length = drawn.end - drawn.start;
            let in_batches = member.is_joint() && samples == most;
            let n_parts = if in_batches { N_BATCHES.min(length) } else { 1 };
            for part in 0..n_parts {
                let [begin, end] = [part, part + 1].map(|k| drawn.start + length * k / n_parts);
                let share =
                    |done: f64| (self.progress)((begin as f64 + done * (end - begin) as f64) / (most * unit) as f64);
                let start = Instant::now();
                let drawn = estimate_watched(estimator, begin..end, self.seed, &share);
                seconds += start.elapsed().as_secs_f64();
                if in_batches {
                    batches.push(self.roster, &drawn, member.n_particles(most), &self.roster.largest_scores(member));
                }
                total = Some(match total {
                    None => drawn,
                    Some(before) => before.merge(&drawn)?,
                });
            }
            if let Some(estimate) = total.as_ref().filter(|estimate| estimate.n_samples > 1) {
                points.push(self.point(samples, estimate, estimate.n_steps, seconds));
            }
            from = samples;
        }
        Ok(Drawn { estimate: total.ok_or(StudyError::NoEstimator)?, points, batches })
    }

    /// Replicates of longer and longer sequences, every count drawn anew: a sequence is even only as a whole.
    fn replicates(&self, most: u64) -> Result<Drawn, StudyError> {
        let Member::Quasi(walk) = self.member else { return Err(StudyError::NoEstimator) };
        let (mut last, mut points, mut sofar) = (None, Vec::new(), 0.0);
        for n_points in counts(1, most / REPLICATES) {
            let share =
                |done: f64| (self.progress)((sofar + done * (n_points * REPLICATES) as f64) / (1.34 * most as f64));
            let start = Instant::now();
            let estimate = estimate_watched(&walk.with_points(n_points), 0..REPLICATES, self.seed, &share);
            let seconds = start.elapsed().as_secs_f64();
            sofar += (n_points * REPLICATES) as f64;
            points.push(self.point(n_points * REPLICATES, &estimate, estimate.n_steps, seconds));
            last = Some(estimate);
        }
        Ok(Drawn { estimate: last.ok_or(StudyError::NoEstimator)?, points, batches: Batches::default() })
    }

    fn point(&self, samples_per_bundle: u64, estimate: &Estimate, steps: u64, seconds: f64) -> SamplePoint {
        let (truth, weights) = (self.roster.truth, self.roster.system.etendue());
        let predicted = self.prediction.map(|prediction| {
            let n_samples = estimate.n_samples as f64;
            (weigh(&prediction.variance, weights, 1) / n_samples / weigh(truth, weights, 2)).sqrt()
        });
        SamplePoint {
            samples_per_bundle,
            error: relative_rms(&estimate.mean, truth, weights),
            standard_error: (weigh(&estimate.variance_of_mean, weights, 1) / weigh(truth, weights, 2)).sqrt(),
            predicted,
            steps,
            seconds,
        }
    }
}

/// `first` times 1, 4, 16, … and `most` at last.
fn counts(first: u64, most: u64) -> Vec<u64> {
    let below = std::iter::successors(Some(first), |n| n.checked_mul(4)).take_while(|n| *n < most);
    below.chain([most]).collect()
}

/// Samples a bundle after which the relative standard error is `error`: at −1/2, or at the slope measured where that is better by design.
fn samples_for(error: f64, last: SamplePoint, slope: f64, is_even: bool) -> f64 {
    let known = last.predicted.unwrap_or(last.standard_error);
    let slope = if is_even && slope < -0.5 { slope } else { -0.5 };
    (last.samples_per_bundle as f64 * (known / error).powf(-1.0 / slope)).ceil().max(1.0)
}

/// Mean reflected radiance of every surface, and the variance of that mean.
fn surface_sample(roster: &Roster<'_>, estimate: &Estimate, batches: &Batches) -> SurfaceSample {
    if let Some(sample) = batches.surface_sample() {
        return sample;
    }
    let (scene, bundles) = (roster.scene, roster.bundles);
    let mut reflected = estimate.mean.clone();
    reflected.add_scaled(-1.0, roster.system.emission());
    let (mean, variance) = refinement::surface_means(scene, bundles, &reflected, Some(&estimate.variance_of_mean));
    SurfaceSample { mean, variance, n_degrees_of_freedom: None }
}

/// Σ weight · valueᵖ over all entries.
pub(super) fn weigh(block: &Block, weights: &[f64], power: i32) -> f64 {
    block.columns().map(|c| c.iter().zip(weights).map(|(v, w)| w * v.powi(power)).sum::<f64>()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_grow_by_four_and_end_where_they_are_told() {
        assert_eq!(counts(1, 64), [1, 4, 16, 64]);
        assert_eq!(counts(1, 50), [1, 4, 16, 50]);
        assert_eq!(counts(1, 1), [1]);
    }

    #[test]
    fn a_tenth_of_the_error_takes_a_hundred_times_the_samples() {
        let point = |standard_error: f64, predicted: Option<f64>| SamplePoint {
            samples_per_bundle: 100,
            error: f64::NAN,
            standard_error,
            predicted,
            steps: 0,
            seconds: 0.0,
        };
        assert_eq!(samples_for(0.01, point(0.1, None), -0.3, false), 10_000.0);
        assert_eq!(samples_for(0.01, point(9.0, Some(0.02)), -0.5, false), 400.0);
        assert_eq!(samples_for(0.01, point(0.1, None), -1.0, true), 1000.0);
        assert_eq!(samples_for(0.01, point(1e-15, None), f64::NAN, false), 1.0);
    }
}
