//! Each strategy (s, t) of bidirectional path tracing by itself, in scenes whose surfaces do not touch: elsewhere those with s ≥ 1 have no
//! variance.

use super::exact::bounces_of_plates;
use super::*;
use etendue::gallery;
use etendue::scattering::Phong;

/// Strategies of up to this many bounces.
const LAST: usize = 4;

/// All (s, t), t ≥ 1, of up to `LAST` bounces, and which bounce each finds.
fn strategies() -> impl Iterator<Item = (usize, usize, usize)> {
    (0..=LAST).flat_map(|k| (1..=k + 1).map(move |t| (k + 1 - t, t, k)))
}

/// Three panels that hang apart, two of them glossy; the second emits, and the third reflects on both sides.
fn panels() -> Scene {
    let gloss = |reflectance: [f64; 2], exponent| Phong::new(reflectance.to_vec(), exponent).unwrap();
    let middle = [0.5, 0.5, 0.5];
    let floor = quad([0.0, 0.0, 0.0], [1.0, 0.0, 0.1], [0.0, 0.0, 1.0], middle);
    let lamp = quad([0.1, 1.1, 0.2], [0.7, 0.0, 0.0], [0.0, 0.1, 0.6], middle);
    let side = quad([-0.3, 0.2, 0.0], [0.0, 0.7, 0.0], [0.05, 0.0, 0.9], middle);
    let screen = quad([0.35, 0.45, 0.3], [0.3, 0.1, 0.0], [0.0, 0.1, 0.3], [0.5, 3.0, 0.5]);
    let mut screen = surface("screen", screen, gloss([0.8, 0.3], 8.0), &[0.0; 2]);
    screen.back = Some(Arc::new(Lambert::new(vec![0.7, 0.9])));
    scene(vec![
        surface("floor", floor, gloss([0.9, 0.6], 3.0), &[0.0; 2]),
        matte("lamp", lamp, &[0.6, 0.8], &[2.0, 1.0]),
        matte("side", side, &[0.5, 0.9], &[0.1, 0.0]),
        screen,
    ])
}

#[test]
fn each_strategy_has_its_bounce_as_its_expectation() {
    let scene = gallery::parallel_plates();
    let bundles = bundles(&scene, 0.5);
    let means = SurfaceMeans::new(&scene, &bundles);
    let exact = bounces_of_plates(LAST);
    let mut verdict = Verdict::default();
    for (s, t, bounce) in strategies() {
        let one = Bidirectional::new(&scene, &bundles).unwrap().strategy(s, t).unwrap();
        let drawn = batches(&one, 1_500, |radiance| means.of(radiance));
        for (plate, drawn) in drawn.iter().enumerate() {
            verdict.compare(format!("({s}, {t}) on plate {plate}"), drawn, &certain(exact[bounce][plate]));
        }
    }
    verdict.assert_agreement();
}

/// Glossy and two-sided surfaces, one of them hiding a part of the others.
#[test]
fn strategies_agree_with_paths_that_meet_emitters() {
    let scene = panels();
    let bundles = bundles(&scene, 100.0);
    let means = SurfaceMeans::new(&scene, &bundles);
    let of = |radiance: &Block| means.of(radiance);
    let reference = PathTracer::new(&scene, &bundles).unwrap().with_sampling(Sampling::Directions);
    let reference = batches(&reference.with_bounces(Bounces::Each(LAST)), 10_000, of);
    let mut verdict = Verdict::default();
    let n_columns = 2 * (LAST + 1);
    for (s, t, bounce) in strategies() {
        let one = Bidirectional::new(&scene, &bundles).unwrap().strategy(s, t).unwrap();
        for (k, drawn) in batches(&one, 2_000, of).iter().enumerate() {
            let known = &reference[k / 2 * n_columns + 2 * bounce + k % 2];
            verdict.compare(format!("({s}, {t}) in {}", means.means[k / 2].0), drawn, known);
        }
    }
    for contestant in contestants(&scene, &bundles, Bounces::Each(LAST)) {
        let samples = 10_000 / contestant.estimator.n_starts() as u64;
        for (k, (drawn, known)) in batches(&*contestant.estimator, samples, of).iter().zip(&reference).enumerate() {
            verdict.compare(format!("{} in {}", contestant.label, means.means[k / n_columns].0), drawn, known);
        }
    }
    verdict.assert_agreement();
}

/// Weighed, the strategies that find a bounce sum to it, here where each alone would have no variance.
#[test]
fn weighted_strategies_sum_to_the_whole() {
    let (albedo, emission) = ([0.6, 0.9], [1.0, 0.5]);
    let scene = gallery::furnace_cube(&albedo, &emission).unwrap();
    let bundles = bundles(&scene, 100.0);
    let means = SurfaceMeans::new(&scene, &bundles);
    for heuristic in [Heuristic::Balance, Heuristic::Power] {
        let mut verdict = Verdict::default();
        for bounce in 0..=LAST {
            let mut total: Vec<Block> = vec![Block::zeros(bundles.n_bundles(), 2); N_BATCHES as usize];
            for t in 1..=bounce + 1 {
                let pairs = Bidirectional::new(&scene, &bundles).unwrap().with_heuristic(heuristic);
                let part = pairs.weighted_strategy(bounce + 1 - t, t).unwrap();
                // Samples of their own for each strategy.
                let first = 100_000 * t as u64;
                for (batch, total) in (0_u64..).zip(&mut total) {
                    let samples = first + 600 * batch..first + 600 * (batch + 1);
                    total.add_scaled(1.0, &estimate_range(&part, samples, SEED).mean);
                }
            }
            let values: Vec<Vec<f64>> = total.iter().map(|radiance| means.of(radiance)).collect();
            for k in 0..values[0].len() {
                let drawn: Moments = values.iter().map(|batch| batch[k]).collect();
                let exact = certain(emission[k % 2] * albedo[k % 2].powi(bounce as i32));
                verdict.compare(format!("{heuristic:?}, bounce {bounce}"), &drawn, &exact);
            }
        }
        verdict.assert_agreement();
    }
}
