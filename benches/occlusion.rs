//! The race on `floating-block`: exchange of a closed scene with a block in it, CPU seconds and closure error before any repair, beside
//! those of View3D 4.0 on a machine of the same kind. And the price of exact shadows against rays.
//!
//! A printed table and no criterion: one run takes a second, and what counts is the ratio to numbers measured elsewhere. Run it on one
//! thread, `RAYON_NUM_THREADS=1`, for CPU seconds of one core.

use etendue::assembly::{Exchange, Occlusion, assemble};
use etendue::basis::{Bundles, Resolution};
use etendue::gallery;
use etendue::scene::Scene;
use std::time::Instant;

/// Facets, View3D's tolerance, its CPU seconds, its closure error (where it was measured).
const VIEW3D: [(usize, f64, f64, Option<f64>); 3] =
    [(10, 1e-4, 2.7, None), (10, 1e-6, 11.5, Some(3e-5)), (16, 1e-4, 15.0, None)];

/// No edge is longer: every facet is a patch.
const WHOLE: f64 = 10.0;

fn run(scene: &Scene, patch_size: f64, occlusion: Occlusion) -> (usize, f64, f64) {
    let bundles = Bundles::new(scene, Resolution { patch_size, n_directions: 1 }).expect("a resolution");
    let settings = Exchange { occlusion, repair: false, ..Exchange::default() };
    // The shortest of three: what interrupts a run only makes it longer.
    let mut seconds = f64::INFINITY;
    let mut closure = 0.0;
    for _ in 0..3 {
        let start = Instant::now();
        let system = assemble(scene, &bundles, settings).expect("a diffuse scene");
        seconds = seconds.min(start.elapsed().as_secs_f64());
        closure = system.report().closure_before_repair;
    }
    (bundles.n_bundles(), seconds, closure)
}

fn main() {
    println!(
        "{:>8} {:>10} {:>12} {:>9} {:>10} {:>24}",
        "facets", "tolerance", "seconds", "closure", "View3D", "ratio of seconds"
    );
    for (n, tolerance, theirs, their_closure) in VIEW3D {
        let scene = gallery::floating_block(n).expect("a scene");
        for ours in [1e-5, 1e-6, 1e-7] {
            let (n_facets, seconds, closure) = run(&scene, WHOLE, Occlusion::Exact { tolerance: ours });
            let theirs_closed = their_closure.map_or(String::new(), |c| format!(" closure {c:.0e}"));
            let view3d = format!("{theirs} s at {tolerance:.0e}{theirs_closed}");
            println!(
                "{n_facets:>8} {ours:>10.0e} {seconds:>12.3} {closure:>9.1e} {view3d:>32} {:>8.1}",
                theirs / seconds
            );
        }
    }
    for (name, patch_size) in [("corner-box", 0.25), ("two-rooms", 0.5), ("cornell-box", 0.25)] {
        let scene = (gallery::find(name).expect("a scene of the gallery").build)();
        let (n, sampled, noisy) = run(&scene, patch_size, Occlusion::by_rays(64));
        for tolerance in [1e-6, 1e-8] {
            let (_, exact, closure) = run(&scene, patch_size, Occlusion::Exact { tolerance });
            println!(
                "{name} of {n}: 64 rays {sampled:.3} s, closure {noisy:.1e}; exact to {tolerance:.0e} {exact:.3} s, {closure:.1e}"
            );
        }
    }
}
