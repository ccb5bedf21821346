//! Assembly of T: cost against the number of bundles, on the Cornell box.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use etendue::assembly::{Exchange, assemble};
use etendue::basis::{Bundles, Resolution};
use etendue::gallery;
use std::hint::black_box;

fn bench(criterion: &mut Criterion) {
    let scene = gallery::cornell_box();
    let mut group = criterion.benchmark_group("assemble");
    group.sample_size(10);
    for patch_size in [0.5, 0.25, 0.125] {
        let bundles = Bundles::new(&scene, Resolution { patch_size, n_directions: 1 }).expect("a resolution");
        let n = bundles.n_bundles();
        group.throughput(Throughput::Elements((n * (n - 1) / 2) as u64));
        group.bench_with_input(BenchmarkId::new("pairs", n), &bundles, |b, bundles| {
            b.iter(|| assemble(&scene, black_box(bundles), Exchange::default()).expect("a diffuse scene"));
        });
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
