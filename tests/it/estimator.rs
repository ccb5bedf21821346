//! Estimators against exact answers: every test of a random number is a hypothesis test at family-wise significance [`ALPHA`].
//!
//! z-scores are taken as normal. A score of skewness γ distorts the probability of the tail at z by exp(γ z³ / 6√N); at z = 5.5 and the
//! N used below that is a factor of exp(γ / 7) for walks and exp(γ / 3) for paths, with γ of about 5 where emitters are hit most
//! rarely.

use etendue::assembly::{Exchange, Occlusion, System, assemble};
use etendue::basis::{Bundles, Resolution};
use etendue::compare::{ZVerdict, compare_blocks, relative_max};
use etendue::estimator::{
    Bounces, Estimate, Estimator, EstimatorError, MatrixWalk, MergeError, PathTracer, Score, Scoring, Truth, estimate,
    estimate_range, estimate_watched,
};
use etendue::gallery::{self, Exact};
use etendue::geometry::{Polygon, Vec3};
use etendue::linalg::{Block, LinearOperator};
use etendue::sampling::Stream;
use etendue::scattering::{Brdf, Lambert, Phong};
use etendue::scene::{Scene, SceneDescription, Surface};
use etendue::solver::{Lu, Solver};
use etendue::stats::{two_sided_p, z_score};
use std::ops::Range;
use std::sync::Arc;

/// Probability that one of these tests rejects estimators that are right.
const ALPHA: f64 = 1e-6;
const SEED: u64 = 0x5eed_0b5e_55ed_ca5e;
/// Samples a start, for walks: some million steps in all.
const N_WALKS: u64 = 40_000;
/// Samples a start, for paths.
const N_PATHS: u64 = 8_000;
/// Merging moments in another order moves a mean by some ulp of the numbers merged.
const MERGE_TOLERANCE: f64 = 1e-13;

// ---------------------------------------------------------------------------------------------------------------------------------
// Scenes

/// A parallelogram from a corner and two edges, its front towards `towards`.
fn quad(corner: [f64; 3], u: [f64; 3], v: [f64; 3], towards: [f64; 3]) -> Polygon {
    let [corner, u, v, towards] = [corner, u, v, towards].map(Vec3::from);
    let polygon = Polygon::new(vec![corner, corner + u, corner + u + v, corner + v]).unwrap();
    if polygon.normal().dot(towards - polygon.centroid()) > 0.0 { polygon } else { polygon.flipped() }
}

fn surface(name: &str, polygon: Polygon, front: impl Brdf + 'static, emission: &[f64]) -> Surface {
    Surface {
        name: name.into(),
        polygons: vec![polygon],
        front: Arc::new(front),
        back: None,
        emission: emission.to_vec(),
        tessellation: None,
    }
}

fn matte(name: &str, polygon: Polygon, albedo: &[f64], emission: &[f64]) -> Surface {
    surface(name, polygon, Lambert::new(albedo.to_vec()), emission)
}

fn scene(surfaces: Vec<Surface>) -> Scene {
    let bands = (0..surfaces[0].emission.len()).map(|band| format!("band-{band}")).collect();
    Scene::new(SceneDescription { name: "test".into(), bands, surfaces, camera: None }).unwrap()
}

/// Floor, ceiling, left, right, back, front of the unit cube, facing inward.
fn cube() -> [Polygon; 6] {
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let wall = |corner, u, v| quad(corner, u, v, [0.5; 3]);
    [wall([0.0; 3], x, z), wall(y, x, z), wall([0.0; 3], y, z), wall(x, y, z), wall([0.0; 3], x, y), wall(z, x, y)]
}

/// A cube open at the front under a ceiling that emits, coloured walls, and a two-sided panel that hides a part of everything.
fn open_room() -> Scene {
    let [floor, ceiling, left, right, back, _] = cube();
    let panel = quad([0.3, 0.1, 0.5], [0.5, 0.0, 0.1], [0.1, 0.6, 0.0], [0.5, 0.5, 2.0]);
    let mut panel = matte("panel", panel, &[0.7, 0.1, 0.4], &[0.0, 0.3, 0.0]);
    panel.back = Some(Arc::new(Lambert::new(vec![0.2, 0.9, 0.5])));
    scene(vec![
        matte("floor", floor, &[0.8, 0.7, 0.6], &[0.0; 3]),
        matte("ceiling", ceiling, &[0.5, 0.6, 0.3], &[3.0, 2.0, 1.0]),
        matte("left", left, &[0.6, 0.05, 0.05], &[0.0; 3]),
        matte("right", right, &[0.1, 0.4, 0.1], &[0.0; 3]),
        matte("back", back, &[0.75; 3], &[0.0; 3]),
        panel,
    ])
}

/// A closed cube whose emitter reflects everything, with five bands and one wall that absorbs all of some.
fn white_emitter() -> Scene {
    let [floor, ceiling, left, right, back, front] = cube();
    let n = 5;
    scene(vec![
        matte("floor", floor, &[0.5, 0.0, 0.9, 1.0, 0.2], &vec![0.0; n]),
        matte("ceiling", ceiling, &[1.0; 5], &[1.0, 2.0, 0.5, 1.0, 0.0]),
        matte("left", left, &[0.3, 0.9, 0.4, 0.5, 0.2], &vec![0.0; n]),
        matte("right", right, &[0.8, 0.7, 0.6, 0.5, 0.4], &[0.0, 0.1, 0.0, 0.0, 1.0]),
        matte("back", back, &vec![0.5; n], &vec![0.0; n]),
        matte("front", front, &vec![0.0; n], &vec![0.0; n]),
    ])
}

fn bundles(scene: &Scene, patch_size: f64) -> Bundles {
    Bundles::new(scene, Resolution { patch_size, n_directions: 1 }).unwrap()
}

fn system(scene: &Scene, patch_size: f64) -> System {
    assemble(scene, &bundles(scene, patch_size), Exchange::default()).unwrap()
}

fn exact(system: &System) -> Block {
    Lu.solve(system.equation(), &mut ()).unwrap().radiance
}

/// The furnace's exact radiance in n bundles.
fn furnace_exact(n: usize, albedo: &[f64], emission: &[f64]) -> Block {
    let Exact::Uniform { radiance } = gallery::furnace_exact(albedo, emission) else { panic!("a furnace is uniform") };
    Block::from_fn(n, albedo.len(), |_, band| radiance[band])
}

// ---------------------------------------------------------------------------------------------------------------------------------
// Estimators for testing

/// Adds one per cent of the right answer to every sample of another estimator.
struct OnePerCentMore<'a> {
    honest: &'a dyn Estimator,
    exact: &'a Block,
}

impl Estimator for OnePerCentMore<'_> {
    fn name(&self) -> &'static str {
        self.honest.name()
    }

    fn truth(&self) -> Truth {
        self.honest.truth()
    }

    fn n_bundles(&self) -> usize {
        self.honest.n_bundles()
    }

    fn n_columns(&self) -> usize {
        self.honest.n_columns()
    }

    fn sample(&self, start: usize, stream: &mut Stream, score: &mut Score) {
        self.honest.sample(start, stream, score);
        (0..self.n_columns()).for_each(|band| score.add(start, band, 0.01 * self.exact.get(start, band)));
    }
}

/// A single start that scores three of many bundles, one of them twice: expectation 2/n in bundle 0 … n − 1 and 1 in bundle n.
struct Scattershot {
    n: usize,
}

impl Estimator for Scattershot {
    fn name(&self) -> &'static str {
        "scattershot"
    }

    fn truth(&self) -> Truth {
        Truth::Discrete
    }

    fn n_bundles(&self) -> usize {
        self.n + 1
    }

    fn n_columns(&self) -> usize {
        2
    }

    fn n_starts(&self) -> usize {
        1
    }

    fn reach(&self, _: usize) -> Range<usize> {
        0..self.n + 1
    }

    fn sample(&self, _: usize, stream: &mut Stream, score: &mut Score) {
        for _ in 0..2 {
            let bundle = (stream.uniform() * self.n as f64) as usize;
            score.add(bundle, 0, 1.0);
            score.add(bundle, 1, stream.uniform() * 2.0);
        }
        (0..2).for_each(|band| (0..2).for_each(|_| score.add(self.n, band, 0.5)));
    }
}

fn held_against(reference: &Block, estimate: &Estimate) -> ZVerdict {
    compare_blocks(reference, &estimate.mean, &estimate.variance_of_mean, ALPHA)
}

/// The weighted mean over all bundles, held against the exact one: shows a bias that single bundles do not.
fn pooled_against(reference: &Block, estimate: &Estimate, weights: &[f64]) -> ZVerdict {
    let total: f64 = weights.iter().sum();
    let n_bands = reference.n_columns();
    let exact = |band| reference.column(band).iter().zip(weights).map(|(l, w)| l * w / total).sum();
    let pooled = |band| estimate.weighted_mean(weights, band).unwrap();
    compare_blocks(
        &Block::from_fn(1, n_bands, |_, band| exact(band)),
        &Block::from_fn(1, n_bands, |_, band| pooled(band).mean),
        &Block::from_fn(1, n_bands, |_, band| pooled(band).variance),
        ALPHA,
    )
}

/// The honest estimator must agree in every bundle and on average, and one that is off by one per cent must not.
fn assert_agrees_and_has_power(estimator: &dyn Estimator, exact: &Block, etendue: &[f64], n_samples: u64) {
    let judge = |estimator: &dyn Estimator| {
        let estimate = estimate(estimator, n_samples, SEED);
        [held_against(exact, &estimate), pooled_against(exact, &estimate, etendue)]
    };
    let verdicts = judge(estimator);
    assert!(verdicts.iter().all(|v| v.agrees), "{}: {verdicts:?}", estimator.name());
    assert!(verdicts[0].n_comparisons > 0, "{}: nothing was compared", estimator.name());
    let verdicts = judge(&OnePerCentMore { honest: estimator, exact });
    assert!(verdicts.iter().any(|v| !v.agrees), "{}: 1 % too much went unnoticed: {verdicts:?}", estimator.name());
}

// ---------------------------------------------------------------------------------------------------------------------------------
// Walks on the matrix: discrete truth

#[test]
fn walks_agree_with_the_direct_solution() {
    for (scene, patch_size) in
        [(open_room(), 0.5), (white_emitter(), 0.5), (gallery::furnace_cube(&[0.5, 0.9], &[1.0, 0.2]).unwrap(), 1.0)]
    {
        let system = system(&scene, patch_size);
        let exact = exact(&system);
        let walk = MatrixWalk::collision(&system).unwrap();
        assert_eq!(walk.truth(), Truth::Discrete);
        // Scores at the last event alone are rarer and larger: they need more walks to show as little.
        for (scoring, n_walks) in [(Scoring::Collision, N_WALKS), (Scoring::Absorption, 6 * N_WALKS)] {
            assert_agrees_and_has_power(&walk.with_scoring(scoring), &exact, system.etendue(), n_walks);
        }
    }
}

/// By surface: the bottom of the small box sees the strip of the large one that reaches through the floor, and nothing else. Its
/// bundles score once in some hundred thousand walks, which no normal approximation covers.
#[test]
fn walks_agree_in_the_cornell_box() {
    let scene = gallery::cornell_box();
    let bundles = bundles(&scene, 0.5);
    let system = assemble(&scene, &bundles, Exchange::default()).unwrap();
    let exact = exact(&system);
    let walk = MatrixWalk::collision(&system).unwrap();
    let estimate = estimate(&walk, N_WALKS / 2, SEED);
    for (k, surface) in scene.surfaces().iter().enumerate() {
        let weight = |i: usize| {
            let is_here = scene.facets()[bundles.patch(i).unwrap().facet].surface == k;
            if is_here { system.etendue()[i] } else { 0.0 }
        };
        let weights: Vec<f64> = (0..bundles.n_bundles()).map(weight).collect();
        let verdict = pooled_against(&exact, &estimate, &weights);
        assert!(verdict.agrees, "{}: {verdict:?}", surface.name);
    }

    // Over all surfaces together, 3 % too much must show.
    let mut more = exact.clone();
    more.add_scaled(0.03, &exact);
    let verdict = pooled_against(&more, &estimate, system.etendue());
    assert!(!verdict.agrees, "3 % too much went unnoticed: {verdict:?}");
}

/// Σ z² over n independent bundles is χ² with n degrees of freedom: mean n, variance 2n. Variances that are off by a factor of two move it
/// by √(n/2) = 11 standard deviations.
#[test]
fn variances_of_walks_are_right() {
    let system = system(&open_room(), 0.15);
    let exact = exact(&system);
    for walk in [MatrixWalk::collision(&system).unwrap(), MatrixWalk::absorption(&system).unwrap()] {
        let estimate = estimate(&walk, 4_000, SEED);
        let n = exact.n_rows();
        let square = |i| {
            let (mean, variance) = (estimate.mean.get(i, 0), estimate.variance_of_mean.get(i, 0));
            z_score(mean, exact.get(i, 0), variance).powi(2)
        };
        let z = ((0..n).map(square).sum::<f64>() - n as f64) / (2.0 * n as f64).sqrt();
        assert!(n >= 250 && two_sided_p(z) > ALPHA, "{}: z = {z} over {n} bundles", walk.name());
    }
}

/// Scattering that alternates between two bands never loses the larger of them.
#[test]
fn a_walk_that_would_never_end_is_refused() {
    let walls = cube().into_iter().enumerate().map(|(k, wall)| {
        let albedo = if k < 3 { [1.0, 0.5] } else { [0.5, 1.0] };
        matte(&format!("wall-{k}"), wall, &albedo, &[1.0, 1.0])
    });
    let closed = scene(walls.clone().collect());
    assert_eq!(MatrixWalk::collision(&system(&closed, 1.0)).unwrap_err(), EstimatorError::NeverEnds { bundle: 0 });

    // With one wall taken out, light escapes and walks end.
    let open = system(&scene(walls.take(5).collect()), 1.0);
    assert_agrees_and_has_power(&MatrixWalk::collision(&open).unwrap(), &exact(&open), open.etendue(), N_WALKS);
}

#[test]
fn rows_above_one_are_refused() {
    let scene = open_room();
    let rough = Exchange { tolerance: 1e-2, occlusion: Occlusion::by_rays(4), repair: false, ..Exchange::default() };
    let system = assemble(&scene, &bundles(&scene, 0.5), rough).unwrap();
    assert!(system.laws().closure > 1e-3, "the premise: closure must be broken");
    assert!(matches!(MatrixWalk::collision(&system), Err(EstimatorError::Propagation(_))));
}

// ---------------------------------------------------------------------------------------------------------------------------------
// Paths in the scene: continuous truth

#[test]
fn paths_agree_with_the_furnace() {
    let (albedo, emission) = ([0.5, 0.75, 0.9], [1.0, 0.5, 0.25]);
    let scene = gallery::furnace_cube(&albedo, &emission).unwrap();
    let bundles = bundles(&scene, 0.5);
    let tracer = PathTracer::new(&scene, &bundles).unwrap();
    assert_eq!(tracer.truth(), Truth::Continuous);
    let exact = furnace_exact(bundles.n_bundles(), &albedo, &emission);
    assert_agrees_and_has_power(&tracer, &exact, bundles.etendue(), N_PATHS);
}

/// The mean radiance of each plate is known to 12 digits.
#[test]
fn paths_agree_with_parallel_plates() {
    let scene = gallery::parallel_plates();
    let Exact::Continuous(exact) = gallery::parallel_plates_exact() else { panic!("the plates' truth is continuous") };
    let bundles = bundles(&scene, 0.25);
    let tracer = PathTracer::new(&scene, &bundles).unwrap();
    let estimate = estimate(&tracer, 4 * N_PATHS, SEED);
    assert_eq!(exact.means.len(), 2);
    for known in exact.means {
        let of_plate = |facet| scene.surface_of(facet).name == known.surface;
        let weight = |e| if of_plate(bundles.patch(e).unwrap().facet) { bundles.etendue()[e] } else { 0.0 };
        let weights: Vec<f64> = (0..bundles.n_bundles()).map(weight).collect();
        let mean = estimate.weighted_mean(&weights, 0).unwrap();
        let z = z_score(mean.mean, known.radiance[0], mean.variance);
        assert!(two_sided_p(z) > ALPHA, "{}: {mean:?} is {z} standard errors from {:?}", known.surface, known.radiance);

        // The same with 1 % more light must be rejected.
        let z = z_score(1.01 * mean.mean, known.radiance[0], mean.variance);
        assert!(two_sided_p(z) < ALPHA, "{}: a bias of 1 % went unnoticed (z = {z})", known.surface);
    }
}

/// A glossy floor under five black walls that all emit 1 sees nothing but 1: it sends out its directional albedo, on average
/// ∫ albedo(θ) 2 cosθ d(cosθ).
#[test]
fn paths_reflect_from_glossy_surfaces() {
    for exponent in [0.0, 4.0, 50.0] {
        let gloss = Phong::new(vec![0.9, 0.4], exponent).unwrap();
        let midpoint = |k: usize| (k as f64 + 0.5) / 10_000.0;
        let albedo = |band| {
            let at = |cosine: f64| {
                let outgoing = Vec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
                gloss.albedo(band, outgoing) * 2.0 * cosine
            };
            (0..10_000).map(|k| at(midpoint(k))).sum::<f64>() / 10_000.0
        };
        let expected = [albedo(0), albedo(1)];

        let [floor, walls @ ..] = cube();
        let walls = walls.into_iter().enumerate();
        let mut surfaces = vec![surface("floor", floor, gloss.clone(), &[0.0; 2])];
        surfaces.extend(walls.map(|(k, wall)| matte(&format!("wall-{k}"), wall, &[0.0; 2], &[1.0; 2])));
        let scene = scene(surfaces);
        let bundles = bundles(&scene, 0.5);
        let exact =
            Block::from_fn(bundles.n_bundles(), 2, |bundle, band| if bundle < 4 { expected[band] } else { 1.0 });
        let tracer = PathTracer::new(&scene, &bundles).unwrap();
        assert_agrees_and_has_power(&tracer, &exact, bundles.etendue(), 2 * N_PATHS);
    }
}

/// A panel in a furnace, its front like the walls, its back white: the back emits nothing and sends on the L it gets, so that L = e/(1 − a)
/// still solves the equation, on both sides of everything.
#[test]
fn paths_see_both_sides() {
    let (albedo, emission) = ([0.5], [1.0]);
    let mut surfaces: Vec<Surface> = gallery::furnace_cube(&albedo, &emission).unwrap().surfaces().to_vec();
    let panel = quad([0.3, 0.3, 0.5], [0.4, 0.0, 0.1], [0.0, 0.4, 0.0], [0.5, 0.5, 2.0]);
    surfaces.push(Surface { back: Some(Arc::new(Lambert::grey(1.0, 1))), ..matte("panel", panel, &albedo, &emission) });
    let scene = scene(surfaces);
    let bundles = bundles(&scene, 1.0);
    let exact = furnace_exact(bundles.n_bundles(), &albedo, &emission);
    let tracer = PathTracer::new(&scene, &bundles).unwrap();
    assert_agrees_and_has_power(&tracer, &exact, bundles.etendue(), 4 * N_PATHS);
}

// ---------------------------------------------------------------------------------------------------------------------------------
// Bounce by bounce

/// KᵏE side by side for k = 0 … `last`, or their sum.
fn bounces_of(system: &System, bounces: Bounces) -> Block {
    let last = bounces.last().expect("a last bounce");
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

#[test]
fn walks_tell_bounces_apart() {
    let system = system(&open_room(), 0.5);
    for bounces in [Bounces::Each(8), Bounces::UpTo(3), Bounces::UpTo(0)] {
        let exact = bounces_of(&system, bounces);
        for scoring in [Scoring::Collision, Scoring::Absorption] {
            let walk = MatrixWalk::collision(&system).unwrap().with_scoring(scoring).with_bounces(bounces);
            let drawn = estimate(&walk, N_WALKS, SEED);
            // Late bounces score too rarely to be looked at bundle by bundle.
            let verdict = pooled_against(&exact, &drawn, system.etendue());
            assert!(verdict.agrees, "{bounces:?}: {verdict:?}");
        }
    }
}

/// Bounce k of the furnace is albedoᵏ times what it emits.
#[test]
fn paths_tell_bounces_apart() {
    let (albedo, emission) = ([0.5, 0.9], [1.0, 0.25]);
    let scene = gallery::furnace_cube(&albedo, &emission).unwrap();
    let bundles = bundles(&scene, 1.0);
    let exact = |columns: usize, of: &dyn Fn(i32, usize) -> f64| {
        Block::from_fn(bundles.n_bundles(), columns, |_, c| of((c / 2) as i32, c % 2))
    };
    let each = exact(18, &|k, band| emission[band] * albedo[band].powi(k));
    let sum = exact(2, &|_, band| emission[band] * (0..4).map(|k| albedo[band].powi(k)).sum::<f64>());
    for (bounces, exact) in [(Bounces::Each(8), each), (Bounces::UpTo(3), sum)] {
        let tracer = PathTracer::new(&scene, &bundles).unwrap().with_bounces(bounces);
        assert_agrees_and_has_power(&tracer, &exact, bundles.etendue(), N_PATHS);
    }
}

// ---------------------------------------------------------------------------------------------------------------------------------
// What holds of every estimator

/// Calls `check` with one estimator of each kind, gathering and shooting.
fn for_each_estimator(check: impl Fn(&dyn Estimator)) {
    let scene = open_room();
    let bundles = bundles(&scene, 0.5);
    let system = assemble(&scene, &bundles, Exchange::default()).unwrap();
    check(&MatrixWalk::collision(&system).unwrap());
    check(&MatrixWalk::absorption(&system).unwrap());
    check(&PathTracer::new(&scene, &bundles).unwrap());
    check(&Scattershot { n: 100 });
}

#[test]
fn threads_change_no_bit() {
    for_each_estimator(|estimator| {
        // More samples than one task takes, and a remainder.
        let on = |n_threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
            pool.install(|| estimate(estimator, 3 * 1024 + 77, SEED))
        };
        let alone = on(1);
        for n_threads in [2, 3, 8] {
            assert_eq!(alone, on(n_threads), "{} on {n_threads} threads", estimator.name());
        }
    });
}

#[test]
fn ranges_merge_to_the_whole() {
    for_each_estimator(|estimator| {
        let range = |samples| estimate_range(estimator, samples, SEED);
        let (first, second, whole) = (range(0..100), range(100..200), range(0..200));
        let merged = first.merge(&second).unwrap();
        assert_eq!((merged.n_samples, &merged.samples), (200, &whole.samples));
        assert_eq!(merged.samples, [0..200]);
        assert!(relative_max(&merged.mean, &whole.mean) < MERGE_TOLERANCE);
        assert!(relative_max(&merged.variance_of_mean, &whole.variance_of_mean) < MERGE_TOLERANCE);

        // A single sample has no variance, but it counts.
        let merged = range(0..1).merge(&range(1..200)).unwrap();
        assert!(range(0..1).variance_of_mean.values().iter().all(|v| v.is_nan()));
        assert!(relative_max(&merged.mean, &whole.mean) < MERGE_TOLERANCE);
        assert!(relative_max(&merged.variance_of_mean, &whole.variance_of_mean) < MERGE_TOLERANCE);

        // Another seed gives other numbers.
        assert_ne!(whole.mean, estimate(estimator, 200, SEED + 1).mean);
    });
}

/// Walks move many abreast; one after another they draw the same samples.
#[test]
fn walks_abreast_are_the_same_walks() {
    let system = system(&open_room(), 0.5);
    for walk in [MatrixWalk::collision(&system).unwrap(), MatrixWalk::absorption(&system).unwrap()] {
        let nothing = Block::zeros(walk.n_bundles(), walk.n_columns());
        let one_by_one = OnePerCentMore { honest: &walk, exact: &nothing };
        let (abreast, single) = (estimate(&walk, 1500, SEED), estimate(&one_by_one, 1500, SEED));
        assert!(relative_max(&abreast.mean, &single.mean) < MERGE_TOLERANCE);
        assert!(relative_max(&abreast.variance_of_mean, &single.variance_of_mean) < MERGE_TOLERANCE);
    }
}

#[test]
fn parts_of_different_estimates_do_not_merge() {
    let shots = Scattershot { n: 10 };
    let first = estimate_range(&shots, 0..100, SEED);
    assert_eq!(first.merge(&estimate_range(&shots, 99..120, SEED)), Err(MergeError::Overlap { sample: 99 }));
    let other_seed = estimate_range(&shots, 100..200, 1);
    assert_eq!(first.merge(&other_seed), Err(MergeError::Seed { left: SEED, right: 1 }));
    let other_shape = estimate_range(&Scattershot { n: 11 }, 100..200, SEED);
    assert_eq!(first.merge(&other_shape), Err(MergeError::Shape { left: (11, 2), right: (12, 2) }));
    assert_eq!(first.weighted_mean(&[1.0; 11], 0), None, "one shot scores several bundles");
}

/// Scores of one sample are added before they are squared: bundle n scores ½ twice in every sample, and has no variance.
#[test]
fn a_single_start_scores_every_bundle() {
    let shots = Scattershot { n: 20 };
    let estimate = estimate(&shots, 20_000, SEED);
    let expected = Block::from_fn(21, 2, |bundle, _| if bundle < 20 { 0.1 } else { 1.0 });
    let verdict = held_against(&expected, &estimate);
    assert!(verdict.agrees && verdict.n_exact == 2, "{verdict:?}");

    // Two shots at one of 20 bundles: variance 2 · (1/20) · (19/20).
    let variance = estimate.variance_of_mean.get(7, 0) * 20_000.0;
    assert!((variance / 0.095 - 1.0).abs() < 0.15, "variance {variance}");
}

#[test]
fn progress_ends_at_one() {
    let shares = std::sync::Mutex::new(Vec::new());
    estimate_watched(&Scattershot { n: 3 }, 5..5000, SEED, &|share| shares.lock().unwrap().push(share));
    let mut shares = shares.into_inner().unwrap();
    shares.sort_by(f64::total_cmp);
    assert_eq!((shares.len(), shares.last()), (5, Some(&1.0)));
    assert!(shares[0] > 0.0);
}
