//! Every solver to 1e-10 on the Cornell box at three sizes.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use etendue::assembly::{Exchange, assemble};
use etendue::basis::{Bundles, Resolution};
use etendue::{gallery, solver};
use std::hint::black_box;

fn bench(criterion: &mut Criterion) {
    let scene = gallery::cornell_box();
    let mut group = criterion.benchmark_group("solve");
    group.sample_size(10);
    for patch_size in [0.5, 0.25, 0.125] {
        let bundles = Bundles::new(&scene, Resolution { patch_size, n_directions: 1 }).expect("a resolution");
        let system = assemble(&scene, &bundles, Exchange::default()).expect("a diffuse scene");
        for method in solver::all(1e-10) {
            group.bench_function(BenchmarkId::new(method.name(), bundles.n_bundles()), |b| {
                b.iter(|| method.solve(black_box(system.equation()), &mut ()).expect("an answer"));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
