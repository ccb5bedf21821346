//! How the cost of assembly grows with the number of patches, on the Cornell box: n² pairs, but visibility settled by clusters.

use etendue::assembly::{Exchange, Occlusion, assemble};
use etendue::basis::{Bundles, Resolution};
use etendue::gallery;
use std::time::Instant;

/// Patch sizes that make some 2 000, 4 000 and 8 000 patches.
const PATCH_SIZES: [f64; 3] = [0.115, 0.08, 0.0565];

fn main() {
    // Cargo's test runner compiles benches and calls them with --test: nothing to do then.
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    let scene = gallery::cornell_box();
    let exchange = Exchange { tolerance: 1e-7, occlusion: Occlusion::Exact { tolerance: 1e-5 }, ..Exchange::default() };
    println!("      n   seconds  ns / n²   shafts  shafts / n²  by clusters   growth of time, of shafts (power of n)");
    let mut last: Option<[f64; 3]> = None;
    for patch_size in PATCH_SIZES {
        let bundles = Bundles::new(&scene, Resolution { patch_size, n_directions: 1 }).expect("a resolution");
        let start = Instant::now();
        let system = assemble(&scene, &bundles, exchange).expect("a diffuse scene");
        let seconds = start.elapsed().as_secs_f64();
        let report = system.report();
        let (n, shafts) = (bundles.n_bundles() as f64, report.n_shafts as f64);
        let by_clusters = 100.0 * report.n_by_clusters as f64 / (0.5 * n * (n - 1.0));
        print!(
            "{n:7} {seconds:9.2} {:8.1} {shafts:8.0} {:12.4} {by_clusters:10.1} %",
            1e9 * seconds / (n * n),
            shafts / (n * n)
        );
        if let Some([n_before, seconds_before, shafts_before]) = last {
            let power = |now: f64, before: f64| (now / before).ln() / (n / n_before).ln();
            print!("   {:.2}, {:.2}", power(seconds, seconds_before), power(shafts, shafts_before));
        }
        println!();
        last = Some([n, seconds, shafts]);
    }
}
