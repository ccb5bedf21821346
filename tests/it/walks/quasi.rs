//! Scrambled Sobol' points.

use super::*;

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
