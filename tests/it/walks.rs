//! Walks on the matrix against the matrix: every test of a random number is a hypothesis test at family-wise significance [`ALPHA`].

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
        system.transport().apply(&powers[k], &mut next);
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
            let drawn = estimate(&walk.shooting(scoring).unwrap(), 1_500_000, SEED);
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
            let quasi = walk.measuring(&wanted).unwrap().quasi(64);
            if bounces.last() > Some(0) {
                assert_agrees("a corner box", &measured, &estimate(&quasi, 1_000, SEED));
                assert_agrees("a corner box", &measured, &estimate(&quasi.sorted(), 1_000, SEED));
            }
            let shooting = walk.shooting(scoring).unwrap().with_bounces(bounces);
            let drawn = estimate(&shooting, 500_000, SEED);
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
    if std::env::var_os("ETENDUE_LARGE").is_some() { 1_000_000 } else { 20_000 }
}

/// Particles for the same: each of them looks at all bundles, and finds most of them rarely.
fn n_particles() -> u64 {
    if std::env::var_os("ETENDUE_LARGE").is_some() { 10_000_000 } else { 1_000_000 }
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
            assert_each_predicted(scene.name(), &exact, &prediction, &estimate(&shooting, n_particles(), SEED));
            let shooting = shooting.with_bounces(Bounces::Each(8));
            let prediction = shooting.predict(Order::Fourth, by_elimination).unwrap();
            let exact = exact_bounces(&system, Bounces::Each(8));
            assert_each_predicted(scene.name(), &exact, &prediction, &estimate(&shooting, n_particles(), SEED));
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

/// Importance from a mesh of a quarter of the bundles leaves a tenth of the variance, or less.
#[test]
fn walks_guided_by_a_coarse_solution_vary_little() {
    let scene = gallery::furnace_cube(&[0.5, 0.5], &[1.0, 2.0]).unwrap();
    let bundles =
        [0.5, 0.25].map(|patch_size| Bundles::new(&scene, Resolution { patch_size, n_directions: 1 }).unwrap());
    let systems = [0, 1].map(|k| {
        let facet = |i: usize| bundles[k].patch(bundles[k].element_of(i).0).unwrap().facet;
        let system = assemble(&scene, &bundles[k], Exchange::default()).unwrap();
        let albedo = |i: usize, band: usize| 0.9 - 0.15 * ((facet(i) + band) % 6) as f64;
        system.with_albedo(Block::from_fn(system.n_bundles(), system.n_bands(), albedo))
    });
    // What the floor sends out, on both meshes.
    let floor = [0, 1].map(|k| {
        let is_floor = |i: usize| bundles[k].patch(bundles[k].element_of(i).0).unwrap().facet == 0;
        Block::from_fn(bundles[k].n_bundles(), 2, |i, _| if is_floor(i) { 1.0 } else { 0.0 })
    });
    let coarse = importance(&systems[0], &floor[0]);
    let parent = |i: usize| {
        let patch = bundles[1].patch(bundles[1].element_of(i).0).unwrap();
        bundles[0].locate(patch.facet, patch.side, patch.polygon.centroid(), patch.polygon.normal()).unwrap()
    };
    let guide = Block::from_fn(bundles[1].n_bundles(), 2, |i, band| coarse.get(parent(i), band));
    let walk = GuidedWalk::shooting(&systems[1], &floor[1], &guide).unwrap();
    let prediction = walk.predict(Order::Fourth, &importance(&systems[1], &floor[1]), by_factors).unwrap();
    let (radiance, wanted) = (exact(&systems[1]), [floor[1].clone()]);
    let right = measured(&systems[1], &wanted, &radiance);
    assert_predicted(scene.name(), &right, &prediction, &estimate(&walk, n_large(), SEED), 12);
    let blind = MatrixWalk::collision(&systems[1]).unwrap().measuring(&wanted).unwrap();
    let blind = blind.predict(Order::Variance, &radiance, by_elimination).unwrap();
    for (guided, blind) in prediction.variance.values().iter().zip(blind.variance.values()) {
        assert!(10.0 * guided < *blind, "{guided} is not well below {blind}");
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
            let a_stage = if scoring == Scoring::ExpectedValue { 2 } else { 1 };
            assert_eq!(answer.history[n_stages].n_products, a_stage * n_stages);
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

/// On the Cornell box: a small one by default, 1 947 bundles under ETENDUE_LARGE=1.
#[test]
fn sequential_walks_solve_the_cornell_box() {
    let is_large = std::env::var_os("ETENDUE_LARGE").is_some();
    let system = system(&gallery::cornell_box(), if is_large { 0.12 } else { 0.5 });
    let walk = MatrixWalk::collision(&system).unwrap();
    let answer = walk.sequential(Sequential { tolerance: 1e-12, n_walks: 64, max_stages: 60 }, SEED);
    assert_eq!(answer.stop, SequentialStop::Converged, "{:?}", answer.history);
    assert!(relative_max(&answer.radiance, &exact(&system)) < 2e-11);
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
    let n_replicates = 100;
    for (quasi, steepest) in [(quasi.clone(), -0.55), (quasi.sorted(), -0.65)] {
        let errors = sizes.map(|n_points| {
            let drawn = estimate(&quasi.with_points(n_points), n_replicates, SEED);
            let error = (drawn.variance_of_mean.get(0, 0) * n_replicates as f64).sqrt();
            assert!(error < 0.5 * independent.standard_error(n_points).get(0, 0), "{n_points} points: {error}");
            error
        });
        // −½ for independent walks; a standard deviation from 100 replicates is good to 7 %, the slope to 0.02.
        let line = fit_power_law(&sizes.map(|n| n as f64), &errors).unwrap();
        assert!(line.slope < steepest, "{}: {line:?}: {errors:?}", quasi.name());
    }
}

// ---------------------------------------------------------------------------------------------------------------------------------
// Multilevel

#[test]
fn levels_add_up_to_the_finest() {
    let furnace = gallery::furnace_cube(&[0.3, 0.6, 0.9], &[1.0, 0.5, 0.2]).unwrap();
    for scene in [furnace, gallery::parallel_plates()] {
        let sizes = [0.5, 0.25, 0.125];
        let bundles = sizes.map(|patch_size| Bundles::new(&scene, Resolution { patch_size, n_directions: 1 }).unwrap());
        let systems = [0, 1, 2].map(|k| {
            // Walls that reflect unlike one another: in a furnace, walks of all levels score alike.
            let facet = |i: usize| bundles[k].patch(bundles[k].element_of(i).0).unwrap().facet;
            let system = assemble(&scene, &bundles[k], Exchange::default()).unwrap();
            let albedo = |i: usize, band: usize| (0.2 + 0.13 * facet(i) as f64) * (1.0 - 0.2 * band as f64);
            system.with_albedo(Block::from_fn(system.n_bundles(), system.n_bands(), albedo))
        });
        let pairs: Vec<_> = bundles.iter().zip(&systems).collect();
        let levels = Multilevel::new(&pairs).unwrap();
        let (name, exact) = (scene.name(), exact(&systems[2]));
        assert_eq!((levels.n_levels(), levels.n_bundles()), (3, exact.n_rows()));

        // Without bias, with error bars that hold, whatever the numbers of samples.
        let drawn = levels.estimate_with(&[20_000, 4_000, 4_000], SEED);
        let verdict = compare_blocks(&exact, &drawn.mean, &drawn.variance_of_mean, ALPHA);
        assert!(verdict.agrees, "{name}: {verdict:?}");
        let mut more = exact.clone();
        more.add_scaled(0.1, &exact);
        assert!(!compare_blocks(&more, &drawn.mean, &drawn.variance_of_mean, ALPHA).agrees);

        // Differences vary the less the finer the levels, ...
        let variances: Vec<f64> = drawn.levels.iter().map(|level| level.variance).collect();
        assert!(variances[2] < 0.8 * variances[1] && variances[1] < 0.5 * variances[0], "{name}: {variances:?}");

        // ... so that the error asked for is met, and even on meshes so coarse at no higher cost than by walks from every fine bundle.
        let error = 0.01 * exact.max_abs();
        let drawn = levels.estimate(error, 200, SEED);
        let total: f64 = systems[2].etendue().iter().sum();
        let mean_variance = |block: &Block| {
            let of =
                |column: &[f64]| column.iter().zip(systems[2].etendue()).map(|(v, mu)| v * mu / total).sum::<f64>();
            block.columns().map(of).fold(0.0, f64::max)
        };
        let reached = mean_variance(&drawn.variance_of_mean).sqrt();
        assert!((reached / error - 1.0).abs() < 0.2, "{name}: {reached} of {error}");
        let alone = MatrixWalk::collision(&systems[2]).unwrap();
        let predicted = alone.predict(Order::Variance, &exact, by_elimination).unwrap();
        let n_walks = mean_variance(&predicted.variance) / (error * error);
        let steps_a_walk = estimate(&alone, 100, SEED).n_steps as f64 / 100.0;
        let n_steps: u64 = drawn.levels.iter().map(|level| level.n_steps).sum();
        let by_itself = n_walks * steps_a_walk;
        assert!((n_steps as f64) < 1.2 * by_itself, "{name}: {n_steps} against {by_itself}: {:?}", drawn.levels);
    }
}

#[test]
fn levels_that_are_no_refinements_are_refused() {
    let scene = gallery::corner_box();
    let bundles =
        [0.5, 0.3].map(|patch_size| Bundles::new(&scene, Resolution { patch_size, n_directions: 1 }).unwrap());
    let systems = [0, 1].map(|k| assemble(&scene, &bundles[k], Exchange::default()).unwrap());
    let refused = Multilevel::new(&[(&bundles[0], &systems[0]), (&bundles[1], &systems[1])]).unwrap_err();
    assert!(
        matches!(refused, EstimatorError::Nesting { level: 1, source: NestingError::Straddles { .. } }),
        "{refused:?}"
    );
    assert_eq!(Multilevel::new(&[]).unwrap_err(), EstimatorError::NoLevels);
}

// ---------------------------------------------------------------------------------------------------------------------------------
// Planted errors

#[derive(Clone, Copy, Debug, PartialEq)]
enum Mistake {
    None,
    /// Survivors are not weighed by a / p.
    RouletteUnweighed,
    /// Every score is 1 % too high.
    ScoreOff,
}

/// The mean radiance of everything by a collision walk of its own, with or without a mistake in it.
struct Planted<'a> {
    system: &'a System,
    starts: AliasTable,
    steps: AliasRows,
    mistake: Mistake,
}

impl Planted<'_> {
    fn albedo(&self, bundle: usize, band: usize) -> f64 {
        self.system.transport().scattering().values().get(bundle, band)
    }
}

impl Estimator for Planted<'_> {
    fn name(&self) -> &'static str {
        "planted"
    }

    fn truth(&self) -> Truth {
        Truth::Discrete
    }

    fn n_bundles(&self) -> usize {
        1
    }

    fn n_columns(&self) -> usize {
        self.system.n_bands()
    }

    fn sample(&self, start: usize, stream: &mut Stream, score: &mut Score) {
        let mut bundle = self.starts.sample(stream.uniform());
        let n_bands = self.system.n_bands();
        let mut weights = vec![if self.mistake == Mistake::ScoreOff { 1.01 } else { 1.0 }; n_bands];
        loop {
            (0..n_bands)
                .for_each(|band| score.add(start, band, weights[band] * self.system.emission().get(bundle, band)));
            let survival = (0..n_bands).map(|band| self.albedo(bundle, band)).fold(0.0, f64::max);
            if stream.uniform() >= survival {
                return;
            }
            if self.mistake != Mistake::RouletteUnweighed {
                (0..n_bands).for_each(|band| weights[band] *= self.albedo(bundle, band) / survival);
            }
            let Some(next) = self.steps.sample(bundle, stream.uniform()) else { return };
            bundle = next;
        }
    }
}

/// Each mistake is caught within the number of samples that the prediction names beforehand: enough for the bias it makes to stand nine
/// standard errors out, where five are too many.
#[test]
fn planted_errors_are_caught_within_the_predicted_budget() {
    let system = system(&gallery::corner_box(), 1.0);
    let (n, n_bands) = (system.n_bundles(), system.n_bands());
    let exact = exact(&system);
    let wanted = &measurements(&system)[..1];
    let walk = MatrixWalk::collision(&system).unwrap().measuring(wanted).unwrap();
    let prediction = walk.predict(Order::Variance, &exact, by_elimination).unwrap();
    let right = measured(&system, wanted, &exact);
    for mistake in [Mistake::RouletteUnweighed, Mistake::ScoreOff] {
        let planted = |mistake| Planted {
            system: &system,
            starts: AliasTable::new(system.etendue()).unwrap(),
            steps: AliasRows::new(n, n, |i, row| system.transport().propagation().row(0, i, row)).unwrap(),
            mistake,
        };
        // What the mistake amounts to.
        let wrong = planted(mistake);
        let albedo = |i: usize, band: usize| match mistake {
            Mistake::RouletteUnweighed => (0..n_bands).map(|band| wrong.albedo(i, band)).fold(0.0, f64::max),
            _ => wrong.albedo(i, band),
        };
        let mut biased = self::exact(&system.with_albedo(Block::from_fn(n, n_bands, albedo)));
        let factor = if mistake == Mistake::ScoreOff { 1.01 } else { 1.0 };
        biased.values_mut().iter_mut().for_each(|v| *v *= factor);
        let bias = measured(&system, wanted, &biased);

        // The budget that shows it in the band where it shows most.
        let samples = |band: usize| {
            let off = (bias.get(0, band) - right.get(0, band)).abs() / (critical_z(ALPHA, n_bands) + 4.0);
            prediction.variance.get(0, band) / (off * off)
        };
        let n_samples = (0..n_bands).map(samples).fold(f64::INFINITY, f64::min).ceil() as u64;
        let judge = |mistake| {
            let drawn = estimate(&planted(mistake), n_samples, SEED);
            compare_blocks(&right, &drawn.mean, &drawn.variance_of_mean, ALPHA)
        };
        let verdict = judge(mistake);
        assert!(!verdict.agrees, "{mistake:?} went unnoticed in {n_samples} samples: {verdict:?}");
        let verdict = judge(Mistake::None);
        assert!(verdict.agrees, "no mistake, {n_samples} samples: {verdict:?}");
    }
}

/// A third of all bundles reflects a thousandth more than it should: walks guided by the right solution vary so little that few of them tell.
#[test]
fn an_albedo_that_is_slightly_off_is_caught_by_guided_walks() {
    let system = system(&gallery::corner_box(), 1.0);
    let (n, n_bands) = (system.n_bundles(), system.n_bands());
    let exact = exact(&system);
    let wanted = &measurements(&system)[..1];
    let right = measured(&system, wanted, &exact);
    let albedo = system.transport().scattering().values();
    let off = |i: usize, band: usize| if 3 * i < n { 1.001 * albedo.get(i, band) } else { albedo.get(i, band) };
    let mistaken = system.with_albedo(Block::from_fn(n, n_bands, off));
    let walk = GuidedWalk::gathering(&mistaken, &exact).unwrap().measuring(wanted).unwrap();
    let biased = self::exact(&mistaken);
    let prediction = walk.predict(Order::Variance, &biased, by_factors).unwrap();
    let bias = measured(&system, wanted, &biased);
    let error = (0..n_bands).map(|band| (bias.get(0, band) - right.get(0, band)).abs()).fold(0.0, f64::max);
    let n_samples = prediction.samples_for(error / (critical_z(ALPHA, n_bands) + 4.0)).max(1_000);
    assert!(n_samples < 20_000, "{n_samples} samples");
    let drawn = estimate(&walk, n_samples, SEED);
    let verdict = compare_blocks(&right, &drawn.mean, &drawn.variance_of_mean, ALPHA);
    assert!(!verdict.agrees, "{n_samples} samples: {verdict:?}");
    let verdict = compare_blocks(&bias, &drawn.mean, &drawn.variance_of_mean, ALPHA);
    assert!(verdict.agrees, "{n_samples} samples: {verdict:?}");
}

// ---------------------------------------------------------------------------------------------------------------------------------
// Threads

#[test]
fn threads_change_no_bit_of_any_walk() {
    let system = system(&gallery::corner_box(), 0.5);
    let exact = exact(&system);
    let walk = MatrixWalk::collision(&system).unwrap();
    let wanted = measurements(&system);
    let all: [(Box<dyn Estimator>, u64); 6] = [
        (Box::new(walk.measuring(&wanted).unwrap()), 5_000),
        (Box::new(walk.shooting(Scoring::Survival).unwrap()), 10_000),
        (Box::new(walk.stochastic_jacobi(10_000).unwrap()), 50),
        (Box::new(GuidedWalk::gathering(&system, &rough(&exact)).unwrap()), 1_500),
        (Box::new(walk.quasi(1_000)), 5),
        (Box::new(walk.measuring(&wanted).unwrap().quasi(20_000)), 20),
    ];
    let on = |n_threads: usize, estimator: &dyn Estimator, n_samples: u64| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
        pool.install(|| estimate(estimator, n_samples, SEED))
    };
    for (estimator, n_samples) in &all {
        let alone = on(1, estimator.as_ref(), *n_samples);
        assert!(alone.n_steps > 0, "{} counts no steps", estimator.name());
        assert_eq!(alone, on(3, estimator.as_ref(), *n_samples), "{}", estimator.name());
    }
}

/// Particles move many abreast; one after another they draw the same samples.
#[test]
fn particles_abreast_are_the_same_particles() {
    let system = system(&gallery::corner_box(), 0.5);
    for bounces in [Bounces::All, Bounces::Each(3), Bounces::UpTo(1), Bounces::UpTo(0)] {
        let shooting =
            MatrixWalk::collision(&system).unwrap().shooting(Scoring::Absorption).unwrap().with_bounces(bounces);
        let drawn = estimate(&shooting, 3_000, SEED);
        let mut sum = Block::zeros(drawn.mean.n_rows(), drawn.mean.n_columns());
        let one_by_one = OneByOne(&shooting);
        sum.copy_from(&estimate(&one_by_one, 3_000, SEED).mean);
        sum.add_scaled(1.0, shooting.known().unwrap());
        assert!(relative_max(&sum, &drawn.mean) < SOLVE_TOLERANCE, "{bounces:?}");
    }
}

/// Another estimator's samples, drawn singly, without what is known.
struct OneByOne<'a>(&'a dyn Estimator);

impl Estimator for OneByOne<'_> {
    fn name(&self) -> &'static str {
        self.0.name()
    }

    fn truth(&self) -> Truth {
        self.0.truth()
    }

    fn n_bundles(&self) -> usize {
        self.0.n_bundles()
    }

    fn n_columns(&self) -> usize {
        self.0.n_columns()
    }

    fn n_starts(&self) -> usize {
        self.0.n_starts()
    }

    fn reach(&self, start: usize) -> std::ops::Range<usize> {
        self.0.reach(start)
    }

    fn sample(&self, start: usize, stream: &mut Stream, score: &mut Score) {
        self.0.sample(start, stream, score);
    }
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
