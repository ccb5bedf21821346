//! Tests of tests: counts, uniformity, equivalence, corrections, and intervals that one may look at while they shrink.

use etendue::sampling::{Stream, Streams};
use etendue::stats::{
    ConfidenceError, EmpiricalBernstein, Moments, NormalMixture, PowerError, UniformityError, benjamini_hochberg,
    benjamini_yekutieli, binomial_interval, binomial_tail, binomial_test, detection_power, detection_samples,
    equivalence_of_means, equivalence_power, equivalence_samples, equivalence_test, holm, kolmogorov_tail,
    normal_critical, normal_tail, p_value_histogram, relative_equivalence, sidak, sidak_level, student_critical,
    student_tail, two_sided_p, uniformity_test,
};

/// Significance of every random test here.
const ALPHA: f64 = 1e-6;

#[track_caller]
fn assert_relative(value: f64, exact: f64, tolerance: f64) {
    assert!((value - exact).abs() <= tolerance * exact.abs(), "{value:e} against {exact:e}: {:e}", value / exact - 1.0);
}

fn exponential(stream: &mut Stream) -> f64 {
    -(1.0 - stream.uniform()).ln()
}

fn normal(stream: &mut Stream) -> f64 {
    (2.0 * exponential(stream)).sqrt() * (std::f64::consts::TAU * stream.uniform()).cos()
}

// ---- counts

#[test]
fn counts_are_tested_exactly() {
    // Ten throws of a fair coin: 1, 10, 45 ways of 1024 for 0, 1, 2 heads.
    let test = binomial_test(2, 10, 0.5);
    assert_relative(test.lower, 56.0 / 1024.0, 1e-14);
    assert_relative(test.upper, 1013.0 / 1024.0, 1e-14);
    assert_relative(test.p_value, 112.0 / 1024.0, 1e-14);
    assert_eq!(binomial_test(5, 10, 0.5).p_value, 1.0);
    assert!(binomial_test(40, 10_000, 1e-3).p_value < 1e-10);
    assert!(binomial_test(17, 10_000, 1e-3).p_value > 0.05);
    assert_eq!((binomial_test(0, 0, 0.5).p_value, binomial_test(1, 10, 0.0).p_value), (1.0, 0.0));
}

#[test]
fn intervals_of_rates_are_clopper_and_pearsons() {
    // scipy 1.17, binomtest(k, n).proportion_ci(0.99).
    let exact = [
        (12, 10_000, 0.000_494_461_450_488_678_3, 0.002_413_028_100_113_894),
        (0, 50, 0.0, 0.100_545_083_374_858_6),
        (50, 50, 0.899_454_916_625_141_4, 1.0),
        (7, 40, 0.053_670_516_935_585_44, 0.376_323_056_590_468_94),
    ];
    for (k, n, low, high) in exact {
        let found = binomial_interval(k, n, 0.01);
        // scipy inverts its own incomplete beta function, to 1e-10 or so.
        assert_relative(found[0], low, 1e-9);
        assert_relative(found[1], high, 1e-9);
        // Their ends are just not refuted.
        for rate in found.into_iter().filter(|p| *p > 0.0 && *p < 1.0) {
            assert_relative(binomial_test(k, n, rate).p_value, 0.01, 1e-10);
        }
    }
}

// ---- uniformity

#[test]
fn kolmogorovs_distribution_is_as_sure_as_it_says() {
    // Durbin's matrix in 40 digits (mpmath) up to n = 1000; then scipy 1.17, kstwo.sf (Simard & L'Ecuyer 2011), good to six digits
    // in the bulk there and to all in the tails.
    let exact = [
        (0.7, 1, 0.6),
        (0.6, 2, 0.32),
        (0.3, 5, 0.664),
        (0.8, 5, 6.4e-4),
        (0.1, 20, 0.976_255_094_592_154_9),
        (0.25, 20, 0.137_625_698_367_176_24),
        (0.6, 20, 2.048_301_164_971_985e-7),
        (0.08, 100, 0.518_219_364_548_066_9),
        (0.15, 100, 0.019_839_242_125_646_05),
        (0.05, 300, 0.427_441_622_391_802),
        (0.02, 1000, 0.810_897_131_070_212_1),
        (0.03, 1000, 0.322_690_246_413_299_9),
        (0.3, 1000, 2.590_715_705_736_8e-80),
        (0.003, 100_000, 0.328_456_3),
        (0.006, 100_000, 1.487_148_9e-3),
        (0.02, 100_000, 3.537_271_193e-35),
    ];
    for (d, n, p) in exact {
        // The two-sided tail as twice the one-sided, 3e-7; Durbin's matrix to rounding; Vrbik's argument to 0.03/n.
        let tolerance = match n {
            _ if p < 0.01 => 3e-7 * p,
            ..=340 => 1e-12 * p,
            _ => 0.03 / n as f64,
        };
        let found = kolmogorov_tail(d, n);
        assert!((found - p).abs() <= tolerance, "{d} of {n}: {found:e} against {p:e}");
    }
    assert_eq!((kolmogorov_tail(0.4, 1), kolmogorov_tail(1.0, 5), kolmogorov_tail(1e-9, 100_000)), (1.0, 0.0, 1.0));
    // No step where one way of computing ends and another begins.
    let around = [339, 340, 341, 342].map(|n| kolmogorov_tail(0.05 * (340.0 / n as f64).sqrt(), n));
    assert!(around.windows(2).all(|pair| (pair[0] - pair[1]).abs() < 2e-4), "{around:?}");
}

#[test]
fn uniform_numbers_are_told_from_others() {
    let draw = |power: f64| -> Vec<f64> {
        let mut stream = Streams::new(109, "uniformity").stream(0, 0);
        (0..5000).map(|_| stream.uniform().powf(power)).collect()
    };
    assert!(uniformity_test(&draw(1.0)).unwrap().p_value > ALPHA);
    // u^1.2 has the distribution function x^(1/1.2), off by 0.067: 4.7/√5000.
    let test = uniformity_test(&draw(1.2)).unwrap();
    assert!(test.p_value < ALPHA && (test.statistic - 0.067).abs() < 0.03, "{test:?}");
    assert_eq!(uniformity_test(&[0.7]).unwrap().statistic, 0.7);
    assert_eq!(uniformity_test(&[]), Err(UniformityError::Empty));
    assert_eq!(uniformity_test(&[0.5, 1.5]), Err(UniformityError::OutOfRange { index: 1, value: 1.5 }));
    assert!(uniformity_test(&[f64::NAN]).is_err());
}

#[test]
fn its_own_p_values_are_uniform() {
    // Samples of 40: the matrix and the tail, with nothing asymptotic.
    let p: Vec<f64> = (0..2000)
        .map(|experiment| {
            let mut stream = Streams::new(113, "uniform").stream(experiment, 0);
            let sample: Vec<f64> = (0..40).map(|_| stream.uniform()).collect();
            uniformity_test(&sample).unwrap().p_value
        })
        .collect();
    assert!(uniformity_test(&p).unwrap().p_value > ALPHA);
}

#[test]
fn histograms_show_what_is_wrong() {
    let mut stream = Streams::new(127, "histogram").stream(0, 0);
    let mut p: Vec<f64> = (0..1000).map(|_| stream.uniform()).collect();
    let fair = p_value_histogram(&p, 20).unwrap();
    assert_eq!((fair.counts.iter().sum::<u64>(), fair.counts.len(), fair.n), (1000, 20, 1000));
    assert!(fair.uniformity.p_value > ALPHA && fair.smallest_corrected > ALPHA);
    // One that is far off leaves the bulk as it was.
    p[500] = 1e-12;
    let one = p_value_histogram(&p, 20).unwrap();
    assert!(one.uniformity.p_value > ALPHA && one.smallest == 1e-12);
    assert_eq!(one.smallest_corrected, sidak(1e-12, 1000));
    // Error bars too small by a fifth move the bulk.
    let shrunk: Vec<f64> = p.iter().map(|p| 2.0 * normal_tail(1.25 * normal_critical(0.5 * p))).collect();
    assert!(p_value_histogram(&shrunk, 20).unwrap().uniformity.p_value < ALPHA);
    assert_eq!(p_value_histogram(&[0.0, 0.25, 0.5, 1.0], 2).unwrap().counts, [2, 2]);
}

// ---- corrections

#[test]
fn corrections_reject_what_they_should() {
    let p = [0.001, 0.04, 0.8, 0.012, 0.03, 0.0004];
    let close =
        |found: &[f64], exact: [f64; 6]| found.iter().zip(exact).for_each(|(a, b)| assert_relative(*a, b, 1e-14));
    // By hand: sorted 0.0004, 0.001, 0.012, 0.03, 0.04, 0.8 times 6, 5, 4, 3, 2, 1, never falling.
    let found = holm(&p, 0.05);
    close(&found.adjusted, [0.005, 0.09, 0.8, 0.048, 0.09, 0.0024]);
    assert_eq!((found.rejected, found.n_rejected), (vec![true, false, false, true, false, true], 3));
    // Times 6/1, 6/2, … 6/6, never rising from below.
    let found = benjamini_hochberg(&p, 0.05);
    close(&found.adjusted, [0.003, 0.048, 0.8, 0.024, 0.045, 0.0024]);
    assert_eq!(found.n_rejected, 5);
    // And times 1 + 1/2 + … + 1/6 = 2.45, at most 1.
    let found = benjamini_yekutieli(&p, 0.05);
    close(&found.adjusted, [0.00735, 0.1176, 1.0, 0.0588, 0.11025, 0.00588]);
    assert_eq!(found.n_rejected, 2);
    // What is not a number never agrees; of nothing, nothing falls.
    assert_eq!(holm(&[0.5, f64::NAN], 1e-9).rejected, [false, true]);
    assert_eq!(benjamini_hochberg(&[0.5, f64::NAN], 1e-9).rejected, [false, true]);
    assert_eq!(benjamini_yekutieli(&[], 0.05).n_rejected, 0);
}

#[test]
fn the_share_of_false_discoveries_is_bounded() {
    // 60 true hypotheses and 40 false ones at z = 3: alarms that are false are 0.1 · 60/100 of all in the mean (Benjamini &
    // Hochberg: with equality for independent tests).
    let (mut share, mut any) = (Moments::default(), 0);
    for experiment in 0..4000 {
        let mut stream = Streams::new(131, "discoveries").stream(experiment, 0);
        let p: Vec<f64> = (0..100).map(|k| normal_tail(normal(&mut stream) + if k < 60 { 0.0 } else { 3.0 })).collect();
        let found = benjamini_hochberg(&p, 0.1);
        let n_false = found.rejected[..60].iter().filter(|r| **r).count();
        share.push(n_false as f64 / found.n_rejected.max(1) as f64);
        any += u64::from(holm(&p, 0.1).rejected[..60].iter().any(|r| *r));
    }
    let z = (share.mean() - 0.06) / share.standard_error();
    assert!(z.abs() < normal_critical(0.5 * ALPHA), "{} of all alarms: z = {z}", share.mean());
    // Holm bounds the chance of any false alarm.
    assert!(binomial_tail(any, 4000, 0.1) > ALPHA, "{any} of 4000");
}

// ---- equivalence

#[test]
fn equivalence_is_two_one_sided_tests() {
    // 0.3 ± 0.1 within 0.5: two standard errors on the near side, eight on the far.
    let test = equivalence_test(-0.3, 0.1, 12.0, 0.5);
    assert_relative(test.p_value, student_tail(2.0, 12.0), 1e-13);
    assert!(test.holds(0.05) && !test.holds(0.01));
    // The smallest margin is the one that just holds.
    let margin = test.smallest_margin(0.01);
    assert_relative(margin, 0.3 + 0.1 * student_critical(0.01, 12.0), 1e-14);
    assert_relative(equivalence_test(-0.3, 0.1, 12.0, margin).p_value, 0.01, 1e-12);
    // Outside the margin, or without one, nothing holds; exact numbers are within it or are not.
    assert!(equivalence_test(0.6, 0.1, f64::INFINITY, 0.5).p_value > 0.5);
    assert!(!equivalence_test(0.0, 0.1, f64::INFINITY, -0.5).holds(0.05));
    assert_eq!(equivalence_test(0.4, 0.0, f64::INFINITY, 0.5).p_value, 0.0);
    assert_eq!(equivalence_test(0.5, 0.0, f64::INFINITY, 0.5).p_value, 1.0);
    assert!(!equivalence_test(f64::NAN, 0.1, 3.0, 0.5).holds(0.5));

    // Of means, with Welch's error bar.
    let [a, b] = [0.0, 0.5].map(|shift| (0..20).map(|k| shift + f64::from(k % 5)).collect::<Moments>());
    let test = equivalence_of_means(&a, &b, 2.0);
    let error = (2.0 * 40.0 / 19.0 / 20.0f64).sqrt();
    assert_relative(test.standard_error, error, 1e-14);
    assert_relative(test.n_degrees_of_freedom, 38.0, 1e-13);
    assert_relative(test.p_value, student_tail(1.5 / error, 38.0), 1e-12);
}

#[test]
fn relative_equivalence_takes_no_quotient_for_normal() {
    // 99.9 ± 0.03 against 100 ± 0.04 within 1 %: (99.9 − 99)/√(0.03² + 0.99² 0.04²) is the nearer edge.
    let test = relative_equivalence([99.9, 0.0009], [100.0, 0.0016], 0.01);
    assert_relative(test.p_value, normal_tail(0.9 / (0.0009f64 + 0.9801 * 0.0016).sqrt()), 1e-9);
    assert_relative(test.difference, -0.001, 1e-12);
    assert_relative(test.standard_error, (0.0009f64 + 0.998_001 * 0.0016).sqrt() / 100.0, 1e-12);
    // Signs turn over together.
    let mirrored = relative_equivalence([-99.9, 0.0009], [-100.0, 0.0016], 0.01);
    assert_eq!((mirrored.p_value, mirrored.difference), (test.p_value, test.difference));
    // A reference that may be zero proves nothing, nor does a zero or what is no number.
    assert!(!relative_equivalence([1.0, 0.0], [1.0, 1.0], 0.1).holds(0.3));
    assert!(!relative_equivalence([0.0, 0.0], [0.0, 0.0], 0.1).holds(0.5));
    assert!(!relative_equivalence([f64::NAN, 1.0], [1.0, 1.0], 0.1).holds(0.5));
    assert!(relative_equivalence([1.0, 0.0], [1.0, 0.0], 1e-9).holds(1e-300));
}

#[test]
fn the_power_said_before_is_the_power_had() {
    let (margin, alpha) = (0.1, 0.01);
    for true_difference in [0.0, 0.04, -0.08] {
        let n = equivalence_samples(true_difference, 1.0, margin, alpha, 0.8).unwrap();
        let error = |n: u64| (1.0 / n as f64).sqrt();
        let power = equivalence_power(true_difference, error(n), margin, alpha);
        assert!(power >= 0.8 && equivalence_power(true_difference, error(n - 1), margin, alpha) < 0.8);
        // Means of n numbers, normal, drawn at once.
        let mut stream = Streams::new(137, "power").stream(n as u32, 0);
        let n_held = (0..4000)
            .filter(|_| {
                let difference = true_difference + error(n) * normal(&mut stream);
                equivalence_test(difference, error(n), f64::INFINITY, margin).holds(alpha)
            })
            .count();
        assert!(binomial_test(n_held as u64, 4000, power).p_value > ALPHA / 3.0, "{n_held} of 4000 at {power}");
    }
    // Without a difference, n = σ² (z_α + z_β/2)²/m² in closed form, rounded up.
    let exact = (normal_critical(0.01) + normal_critical(0.1)).powi(2) / 0.01;
    assert_eq!(equivalence_samples(0.0, 1.0, 0.1, 0.01, 0.8), Ok(exact.ceil() as u64));
    assert_eq!(equivalence_samples(0.0, 0.0, 0.1, 0.01, 0.8), Ok(1));
    assert_eq!(equivalence_power(0.0, 1.0, 0.1, 0.01), 0.0);
    let outside = PowerError::OutsideMargin { difference: 0.1, margin: 0.1 };
    assert_eq!(equivalence_samples(0.1, 1.0, 0.1, 0.01, 0.8), Err(outside));
    assert!(matches!(equivalence_samples(0.0, 1.0, 0.1, 0.0, 0.8), Err(PowerError::Probability { .. })));
    assert!(matches!(equivalence_samples(0.0, -1.0, 0.1, 0.1, 0.8), Err(PowerError::Variance { .. })));
}

#[test]
fn the_budget_said_before_finds_the_bug() {
    // A mean off by 0.1 % of 1, numbers of standard deviation 0.5, one comparison of 300 together at 1e-6.
    let (difference, variance, alpha) = (1e-3, 0.25, sidak_level(1e-6, 300));
    let n = detection_samples(difference, variance, alpha, 0.9).unwrap();
    let closed = (normal_critical(0.5 * alpha) + normal_critical(0.1)).powi(2) * variance / difference / difference;
    assert_relative(n as f64, closed, 1e-5);
    let error = (variance / n as f64).sqrt();
    let mut stream = Streams::new(151, "budget").stream(0, 0);
    let found = (0..4000).filter(|_| two_sided_p((difference + error * normal(&mut stream)) / error) < alpha).count();
    assert!(binomial_test(found as u64, 4000, 0.9).p_value > ALPHA, "{found} of 4000");
    // Without a difference the test finds what it finds by chance.
    assert_relative(detection_power(0.0, error, 0.01), 0.01, 1e-12);
    assert_eq!(detection_samples(0.1, 0.0, 0.01, 0.9), Ok(1));
    assert!(matches!(detection_samples(0.0, 1.0, 0.01, 0.9), Err(PowerError::NoDifference { .. })));
    assert!(matches!(detection_samples(0.1, 1.0, 0.01, 1.0), Err(PowerError::Probability { .. })));
    assert!(matches!(detection_samples(0.1, f64::NAN, 0.01, 0.5), Err(PowerError::Variance { .. })));
}

// ---- confidence sequences

#[test]
fn normal_mixtures_are_robbins() {
    let sequence = NormalMixture::new(0.05, 10, 1000).unwrap();
    let sample: Moments = (0..1000).map(|k| f64::from(k % 2)).collect();
    // By hand: −2 ln 0.05 = 5.991465, ln(6.991465) = 1.944690; n ρ² = 7.936155; s² = 250/999.
    let growth: f64 = 8.936_154_9;
    let half = (250.0 / 999.0 * 2.0 * growth / 7_936.154_9 * (growth.sqrt() / 0.05).ln()).sqrt();
    assert_relative(sequence.half_width(&sample), half, 1e-6);
    assert_relative(sequence.interval(&sample)[1], 0.5 + half, 1e-6);
    // Not twice the width of an interval for this one look, and near the best there is.
    let once = normal_critical(0.025) * sample.standard_error();
    assert!(half > 1.3 * once && half < 1.6 * once, "{}", half / once);
    let others = [300, 3000].map(|best| NormalMixture::new(0.05, 10, best).unwrap().half_width(&sample));
    assert!(others.iter().all(|other| *other > half && *other < 1.15 * half));
    // The p-value is the level at which the interval ends.
    let edge = sequence.interval(&sample)[0];
    assert_relative(sequence.p_value(&sample, edge), 0.05, 1e-10);
    assert_eq!(sequence.p_value(&sample, 0.5), 1.0);
    let few: Moments = [0.0, 1.0, 0.0].into_iter().collect();
    assert_eq!((sequence.half_width(&few), sequence.p_value(&few, 7.0)), (f64::INFINITY, 1.0));
    // Exact numbers leave no doubt.
    let constant: Moments = [2.0; 50].into_iter().collect();
    assert_eq!((sequence.p_value(&constant, 2.0), sequence.p_value(&constant, 2.1)), (1.0, 0.0));
}

/// Runs of exponential numbers: how many does the sequence miss at any time up to the last?
#[test]
fn normal_mixtures_hold_at_all_times_together() {
    let (n_runs, n_last, alpha) = (1000, 3000, 0.05);
    let sequence = NormalMixture::new(alpha, 100, 1000).unwrap();
    let (mut n_missed, mut n_missed_naively) = (0, 0);
    for run in 0..n_runs {
        let mut stream = Streams::new(139, "sequence").stream(run, 0);
        let mut sample = Moments::default();
        let (mut missed, mut naively) = (false, false);
        for _ in 0..n_last {
            sample.push(exponential(&mut stream));
            missed |= (sample.mean() - 1.0).abs() > sequence.half_width(&sample);
            naively |= sample.n() >= 100 && (sample.mean() - 1.0).abs() > 1.96 * sample.standard_error();
        }
        n_missed += u64::from(missed);
        n_missed_naively += u64::from(naively);
    }
    let n_runs = u64::from(n_runs);
    assert!(binomial_tail(n_missed, n_runs, alpha) > ALPHA, "{n_missed} of {n_runs}");
    // Whoever looks at ordinary intervals all the time is misled several times as often.
    assert!(n_missed_naively > 4 * n_runs / 20, "{n_missed_naively} of {n_runs}");
}

/// A score of 1 in a hundred samples, where every normal approximation is at a loss for the first thousands.
#[test]
fn empirical_bernstein_holds_at_all_times_together() {
    let (n_runs, n_last, alpha) = (1000, 3000, 0.05);
    let mut n_missed = 0;
    let mut width = Moments::default();
    for run in 0..n_runs {
        let mut stream = Streams::new(149, "Bernstein").stream(run, 0);
        let mut sequence = EmpiricalBernstein::new([-1.0, 1.0], alpha).unwrap();
        for _ in 0..n_last {
            sequence.push(if stream.uniform() < 0.01 { 1.0 } else { 0.0 }).unwrap();
        }
        // The interval is the meeting of all so far: it holds now if it always did.
        let [low, high] = sequence.interval();
        n_missed += u64::from(!(low <= 0.01 && 0.01 <= high));
        width.push(0.5 * (high - low));
        assert_eq!(sequence.n(), n_last);
    }
    assert!(binomial_tail(n_missed, u64::from(n_runs), alpha) > ALPHA, "{n_missed} of {n_runs}");
    // Narrow as the numbers' own spread, √0.0099, not as the bounds': those alone would give √(2 ln(2/α)/n) = 0.05.
    let normal = 1.96 * (0.0099 / n_last as f64).sqrt();
    assert!(width.mean() < 6.0 * normal, "{} times the normal width", width.mean() / normal);
}

#[test]
fn sequences_refuse_what_they_cannot_promise() {
    let mut sequence = EmpiricalBernstein::new([0.0, 2.0], 0.01).unwrap();
    assert_eq!(sequence.interval(), [0.0, 2.0]);
    let out = ConfidenceError::OutOfBounds { index: 0, value: 2.5, low: 0.0, high: 2.0 };
    assert_eq!(sequence.push(2.5), Err(out));
    assert!(sequence.push(f64::NAN).is_err() && sequence.n() == 0);
    assert!(matches!(EmpiricalBernstein::new([1.0, 1.0], 0.01), Err(ConfidenceError::Bounds { .. })));
    assert_eq!(NormalMixture::new(0.0, 1, 9), Err(ConfidenceError::Significance { value: 0.0 }));
    assert!(matches!(EmpiricalBernstein::new([0.0, 1.0], 1.0), Err(ConfidenceError::Significance { .. })));
    // A mean that moves is found out: no value was within all intervals.
    (0..20_000).for_each(|k| sequence.push(if k < 10_000 { 0.0 } else { 2.0 }).unwrap());
    assert!(sequence.interval()[0] > sequence.interval()[1]);
}
