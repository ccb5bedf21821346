//! One product with K, three bands at once, on the Cornell box at three sizes; beside it the bare read of the same memory.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use etendue::assembly::{Exchange, assemble};
use etendue::basis::{Bundles, Resolution};
use etendue::gallery;
use etendue::linalg::{Block, Dense, LinearOperator, Sparse};
use std::hint::black_box;

fn bench(criterion: &mut Criterion) {
    let scene = gallery::cornell_box();
    let mut group = criterion.benchmark_group("apply");
    for patch_size in [0.5, 0.25] {
        let bundles = Bundles::new(&scene, Resolution { patch_size, n_directions: 1 }).expect("a resolution");
        let system = assemble(&scene, &bundles, Exchange::default()).expect("a diffuse scene");
        let n = bundles.n_bundles();
        let x = system.emission().clone();
        let mut y = Block::zeros(n, x.n_columns());
        group.throughput(Throughput::Bytes((8 * n * n) as u64));
        group.bench_function(BenchmarkId::new("K", n), |b| b.iter(|| system.transport().apply(black_box(&x), &mut y)));

        let dense = Dense::from_operator(system.transport(), 0);
        group.bench_function(BenchmarkId::new("dense", n), |b| b.iter(|| dense.apply(black_box(&x), &mut y)));
        let sparse = Sparse::from_operator(system.transport(), 0);
        group.bench_function(BenchmarkId::new("sparse", n), |b| b.iter(|| sparse.apply(black_box(&x), &mut y)));
        group.bench_function(BenchmarkId::new("read", n), |b| {
            b.iter(|| {
                let lanes = |chunk: &[f64]| chunk.iter().map(|v| v.to_bits()).fold(0, u64::wrapping_add);
                black_box(dense.values()).chunks(4096).map(lanes).fold(0, u64::wrapping_add)
            });
        });
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
