//! Sixteen samples a bundle of every estimator on the Cornell box at three sizes, and the tables that walks need.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use etendue::assembly::{Exchange, assemble};
use etendue::basis::{Bundles, Resolution};
use etendue::estimator::{Estimator, MatrixWalk, PathTracer, estimate};
use etendue::gallery;
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

criterion_group!(benches, bench);
criterion_main!(benches);
