//! Are random answers the deterministic ones, and their variances those foretold?
//!
//! Where a bundle's samples score it alone, its own variance is the error bar. Where one sample scores many bundles, batches of samples are
//! independent and bundles are not: then a sum over bundles is compared by the spread of its batches, and Student's t takes the place of z.

use super::estimation::weigh;
use super::estimators::Roster;
use super::outcome::VarianceAgreement;
use super::refinement::{SurfaceSample, surface_means};
use crate::compare::{ROUNDING_TOLERANCE, compare_blocks, pooled};
use crate::estimator::{Estimate, Prediction};
use crate::linalg::Block;
use crate::stats::{Moments, sidak, student_tail, variance_test_of};

/// A χ² of fewer degrees of freedom than this is too wide to tell anything.
const FEWEST_DEGREES: f64 = 30.0;

/// Predicted relative variances below this are rounding.
const NO_VARIANCE: f64 = 1e-24;

/// Kurtosis of a normal number, whose variance has χ² with one degree of freedom less than there are numbers.
const NORMAL_KURTOSIS: f64 = 3.0;

/// The farthest of many comparisons.
pub(super) struct Verdict {
    pub worst_z: f64,
    /// Of the t that it is, where it is none of a normal.
    pub n_degrees_of_freedom: Option<f64>,
    pub n_comparisons: usize,
    /// Šidák-corrected.
    pub p_value: f64,
}

/// What independent parts of an estimate have measured.
#[derive(Clone, Debug, Default)]
pub(super) struct Batches {
    /// Reflected flux of pooled bundles.
    pooled: Vec<Moments>,
    /// Étendue-weighted sum of the sample variances.
    variance: Moments,
    /// Reflected radiance, surfaces × bands.
    surfaces: Vec<Moments>,
    shape: (usize, usize),
}

impl Batches {
    /// Adds one part of an estimate of `n_particles` in all.
    pub fn push(&mut self, roster: &Roster<'_>, part: &Estimate, n_particles: u64, largest: &[f64]) {
        let [_, flux] = pooled_flux(roster, &part.mean, n_particles, largest);
        add(&mut self.pooled, flux.values());
        self.variance.push(weigh(&part.variance_of_mean, roster.system.etendue(), 1) * part.n_samples as f64);

        let mut reflected = part.mean.clone();
        reflected.add_scaled(-1.0, roster.system.emission());
        let (means, _) = surface_means(roster.scene, roster.bundles, &reflected, None);
        add(&mut self.surfaces, means.values());
        self.shape = (means.n_rows(), means.n_columns());
    }

    /// Means of surfaces by the spread of the batches; `None` without two.
    pub fn surface_sample(&self) -> Option<SurfaceSample> {
        if self.variance.n() < 2 {
            return None;
        }
        let (n_rows, n_columns) = self.shape;
        let block = |of: &dyn Fn(&Moments) -> f64| {
            Block::from_fn(n_rows, n_columns, |s, band| of(&self.surfaces[s + n_rows * band]))
        };
        Some(SurfaceSample {
            mean: block(&Moments::mean),
            variance: block(&Moments::variance_of_mean),
            n_degrees_of_freedom: Some((self.variance.n() - 1) as f64),
        })
    }
}

/// Bundle by bundle, pooled with neighbours; `n_degrees_of_freedom` where each variance rests on few numbers.
pub(super) fn against_variances(
    roster: &Roster<'_>,
    estimate: &Estimate,
    n_samples: u64,
    largest: &[f64],
    n_degrees_of_freedom: Option<f64>,
) -> Verdict {
    let weights = roster.system.etendue();
    let [reference, mean, variance] =
        pooled(roster.truth, &estimate.mean, &estimate.variance_of_mean, weights, n_samples, largest);
    // The level decides nothing here: who reads the p-value has his own.
    let verdict = compare_blocks(&reference, &mean, &variance, 0.5);
    let n = verdict.n_comparisons;
    let p_value = match n_degrees_of_freedom {
        Some(degrees) if n > 0 && verdict.worst_z.is_finite() => {
            sidak((2.0 * student_tail(verdict.worst_z, degrees)).min(1.0), n)
        }
        _ => verdict.p_value,
    };
    Verdict { worst_z: verdict.worst_z, n_degrees_of_freedom, n_comparisons: n, p_value }
}

/// Pooled flux by the spread of the batches.
pub(super) fn against_batches(roster: &Roster<'_>, batches: &Batches, n_particles: u64, largest: &[f64]) -> Verdict {
    let n_batches = batches.variance.n();
    if n_batches < 3 || batches.pooled.is_empty() {
        return Verdict { worst_z: 0.0, n_degrees_of_freedom: None, n_comparisons: 0, p_value: 1.0 };
    }
    let [reference, _] = pooled_flux(roster, roster.truth, n_particles, largest);
    let size = reference.max_abs();
    let degrees = (n_batches - 1) as f64;
    let mut worst: f64 = 0.0;
    for (flux, moments) in reference.values().iter().zip(&batches.pooled) {
        let error = moments.variance_of_mean().sqrt().hypot(ROUNDING_TOLERANCE * size);
        let t = (moments.mean() - flux).abs() / error;
        worst = worst.max(if t.is_nan() { f64::INFINITY } else { t });
    }
    let n_comparisons = batches.pooled.len();
    let p_value = sidak((2.0 * student_tail(worst, degrees)).min(1.0), n_comparisons);
    Verdict { worst_z: worst, n_degrees_of_freedom: Some(degrees), n_comparisons, p_value }
}

/// Holds the measured variance of a sample against the predicted one, both summed over bundles and bands with their étendue.
pub(super) fn variance_agreement(
    roster: &Roster<'_>,
    estimate: &Estimate,
    batches: &Batches,
    prediction: &Prediction,
) -> Option<VarianceAgreement> {
    let weights = roster.system.etendue();
    let predicted = weigh(&prediction.variance, weights, 1);
    if predicted <= NO_VARIANCE * weigh(roster.truth, weights, 2) {
        return None;
    }

    // Take the spread of the sum from the fourth moments where bundles are independent, bands of one walk as wholly dependent; from the
    // spread of the batches where they are not.
    let (measured, standard_error) = if batches.variance.n() > 2 {
        (batches.variance.mean(), batches.variance.standard_error())
    } else {
        let errors = prediction.variance_standard_error(estimate.n_samples)?;
        let of_band = |c: &[f64]| c.iter().zip(weights).map(|(e, w)| (w * e).powi(2)).sum::<f64>().sqrt();
        let measured = weigh(&estimate.variance_of_mean, weights, 1) * estimate.n_samples as f64;
        (measured, errors.columns().map(of_band).sum())
    };

    // A χ² that is as wide.
    let n_degrees = 2.0 * (predicted / standard_error).powi(2);
    if !(FEWEST_DEGREES..1e15).contains(&n_degrees) {
        return None;
    }
    let test = variance_test_of(n_degrees.round() as u64 + 1, measured, predicted, NORMAL_KURTOSIS).ok()?;
    Some(VarianceAgreement { ratio: test.ratio, standard_error: standard_error / predicted, p_value: test.p_value })
}

/// What is reflected, as flux, of the truth and of an answer, pooled until normal. A particle carries much the same to all bundles, so flux and
/// not radiance makes its scores equal.
fn pooled_flux(roster: &Roster<'_>, answer: &Block, n_particles: u64, largest: &[f64]) -> [Block; 2] {
    let (etendue, emission) = (roster.system.etendue(), roster.system.emission());
    let flux = |radiance: &Block| {
        let at = |i: usize, band: usize| etendue[i] * (radiance.get(i, band) - emission.get(i, band));
        Block::from_fn(emission.n_rows(), emission.n_columns(), at)
    };
    let (truth, weights) = (flux(roster.truth), vec![1.0; emission.n_rows()]);
    let [truth, answer, _] = pooled(&truth, &flux(answer), &truth, &weights, n_particles, largest);
    [truth, answer]
}

/// One more number for each.
fn add(moments: &mut Vec<Moments>, values: &[f64]) {
    moments.resize(values.len().max(moments.len()), Moments::default());
    moments.iter_mut().zip(values).for_each(|(moments, value)| moments.push(*value));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::assembly::{Exchange, System, assemble};
    use crate::basis::{Bundles, Resolution};
    use crate::estimator::estimate_range;
    use crate::gallery;
    use crate::scene::Scene;
    use crate::solver::{Gth, Solver};

    const SEED: u64 = 60_601;
    const SIGNIFICANCE: f64 = 1e-6;

    fn corner_box() -> (Scene, Bundles, System, Block) {
        let scene = gallery::corner_box();
        let bundles = Bundles::new(&scene, Resolution { patch_size: 0.5, n_directions: 1 }).expect("it can be cut");
        let system = assemble(&scene, &bundles, Exchange::default()).expect("and assembled");
        let truth = Gth.solve(system.equation(), &mut ()).expect("and solved").radiance;
        (scene, bundles, system, truth)
    }

    /// What a method says of this truth, from 48 batches of 512 samples a bundle in all, and the ratio of its variance to the foretold one
    /// times `variance`.
    fn verdict(roster: &Roster<'_>, name: &str, variance: f64) -> (Verdict, Option<VarianceAgreement>) {
        let member = roster.member(name).expect("the scene suits every method");
        let (estimator, largest) = (member.estimator(), roster.largest_scores(&member));
        let n_samples = 512 * member.samples_a_bundle();
        let n_particles = member.n_particles(512);
        let mut batches = Batches::default();
        if member.is_joint() {
            for part in 0..48 {
                let range = n_samples * part / 48..n_samples * (part + 1) / 48;
                batches.push(roster, &estimate_range(estimator, range, SEED), n_particles, &largest);
            }
        }
        let whole = estimate_range(estimator, 0..n_samples, SEED);
        let prediction = roster.predict(&member).and_then(Result::ok).map(|mut prediction| {
            prediction.variance.values_mut().iter_mut().for_each(|v| *v *= variance);
            prediction
        });
        let agreement = prediction.and_then(|prediction| variance_agreement(roster, &whole, &batches, &prediction));
        let verdict = if member.is_joint() {
            against_batches(roster, &batches, n_particles, &largest)
        } else {
            against_variances(roster, &whole, n_particles, &largest, None)
        };
        (verdict, agreement)
    }

    #[test]
    fn a_truth_that_is_another_is_found_out_and_the_right_one_is_not() {
        let (scene, bundles, system, truth) = corner_box();
        let mut brighter = truth.clone();
        brighter.values_mut().iter_mut().for_each(|v| *v *= 1.05);
        for name in ["collision-walk", "absorption-shooting", "stochastic-jacobi"] {
            let (right, _) = verdict(&Roster::new(&scene, &bundles, &system, &truth), name, 1.0);
            assert!(right.p_value >= SIGNIFICANCE && right.n_comparisons > 10, "{name}: {}", right.worst_z);
            let (wrong, _) = verdict(&Roster::new(&scene, &bundles, &system, &brighter), name, 1.0);
            assert!(wrong.p_value < SIGNIFICANCE, "{name}: {}", wrong.worst_z);
        }
    }

    #[test]
    fn a_variance_that_is_another_is_found_out_and_the_right_one_is_not() {
        let (scene, bundles, system, truth) = corner_box();
        let roster = Roster::new(&scene, &bundles, &system, &truth);
        for name in ["survival-walk", "collision-shooting"] {
            let [right, wrong] = [1.0, 1.5].map(|factor| verdict(&roster, name, factor).1.expect("samples enough"));
            assert!(right.p_value >= SIGNIFICANCE, "{name}: {right:?}");
            assert!(wrong.p_value < SIGNIFICANCE, "{name}: {wrong:?}");
        }
    }

    #[test]
    fn a_method_without_variance_has_none_to_test() {
        let (scene, bundles, system, truth) = corner_box();
        let roster = Roster::new(&scene, &bundles, &system, &truth);
        let (exact, variance) = verdict(&roster, "guided-walk", 1.0);
        assert!(variance.is_none() && exact.worst_z < 10.0, "{}", exact.worst_z);
        assert_eq!(roster.member("guided-walk").map(|member| member.estimator().n_bundles()), Ok(bundles.n_bundles()));
    }
}
