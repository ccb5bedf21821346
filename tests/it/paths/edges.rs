//! What holds of every estimator of paths, and what is refused.

use super::*;
use etendue::estimator::{EstimatorError, Score, Truth, estimate};
use etendue::gallery;
use etendue::sampling::Stream;
use etendue::scattering::Phong;

/// Bands that nothing emits, and sides that reflect nothing.
fn dim_room() -> Scene {
    let [floor, ceiling, left, right, back, _] = cube();
    let mut shelf =
        matte("shelf", quad([0.2, 0.4, 0.2], [0.5, 0.0, 0.1], [0.0, 0.1, 0.5], [0.5, 2.0, 0.5]), &[0.0; 5], &[0.0; 5]);
    shelf.back = Some(Arc::new(Lambert::grey(0.7, 5)));
    scene(vec![
        matte("floor", floor, &[0.5, 0.9, 0.0, 0.3, 1.0], &[0.0; 5]),
        matte("ceiling", ceiling, &[0.5; 5], &[1.0, 0.0, 2.0, 0.0, 0.5]),
        surface("left", left, Phong::new(vec![0.9, 0.5, 0.1, 1.0, 0.0], 12.0).unwrap(), &[0.0; 5]),
        matte("right", right, &[0.2; 5], &[0.0; 5]),
        matte("back", back, &[0.9, 0.1, 0.5, 0.8, 1.0], &[0.0; 5]),
        shelf,
    ])
}

#[test]
fn threads_change_no_bit() {
    let scene = dim_room();
    let bundles = bundles(&scene, 0.5);
    for contestant in contestants(&scene, &bundles, Bounces::Each(4)) {
        let on = |n_threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
            // More samples than one task takes, and a remainder.
            pool.install(|| estimate(&*contestant.estimator, 2 * 1024 + 77, SEED))
        };
        let alone = on(1);
        assert!(alone.n_steps > 0, "{} cast no rays", contestant.label);
        for n_threads in [2, 3, 8] {
            assert_eq!(alone, on(n_threads), "{} on {n_threads} threads", contestant.label);
        }
    }
}

/// Another estimator's samples, one after another.
struct OneByOne<'a> {
    all: &'a dyn Estimator,
}

impl Estimator for OneByOne<'_> {
    fn name(&self) -> &'static str {
        self.all.name()
    }

    fn truth(&self) -> Truth {
        self.all.truth()
    }

    fn n_bundles(&self) -> usize {
        self.all.n_bundles()
    }

    fn n_columns(&self) -> usize {
        self.all.n_columns()
    }

    fn sample(&self, start: usize, stream: &mut Stream, score: &mut Score) {
        self.all.sample(start, stream, score);
    }
}

/// Paths of one bundle go abreast. Each finds what it finds alone, on diffuse and on glossy surfaces, and costs as many rays.
#[test]
fn paths_abreast_are_the_same_paths() {
    let scene = dim_room();
    let bundles = bundles(&scene, 0.5);
    for contestant in contestants(&scene, &bundles, Bounces::Each(3)).iter().filter(|c| c.label.starts_with("paths")) {
        let abreast = estimate(&*contestant.estimator, 150, SEED);
        let alone = estimate(&OneByOne { all: &*contestant.estimator }, 150, SEED);
        assert_eq!(abreast, alone, "{}", contestant.label);
    }
}

/// A band that nothing emits is dark, exactly and without noise; so is what a black side sends out. Nothing is negative or no number.
#[test]
fn dark_is_dark() {
    let scene = dim_room();
    let bundles = bundles(&scene, 0.5);
    for contestant in contestants(&scene, &bundles, Bounces::All) {
        let drawn = estimate(&*contestant.estimator, 3_000, SEED);
        assert!(drawn.mean.values().iter().all(|value| value.is_finite() && *value >= 0.0), "{}", contestant.label);
        for bundle in 0..bundles.n_bundles() {
            let patch = bundles.patch(bundle).unwrap();
            let is_black = scene.surface_of(patch.facet).name == "shelf" && patch.side == Side::Front;
            for band in (0..5).filter(|band| is_black || [1, 3].contains(band)) {
                let (mean, variance) = (drawn.mean.get(bundle, band), drawn.variance_of_mean.get(bundle, band));
                assert_eq!((mean, variance), (0.0, 0.0), "{}: bundle {bundle}, band {band}", contestant.label);
            }
        }
    }
}

/// Where nothing reflects, every estimator gives the emission, exactly.
#[test]
fn a_black_scene_sends_out_what_it_emits() {
    let walls = cube().into_iter().enumerate().map(|(k, w)| matte(&format!("wall-{k}"), w, &[0.0], &[k as f64]));
    let scene = scene(walls.collect());
    let bundles = bundles(&scene, 0.5);
    for contestant in contestants(&scene, &bundles, Bounces::All) {
        let drawn = estimate(&*contestant.estimator, 50, SEED);
        for bundle in 0..bundles.n_bundles() {
            let facet = bundles.patch(bundle).unwrap().facet;
            assert_eq!(drawn.mean.get(bundle, 0), facet as f64, "{}", contestant.label);
            assert_eq!(drawn.variance_of_mean.get(bundle, 0), 0.0, "{}", contestant.label);
        }
    }
}

#[test]
fn closed_parts_that_absorb_nothing_are_refused() {
    let walls = |albedo: &dyn Fn(usize) -> Vec<f64>, n: usize| {
        let wall = |(k, wall)| matte(&format!("wall-{k}"), wall, &albedo(k), &[1.0, 1.0]);
        scene(cube().into_iter().take(n).enumerate().map(wall).collect())
    };
    let white = walls(&|_| vec![0.5, 1.0], 6);
    let bundles_of_white = bundles(&white, 1.0);
    let never = Err(EstimatorError::NeverEnds { bundle: 0 });
    assert_eq!(PathTracer::new(&white, &bundles_of_white).map(|_| ()), never);
    assert_eq!(LightTracer::new(&white, &bundles_of_white).map(|_| ()), never);
    assert_eq!(Bidirectional::new(&white, &bundles_of_white).map(|_| ()), never);

    // One wall that absorbs, no two bands white in the same place, or a way out: all of these end.
    let is_accepted = |scene: &Scene| PathTracer::new(scene, &bundles(scene, 1.0)).is_ok();
    assert!(is_accepted(&walls(&|k| vec![0.5, if k == 4 { 0.999 } else { 1.0 }], 6)));
    assert!(is_accepted(&walls(&|k| if k < 3 { vec![1.0, 0.5] } else { vec![0.5, 1.0] }, 6)));
    assert!(is_accepted(&walls(&|_| vec![1.0, 1.0], 5)));

    // An absorber of a millionth of the wall is found, wherever it is.
    let [_, ceiling, left, right, back, front] = cube();
    let tiny = quad([0.3, 0.1, 0.7], [1e-3, 0.0, 0.0], [0.0, 0.0, 1e-3], [0.3, 1.0, 0.7]);
    let mut surfaces: Vec<Surface> = [cube()[0].clone(), ceiling, left, right, back, front]
        .into_iter()
        .enumerate()
        .map(|(k, wall)| matte(&format!("wall-{k}"), wall, &[1.0, 1.0], &[1.0, 1.0]))
        .collect();
    surfaces.push(matte("tiny", tiny, &[0.5, 0.5], &[0.0; 2]));
    assert!(is_accepted(&scene(surfaces)));

    // A closed white box behind a wall of an ordinary room is found, though no emitter is in it.
    let mut surfaces: Vec<Surface> = cube()
        .into_iter()
        .enumerate()
        .map(|(k, wall)| matte(&format!("wall-{k}"), wall, &[0.5, 0.5], &[1.0, 1.0]))
        .collect();
    let shifted = |wall: &Polygon| Polygon::new(wall.vertices().iter().map(|v| *v + 3.0 * Vec3::X).collect()).unwrap();
    surfaces.extend(
        cube().iter().enumerate().map(|(k, wall)| matte(&format!("hidden-{k}"), shifted(wall), &[1.0, 0.2], &[0.0; 2])),
    );
    let hidden = scene(surfaces);
    let refused = PathTracer::new(&hidden, &bundles(&hidden, 1.0)).map(|_| ());
    assert_eq!(refused, Err(EstimatorError::NeverEnds { bundle: 6 }));
}

#[test]
fn settings_that_make_no_sense_are_refused() {
    let scene = gallery::parallel_plates();
    let bundles = bundles(&scene, 1.0);
    for survival in [0.0, -0.5, 1.5, f64::NAN] {
        let refused = PathTracer::new(&scene, &bundles).unwrap().with_roulette(Roulette::Constant(survival));
        assert!(matches!(refused.map(|_| ()), Err(EstimatorError::Survival { .. })), "{survival}");
        assert!(LightTracer::new(&scene, &bundles).unwrap().with_roulette(Roulette::Constant(survival)).is_err());
    }
    let paths = Bidirectional::new(&scene, &bundles).unwrap().strategy(3, 0).map(|_| ());
    assert_eq!(paths, Err(EstimatorError::NoEyeVertex { n_light: 3 }));
    let other = gallery::furnace_sphere(1, &[0.5], &[1.0]).unwrap();
    let foreign = LightTracer::new(&scene, &Bundles::new(&other, bundles.resolution()).unwrap()).map(|_| ());
    assert!(matches!(foreign, Err(EstimatorError::ForeignBundles { .. })));
}
