//! Higher moments, covariances and control variates, and the error bars of variances.

use etendue::sampling::{Stream, Streams};
use etendue::stats::{
    Covariance, HigherMoments, Moments, VarianceTestError, chi_squared_lower_tail, chi_squared_tail, critical_z,
    kolmogorov_tail, uniformity_test, variance_test, variance_test_of, z_score,
};
use std::f64::consts::TAU;

/// Family-wise significance of every test here.
const ALPHA: f64 = 1e-6;

#[track_caller]
fn assert_relative(value: f64, exact: f64, tolerance: f64) {
    assert!((value - exact).abs() <= tolerance * exact.abs(), "{value:e} against {exact:e}: {:e}", value / exact - 1.0);
}

/// The scatter of what was measured is about `expected`.
#[track_caller]
fn assert_mean(measured: &Moments, expected: f64) {
    let z = z_score(measured.mean(), expected, measured.variance_of_mean());
    assert!(z.abs() < critical_z(ALPHA, 1), "{:e} against {expected:e}: z = {z}", measured.mean());
}

fn exponential(stream: &mut Stream) -> f64 {
    -(1.0 - stream.uniform()).ln()
}

fn normal(stream: &mut Stream) -> f64 {
    (2.0 * exponential(stream)).sqrt() * (TAU * stream.uniform()).cos()
}

#[test]
fn higher_moments_are_those_of_the_definition() {
    // −1, 0, 0, 4 and 7 beside a large mean: Σ (x − 2)^k = 46, 90, 754 by hand.
    let m: HigherMoments = [-1.0, 0.0, 0.0, 4.0, 7.0].map(|d| 1e8 + d).into_iter().collect();
    assert_eq!((m.n(), m.mean()), (5, 1e8 + 2.0));
    assert_relative(m.variance(), 11.5, 1e-15);
    assert_relative(m.skewness(), 90.0 / 5.0 / (46.0f64 / 5.0).powf(1.5), 1e-15);
    assert_relative(m.kurtosis(), 754.0 * 5.0 / 46.0 / 46.0, 1e-15);
    assert_relative(m.variance_of_variance(), 11.5 * 11.5 * (754.0 * 5.0 / 46.0 / 46.0 - 0.5) / 5.0, 1e-14);
    assert_eq!(m.standard_error_of_variance(), m.variance_of_variance().sqrt());
    // Nothing is known of nothing.
    let none = HigherMoments::default();
    assert!(
        [none.variance(), none.skewness(), none.kurtosis(), none.variance_of_variance()].iter().all(|v| v.is_nan())
    );
    let constant: HigherMoments = [3.0; 4].into_iter().collect();
    assert!(constant.variance() == 0.0 && constant.kurtosis().is_nan());
}

#[test]
fn merging_and_padding_is_pushing() {
    let streams = Streams::new(83, "higher moments");
    let pairs: Vec<(f64, f64)> = (0..1000)
        .map(|k| {
            let mut stream = streams.stream(0, k);
            let x = exponential(&mut stream);
            (x, x * x + stream.uniform())
        })
        .collect();
    let mut padded: Vec<(f64, f64)> = pairs.clone();
    padded.resize(1700, (0.0, 0.0));
    let whole: HigherMoments = padded.iter().map(|p| p.0).collect();
    let both: Covariance = padded.iter().copied().collect();
    for n_parts in [1, 3, 999] {
        let (mut merged, mut together) = (HigherMoments::default(), Covariance::default());
        for part in pairs.chunks(pairs.len().div_ceil(n_parts)) {
            merged.merge(&part.iter().map(|p| p.0).collect());
            together.merge(&part.iter().copied().collect());
        }
        merged.merge(&HigherMoments::default());
        together.merge(&Covariance::default());
        merged.pad_with_zeros(1700);
        together.pad_with_zeros(1700);
        // A thousand roundings of sums of one sign; third powers cancel a few digits more.
        for (a, b) in [
            (merged.mean(), whole.mean()),
            (merged.variance(), whole.variance()),
            (merged.skewness(), whole.skewness()),
            (merged.kurtosis(), whole.kurtosis()),
            (together.x().mean(), whole.mean()),
            (together.x().variance(), whole.variance()),
            (together.y().variance(), both.y().variance()),
            (together.covariance(), both.covariance()),
            (together.variance_of_covariance(), both.variance_of_covariance()),
            (together.self_controlled_mean(1.0).leading_bias, both.self_controlled_mean(1.0).leading_bias),
        ] {
            assert_relative(a, b, 1e-12);
        }
        assert_eq!((merged.n(), together.n()), (1700, 1700));
    }
}

#[test]
fn the_error_bar_of_a_variance_is_how_variances_scatter() {
    // Var(s²) of 400 exponential numbers is exactly (9 − 397/399)/400, of uniform ones (1/144)(1.8 − 397/399)/400.
    // With the sample's own moments, the bias of their powers leaves −20/n² and 1.6/144 n² of that, from the bias of m₄ and of s⁴.
    let kinds = [(0, (9.0 - 397.0 / 399.0) / 400.0, -20.0), (1, (1.8 - 397.0 / 399.0) / 400.0 / 144.0, 1.6 / 144.0)];
    for (kind, exact, bias) in kinds {
        let (mut variances, mut predicted) = (HigherMoments::default(), Moments::default());
        for experiment in 0..4000 {
            let mut stream = Streams::new(89, "variances").stream(experiment, kind);
            let draw = |_| if kind == 0 { exponential(&mut stream) } else { stream.uniform() };
            let m: HigherMoments = (0..400).map(draw).collect();
            variances.push(m.variance());
            predicted.push(m.variance_of_variance());
        }
        let z = z_score(variances.variance(), exact, variances.variance_of_variance());
        assert!(z.abs() < critical_z(ALPHA, 1), "kind {kind}: z = {z}");
        assert_mean(&predicted, exact + bias / 400.0 / 400.0);
    }
}

#[test]
fn covariances_are_those_of_the_definition() {
    let pairs = [(1.0, 2.0), (2.0, 1.0), (4.0, 7.0), (5.0, 6.0)].map(|(x, y)| (1e7 + x, y - 1e7));
    let c: Covariance = pairs.into_iter().collect();
    // Deviations (−2, −2), (−1, −3), (1, 3), (2, 2): Σ uv = 14, Σ u² = 10, Σ v² = 26, Σ u²v² = 50.
    assert_eq!((c.n(), c.x().mean(), c.y().mean()), (4, 1e7 + 3.0, 4.0 - 1e7));
    assert_relative(c.covariance(), 14.0 / 3.0, 1e-15);
    assert_relative(c.x().variance(), 10.0 / 3.0, 1e-15);
    assert_relative(c.y().variance(), 26.0 / 3.0, 1e-15);
    assert_relative(c.correlation(), 14.0 / 260f64.sqrt(), 1e-15);
    assert_relative(c.control_coefficient(), 1.4, 1e-15);
    assert_relative(c.variance_of_covariance(), (12.5 - 12.25) / 4.0 + (2.5 * 6.5 + 12.25) / 12.0, 1e-14);
    // Mean x is 3, of which 2.5 was expected.
    let controlled = c.controlled_mean(1e7 + 2.5, 2.0);
    assert_eq!((controlled.mean, controlled.coefficient, controlled.leading_bias), (4.0 - 1e7 - 1.0, 2.0, 0.0));
    // Σ (v − 2u)² = 26 − 56 + 40.
    assert_relative(controlled.variance_of_mean, 10.0 / 3.0 / 4.0, 1e-14);
    let own = c.self_controlled_mean(1e7 + 2.5);
    // Σ ε² = 26 − 1.4 · 14 = 6.4 over two degrees of freedom, at half a unit from the mean.
    assert_relative(own.variance_of_mean, 3.2 * (0.25 + 0.25 / 10.0), 1e-13);
    assert_relative(own.mean, 4.0 - 1e7 - 0.7, 1e-15);

    let few: Covariance = [(1.0, 2.0)].into_iter().collect();
    assert!(few.covariance().is_nan() && few.variance_of_covariance().is_nan());
    assert!(few.self_controlled_mean(1.0).variance_of_mean.is_nan());
    // A control that does not vary is no control.
    let constant: Covariance = [(1.0, 2.0), (1.0, 4.0), (1.0, 3.0)].into_iter().collect();
    assert_eq!(constant.self_controlled_mean(0.0).mean, 3.0);
    assert_relative(constant.self_controlled_mean(0.0).variance_of_mean, 1.0 / 3.0, 1e-15);
}

#[test]
fn the_error_bar_of_a_covariance_is_how_covariances_scatter() {
    // x exponential, y = x + an exponential: covariance 1; μ₂₂ = E u⁴ + E u² = 9 + 1, μ₂₀ = 1, μ₀₂ = 2.
    let n = 300.0;
    let exact = (10.0 - 1.0) / n + (2.0 + 1.0) / (n * (n - 1.0));
    let (mut covariances, mut predicted) = (HigherMoments::default(), Moments::default());
    for experiment in 0..4000 {
        let mut stream = Streams::new(97, "covariances").stream(experiment, 0);
        let c: Covariance = (0..300)
            .map(|_| {
                let x = exponential(&mut stream);
                (x, x + exponential(&mut stream))
            })
            .collect();
        covariances.push(c.covariance());
        predicted.push(c.variance_of_covariance());
    }
    assert_mean(&covariances.moments(), 1.0);
    let z = z_score(covariances.variance(), exact, covariances.variance_of_variance());
    assert!(z.abs() < critical_z(ALPHA, 1), "z = {z}");
    assert_relative(predicted.mean(), exact, 0.1);
}

#[test]
fn control_variates_are_as_good_as_their_error_bars() {
    // y = x² on [0, 1]: mean 1/3; the best coefficient is 1 and leaves ε = (x − ½)² − 1/12, E ε² = 1/180. A coefficient of the
    // sample's own costs −E[(x − ½)² ε]/(n/12) = −1/(15 n).
    let n = 100;
    let mut moments = [Moments::default(); 5];
    for experiment in 0..40_000 {
        let mut stream = Streams::new(101, "controls").stream(experiment, 0);
        let c: Covariance = (0..n).map(|_| stream.uniform()).map(|x| (x, x * x)).collect();
        let (given, own) = (c.controlled_mean(0.5, 1.0), c.self_controlled_mean(0.5));
        let values = [given.mean, given.variance_of_mean, own.mean, own.variance_of_mean, own.leading_bias];
        moments.iter_mut().zip(values).for_each(|(m, v)| m.push(v));
    }
    let [given, given_variance, own, own_variance, own_bias] = moments;
    let n = f64::from(n);
    assert_mean(&given, 1.0 / 3.0);
    assert_mean(&given_variance, 1.0 / 180.0 / n);
    // Seventeen standard errors of bias are seen, and are what was said; the next order is a tenth of a standard error.
    let bias = -1.0 / 15.0 / n;
    assert_mean(&own, 1.0 / 3.0 + bias);
    assert!((own.mean() - 1.0 / 3.0).abs() > 10.0 * own.standard_error());
    assert_relative(own_bias.mean(), bias, 0.05);
    // The scatter is what the error bars say, to the 1/√(2 · 40 000) it is known to.
    let scatter = own.variance() / own_variance.mean();
    assert!((scatter - 1.0).abs() < 0.02 + 2.0 / n, "{scatter}");
    // Where y is x and noise, nothing is biased, and a perfect control leaves nothing to chance.
    let line: Covariance = (0..50).map(f64::from).map(|x| (x, 3.0 - 2.0 * x)).collect();
    let exact = line.self_controlled_mean(1.0);
    // Rounding of the sums of squares, 4e4.
    assert!((exact.mean - 1.0).abs() < 1e-12 && exact.variance_of_mean < 1e-12 && exact.leading_bias.abs() < 1e-12);
}

#[test]
fn variances_are_tested_exactly_where_numbers_are_normal() {
    // ν = n − 1 at kurtosis 3, and the p-value twice the smaller tail of χ².
    let test = variance_test_of(17, 2.6, 1.3, 3.0).unwrap();
    assert_relative(test.n_degrees_of_freedom, 16.0, 1e-14);
    assert_relative(test.p_value, 2.0 * chi_squared_tail(32.0, 16.0), 1e-12);
    let test = variance_test_of(17, 0.65, 1.3, 3.0).unwrap();
    assert_relative(test.p_value, 2.0 * chi_squared_lower_tail(8.0, 16.0), 1e-12);
    assert_relative(test.z, -0.5 * 8f64.sqrt(), 1e-14);

    // p-values of 2000 samples of 8 normal numbers are uniform.
    let p: Vec<f64> = (0..2000)
        .map(|experiment| {
            let mut stream = Streams::new(103, "normal").stream(experiment, 0);
            let m: Moments = (0..8).map(|_| 3.0 + 2.0 * normal(&mut stream)).collect();
            variance_test_of(m.n(), m.variance(), 4.0, 3.0).unwrap().p_value
        })
        .collect();
    let verdict = uniformity_test(&p).unwrap();
    assert!(verdict.p_value > ALPHA, "{verdict:?}");
    assert_eq!(verdict.p_value, kolmogorov_tail(verdict.statistic, 2000));
}

#[test]
fn wrong_variances_are_found_and_right_ones_are_not() {
    let mut stream = Streams::new(107, "planted").stream(0, 0);
    let m: HigherMoments = (0..100_000).map(|_| exponential(&mut stream)).collect();
    assert!(variance_test(&m, 1.0).unwrap().p_value > ALPHA);
    // √(100 000/8) standard errors a unit make 11 of 10 % off.
    for wrong in [1.1, 1.0 / 1.1] {
        let test = variance_test(&m, wrong).unwrap();
        assert!(test.p_value < ALPHA && test.z.abs() > 6.0, "{test:?}");
    }
    let constant: HigherMoments = [2.0; 50].into_iter().collect();
    assert_eq!(variance_test(&constant, 1.0).unwrap().p_value, 0.0);

    assert_eq!(variance_test(&HigherMoments::default(), 1.0), Err(VarianceTestError::TooFewNumbers { found: 0 }));
    assert_eq!(variance_test(&m, 0.0), Err(VarianceTestError::Prediction { value: 0.0 }));
    assert_eq!(variance_test_of(9, 1.0, 1.0, 0.5), Err(VarianceTestError::Kurtosis { value: 0.5 }));
    let overflowing: HigherMoments = [1e300, -1e300].into_iter().collect();
    assert_eq!(variance_test(&overflowing, 1.0), Err(VarianceTestError::NotFinite));
}
