//! Verdicts on clean runs: every kind raises false alarms as often as it says.
//!
//! Each kind judges runs in which nothing is wrong, at significance 1e-3, and the number of alarms is tested against 1e-3 by the
//! exact binomial test: 10⁴ runs of each kind, 10⁵ with `ETENDUE_LARGE=1`. Kinds that promise 1e-3 *at most* are tested from
//! above. Where a verdict is asymptotic, the runs are long enough for its own rate to be 1e-3 within a tenth or two.

use etendue::compare::{compare_blocks, compare_blocks_anytime, equivalent_blocks, p_values, pooled};
use etendue::estimator::{Estimator, Score, Truth, estimate};
use etendue::linalg::Block;
use etendue::sampling::{Stream, Streams};
use etendue::stats::{
    ControlledMean, Covariance, EmpiricalBernstein, HigherMoments, Moments, NormalMixture, benjamini_hochberg,
    benjamini_yekutieli, binomial_test, chi_squared_test, equivalence_of_means, equivalence_test, holm, normal_tail,
    relative_equivalence, sidak, two_sided_p, uniformity_test, variance_test, variance_test_of, welch_test,
};
use std::f64::consts::TAU;

/// What every verdict is asked for.
const SIGNIFICANCE: f64 = 1e-3;

/// Significance of each binomial test of false alarms: the thirty or so here make 1 % together, and no alarm in 10⁴ runs is too
/// few.
const ALPHA: f64 = 3e-4;

/// Is time no object?
fn is_large() -> bool {
    std::env::var("ETENDUE_LARGE").is_ok_and(|v| v == "1")
}

/// Runs of a kind.
fn n_runs() -> u32 {
    if is_large() { 100_000 } else { 10_000 }
}

fn exponential(stream: &mut Stream) -> f64 {
    -(1.0 - stream.uniform()).ln()
}

fn normal(stream: &mut Stream) -> f64 {
    (2.0 * exponential(stream)).sqrt() * (TAU * stream.uniform()).cos()
}

/// False alarms by kind.
struct Alarms<const K: usize> {
    kinds: [&'static str; K],
    counts: [u64; K],
    n_runs: u32,
}

impl<const K: usize> Alarms<K> {
    /// Counts the alarms of clean runs, each judged in K ways.
    fn of(kinds: [&'static str; K], judge: impl Fn(&mut Stream) -> [bool; K]) -> Self {
        let streams = Streams::new(1009, kinds[0]);
        Self::collect(kinds, (0..n_runs()).map(|run| judge(&mut streams.stream(run, 0))))
    }

    fn collect(kinds: [&'static str; K], verdicts: impl Iterator<Item = [bool; K]>) -> Self {
        let (mut counts, mut n_runs) = ([0; K], 0);
        for alarms in verdicts {
            counts.iter_mut().zip(alarms).for_each(|(count, alarm)| *count += u64::from(alarm));
            n_runs += 1;
        }
        Self { kinds, counts, n_runs }
    }

    /// The kind number k alarms at the significance it was asked for.
    #[track_caller]
    fn assert_as_promised(&self, k: usize) {
        let test = binomial_test(self.counts[k], u64::from(self.n_runs), SIGNIFICANCE);
        assert!(test.p_value > ALPHA, "{}: {test:?}", self.kinds[k]);
    }

    #[track_caller]
    fn assert_all_as_promised(&self) {
        (0..K).for_each(|k| self.assert_as_promised(k));
    }

    /// The kind number k alarms at that significance or less often.
    #[track_caller]
    fn assert_at_most_promised(&self, k: usize) {
        let test = binomial_test(self.counts[k], u64::from(self.n_runs), SIGNIFICANCE);
        assert!(test.upper > ALPHA, "{}: {test:?}", self.kinds[k]);
    }
}

// ---- the machinery of estimators

const N_BUNDLES: usize = 5;

/// Scores that hit once in four times make false alarms of 1.4e-3 at 512 samples, and of 1.1e-3 at 2048: the more runs look, the
/// closer it must be.
fn n_samples() -> u64 {
    if is_large() { 2048 } else { 512 }
}

/// Scores a bundle's known radiance times a number of mean 1, independent between columns: a uniform one, the mean of two, and
/// four once in four times.
struct Synthetic;

fn radiance(bundle: usize, column: usize) -> f64 {
    1.0 + 0.3 * bundle as f64 + 0.1 * column as f64
}

impl Estimator for Synthetic {
    fn name(&self) -> &'static str {
        "synthetic"
    }

    fn truth(&self) -> Truth {
        Truth::Discrete
    }

    fn n_bundles(&self) -> usize {
        N_BUNDLES
    }

    fn n_columns(&self) -> usize {
        3
    }

    fn sample(&self, start: usize, stream: &mut Stream, score: &mut Score) {
        let ([a, b], [c, d]) = (stream.uniform2(), stream.uniform2());
        score.add(start, 0, radiance(start, 0) * 2.0 * a);
        score.add(start, 1, radiance(start, 1) * b);
        score.add(start, 1, radiance(start, 1) * c);
        if d < 0.25 {
            score.add(start, 2, 4.0 * radiance(start, 2));
        }
    }
}

#[test]
fn estimates_held_against_the_truth() {
    let exact = Block::from_fn(N_BUNDLES, 3, radiance);
    let weights = [1.0, 2.0, 1.0, 0.5, 1.0];
    let total: f64 = weights.iter().sum();
    let expected = (0..N_BUNDLES).map(|b| weights[b] * radiance(b, 1)).sum::<f64>() / total;
    let largest = [2.0, 2.0, 4.0].map(|most| most * radiance(N_BUNDLES - 1, 2));
    let n_samples = n_samples();
    let judge = |seed| {
        let estimate = estimate(&Synthetic, n_samples, seed);
        let (mean, variance) = (&estimate.mean, &estimate.variance_of_mean);
        let weighted = estimate.weighted_mean(&weights, 1).unwrap();
        let [joined, joined_mean, joined_variance] =
            pooled(&exact, mean, variance, &[1.0; N_BUNDLES], n_samples, &largest);
        assert!(joined.n_rows() > 4);
        let p = p_values(&exact, mean, variance);
        [
            !compare_blocks(&exact, mean, variance, SIGNIFICANCE).agrees,
            !compare_blocks(&joined, &joined_mean, &joined_variance, SIGNIFICANCE).agrees,
            two_sided_p((weighted.mean - expected) / weighted.variance.sqrt()) < SIGNIFICANCE,
            benjamini_hochberg(&p, SIGNIFICANCE).n_rejected > 0,
            holm(&p, SIGNIFICANCE).n_rejected > 0,
        ]
    };
    let kinds = ["entry by entry", "pooled", "weighted mean", "Benjamini-Hochberg", "Holm"];
    Alarms::collect(kinds, (0..u64::from(n_runs())).map(|run| judge(7919 + run))).assert_all_as_promised();
}

// ---- two samples, and one against a number

#[test]
fn means_held_against_means() {
    let alarms = Alarms::of(["Welch", "equivalence of means", "equivalent blocks"], |stream| {
        let a: Moments = (0..30).map(|_| normal(stream)).collect();
        let b: Moments = (0..20).map(|_| 1.0 + 3.0 * normal(stream)).collect();
        let shifted: Moments = (0..20).map(|_| 3.0 * normal(stream)).collect();
        // The worst that may be called equal within a margin lies just on it; the other two entries are far inside.
        let entries = [1.0 + 0.001 * normal(stream), 0.5 + 0.01 * normal(stream), -0.3 + 0.001 * normal(stream)];
        let reference = Block::from_fn(3, 1, |r, _| [1.0, 0.4, -0.3][r]);
        let mean = Block::from_fn(3, 1, |r, _| entries[r]);
        let variance = Block::from_fn(3, 1, |r, _| [1e-6, 1e-4, 1e-6][r]);
        [
            welch_test(&a, &shifted).p_value < SIGNIFICANCE,
            // Within ±1, where the true difference is 1: so wide a margin is shown only where the samples happen to be close.
            equivalence_of_means(&b, &a, 1.0).holds(SIGNIFICANCE),
            equivalent_blocks(&reference, &mean, &variance, 0.1, SIGNIFICANCE).holds,
        ]
    });
    alarms.assert_as_promised(0);
    // With error bars of the size of the margin the far side stands in the way too, and makes it rarer.
    alarms.assert_at_most_promised(1);
    alarms.assert_as_promised(2);
}

#[test]
fn equivalence_on_its_margin() {
    let kinds = ["equivalence above", "below", "with its own error bar", "relative above", "relative below"];
    Alarms::of(kinds, |stream| {
        let noise = 0.01 * normal(stream);
        let sample: Moments = (0..12).map(|_| 5.0 + 0.1 * normal(stream)).collect();
        // A reference known to 1 % only, of which the value is 10 % too much, or too little.
        let reference = 2.0 + 0.02 * normal(stream);
        let [above, below] = [2.2, 1.8].map(|value| value + 0.01 * normal(stream));
        let relative = |value: f64| relative_equivalence([value, 1e-4], [reference, 4e-4], 0.1).holds(SIGNIFICANCE);
        [
            equivalence_test(0.3 + noise, 0.01, f64::INFINITY, 0.3).holds(SIGNIFICANCE),
            equivalence_test(-0.3 + noise, 0.01, f64::INFINITY, 0.3).holds(SIGNIFICANCE),
            equivalence_test(sample.mean() - 4.0, sample.standard_error(), 11.0, 1.0).holds(SIGNIFICANCE),
            relative(above),
            relative(below),
        ]
    })
    .assert_all_as_promised();
}

// ---- distributions, variances, counts

#[test]
fn distributions_held_against_distributions() {
    let alarms = Alarms::of(["chi squared", "Kolmogorov-Smirnov", "binomial"], |stream| {
        let mut cells = [0; 16];
        (0..1600).for_each(|_| cells[(stream.uniform() * 16.0) as usize] += 1);
        let numbers: Vec<f64> = (0..30).map(|_| stream.uniform()).collect();
        let n_hits = (0..400).filter(|_| stream.uniform() < 0.1).count();
        [
            chi_squared_test(&cells, &[100.0; 16]).unwrap().p_value < SIGNIFICANCE,
            uniformity_test(&numbers).unwrap().p_value < SIGNIFICANCE,
            binomial_test(n_hits as u64, 400, 0.1).p_value < SIGNIFICANCE,
        ]
    });
    alarms.assert_as_promised(0);
    alarms.assert_as_promised(1);
    // A count that is refuted is one whose exact tail is below half the significance: of the discrete, some less.
    alarms.assert_at_most_promised(2);
}

#[test]
fn variances_held_against_predictions() {
    let kinds = ["variance of normal numbers", "of known kurtosis", "of unknown kurtosis"];
    Alarms::of(kinds, |stream| {
        let few: HigherMoments = (0..20).map(|_| 2.0 * normal(stream)).collect();
        let skewed: HigherMoments = (0..1000).map(|_| exponential(stream)).collect();
        let flat: HigherMoments = (0..1000).map(|_| stream.uniform()).collect();
        [
            variance_test_of(few.n(), few.variance(), 4.0, 3.0).unwrap().p_value < SIGNIFICANCE,
            variance_test_of(skewed.n(), skewed.variance(), 1.0, 9.0).unwrap().p_value < SIGNIFICANCE,
            variance_test(&flat, 1.0 / 12.0).unwrap().p_value < SIGNIFICANCE,
        ]
    })
    .assert_all_as_promised();
}

#[test]
fn controlled_means_held_against_the_truth() {
    Alarms::of(["control variate", "self-fitted control variate"], |stream| {
        // y = x² and noise over [0, 1], of mean 1/3; the control takes most of the parabola out.
        let pairs: Covariance =
            (0..400).map(|_| stream.uniform2()).map(|[x, noise]| (x, x * x + 0.1 * (noise - 0.5))).collect();
        let is_off = |controlled: ControlledMean| {
            let apart = controlled.mean - 1.0 / 3.0 - controlled.leading_bias;
            two_sided_p(apart / controlled.variance_of_mean.sqrt()) < SIGNIFICANCE
        };
        [is_off(pairs.controlled_mean(0.5, 1.0)), is_off(pairs.self_controlled_mean(0.5))]
    })
    .assert_all_as_promised();
}

// ---- many at once

#[test]
fn corrections_of_many() {
    let kinds = ["Benjamini-Hochberg", "Sidak", "Holm", "Benjamini-Yekutieli", "of dependent ones", "Holm's"];
    let alarms = Alarms::of(kinds, |stream| {
        let p: Vec<f64> = (0..50).map(|_| stream.uniform()).collect();
        let smallest = p.iter().copied().fold(1.0, f64::min);
        // One number that all share, with either sign: as dependent as can be.
        let common = normal(stream);
        let dependent: Vec<f64> =
            (0..50).map(|k| normal_tail(if k % 2 == 0 { common } else { -common } + 0.1 * normal(stream))).collect();
        [
            benjamini_hochberg(&p, SIGNIFICANCE).n_rejected > 0,
            sidak(smallest, 50) < SIGNIFICANCE,
            holm(&p, SIGNIFICANCE).n_rejected > 0,
            benjamini_yekutieli(&p, SIGNIFICANCE).n_rejected > 0,
            benjamini_yekutieli(&dependent, SIGNIFICANCE).n_rejected > 0,
            holm(&dependent, SIGNIFICANCE).n_rejected > 0,
        ]
    });
    (0..3).for_each(|k| alarms.assert_as_promised(k));
    (3..6).for_each(|k| alarms.assert_at_most_promised(k));
}

// ---- looking while it runs

#[test]
fn sequences_looked_at_all_the_time() {
    let alarms = Alarms::of(["normal mixture", "always-valid p-value", "empirical Bernstein"], |stream| {
        let mixture = NormalMixture::new(SIGNIFICANCE, 200, 500).unwrap();
        let mut bernstein = EmpiricalBernstein::new([0.0, 1.0], SIGNIFICANCE).unwrap();
        let mut sample = Moments::default();
        let [mut missed, mut refuted] = [false; 2];
        for _ in 0..1000 {
            let uniform = stream.uniform();
            sample.push(uniform * uniform);
            bernstein.push(uniform * uniform).unwrap();
            let [low, high] = mixture.interval(&sample);
            missed |= !(low <= 1.0 / 3.0 && 1.0 / 3.0 <= high);
            refuted |= mixture.p_value(&sample, 1.0 / 3.0) < SIGNIFICANCE;
        }
        let [low, high] = bernstein.interval();
        assert_eq!(missed, refuted, "an interval and a p-value that disagree");
        [missed, refuted, !(low <= 1.0 / 3.0 && 1.0 / 3.0 <= high)]
    });
    (0..3).for_each(|k| alarms.assert_at_most_promised(k));
}

#[test]
fn estimates_looked_at_all_the_time() {
    let kinds = ["blocks at any time", "blocks looked at once"];
    let sequence = NormalMixture::new(SIGNIFICANCE, 200, 400).unwrap();
    let reference = Block::from_fn(3, 1, |_, _| 0.5);
    let alarms = Alarms::of(kinds, |stream| {
        let mut samples = [Moments::default(); 3];
        let [mut at_any_time, mut naively] = [false; 2];
        for n_samples in 1..=800 {
            samples.iter_mut().for_each(|sample| sample.push(stream.uniform()));
            if n_samples % 20 == 0 {
                let mean = Block::from_fn(3, 1, |r, _| samples[r].mean());
                let variance = Block::from_fn(3, 1, |r, _| samples[r].variance_of_mean());
                at_any_time |= !compare_blocks_anytime(&reference, &mean, &variance, n_samples, &sequence).agrees;
                naively |= n_samples >= 200 && !compare_blocks(&reference, &mean, &variance, SIGNIFICANCE).agrees;
            }
        }
        [at_any_time, naively]
    });
    alarms.assert_at_most_promised(0);
    // Verdicts for one look are not for thirty: that is what the sequence is for.
    assert!(alarms.counts[1] > 3 * u64::from(alarms.n_runs) / 1000, "{} of {}", alarms.counts[1], alarms.n_runs);
}
