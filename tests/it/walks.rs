//! Walks on the matrix against the matrix: every test of a random number is a hypothesis test at family-wise significance [`ALPHA`].

use etendue::assembly::{Exchange, System, assemble};
use etendue::basis::{Bundles, Resolution};
use etendue::compare::compare_blocks;
use etendue::estimator::{Bounces, Estimate, Estimator, EstimatorError, MatrixWalk, Scoring, Truth, estimate};
use etendue::gallery;
use etendue::linalg::Block;
use etendue::scene::Scene;
use etendue::solver::{Gth, Solver};

/// Probability that one of these tests rejects walks that are right.
const ALPHA: f64 = 1e-6;
const SEED: u64 = 0x0dd5_0f0d_d5ee_d5a1;

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
