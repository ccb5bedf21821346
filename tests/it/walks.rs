//! Walks on the matrix against the matrix: every test of a random number is a hypothesis test at family-wise significance [`ALPHA`].

use etendue::assembly::{Exchange, System, assemble};
use etendue::basis::{Bundles, Resolution};
use etendue::compare::{compare_blocks, relative_max};
use etendue::estimator::{
    Bounces, Estimate, Estimator, EstimatorError, GuidedWalk, MatrixWalk, OracleError, Order, Prediction, Scoring,
    Sequential, SequentialStop, Truth, estimate,
};
use etendue::gallery;
use etendue::linalg::{Block, Equation};
use etendue::sampling::Stream;
use etendue::scene::Scene;
use etendue::solver::{Gth, Lu, SolveError, Solver};
use etendue::stats::{critical_z, fit_line, fit_power_law};

/// Probability that one of these tests rejects walks that are right.
const ALPHA: f64 = 1e-6;
const SEED: u64 = 0x0dd5_0f0d_d5ee_d5a1;
/// Relative standard deviation of walks that are guided by the solution: some ulp a step, and what elimination leaves.
const NO_DEVIATION: f64 = 1e-10;
/// A measured variance whose standard error is this small, relatively, rests on some thousand rare scores.
const NEARLY_NORMAL: f64 = 0.03;
/// Elimination without subtraction loses some ulp an unknown, of which there are hundreds at most.
const SOLVE_TOLERANCE: f64 = 1e-12;

// ---------------------------------------------------------------------------------------------------------------------------------
// Scenes and their exact answers

/// Gallery scenes whose lamps are large enough for walks to find them often: a closed furnace of three bands, an open pair of plates, and a
/// box of three colours.
fn scenes() -> Vec<(Scene, f64)> {
    let furnace = gallery::furnace_cube(&[0.3, 0.6, 0.9], &[1.0, 0.5, 0.2]).unwrap();
    vec![(furnace, 1.0), (gallery::parallel_plates(), 0.5), (gallery::corner_box(), 0.5)]
}

fn system(scene: &Scene, patch_size: f64) -> System {
    let bundles = Bundles::new(scene, Resolution { patch_size, n_directions: 1 }).unwrap();
    assemble(scene, &bundles, Exchange::default()).unwrap()
}

fn exact(system: &System) -> Block {
    Gth.solve(system.equation(), &mut ()).unwrap().radiance
}

/// KᵏE side by side for k = 0 … `last`, or their sum.
fn exact_bounces(system: &System, bounces: Bounces) -> Block {
    let Some(last) = bounces.last() else { return exact(system) };
    let (n, n_bands) = (system.n_bundles(), system.n_bands());
    let mut powers = vec![system.emission().clone()];
    for k in 0..last {
        let mut next = Block::zeros(n, n_bands);
        etendue::linalg::LinearOperator::apply(system.transport(), &powers[k], &mut next);
        powers.push(next);
    }
    match bounces {
        Bounces::Each(_) => Block::from_fn(n, n_bands * (last + 1), |i, c| powers[c / n_bands].get(i, c % n_bands)),
        _ => Block::from_fn(n, n_bands, |i, band| powers.iter().map(|power| power.get(i, band)).sum()),
    }
}

/// ⟨W, L⟩, one row a measurement.
fn measured(system: &System, measurements: &[Block], radiance: &Block) -> Block {
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
fn measurements(system: &System) -> Vec<Block> {
    let (n, n_bands) = (system.n_bundles(), system.n_bands());
    let total: f64 = system.etendue().iter().sum();
    let uneven = |i: usize, band: usize| if 2 * i < n { 1.0 + band as f64 } else { -0.25 } / total;
    vec![Block::from_fn(n, n_bands, |_, _| 1.0 / total), Block::from_fn(n, n_bands, uneven)]
}

// ---------------------------------------------------------------------------------------------------------------------------------
// Agreement

fn assert_agrees(name: &str, exact: &Block, drawn: &Estimate) {
    let verdict = compare_blocks(exact, &drawn.mean, &drawn.variance_of_mean, ALPHA);
    assert!(verdict.agrees, "{} in {name}: {verdict:?}", drawn.estimator);
    assert!(verdict.n_comparisons > 0, "{} in {name}: nothing was compared", drawn.estimator);
}

/// The estimate agrees with the answer and not with one that is off by three per cent.
fn assert_agrees_and_has_power(name: &str, exact: &Block, drawn: &Estimate) {
    assert_agrees(name, exact, drawn);
    let mut more = exact.clone();
    more.add_scaled(0.03, exact);
    let verdict = compare_blocks(&more, &drawn.mean, &drawn.variance_of_mean, ALPHA);
    assert!(!verdict.agrees, "{} in {name}: three per cent went unnoticed: {verdict:?}", drawn.estimator);
}

#[test]
fn every_scoring_gathers_the_radiance() {
    for (scene, patch_size) in scenes() {
        let system = system(&scene, patch_size);
        let (exact, walk) = (exact(&system), MatrixWalk::collision(&system).unwrap());
        for scoring in Scoring::ALL {
            let drawn = estimate(&walk.with_scoring(scoring), 200_000, SEED);
            assert_agrees_and_has_power(scene.name(), &exact, &drawn);
        }
    }
}

#[test]
fn every_scoring_measures() {
    for (scene, patch_size) in scenes() {
        let system = system(&scene, patch_size);
        let (exact, walk) = (exact(&system), MatrixWalk::collision(&system).unwrap());
        let wanted = measurements(&system);
        for scoring in Scoring::ALL {
            let measuring = walk.with_scoring(scoring).measuring(&wanted).unwrap();
            assert_eq!((measuring.n_bundles(), measuring.truth()), (2, Truth::Discrete));
            let drawn = estimate(&measuring, 400_000, SEED);
            assert_agrees_and_has_power(scene.name(), &measured(&system, &wanted, &exact), &drawn);
        }
    }
}

#[test]
fn every_scoring_shoots() {
    for (scene, patch_size) in scenes() {
        let system = system(&scene, patch_size);
        let (exact, walk) = (exact(&system), MatrixWalk::collision(&system).unwrap());
        for scoring in Scoring::ALL {
            let drawn = estimate(&walk.shooting(scoring).unwrap(), 4_000_000, SEED);
            assert!(!drawn.independent_bundles);
            assert_agrees_and_has_power(scene.name(), &exact, &drawn);
        }
        let jacobi = walk.stochastic_jacobi(1_000).unwrap();
        assert_agrees_and_has_power(scene.name(), &exact, &estimate(&jacobi, 4_000, SEED));
    }
}

#[test]
fn bounces_are_told_apart() {
    let system = system(&gallery::corner_box(), 0.5);
    let walk = MatrixWalk::collision(&system).unwrap();
    let wanted = measurements(&system);
    for bounces in [Bounces::Each(8), Bounces::UpTo(3), Bounces::UpTo(0)] {
        let exact = exact_bounces(&system, bounces);
        let measured = measured(&system, &wanted, &exact);
        for scoring in Scoring::ALL {
            let walk = walk.with_scoring(scoring).with_bounces(bounces);
            assert_agrees("a corner box", &measured, &estimate(&walk.measuring(&wanted).unwrap(), 400_000, SEED));
            let shooting = walk.shooting(scoring).unwrap().with_bounces(bounces);
            let drawn = estimate(&shooting, 2_000_000, SEED);
            if bounces == Bounces::UpTo(0) {
                assert_eq!(drawn.mean, exact);
            } else {
                assert_agrees("a corner box", &exact, &drawn);
            }
        }
        let jacobi = walk.stochastic_jacobi(1_000).unwrap().with_bounces(bounces);
        assert_eq!(estimate(&jacobi, 1, SEED).mean.n_columns(), exact.n_columns());
        if bounces.last() > Some(0) {
            assert_agrees("a corner box", &exact, &estimate(&jacobi, 4_000, SEED));
        }
    }
}

// ---------------------------------------------------------------------------------------------------------------------------------
// Predicted error bars

/// Any solver will do; this one subtracts nothing.
fn by_elimination(equation: Equation<'_>) -> Result<Block, SolveError> {
    Gth.solve(equation, &mut ()).map(|solution| solution.radiance)
}

/// Walks a start for the tests of variances: small by default, a million under ETENDUE_LARGE=1.
fn n_large() -> u64 {
    if std::env::var_os("ETENDUE_LARGE").is_some() { 1_000_000 } else { 50_000 }
}

/// How far a measured variance is from the predicted one, over all entries of a column together: Σ (s²/V − 1) over its standard error. The
/// entries must be independent. Entries that do not vary must not vary.
fn variance_z(prediction: &Prediction, drawn: &Estimate) -> f64 {
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
fn assert_predicted(name: &str, exact: &Block, prediction: &Prediction, drawn: &Estimate, n_families: usize) {
    assert!(relative_max(&prediction.mean, exact) < SOLVE_TOLERANCE, "{} in {name}: the mean", drawn.estimator);
    let mut variance_of_mean = prediction.variance.clone();
    variance_of_mean.values_mut().iter_mut().for_each(|v| *v /= drawn.n_samples as f64);
    let verdict = compare_blocks(exact, &drawn.mean, &variance_of_mean, ALPHA);
    assert!(verdict.agrees, "{} in {name}: {verdict:?}", drawn.estimator);
    let z = variance_z(prediction, drawn);
    assert!(
        z.abs() < critical_z(ALPHA, n_families),
        "{} in {name}: the variance is off by {z} standard errors",
        drawn.estimator
    );
}

/// As [`assert_predicted`], entry by entry, for those of enough samples that their variance is nearly normal.
fn assert_each_predicted(name: &str, exact: &Block, prediction: &Prediction, drawn: &Estimate) {
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

#[test]
fn variances_of_gathering_walks_are_predicted() {
    for (scene, patch_size) in scenes() {
        let system = system(&scene, patch_size);
        let (exact, walk) = (exact(&system), MatrixWalk::collision(&system).unwrap());
        let wanted = measurements(&system);
        for scoring in Scoring::ALL {
            let walk = walk.with_scoring(scoring);
            let prediction = walk.predict(Order::Fourth, &exact, by_elimination).unwrap();
            assert_predicted(scene.name(), &exact, &prediction, &estimate(&walk, n_large(), SEED), 24);
            let (measuring, measured) = (walk.measuring(&wanted).unwrap(), measured(&system, &wanted, &exact));
            let prediction = measuring.predict(Order::Fourth, &exact, by_elimination).unwrap();
            assert_predicted(scene.name(), &measured, &prediction, &estimate(&measuring, n_large(), SEED), 24);
        }
    }
}

#[test]
fn variances_of_bounces_are_predicted() {
    let system = system(&gallery::corner_box(), 1.0);
    let walk = MatrixWalk::collision(&system).unwrap();
    let wanted = measurements(&system);
    for bounces in [Bounces::Each(8), Bounces::UpTo(3), Bounces::UpTo(0)] {
        let exact = exact_bounces(&system, bounces);
        for scoring in Scoring::ALL {
            let walk = walk.with_scoring(scoring).with_bounces(bounces).measuring(&wanted).unwrap();
            let never = |_: Equation<'_>| -> Result<Block, SolveError> { panic!("bounces that end need no solve") };
            let prediction = walk.predict(Order::Fourth, &exact, never).unwrap();
            assert_predicted(
                "a corner box",
                &measured(&system, &wanted, &exact),
                &prediction,
                &estimate(&walk, 100_000, SEED),
                12,
            );
        }
    }
}

/// Errors of different bundles are not independent: one bundle at a time.
#[test]
fn variances_of_shooting_walks_are_predicted() {
    for (scene, patch_size) in scenes() {
        let system = system(&scene, patch_size);
        let (exact, walk) = (exact(&system), MatrixWalk::collision(&system).unwrap());
        for scoring in Scoring::ALL {
            let shooting = walk.shooting(scoring).unwrap();
            let prediction = shooting.predict(Order::Fourth, by_elimination).unwrap();
            assert_each_predicted(scene.name(), &exact, &prediction, &estimate(&shooting, 40 * n_large(), SEED));
            let shooting = shooting.with_bounces(Bounces::Each(8));
            let prediction = shooting.predict(Order::Fourth, by_elimination).unwrap();
            let exact = exact_bounces(&system, Bounces::Each(8));
            assert_each_predicted(scene.name(), &exact, &prediction, &estimate(&shooting, 40 * n_large(), SEED));
            let partial = shooting.with_bounces(Bounces::UpTo(2)).predict(Order::Variance, by_elimination);
            assert_eq!(partial, Err(OracleError::PartialSum { last: 2 }));
        }
    }
}

/// `samples_for` names a number of walks that meets the error, and half as many would not.
#[test]
fn samples_for_an_error_are_enough_and_not_too_many() {
    let system = system(&gallery::corner_box(), 1.0);
    let (exact, walk) = (exact(&system), MatrixWalk::collision(&system).unwrap());
    let prediction = walk.predict(Order::Variance, &exact, by_elimination).unwrap();
    assert_eq!((&prediction.third, &prediction.fourth), (&None, &None));
    let error = 0.02 * exact.max_abs();
    let n_walks = prediction.samples_for(error);
    assert!(
        prediction.standard_error(n_walks).max_abs() <= error
            && prediction.standard_error(n_walks / 2).max_abs() > error
    );
    let drawn = estimate(&walk, n_walks, SEED);
    let largest = drawn.variance_of_mean.values().iter().fold(0.0, |a: f64, v| a.max(v.sqrt()));
    assert!((largest / error - 1.0).abs() < 0.25, "{n_walks} walks leave {largest} of {error}");
    let n_walks = prediction.samples_for_relative(0.01);
    let errors = prediction.standard_error(n_walks);
    let worst = errors.values().iter().zip(exact.values()).map(|(e, l)| e / l).fold(0.0, f64::max);
    assert!((worst / 0.01 - 1.0).abs() < 1e-3, "{worst}");
}

// ---------------------------------------------------------------------------------------------------------------------------------
// Importance

/// J of a measurement.
fn importance(system: &System, measurement: &Block) -> Block {
    Gth.solve(system.adjoint().equation(measurement), &mut ()).unwrap().radiance
}

fn by_factors(equation: Equation<'_>) -> Result<Block, SolveError> {
    Lu.solve(equation, &mut ()).map(|solution| solution.radiance)
}

/// A guide that is off by up to 10 %, and never the same way. (At 30 %, walks in a furnace of albedo 0.9 have no fourth moment.)
fn rough(exact: &Block) -> Block {
    let mut stream = Stream::new(SEED, 7, 7);
    Block::from_fn(exact.n_rows(), exact.n_columns(), |i, c| exact.get(i, c) * (0.9 + 0.2 * stream.uniform()))
}

#[test]
fn walks_guided_by_the_solution_have_no_variance() {
    for (scene, patch_size) in scenes() {
        let system = system(&scene, patch_size);
        let exact = exact(&system);
        let wanted = measurements(&system)[..1].to_vec();
        let gathering = GuidedWalk::gathering(&system, &exact).unwrap();
        let measuring = gathering.measuring(&wanted).unwrap();
        let shooting = GuidedWalk::shooting(&system, &wanted[0], &importance(&system, &wanted[0])).unwrap();
        let measured = measured(&system, &wanted, &exact);
        let walks: [(&dyn Estimator, &Block); 3] =
            [(&gathering, &exact), (&measuring, &measured), (&shooting, &measured)];
        for (walk, exact) in walks {
            let drawn = estimate(walk, 2_000, SEED);
            assert!(relative_max(&drawn.mean, exact) < SOLVE_TOLERANCE, "{} in {}", walk.name(), scene.name());
            let worst = drawn.variance_of_mean.values().iter().zip(exact.values());
            let worst = worst.map(|(v, l)| (v * 2_000.0).sqrt() / l).fold(0.0, f64::max);
            assert!(worst < NO_DEVIATION, "{} in {}: the deviation is {worst:e}", walk.name(), scene.name());
        }
        let predicted = gathering.predict(Order::Fourth, &exact, by_factors).unwrap();
        let worst =
            predicted.variance.values().iter().zip(exact.values()).map(|(v, l)| v.sqrt() / l).fold(0.0, f64::max);
        assert!(worst < NO_DEVIATION, "{}: predicted {worst:e}", scene.name());
    }
}

#[test]
fn walks_guided_roughly_are_right_and_predicted() {
    for (scene, patch_size) in scenes() {
        let system = system(&scene, patch_size);
        let exact = exact(&system);
        let wanted = measurements(&system);
        let gathering = GuidedWalk::gathering(&system, &rough(&exact)).unwrap();
        let prediction = gathering.predict(Order::Fourth, &exact, by_factors).unwrap();
        assert_predicted(scene.name(), &exact, &prediction, &estimate(&gathering, n_large(), SEED), 12);

        let (measuring, all) = (gathering.measuring(&wanted).unwrap(), measured(&system, &wanted, &exact));
        let prediction = measuring.predict(Order::Fourth, &exact, by_factors).unwrap();
        assert_predicted(scene.name(), &all, &prediction, &estimate(&measuring, n_large(), SEED), 12);

        let (exact, first) = (importance(&system, &wanted[0]), measured(&system, &wanted[..1], &exact));
        let shooting = GuidedWalk::shooting(&system, &wanted[0], &rough(&exact)).unwrap();
        let predicted = shooting.predict(Order::Fourth, &exact, by_factors).unwrap();
        assert_predicted(scene.name(), &first, &predicted, &estimate(&shooting, n_large(), SEED), 12);

        // A rough guide beats none by far.
        let blind = MatrixWalk::collision(&system).unwrap().measuring(&wanted[..1]).unwrap();
        let blind = blind.predict(Order::Variance, &self::exact(&system), by_elimination).unwrap();
        for (guided, blind) in predicted.variance.values().iter().zip(blind.variance.values()) {
            assert!(*blind < 1e-20 || 3.0 * guided < *blind, "{}: {guided} is not well below {blind}", scene.name());
        }
    }
}

/// A guide that knows nothing sends weights up without end.
#[test]
fn moments_that_do_not_exist_are_refused() {
    let system = system(&gallery::corner_box(), 1.0);
    let exact = exact(&system);
    let mut stream = Stream::new(SEED, 8, 8);
    let wild = Block::from_fn(exact.n_rows(), exact.n_columns(), |_, _| 10f64.powf(6.0 * stream.uniform()));
    let walk = GuidedWalk::gathering(&system, &wild).unwrap();
    let refused = walk.predict(Order::Variance, &exact, by_factors);
    assert!(matches!(refused, Err(OracleError::Infinite { order: 2, radius }) if radius >= 1.0), "{refused:?}");

    let mut zero = exact.clone();
    zero.set(3, 0, 0.0);
    assert_eq!(GuidedWalk::gathering(&system, &zero).unwrap_err(), EstimatorError::GuideMisses { bundle: 3, band: 0 });
    zero.set(3, 0, -1.0);
    let refused = GuidedWalk::gathering(&system, &zero).unwrap_err();
    assert_eq!(refused, EstimatorError::Guide { bundle: 3, band: 0, value: -1.0 });
}

// ---------------------------------------------------------------------------------------------------------------------------------
// Sequential Monte Carlo

#[test]
fn sequential_walks_converge_exponentially() {
    for (scene, patch_size) in scenes() {
        let system = system(&scene, patch_size);
        let (exact, walk) = (exact(&system), MatrixWalk::collision(&system).unwrap());
        for scoring in Scoring::ALL {
            let settings = Sequential { tolerance: 1e-12, n_walks: 1_000, max_stages: 60 };
            let answer = walk.with_scoring(scoring).sequential(settings, SEED);
            let (name, n_stages) = (scene.name(), answer.history.len() - 1);
            assert_eq!(answer.stop, SequentialStop::Converged, "{scoring:?} in {name}: {:?}", answer.history);
            assert_eq!(answer.history[n_stages].n_products, n_stages);
            // ‖L̃ − L‖ ≤ ‖r‖ / (1 − ‖K‖), and no albedo exceeds 0.9.
            assert!(relative_max(&answer.radiance, &exact) < 2e-11, "{scoring:?} in {name}");

            // Every stage takes the same work and about the same factor.
            let logs: Vec<f64> = answer.history.iter().map(|stage| stage.residual.ln()).collect();
            let line = fit_line(&(0..logs.len()).map(|k| k as f64).collect::<Vec<_>>(), &logs).unwrap();
            assert!(
                line.slope < -0.7 && line.slope_standard_error < 0.1 * -line.slope,
                "{scoring:?} in {name}: {line:?}"
            );
        }
    }
}

#[test]
fn sequential_walks_stop_where_rounding_begins_or_walks_are_few() {
    let system = system(&gallery::corner_box(), 0.25);
    let walk = MatrixWalk::collision(&system).unwrap();
    let settings = Sequential { tolerance: 0.0, n_walks: 1_000, max_stages: 200 };
    let rounding = walk.sequential(settings, SEED);
    assert_eq!(rounding.stop, SequentialStop::Stalled);
    assert!(rounding.history.iter().any(|stage| stage.residual < 1e-14), "{:?}", rounding.history);
    assert_eq!(walk.sequential(Sequential { max_stages: 2, ..settings }, SEED).stop, SequentialStop::Budget);
    assert_eq!(walk.sequential(Sequential { n_walks: 1, ..settings }, SEED).stop, SequentialStop::Stalled);
}

// ---------------------------------------------------------------------------------------------------------------------------------
// Quasi-Monte Carlo

#[test]
fn scrambled_points_walk_without_bias() {
    for (scene, patch_size) in scenes() {
        let system = system(&scene, patch_size);
        let (exact, walk) = (exact(&system), MatrixWalk::collision(&system).unwrap());
        let wanted = measurements(&system);
        for scoring in Scoring::ALL {
            let walk = walk.with_scoring(scoring);
            assert_agrees_and_has_power(scene.name(), &exact, &estimate(&walk.quasi(256), 400, SEED));
            let measuring = walk.measuring(&wanted).unwrap().quasi(256);
            assert_agrees_and_has_power(
                scene.name(),
                &measured(&system, &wanted, &exact),
                &estimate(&measuring, 1_000, SEED),
            );
        }
    }
}

/// The error of a mean over everything falls faster than that of independent walks, and lies below it everywhere.
#[test]
fn scrambled_points_converge_faster() {
    let system = system(&gallery::corner_box(), 0.25);
    let wanted = &measurements(&system)[..1];
    let measuring =
        MatrixWalk::collision(&system).unwrap().with_scoring(Scoring::ExpectedValue).measuring(wanted).unwrap();
    let exact = exact(&system);
    let independent = measuring.predict(Order::Variance, &exact, by_elimination).unwrap();
    let quasi = measuring.quasi(1);
    let sizes = [64u64, 256, 1024, 4096, 16384];
    let n_replicates = 200;
    let errors = sizes.map(|n_points| {
        let drawn = estimate(&quasi.with_points(n_points), n_replicates, SEED);
        let error = (drawn.variance_of_mean.get(0, 0) * n_replicates as f64).sqrt();
        assert!(error < 0.75 * independent.standard_error(n_points).get(0, 0), "{n_points} points: {error}");
        error
    });
    // −½ for independent walks; a standard deviation from 200 replicates is good to 5 %, the slope to 0.02.
    let line = fit_power_law(&sizes.map(|n| n as f64), &errors).unwrap();
    assert!(line.slope < -0.6, "{line:?}: {errors:?}");
}

// ---------------------------------------------------------------------------------------------------------------------------------
// Refusals

#[test]
fn what_cannot_be_sampled_is_refused() {
    let system = system(&gallery::corner_box(), 1.0);
    let walk = MatrixWalk::collision(&system).unwrap();
    let nothing = Block::zeros(system.n_bundles(), system.n_bands());
    assert!(matches!(walk.measuring(&[nothing]), Err(EstimatorError::Measurement { measurement: 0, .. })));
    assert_eq!(walk.stochastic_jacobi(0).unwrap_err(), EstimatorError::NoParticles);

    let by_rows = system.repaired_by(etendue::assembly::RepairMethod::Rows).0;
    let walk = MatrixWalk::collision(&by_rows).unwrap();
    assert_eq!(walk.shooting(Scoring::Collision).unwrap_err(), EstimatorError::NotReciprocal);
}
