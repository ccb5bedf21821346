//! One product with K, three bands at once, on the Cornell box at two sizes; and what a product costs over the bare read of the same
//! memory, measured in turns and printed as ratios.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group};
use etendue::assembly::{Exchange, assemble};
use etendue::basis::{Bundles, Resolution};
use etendue::gallery;
use etendue::linalg::{Block, Dense, LinearOperator, Sparse};
use std::hint::black_box;
use std::time::Instant;

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
    }
    group.finish();
}

/// Rows of the dense matrix of the ratios: 128 MiB, beyond any cache.
const DENSE: usize = 4096;

/// Rows of the sparse one, and entries in each.
const SPARSE: [usize; 2] = [20_000, 200];

/// Turns that the contestants take.
const TURNS: usize = 9;

/// The machine's one stream: every word of the slice read once.
fn read(words: &[f64]) -> u64 {
    let bits = |chunk: &[f64; 16], sums: &mut [u64; 16]| {
        sums.iter_mut().zip(chunk).for_each(|(sum, v)| *sum = sum.wrapping_add(v.to_bits()));
    };
    pulp::Arch::new().dispatch(|| {
        let mut sums = [0u64; 16];
        words.as_chunks::<16>().0.iter().for_each(|chunk| bits(chunk, &mut sums));
        sums.iter().fold(0u64, |a, b| a.wrapping_add(*b))
    })
}

/// Shortest seconds of each contestant over all turns.
fn race<const N: usize>(mut contestants: [&mut dyn FnMut(); N]) -> [f64; N] {
    let mut best = [f64::INFINITY; N];
    for _ in 0..TURNS {
        for (best, run) in best.iter_mut().zip(&mut contestants) {
            let start = Instant::now();
            run();
            *best = best.min(start.elapsed().as_secs_f64());
        }
    }
    best
}

/// On one thread, so that one stream stands against one stream.
fn ratios() {
    let dense = Dense::from_fn(DENSE, DENSE, |r, c| ((r * 7 + c * 13) % 101) as f64);
    let rounded = dense.rounded();
    let [mut one, mut three, mut single] = [1, 3, 1].map(|columns| Block::zeros(DENSE, columns));
    let x = [1, 3].map(|columns| Block::from_fn(DENSE, columns, |i, c| (i + c) as f64));
    let [bare, one, three, single] = race([
        &mut || {
            black_box(read(black_box(dense.values())));
        },
        &mut || dense.apply(black_box(&x[0]), &mut one),
        &mut || dense.apply(black_box(&x[1]), &mut three),
        &mut || rounded.apply(black_box(&x[0]), &mut single),
    ]);
    let gigabytes = (8 * DENSE * DENSE) as f64 / bare * 1e-9;
    println!(
        "dense {DENSE}: one read {gigabytes:.1} GB/s; a product over it: one band {:.2}, three bands {:.2}, f32 {:.2}",
        one / bare,
        three / bare,
        single / bare
    );

    let [n, a_row] = SPARSE;
    let row =
        |r: usize| (0..a_row).map(|k| ((k * (n / a_row) + (r * 37 + k * 11) % (n / a_row)) as u32, 1.0)).collect();
    let rows: Vec<Vec<(u32, f64)>> = (0..n).map(row).collect();
    let sparse = Sparse::from_rows(n, &rows);
    let x = [1, 3].map(|columns| Block::from_fn(n, columns, |i, c| (i + c) as f64));
    let [mut one, mut three] = [1, 3].map(|columns| Block::zeros(n, columns));
    let [one, three] =
        race([&mut || sparse.apply(black_box(&x[0]), &mut one), &mut || sparse.apply(black_box(&x[1]), &mut three)]);
    let entries = (n * a_row) as f64 * 1e-9;
    println!("sparse {n} × {a_row}: {:.2} G entries/s with one band, {:.2} with three", entries / one, entries / three);
}

criterion_group!(benches, bench);

fn main() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    pool.install(ratios);
    benches();
    Criterion::default().configure_from_args().final_summary();
}
