//! Every scoring has the radiance as its mean.

use super::*;

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
