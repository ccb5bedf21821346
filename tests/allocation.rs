//! No solver allocates once it iterates.
#![allow(clippy::unwrap_used)]

use etendue::assembly::{Exchange, assemble};
use etendue::basis::{Bundles, Resolution};
use etendue::gallery;
use etendue::linalg::Equation;
use etendue::solver::{self, Iteration, Solver, Stop};
use std::ops::ControlFlow;

/// Iterations of the shorter and of the longer solve; histories have room for far more.
const ITERATIONS: [usize; 2] = [3, 8];

/// Allocations of a solve that is stopped at this iteration, on this thread.
fn count(solver: &dyn Solver, equation: Equation<'_>, last: usize) -> u64 {
    let mut watch =
        |it: Iteration<'_>| if it.index == last { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    let mut stop = None;
    let info = allocation_counter::measure(|| stop = Some(solver.solve(equation, &mut watch).unwrap().report.stop));
    assert_eq!(stop, Some(Stop::Observer), "{} ended before iteration {last}", solver.name());
    info.count_total
}

#[test]
fn no_solver_allocates_in_its_loop() {
    // On a thread of rayon's, so that all of the work is done there.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| {
        let scene = gallery::cornell_box();
        let bundles = Bundles::new(&scene, Resolution { patch_size: 0.5, n_directions: 1 }).unwrap();
        let system = assemble(&scene, &bundles, Exchange::default()).unwrap();
        let mut n_tried = 0;
        // Nothing is solved to 0, so that every method goes on for as long as it is let.
        for solver in solver::all(0.0).iter().filter(|solver| !solver.is_direct()) {
            // The first use makes room that operators keep.
            let [_, short, long] =
                [ITERATIONS[0], ITERATIONS[0], ITERATIONS[1]].map(|last| count(&**solver, system.equation(), last));
            assert_eq!(short, long, "{} allocates as it goes", solver.name());
            // The measure itself is no idle one.
            assert!(short > 0);
            n_tried += 1;
        }
        assert!(n_tried > 20);
    });
}
