//! Tails and critical values far out, against mpmath at 50 digits: erfc, gammainc, betainc, sums of exact binomial terms, and
//! bisections on them.

use etendue::stats::special::{regularised_incomplete_beta, regularised_lower_gamma, regularised_upper_gamma};
use etendue::stats::{
    binomial_lower_tail, binomial_tail, chi_squared_critical, chi_squared_lower_tail, chi_squared_tail, critical_z,
    fisher_critical, fisher_tail, normal_critical, normal_tail, student_critical, student_tail, two_sided_p,
};

/// What every tail and critical value promises, relatively.
const TOLERANCE: f64 = 1e-12;

#[track_caller]
fn assert_close(value: f64, exact: f64, what: &str) {
    let relative = value / exact - 1.0;
    assert!(relative.abs() <= TOLERANCE, "{what}: {value:e} against {exact:e}, off by {relative:e}");
}

/// Where differences of ln Γ keep six digits of sixteen, and where even Boost's fractions leave 7e-12.
#[test]
fn incomplete_functions_of_large_parameters() {
    let beta = [
        (298.963_980_929_473_17, 31.259_649_368_221_49, 0.086_944_119_849_408_42, 2.794_637_125_207_849e-276),
        (619_546.662_670_585_1, 838_459.419_971_976_8, 0.413_741_039_446_042_5, 1.778_409_512_220_688_1e-165),
        (37_865.681_431_987_185, 459_375.336_622_329_4, 0.063_671_604_203_638_31, 4.567_820_949_205_857e-269),
        (571_196.131_440_700_1, 724_543.030_170_294_5, 0.436_763_435_217_601_47, 5.730_875_985_566_182_6e-21),
        (3.0, 7.0, 1e-12, 8.399_999_999_962_199e-35),
    ];
    for (a, b, x, exact) in beta {
        assert_close(regularised_incomplete_beta(a, b, x), exact, &format!("I({a}, {b}, {x})"));
    }
    let lower_gamma = [
        (9_866_586.149_069_587, 9_851_891.839_097_215, 1.432_432_803_031_031e-6),
        (1_822_764.125_740_568_9, 1_818_584.954_962_055, 9.755_395_987_490_376e-4),
    ];
    for (a, x, exact) in lower_gamma {
        assert_close(regularised_lower_gamma(a, x), exact, &format!("P({a}, {x})"));
        assert_close(regularised_upper_gamma(a, x), 1.0 - exact, &format!("Q({a}, {x})"));
    }
}

#[test]
fn normal_tails_and_critical_values() {
    let tails = [
        (-3.0, 9.986_501_019_683_699_054e-1),
        (-0.25, 5.987_063_256_829_237_242e-1),
        (0.5, 3.085_375_387_259_868_963e-1),
        (2.0, 2.275_013_194_817_920_72e-2),
        (6.0, 9.865_876_450_376_981_407e-10),
        (10.0, 7.619_853_024_160_526_066e-24),
        (20.0, 2.753_624_118_606_233_695e-89),
        (30.0, 4.906_713_927_148_187_059e-198),
        (37.0, 5.725_571_222_524_576_822e-300),
    ];
    for (z, p) in tails {
        assert_close(normal_tail(z), p, &format!("beyond {z}"));
    }
    let critical = [
        (0.25, 6.744_897_501_960_817_432e-1),
        (0.001, 3.090_232_306_167_813_535_4),
        (1e-6, 4.753_424_308_822_898_957_3),
        (1e-15, 7.941_345_326_170_996_771_3),
        (1e-30, 1.146_402_468_844_361_572e1),
        (1e-100, 2.127_345_356_096_532_429e1),
        (1e-200, 3.020_559_417_957_964_306e1),
        (1e-300, 3.704_709_629_936_119_923e1),
    ];
    for (p, z) in critical {
        assert_close(normal_critical(p), z, &format!("p = {p:e}"));
    }
    assert_close(normal_critical(0.75), -critical[0].1, "the other side");
    // Two-sided and corrected, as verdicts over many comparisons ask for it.
    assert_close(critical_z(2e-300, 1), critical[7].1, "two-sided");
    assert_close(two_sided_p(37.0), 2.0 * tails[8].1, "two-sided");
    assert_eq!((normal_critical(0.5), normal_tail(f64::INFINITY)), (0.0, 0.0));
    assert!([0.0, 1.0, -0.1, f64::NAN].into_iter().all(|p| normal_critical(p).is_nan()));
}

#[test]
fn student_tails_and_critical_values() {
    let tails = [
        (0.5, 3.0, 3.257_239_824_240_754_972e-1),
        (12.0, 1.0, 2.646_467_605_958_987_545e-2),
        (10_000_000_000.0, 3.0, 1.102_657_790_843_584_099e-30),
        (3.5, 4.5, 1.027_084_498_469_278_695e-2),
        (40.0, 10.0, 1.140_428_871_542_877_322e-12),
        (15.0, 30.0, 8.766_648_278_742_424_004e-16),
        (14.0, 100.0, 1.326_203_605_192_234_592e-25),
        (8.0, 1000.0, 1.713_330_741_195_737_198e-15),
        (12.0, 10_000.0, 2.989_889_803_905_662_582e-33),
        (11.5, 1_000_000.0, 6.625_108_630_350_328_850e-31),
        (11.5, 1_000_000_000.0, 6.595_800_720_880_348_409e-31),
        (37.0, 1_000_000_000_000.0, 5.725_573_909_103_507_095e-300),
    ];
    for (t, n, p) in tails {
        assert_close(student_tail(t, n), p, &format!("beyond {t} of {n}"));
        assert_close(student_tail(-t, n), 1.0 - p, &format!("below {t} of {n}"));
    }
    let critical = [
        (0.001, 2.0, 2.232_712_477_011_987_520e1),
        (1e-30, 5.0, 1.568_392_559_097_971_370e6),
        (1e-9, 17.5, 1.122_917_191_813_525_377e1),
        (1e-30, 100.0, 1.656_448_917_760_575_818e1),
        (5e-7, 100_000.0, 4.891_943_340_715_111_205_6),
        (0.2, 8.0, 8.888_895_177_670_197_519e-1),
    ];
    for (p, n, t) in critical {
        assert_close(student_critical(p, n), t, &format!("p = {p:e} of {n}"));
    }
    assert_eq!((student_tail(0.0, 3.0), student_tail(f64::INFINITY, 3.0)), (0.5, 0.0));
    assert_eq!(student_tail(2.0, f64::INFINITY), normal_tail(2.0));
    assert!(student_tail(f64::NAN, 3.0).is_nan() && student_tail(1.0, f64::NAN).is_nan());
}

#[test]
fn chi_squared_tails_and_critical_values() {
    let tails = [
        (0.1, 1.0, 7.518_296_340_458_492_758e-1),
        (5.0, 3.0, 1.717_971_442_967_331_350e-1),
        (150.0, 1.0, 1.733_643_245_717_826_362e-34),
        (200.0, 20.0, 1.125_347_396_084_273_388e-31),
        (400.0, 100.0, 1.692_797_995_885_708_767e-37),
        (1600.0, 1000.0, 1.742_039_824_439_163_043e-30),
        (11_500.0, 10_000.0, 2.184_389_771_509_755_456e-24),
        (1_016_000.0, 1_000_000.0, 1.101_645_809_377_284_785e-29),
        (100_160_000.0, 100_000_000.0, 6.008_086_783_857_667_041e-30),
    ];
    for (x, n, p) in tails {
        assert_close(chi_squared_tail(x, n), p, &format!("beyond {x} of {n}"));
    }
    let lower = [
        (1e-8, 3.0, 2.659_615_194_697_372_342e-13),
        (1.0, 30.0, 1.461_050_092_443_921_956e-17),
        (500.0, 1000.0, 4.067_165_681_999_001_198e-44),
        (8700.0, 10_000.0, 3.317_380_624_184_638_493e-22),
        (984_000.0, 1_000_000.0, 2.812_545_216_379_416_838e-30),
    ];
    for (x, n, p) in lower {
        assert_close(chi_squared_lower_tail(x, n), p, &format!("below {x} of {n}"));
    }
    let critical = [
        (0.05, 1.0, 3.841_458_820_694_125_865_3),
        (1e-30, 1.0, 1.327_998_927_050_142_172e2),
        (1e-30, 7.0, 1.576_530_277_312_434_733e2),
        (1e-6, 255.0, 3.770_781_154_989_868_095e2),
        (1e-30, 10_000.0, 1.170_930_213_307_703_061e4),
    ];
    for (p, n, x) in critical {
        assert_close(chi_squared_critical(p, n), x, &format!("p = {p:e} of {n}"));
    }
    assert_eq!((chi_squared_tail(0.0, 3.0), chi_squared_tail(f64::INFINITY, 3.0)), (1.0, 0.0));
    assert!(chi_squared_tail(f64::NAN, 3.0).is_nan());
}

#[test]
fn fisher_tails_and_critical_values() {
    let tails = [
        (1.5, 3.0, 8.0, 2.868_889_6e-1),
        (1000.0, 5.0, 12.0, 2.753_646_727_870_036_693e-15),
        (40.0, 2.0, 100.0, 1.723_354_985_368_026_637e-13),
        (12.0, 10.0, 500.0, 1.121_653_797_565_552_763e-18),
        (2.0, 1000.0, 1000.0, 9.960_028_532_774_174_506e-28),
        (1.5, 2000.0, 3000.0, 5.319_911_787_680_298_207e-24),
        (0.01, 4.0, 7.0, 9.997_481_707_032_715_899e-1),
    ];
    for (f, above, below, p) in tails {
        assert_close(fisher_tail(f, above, below), p, &format!("beyond {f} of {above} over {below}"));
    }
    let critical = [
        (0.05, 3.0, 8.0, 4.066_180_551_351_162_151_5),
        (1e-30, 10.0, 50.0, 1.127_882_145_517_889_031e2),
        (1e-9, 100.0, 1000.0, 2.211_231_743_076_667_424_9),
    ];
    for (p, above, below, f) in critical {
        assert_close(fisher_critical(p, above, below), f, &format!("p = {p:e} of {above} over {below}"));
    }
    assert_eq!((fisher_tail(0.0, 3.0, 4.0), fisher_tail(f64::INFINITY, 3.0, 4.0)), (1.0, 0.0));
}

#[test]
fn binomial_tails() {
    let tails = [
        (3, 10, 0.3, 6.172_172_135_999_999_703e-1),
        (25, 10_000, 0.001, 4.643_922_008_850_701_604e-5),
        (60, 10_000, 0.001, 5.765_336_417_138_579_370e-27),
        (100, 100, 0.5, 7.888_609_052_210_118_054e-31),
        (700, 1000, 0.5, 8.832_839_003_975_068_570e-38),
        (1, 1_000_000, 1e-30, 1.000_000_000_000_000_083e-24),
        (510_000, 1_000_000, 0.5, 2.772_181_643_849_612_301e-89),
        (5500, 1_000_000_000, 4e-6, 1.176_573_922_374_627_120e-111),
    ];
    for (k, n, p, tail) in tails {
        assert_close(binomial_tail(k, n, p), tail, &format!("at least {k} of {n} at {p}"));
    }
    let lower = [
        (0, 10_000, 0.001, 4.517_334_597_704_863_672e-5),
        (3, 10_000, 0.02, 2.619_919_989_239_939_115e-82),
        (300, 1000, 0.5, 8.832_839_003_975_068_570e-38),
        (7, 10, 0.3, 9.984_096_136_000_000_004e-1),
        (490_000, 1_000_000, 0.5, 2.772_181_643_849_612_301e-89),
    ];
    for (k, n, p, tail) in lower {
        assert_close(binomial_lower_tail(k, n, p), tail, &format!("at most {k} of {n} at {p}"));
    }
    assert_eq!((binomial_tail(0, 5, 0.3), binomial_tail(6, 5, 0.3), binomial_lower_tail(5, 5, 0.3)), (1.0, 0.0, 1.0));
    assert_eq!((binomial_tail(1, 5, 0.0), binomial_tail(5, 5, 1.0), binomial_lower_tail(4, 5, 1.0)), (0.0, 1.0, 0.0));
}
