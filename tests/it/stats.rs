//! Moments, tests and fits, against values computed in 40-digit arithmetic (mpmath's erfc, gammainc, betainc) where not said otherwise.

use etendue::sampling::Streams;
use etendue::stats::special::{gamma_ratio_half, regularised_incomplete_beta, regularised_upper_gamma};
use etendue::stats::{
    ChiSquaredError, FitError, Moments, MomentsBlock, chi_squared_test, critical_z, fit_line, fit_power_law, sidak,
    sidak_level, two_sided_p, welch_test, z_score,
};

#[track_caller]
fn assert_relative(value: f64, exact: f64, tolerance: f64) {
    assert!((value - exact).abs() <= tolerance * exact.abs(), "{value:e} against {exact:e}: {:e}", value / exact - 1.0);
}

// ---- special functions

#[test]
fn normal_tails_are_accurate_far_out() {
    // The argument's own rounding costs z² ulp: 3e-13 at z = 37.
    let exact = [
        (0.001, 0.999_202_115_572_177_9),
        (0.1, 0.920_344_325_445_942_0),
        (0.5, 0.617_075_077_451_973_8),
        (1.0, 0.317_310_507_862_914_1),
        (1.96, 0.049_995_790_296_440_87),
        (3.0, 2.699_796_063_260_189e-3),
        (5.0, 5.733_031_437_583_878e-7),
        (8.0, 1.244_192_114_854_356_8e-15),
        (12.0, 3.552_964_224_155_358e-33),
        (20.0, 5.507_248_237_212_467e-89),
        (30.0, 9.813_427_854_296_374e-198),
        (37.0, 1.145_114_244_504_915_4e-299),
    ];
    for (z, p) in exact {
        assert_relative(two_sided_p(z), p, 1e-12);
        assert_eq!(two_sided_p(-z), two_sided_p(z));
    }
    assert_eq!((two_sided_p(0.0), two_sided_p(f64::INFINITY)), (1.0, 0.0));
}

#[test]
fn incomplete_functions_match_their_tables() {
    // 1e-12: what the logarithms of Γ leave at arguments of some hundreds.
    let upper_gamma = [
        (0.5, 1.75, 0.061_368_829_139_402_17),
        (2.0, 4.75, 0.049_747_247_417_943_645),
        (31.5, 50.0, 0.002_077_236_552_784_795_4),
        (31.5, 15.0, 0.999_866_018_585_238_4),
        (250.0, 350.0, 7.728_992_111_216_652e-9),
    ];
    for (a, x, exact) in upper_gamma {
        assert_relative(regularised_upper_gamma(a, x), exact, 1e-12);
    }
    let beta = [
        (1.0, 0.3, 0.163_339_973_465_924_45),
        (3.5, 0.9, 0.407_083_822_065_589),
        (51.0, 0.999, 0.749_974_994_560_834_5),
        (51.0, 0.2, 1.979_349_186_092_127e-37),
        (501.0, 0.9999, 0.751_643_682_375_644_2),
        (12.5, 0.4, 2.114_125_030_700_303e-6),
    ];
    for (a, x, exact) in beta {
        assert_relative(regularised_incomplete_beta(a, 0.5, x), exact, 1e-12);
    }
    // 1e-14: two dozen roundings of the recurrence.
    let ratio = [
        (0.0, 1.772_453_850_905_516),
        (0.5, 1.128_379_167_095_512_6),
        (2.5, 0.601_802_222_450_940_1),
        (23.9, 0.203_483_781_781_137_45),
        (50.0, 0.141_068_250_297_538_26),
        (1e6, 9.999_998_750_000_078e-4),
    ];
    for (x, exact) in ratio {
        assert_relative(gamma_ratio_half(x), exact, 1e-14);
    }
}

#[test]
fn critical_values_invert_the_corrected_tail() {
    let exact = [
        (0.05, 1, 1.959_963_984_540_054_2),
        (1e-6, 1, 4.891_638_475_698_59),
        (1e-6, 1000, 6.109_410_125_144_645),
        (1e-6, 1_000_000, 7.130_506_779_354_957),
        (0.01, 50, 3.717_773_283_402_13),
    ];
    for (alpha, n, z) in exact {
        assert_relative(critical_z(alpha, n), z, 1e-13);
        assert_relative(sidak(two_sided_p(critical_z(alpha, n)), n), alpha, 1e-11);
        assert_relative(sidak(sidak_level(alpha, n), n), alpha, 1e-14);
    }
    assert_relative(critical_z(0.99, 1), 0.012_533_469_508_069, 1e-12);
    assert_eq!(sidak(0.0, 1000), 0.0);
    assert_eq!(sidak(1.0, 1000), 1.0);
}

#[test]
fn z_scores_of_exact_numbers_are_zero_or_infinite() {
    assert_eq!(z_score(3.0, 1.0, 4.0), 1.0);
    assert_eq!(z_score(2.0, 2.0, 0.0), 0.0);
    assert_eq!(z_score(2.0, 2.5, 0.0), f64::NEG_INFINITY);
}

// ---- moments

#[test]
fn moments_keep_their_digits_beside_a_large_mean() {
    // Deviations −2 … 2 about 1e9 have variance 2.5 exactly; the textbook's Σx² − n mean² would keep no digit.
    let m: Moments = [-2.0, -1.0, 0.0, 1.0, 2.0].map(|d| 1e9 + d).into_iter().collect();
    assert_eq!((m.n(), m.mean(), m.variance(), m.variance_of_mean()), (5, 1e9, 2.5, 0.5));
    assert!(Moments::default().variance().is_nan());
    assert!([7.0].into_iter().collect::<Moments>().standard_error().is_nan());
}

#[test]
fn merging_parts_is_the_whole() {
    let streams = Streams::new(67, "moments");
    let values: Vec<f64> = (0..1000).map(|k| streams.stream(0, k).uniform()).collect();
    let whole: Moments = values.iter().copied().collect();
    for n_parts in [1, 2, 7, 999, 2000] {
        let mut merged = Moments::default();
        for part in values.chunks(values.len().div_ceil(n_parts)) {
            merged.merge(&part.iter().copied().collect());
        }
        merged.merge(&Moments::default());
        assert_eq!(merged.n(), whole.n());
        // A thousand roundings, most of which cancel.
        assert_relative(merged.mean(), whole.mean(), 1e-14);
        assert_relative(merged.variance(), whole.variance(), 1e-13);
    }
}

#[test]
fn padding_adds_the_zeros_that_were_not_pushed() {
    let (mut sparse, mut full) = (Moments::default(), Moments::default());
    for value in [3.0, 1.0, 8.0] {
        sparse.push(value);
        full.push(value);
    }
    (0..97).for_each(|_| full.push(0.0));
    sparse.pad_with_zeros(100);
    assert_eq!(sparse.n(), 100);
    assert_relative(sparse.mean(), full.mean(), 1e-14);
    assert_relative(sparse.variance(), full.variance(), 1e-13);
}

#[test]
fn a_block_is_its_samples_side_by_side() {
    let mut block = MomentsBlock::new(3);
    let mut other = MomentsBlock::new(3);
    for k in 0..10 {
        block.push(k % 3, k as f64);
        other.push(1, 0.5 * k as f64);
    }
    let alone: Moments = [1.0, 4.0, 7.0].into_iter().collect();
    assert_eq!(block.get(1), alone);
    let mut merged = alone;
    merged.merge(&other.get(1));
    block.merge(&other);
    assert_eq!(block.get(1), merged);
    assert_eq!(block.get(0), [0.0, 3.0, 6.0, 9.0].into_iter().collect());
    assert_eq!(block.means()[1], merged.mean());
    assert_eq!(block.variances_of_mean().nth(1), Some(merged.variance_of_mean()));
    block.pad_with_zeros(50);
    assert!((0..3).all(|k| block.get(k).n() == 50));
}

// ---- tests

#[test]
fn chi_squared_pools_and_judges() {
    // Mendel's peas (1866): 315, 108, 101, 32 against 9 : 3 : 3 : 1; χ² = 0.470024, p = 0.925426 for three degrees of freedom.
    let expected = [9.0, 3.0, 3.0, 1.0].map(|share| 556.0 * share / 16.0);
    let test = chi_squared_test(&[315, 108, 101, 32], &expected).unwrap();
    assert_relative(test.statistic, 0.470_023_980_815_347_7, 1e-13);
    assert_relative(test.p_value, 0.925_425_895_103_616_2, 1e-12);
    assert_eq!(test.n_degrees_of_freedom, 3);

    // Four cells that expect 2 each make one pool of 6, and the fourth joins the next cell.
    let test = chi_squared_test(&[3, 1, 2, 2, 52, 40], &[2.0, 2.0, 2.0, 2.0, 46.0, 46.0]).unwrap();
    assert_eq!(test.n_degrees_of_freedom, 2);
    assert_relative(test.statistic, 36.0 / 48.0 + 36.0 / 46.0, 1e-12);

    // What cannot be refutes, pooled or not.
    let test = chi_squared_test(&[1, 49, 50], &[0.0, 50.0, 50.0]).unwrap();
    assert_eq!((test.statistic, test.p_value), (f64::INFINITY, 0.0));
}

#[test]
fn chi_squared_refuses_what_it_cannot_judge() {
    assert!(matches!(chi_squared_test(&[1], &[0.5, 0.5]), Err(ChiSquaredError::Length { .. })));
    assert!(matches!(chi_squared_test(&[50, 50], &[45.0, 45.0]), Err(ChiSquaredError::Totals { .. })));
    assert!(matches!(chi_squared_test(&[3, 3], &[3.0, 3.0]), Err(ChiSquaredError::TooFewCells { found: 1 })));
    assert!(matches!(
        chi_squared_test(&[3, 3], &[f64::NAN, 3.0]),
        Err(ChiSquaredError::BadExpectation { cell: 0, .. })
    ));
}

#[test]
fn p_values_of_true_hypotheses_are_uniform() {
    // A test of the tests: p-values of 1000 fair experiments fall evenly into ten bins.
    let mut counts = [[0; 10]; 2];
    for experiment in 0..1000 {
        let mut stream = Streams::new(71, "p-values").stream(experiment, 0);
        let mut cells = [0; 8];
        let (mut a, mut b) = (Moments::default(), Moments::default());
        for _ in 0..400 {
            let u = stream.uniform();
            cells[(u * 8.0) as usize] += 1;
            a.push(u);
            if u < 0.25 {
                b.push(2.0 * stream.uniform() - 0.5);
            }
        }
        let p = [chi_squared_test(&cells, &[50.0; 8]).unwrap().p_value, welch_test(&a, &b).p_value];
        for (counts, p) in counts.iter_mut().zip(p) {
            counts[((p * 10.0) as usize).min(9)] += 1;
        }
    }
    for counts in counts {
        let p = chi_squared_test(&counts, &[100.0; 10]).unwrap().p_value;
        assert!(p > sidak_level(1e-6, 2), "{counts:?}: p = {p:e}");
    }
}

#[test]
fn welch_compares_means_of_unequal_spread() {
    let a: Moments = [27.5, 21.0, 19.0, 23.6, 17.0, 17.9, 16.9, 20.1, 21.9, 22.6, 23.1, 19.6, 19.0, 21.7, 21.4]
        .into_iter()
        .collect();
    let b: Moments = [27.1, 22.0, 20.8, 23.4, 23.4, 23.5, 25.8, 22.0, 24.8, 20.2, 21.9, 22.1, 22.9, 30.5, 31.3]
        .into_iter()
        .collect();
    let test = welch_test(&a, &b);
    assert_relative(test.t, -2.949_236_837_313_106, 1e-13);
    assert_relative(test.n_degrees_of_freedom, 27.311_610_472_220_31, 1e-13);
    assert_relative(test.p_value, 0.006_460_408_027_460_364, 1e-11);
    assert_relative(a.mean(), 20.82, 1e-15);

    let constant = |value: f64| [value; 3].into_iter().collect::<Moments>();
    assert_eq!(welch_test(&constant(1.0), &constant(1.0)).p_value, 1.0);
    assert_eq!(welch_test(&constant(1.0), &constant(2.0)).p_value, 0.0);
    assert!(welch_test(&a, &[1.0].into_iter().collect()).p_value.is_nan());
}

// ---- fits

#[test]
fn lines_are_fitted_with_their_uncertainty() {
    // By hand: x = 0…3, y = 1, 3, 4, 8 has slope 2.2, intercept 0.7, residuals 0.3, 0.1, −1.1, 0.7, so s² = 1.8/2 over Σ(x − 1.5)² = 5.
    let line = fit_line(&[0.0, 1.0, 2.0, 3.0], &[1.0, 3.0, 4.0, 8.0]).unwrap();
    assert_relative(line.slope, 2.2, 1e-14);
    assert_relative(line.intercept, 0.7, 1e-14);
    assert_relative(line.slope_standard_error, (0.9f64 / 5.0).sqrt(), 1e-14);
    let law = fit_power_law(&[1.0, 10.0, 100.0], &[3.0, 0.03, 0.0003]).unwrap();
    assert_relative(law.slope, -2.0, 1e-14);
    assert_relative(law.intercept, 3f64.ln(), 1e-13);
    assert!(law.slope_standard_error < 1e-14);
    assert_eq!(fit_line(&[0.0, 1.0], &[0.0, 1.0]).unwrap().slope_standard_error, f64::INFINITY);
}

#[test]
fn slopes_scatter_as_their_standard_error_says() {
    let x: Vec<f64> = (0..12).map(f64::from).collect();
    let (mut slopes, mut variances) = (Moments::default(), Moments::default());
    for experiment in 0..4000 {
        let mut stream = Streams::new(73, "slopes").stream(experiment, 0);
        let y: Vec<f64> = x.iter().map(|x| 2.0 * x + stream.uniform() + stream.uniform() + stream.uniform()).collect();
        let line = fit_line(&x, &y).unwrap();
        slopes.push(line.slope);
        variances.push(line.slope_standard_error.powi(2));
    }
    assert!(z_score(slopes.mean(), 2.0, slopes.variance_of_mean()).abs() < critical_z(1e-6, 2));
    // The variance of three uniform numbers is 1/4; of a slope over 0…11, that over Σ(x − 5.5)² = 143.
    let z = z_score(variances.mean(), 0.25 / 143.0, variances.variance_of_mean());
    assert!(z.abs() < critical_z(1e-6, 2), "z = {z}");
}

#[test]
fn fits_refuse_points_without_a_line() {
    assert_eq!(fit_line(&[1.0], &[1.0]), Err(FitError::TooFewPoints { found: 1 }));
    assert_eq!(fit_line(&[1.0, 2.0], &[1.0]), Err(FitError::Length { n_x: 2, n_y: 1 }));
    assert_eq!(fit_line(&[2.0, 2.0], &[1.0, 3.0]), Err(FitError::Vertical { x: 2.0 }));
    assert!(matches!(fit_line(&[1.0, f64::NAN], &[1.0, 3.0]), Err(FitError::NotFinite { point: 1, .. })));
    assert_eq!(fit_power_law(&[1.0, 2.0], &[1.0, 0.0]), Err(FitError::NotPositive { point: 1, x: 2.0, y: 0.0 }));
}
