//! Variances are what their linear systems say.

use super::*;

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
