//! Sequential Monte Carlo.

use super::*;

#[test]
fn sequential_walks_converge_exponentially() {
    for (scene, patch_size) in scenes() {
        let system = system(&scene, patch_size);
        let (exact, walk) = (exact(&system), MatrixWalk::collision(&system).unwrap());
        for scoring in Scoring::ALL {
            let settings = Sequential { tolerance: 1e-12, n_walks: 1_000, max_stages: 60 };
            let answer = walk.with_scoring(scoring).sequential(settings, SEED);
            let (name, n_stages) = (scene.name(), answer.history.len() - 1);
            assert_eq!(answer.stop, SequentialStop::Converged, "{scoring:?} in {name}: {:?}", answer.history);
            let a_stage = if scoring == Scoring::ExpectedValue { 2 } else { 1 };
            assert_eq!(answer.history[n_stages].n_products, a_stage * n_stages);
            // ‖L̃ − L‖ ≤ ‖r‖ / (1 − ‖K‖), and no albedo exceeds 0.9.
            assert!(relative_max(&answer.radiance, &exact) < 2e-11, "{scoring:?} in {name}");

            // Every stage takes the same work and about the same factor.
            let logs: Vec<f64> = answer.history.iter().map(|stage| stage.residual.ln()).collect();
            let line = fit_line(&(0..logs.len()).map(|k| k as f64).collect::<Vec<_>>(), &logs).unwrap();
            assert!(
                line.slope < -0.7 && line.slope_standard_error < 0.1 * -line.slope,
                "{scoring:?} in {name}: {line:?}"
            );
        }
    }
}

#[test]
fn sequential_walks_stop_where_rounding_begins_or_walks_are_few() {
    let system = system(&gallery::corner_box(), 0.25);
    let walk = MatrixWalk::collision(&system).unwrap();
    let settings = Sequential { tolerance: 0.0, n_walks: 1_000, max_stages: 200 };
    let rounding = walk.sequential(settings, SEED);
    assert_eq!(rounding.stop, SequentialStop::Stalled);
    assert!(rounding.history.iter().any(|stage| stage.residual < 1e-14), "{:?}", rounding.history);
    assert_eq!(walk.sequential(Sequential { max_stages: 2, ..settings }, SEED).stop, SequentialStop::Budget);
    assert_eq!(walk.sequential(Sequential { n_walks: 1, ..settings }, SEED).stop, SequentialStop::Stalled);
}

/// On the Cornell box: a small one by default, 1 947 bundles under ETENDUE_LARGE=1.
#[test]
fn sequential_walks_solve_the_cornell_box() {
    let is_large = std::env::var_os("ETENDUE_LARGE").is_some();
    let system = system(&gallery::cornell_box(), if is_large { 0.12 } else { 0.5 });
    let walk = MatrixWalk::collision(&system).unwrap();
    let answer = walk.sequential(Sequential { tolerance: 1e-12, n_walks: 64, max_stages: 60 }, SEED);
    assert_eq!(answer.stop, SequentialStop::Converged, "{:?}", answer.history);
    assert!(relative_max(&answer.radiance, &exact(&system)) < 2e-11);
}
