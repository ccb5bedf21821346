//! Every solver to 1e-10 on the Cornell box at three sizes; and the factorizations over faer's own calls, measured in turns and printed as
//! ratios.

use criterion::{BenchmarkId, Criterion, criterion_group};
use etendue::assembly::{Exchange, assemble};
use etendue::basis::{Bundles, Resolution};
use etendue::linalg::{CholeskyFactor, Dense, LuFactor};
use etendue::{gallery, solver};
use faer::{Mat, Par, Side};
use std::hint::black_box;
use std::time::Instant;

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

/// Rows of the matrices of the ratios.
const SIZES: [usize; 2] = [512, 1536];

/// Turns that the two of a pair take.
const TURNS: usize = 9;

/// Shortest seconds of either.
fn race(mut ours: impl FnMut(), mut theirs: impl FnMut()) -> [f64; 2] {
    let timed = |run: &mut dyn FnMut()| {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64()
    };
    (0..TURNS).fold([f64::INFINITY; 2], |[a, b], _| [a.min(timed(&mut ours)), b.min(timed(&mut theirs))])
}

/// Ours start from a matrix by rows and check what they are given; faer's from its own matrix. On one thread.
fn ratios() {
    faer::set_global_parallelism(Par::Seq);
    for n in SIZES {
        let entry = |r: usize, c: usize| {
            let (low, high) = (r.min(c), r.max(c));
            if low == high { n as f64 } else { ((low * 7 + high * 13) % 101) as f64 / 101.0 }
        };
        let (dense, mat) = (Dense::from_fn(n, n, entry), Mat::from_fn(n, n, entry));
        let lu = race(
            || drop(black_box(LuFactor::new(black_box(&dense)))),
            || drop(black_box(black_box(&mat).partial_piv_lu())),
        );
        let cholesky = race(
            || drop(black_box(CholeskyFactor::new(black_box(&dense)))),
            || drop(black_box(black_box(&mat).llt(Side::Lower))),
        );
        let [lu, cholesky] = [lu, cholesky].map(|[ours, theirs]| ours / theirs);
        println!("factorization of {n} over faer's own: LU {lu:.2}, Cholesky {cholesky:.2}");
    }
}

criterion_group!(benches, bench);

fn main() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    pool.install(ratios);
    benches();
    Criterion::default().configure_from_args().final_summary();
}
