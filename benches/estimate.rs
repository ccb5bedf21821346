//! Sixteen samples a bundle of every estimator on the Cornell box at three sizes, and the tables that walks need; then walks alone, counted
//! in steps, in a furnace where all of them are long; and light paths in rays a second, beside the bare rate of closest hits.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use etendue::assembly::{Exchange, assemble};
use etendue::basis::{Bundles, Resolution};
use etendue::estimator::{
    Bidirectional, Estimator, LightTracer, MatrixWalk, PathTracer, Sampling, Scoring, Sequential, estimate,
};
use etendue::gallery;
use etendue::geometry::{Frame, Polygon, Ray, Tracer};
use etendue::sampling::{Stream, warp};
use etendue::scene::Scene;
use std::hint::black_box;

const SAMPLES: u64 = 16;

fn bench(criterion: &mut Criterion) {
    let scene = gallery::cornell_box();
    let mut group = criterion.benchmark_group("estimate");
    group.sample_size(10);
    for patch_size in [0.5, 0.25, 0.125] {
        let bundles = Bundles::new(&scene, Resolution { patch_size, n_directions: 1 }).expect("a resolution");
        let system = assemble(&scene, &bundles, Exchange::default()).expect("a diffuse scene");
        let n = bundles.n_bundles();
        group.bench_function(BenchmarkId::new("tables", n), |b| {
            b.iter(|| MatrixWalk::collision(black_box(&system)).expect("a table"));
        });
        let collision = MatrixWalk::collision(&system).expect("a table");
        let absorption = MatrixWalk::absorption(&system).expect("a table");
        let paths = PathTracer::new(&scene, &bundles).expect("emitters");
        let all: [&dyn Estimator; 3] = [&collision, &absorption, &paths];
        group.throughput(Throughput::Elements(SAMPLES * n as u64));
        for estimator in all {
            group.bench_function(BenchmarkId::new(estimator.name(), n), |b| {
                b.iter(|| estimate(black_box(estimator), SAMPLES, 1));
            });
        }
    }
    group.finish();
}

/// Steps a second on one thread. The furnace's K is full; its larger tables do not fit any cache.
fn steps(criterion: &mut Criterion) {
    let scene = gallery::furnace_cube(&[0.9], &[1.0]).expect("a furnace");
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    let mut group = criterion.benchmark_group("steps");
    group.sample_size(10);
    for patch_size in [0.2, 0.04] {
        let bundles = Bundles::new(&scene, Resolution { patch_size, n_directions: 1 }).expect("a resolution");
        let rough = Exchange { tolerance: 1e-2, ..Exchange::default() };
        let system = assemble(&scene, &bundles, rough).expect("a diffuse scene");
        let n = bundles.n_bundles();
        let walk = MatrixWalk::collision(&system).expect("a table");
        let shooting = walk.shooting(Scoring::Collision).expect("emission");
        let jacobi = walk.stochastic_jacobi(100_000).expect("particles");
        let all: [(&dyn Estimator, u64); 3] = [(&walk, 1 + 200_000 / n as u64), (&shooting, 100_000), (&jacobi, 4)];
        for (estimator, n_samples) in all {
            group.throughput(Throughput::Elements(estimate(estimator, n_samples, 1).n_steps));
            group.bench_function(BenchmarkId::new(estimator.name(), n), |b| {
                b.iter(|| alone.install(|| estimate(black_box(estimator), n_samples, 1)));
            });
        }
    }
    group.finish();
}

/// From nothing to 1e-12 by sequential Monte Carlo.
fn sequential(criterion: &mut Criterion) {
    let scene = gallery::cornell_box();
    let mut group = criterion.benchmark_group("sequential");
    group.sample_size(10);
    let bundles = Bundles::new(&scene, Resolution { patch_size: 0.25, n_directions: 1 }).expect("a resolution");
    let system = assemble(&scene, &bundles, Exchange::default()).expect("a diffuse scene");
    let walk = MatrixWalk::collision(&system).expect("a table");
    for n_walks in [16, 64, 256] {
        let settings = Sequential { tolerance: 1e-12, n_walks, max_stages: 100 };
        group.bench_function(BenchmarkId::new("to-1e-12", n_walks), |b| {
            b.iter(|| black_box(&walk).sequential(settings, 1))
        });
    }
    group.finish();
}

/// Rays a second: of paths, all that they cast, closest hits and shadow rays; and of closest hits alone, along rays that leave the scene's
/// surfaces as the paths' do.
fn rays(criterion: &mut Criterion) {
    let scene = gallery::cornell_box();
    let bundles = Bundles::new(&scene, Resolution { patch_size: 0.125, n_directions: 1 }).expect("a resolution");
    let mut group = criterion.benchmark_group("rays");
    group.sample_size(10);

    let polygons: Vec<&Polygon> = (0..scene.facets().len()).map(|facet| scene.polygon(facet)).collect();
    let tracer = Tracer::new(&polygons);
    let bare = diffuse_rays(&scene, &bundles, &tracer, 1 << 16);
    group.throughput(Throughput::Elements(bare.len() as u64));
    group.bench_function("closest hits", |b| {
        b.iter(|| bare.iter().filter_map(|(ray, facet)| tracer.closest(black_box(ray), Some(*facet))).count());
    });

    let paths = || PathTracer::new(&scene, &bundles).expect("emitters");
    let met = paths().with_sampling(Sampling::Directions);
    let both = paths();
    let light = LightTracer::new(&scene, &bundles).expect("emitters");
    let pairs = Bidirectional::new(&scene, &bundles).expect("emitters");
    let all: [(&dyn Estimator, u64); 4] = [(&both, SAMPLES), (&met, SAMPLES), (&light, 1 << 16), (&pairs, SAMPLES)];
    for (estimator, n_samples) in all {
        group.throughput(Throughput::Elements(estimate(estimator, n_samples, 1).n_steps));
        group.bench_function(estimator.name(), |b| b.iter(|| estimate(black_box(estimator), n_samples, 1)));
    }
    group.finish();
}

/// Rays from points of the bundles in directions of density cosθ/π, and on from where they end while they survive.
fn diffuse_rays(scene: &Scene, bundles: &Bundles, tracer: &Tracer, n: usize) -> Vec<(Ray, usize)> {
    const SURVIVAL: f64 = 0.7;
    let mut rays = Vec::with_capacity(n);
    for number in 0_u64.. {
        let mut stream = Stream::new(1, 0, number);
        let patch = bundles.patch((number * 7919 % bundles.n_bundles() as u64) as usize).expect("a patch");
        let (mut facet, mut origin) = (patch.facet, patch.polygon.sample(stream.uniform2()));
        loop {
            let frame = Frame::about(scene.polygon(facet).normal());
            let ray = Ray { origin, direction: frame.to_world(warp::cosine_hemisphere(stream.uniform2()).into()) };
            rays.push((ray, facet));
            if rays.len() == n {
                return rays;
            }
            let Some(hit) = tracer.closest(&ray, Some(facet)).filter(|hit| hit.front) else { break };
            if stream.uniform() >= SURVIVAL {
                break;
            }
            (facet, origin) = (hit.polygon, ray.at(hit.t));
        }
    }
    rays
}

criterion_group!(benches, bench, steps, sequential, rays);
criterion_main!(benches);
