//! Walks on the matrix against the matrix: every test of a random number is a hypothesis test at family-wise significance [`ALPHA`].

mod agreement;
mod guided;
mod multilevel;
mod planted;
mod predicted;
mod quasi;
mod sequential;
mod threads;

use etendue::assembly::{Exchange, System, assemble};
use etendue::basis::{Bundles, Resolution};
use etendue::compare::{compare_blocks, relative_max};
use etendue::estimator::{
    Bounces, Estimate, Estimator, EstimatorError, GuidedWalk, MatrixWalk, Multilevel, NestingError, OracleError, Order,
    Prediction, Score, Scoring, Sequential, SequentialStop, Truth, estimate,
};
use etendue::gallery;
use etendue::linalg::{Block, Equation, LinearOperator};
use etendue::sampling::{AliasRows, AliasTable, Stream};
use etendue::scene::Scene;
use etendue::solver::{Gth, Lu, SolveError, Solver};
use etendue::stats::{critical_z, fit_line, fit_power_law};

/// Probability that one of these tests rejects walks that are right.
pub const ALPHA: f64 = 1e-6;
pub const SEED: u64 = 0x0dd5_0f0d_d5ee_d5a1;
/// Relative standard deviation of walks that are guided by the solution: some ulp a step, and what elimination leaves.
pub const NO_DEVIATION: f64 = 1e-10;
/// A measured variance whose standard error is this small, relatively, rests on some thousand rare scores.
pub const NEARLY_NORMAL: f64 = 0.03;
/// Elimination without subtraction loses some ulp an unknown, of which there are hundreds at most.
pub const SOLVE_TOLERANCE: f64 = 1e-12;

/// Gallery scenes whose lamps are large enough for walks to find them often: a closed furnace of three bands, an open pair of plates, and a
/// box of three colours.
pub fn scenes() -> Vec<(Scene, f64)> {
    let furnace = gallery::furnace_cube(&[0.3, 0.6, 0.9], &[1.0, 0.5, 0.2]).unwrap();
    vec![(furnace, 1.0), (gallery::parallel_plates(), 0.5), (gallery::corner_box(), 0.5)]
}

pub fn system(scene: &Scene, patch_size: f64) -> System {
    let bundles = Bundles::new(scene, Resolution { patch_size, n_directions: 1 }).unwrap();
    assemble(scene, &bundles, Exchange::default()).unwrap()
}

pub fn exact(system: &System) -> Block {
    Gth.solve(system.equation(), &mut ()).unwrap().radiance
}

/// KᵏE side by side for k = 0 … `last`, or their sum.
pub fn exact_bounces(system: &System, bounces: Bounces) -> Block {
    let Some(last) = bounces.last() else { return exact(system) };
    let (n, n_bands) = (system.n_bundles(), system.n_bands());
    let mut powers = vec![system.emission().clone()];
    for k in 0..last {
        let mut next = Block::zeros(n, n_bands);
        system.transport().apply(&powers[k], &mut next);
        powers.push(next);
    }
    match bounces {
        Bounces::Each(_) => Block::from_fn(n, n_bands * (last + 1), |i, c| powers[c / n_bands].get(i, c % n_bands)),
        _ => Block::from_fn(n, n_bands, |i, band| powers.iter().map(|power| power.get(i, band)).sum()),
    }
}

/// ⟨W, L⟩, one row a measurement.
pub fn measured(system: &System, measurements: &[Block], radiance: &Block) -> Block {
    let n_bands = system.n_bands();
    Block::from_fn(measurements.len(), radiance.n_columns(), |m, c| {
        let terms = system
            .etendue()
            .iter()
            .enumerate()
            .map(|(i, mu)| mu * measurements[m].get(i, c % n_bands) * radiance.get(i, c));
        terms.sum()
    })
}

/// The mean over everything, and a difference of two halves that is weighed unevenly.
pub fn measurements(system: &System) -> Vec<Block> {
    let (n, n_bands) = (system.n_bundles(), system.n_bands());
    let total: f64 = system.etendue().iter().sum();
    let uneven = |i: usize, band: usize| if 2 * i < n { 1.0 + band as f64 } else { -0.25 } / total;
    vec![Block::from_fn(n, n_bands, |_, _| 1.0 / total), Block::from_fn(n, n_bands, uneven)]
}

pub fn assert_agrees(name: &str, exact: &Block, drawn: &Estimate) {
    let verdict = compare_blocks(exact, &drawn.mean, &drawn.variance_of_mean, ALPHA);
    assert!(verdict.agrees, "{} in {name}: {verdict:?}", drawn.estimator);
    assert!(verdict.n_comparisons > 0, "{} in {name}: nothing was compared", drawn.estimator);
}

/// The estimate agrees with the answer and not with one that is off by three per cent.
pub fn assert_agrees_and_has_power(name: &str, exact: &Block, drawn: &Estimate) {
    assert_agrees(name, exact, drawn);
    let mut more = exact.clone();
    more.add_scaled(0.03, exact);
    let verdict = compare_blocks(&more, &drawn.mean, &drawn.variance_of_mean, ALPHA);
    assert!(!verdict.agrees, "{} in {name}: three per cent went unnoticed: {verdict:?}", drawn.estimator);
}

/// Any solver will do; this one subtracts nothing.
pub fn by_elimination(equation: Equation<'_>) -> Result<Block, SolveError> {
    Gth.solve(equation, &mut ()).map(|solution| solution.radiance)
}

/// Walks a start for the tests of variances: small by default, a million under ETENDUE_LARGE=1.
pub fn n_large() -> u64 {
    if std::env::var_os("ETENDUE_LARGE").is_some() { 1_000_000 } else { 20_000 }
}

/// Particles for the same: each of them looks at all bundles, and finds most of them rarely.
pub fn n_particles() -> u64 {
    if std::env::var_os("ETENDUE_LARGE").is_some() { 10_000_000 } else { 1_000_000 }
}

/// How far a measured variance is from the predicted one, over all entries of a column together: Σ (s²/V − 1) over its standard error. The
/// entries must be independent. Entries that do not vary must not vary.
pub fn variance_z(prediction: &Prediction, drawn: &Estimate) -> f64 {
    let n = drawn.n_samples as f64;
    let errors = prediction.variance_standard_error(drawn.n_samples).unwrap();
    let (mut sum, mut square) = (0.0, 0.0);
    let entries = prediction.variance.values().iter().zip(drawn.variance_of_mean.values()).zip(errors.values());
    for (((variance, measured), error), mean) in entries.zip(prediction.mean.values()) {
        let rounding = (SOLVE_TOLERANCE * mean).powi(2);
        if *variance <= rounding {
            assert!(n * measured <= rounding, "{}: what is certain varies", drawn.estimator);
            continue;
        }
        sum += n * measured / variance - 1.0;
        square += (error / variance).powi(2);
    }
    if square == 0.0 { 0.0 } else { sum / square.sqrt() }
}

/// The prediction's mean is the answer, its error bars hold for the sample's mean, and its variance is the sample's.
pub fn assert_predicted(name: &str, exact: &Block, prediction: &Prediction, drawn: &Estimate, n_families: usize) {
    assert!(relative_max(&prediction.mean, exact) < SOLVE_TOLERANCE, "{} in {name}: the mean", drawn.estimator);
    let mut variance_of_mean = prediction.variance.clone();
    variance_of_mean.values_mut().iter_mut().for_each(|v| *v /= drawn.n_samples as f64);
    let verdict = compare_blocks(exact, &drawn.mean, &variance_of_mean, ALPHA);
    assert!(verdict.agrees, "{} in {name}: {verdict:?}", drawn.estimator);
    let z = variance_z(prediction, drawn);
    if drawn.n_samples >= 1_000_000 {
        let measured: f64 = drawn.variance_of_mean.values().iter().sum();
        let predicted: f64 =
            prediction.standard_error(drawn.n_samples).values().iter().map(|error| error * error).sum();
        let ratio = (measured / predicted).sqrt();
        assert!(
            (ratio - 1.0).abs() < 0.01,
            "{} in {name}: standard errors are {ratio} of the predicted ones",
            drawn.estimator
        );
    }
    assert!(
        z.abs() < critical_z(ALPHA, n_families),
        "{} in {name}: the variance is off by {z} standard errors",
        drawn.estimator
    );
}

/// As [`assert_predicted`], entry by entry, for those of enough samples that their variance is nearly normal.
pub fn assert_each_predicted(name: &str, exact: &Block, prediction: &Prediction, drawn: &Estimate) {
    assert!(relative_max(&prediction.mean, exact) < SOLVE_TOLERANCE, "{} in {name}: the mean", drawn.estimator);
    let n = drawn.n_samples as f64;
    let (errors, mut n_compared) = (prediction.variance_standard_error(drawn.n_samples).unwrap(), 0);
    for (k, variance) in prediction.variance.values().iter().enumerate() {
        let (measured, error) = (n * drawn.variance_of_mean.values()[k], errors.values()[k]);
        if error < NEARLY_NORMAL * variance {
            n_compared += 1;
            let off =
                [(measured - variance) / error, (drawn.mean.values()[k] - exact.values()[k]) / (variance / n).sqrt()];
            assert!(
                off.iter().all(|z| z.abs() < critical_z(ALPHA, 2_000)),
                "{} in {name}: entry {k} is off by {off:?}",
                drawn.estimator
            );
        }
    }
    assert!(n_compared > 0, "{} in {name}: nothing was compared", drawn.estimator);
}

/// J of a measurement.
pub fn importance(system: &System, measurement: &Block) -> Block {
    Gth.solve(system.adjoint().equation(measurement), &mut ()).unwrap().radiance
}

pub fn by_factors(equation: Equation<'_>) -> Result<Block, SolveError> {
    Lu.solve(equation, &mut ()).map(|solution| solution.radiance)
}

/// A guide that is off by up to 10 %, and never the same way. (At 30 %, walks in a furnace of albedo 0.9 have no fourth moment.)
pub fn rough(exact: &Block) -> Block {
    let mut stream = Stream::new(SEED, 7, 7);
    Block::from_fn(exact.n_rows(), exact.n_columns(), |i, c| exact.get(i, c) * (0.9 + 0.2 * stream.uniform()))
}
