//! What a study says of methods, against what theory says of them: albedos, predictions, duality.

use super::scenes::{self, Case};
use etendue::assembly::{Exchange, Gather};
use etendue::basis::Resolution;
use etendue::linalg::{Block, LinearOperator};
use etendue::solver::{self, Lu, Solver};
use etendue::study::{self, AlbedoStudy, LinearSensor, Provenance, SolverRun, StudyError, StudyOutcome, StudySettings};
use std::collections::BTreeMap;

const TOLERANCE: f64 = 1e-12;

/// Relative; a direct answer errs by some ulp times the condition of I − K, below 10³ in the scenes of the gallery.
const ROUNDING: f64 = 1e-12;

fn methods(names: &[&str]) -> Vec<Box<dyn Solver>> {
    names.iter().map(|name| solver::named(name, TOLERANCE).unwrap()).collect()
}

fn run<'a>(study: &'a AlbedoStudy, level: usize, solver: &str) -> &'a SolverRun {
    study.levels[level].runs.iter().find(|run| run.solver == solver).unwrap()
}

#[test]
fn products_grow_with_albedo_as_theory_says() {
    let case = scenes::find("furnace-cube");
    let methods = methods(&["gth", "neumann", "chebyshev", "deflated-cg"]);
    let albedos = [0.9, 0.5, 0.99, 0.9];
    let study = study::albedo_study(&case.system, &methods, &albedos, TOLERANCE, 1e4, &|_| ()).unwrap();
    // In order, and each once.
    assert_eq!(study.levels.iter().map(|level| level.albedo).collect::<Vec<_>>(), [0.5, 0.9, 0.99]);
    for (level, albedo) in [0.5_f64, 0.9, 0.99].into_iter().enumerate() {
        // In a furnace K E = albedo E: after p products albedoᵖ is left, exactly so many.
        let expected = (TOLERANCE.ln() / albedo.ln()).ceil();
        assert_eq!(run(&study, level, "neumann").products, expected, "{albedo}");
        assert!(run(&study, level, "deflated-cg").products < 2.0);
        // Fourteen products measure the interval; the rest is below the polynomial's bound for κ ≤ 2 / (1 − albedo).
        let most = 14.0 + 0.5 * (2.0 / (1.0 - albedo)).sqrt() * (2.0 / TOLERANCE * 2.0 / (1.0 - albedo)).ln();
        assert!(run(&study, level, "chebyshev").products < most + 2.0, "{albedo}");
        assert!(study.levels[level].runs.iter().all(|run| run.error < 1e-10), "{albedo}");
    }
}

#[test]
fn a_budget_ends_a_method_and_an_albedo_out_of_range_the_study() {
    let case = scenes::find("furnace-cube");
    let budget = 20.0;
    let methods = methods(&["neumann", "cg"]);
    let study = study::albedo_study(&case.system, &methods, &[0.9], TOLERANCE, budget, &|_| ()).unwrap();
    let neumann = run(&study, 0, "neumann");
    assert_eq!((neumann.stop.as_str(), neumann.products), ("budget", budget));
    assert_eq!(run(&study, 0, "cg").stop, "converged");
    for albedo in [1.0, -0.5, f64::NAN, f64::INFINITY] {
        let refused = study::albedo_study(&case.system, &methods, &[0.5, albedo], TOLERANCE, budget, &|_| ());
        assert!(matches!(refused, Err(StudyError::AlbedoOutOfRange { .. })), "{albedo}");
    }
}

#[test]
fn a_reading_is_the_same_by_light_and_by_importance() {
    for case in scenes::coarse() {
        let sensor = LinearSensor::of(&case.scene, &case.bundles, &case.system);
        for method in solver::all(1e-13).iter().filter(|method| method.is_direct()) {
            let radiance = method.solve(case.system.equation(), &mut ()).unwrap().radiance;
            let duality = sensor.duality(&case.system, &radiance, &**method, &mut ()).unwrap();
            let name = (case.entry.name, method.name());
            assert!(duality.difference <= ROUNDING, "{name:?}: {:e}", duality.difference);
            assert!(duality.reading.iter().all(|reading| *reading > 0.0), "{name:?}: {:?}", duality.reading);
        }
    }
}

#[test]
fn a_light_field_of_another_scene_has_no_dual() {
    let case = scenes::find("corner-box");
    let sensor = LinearSensor::of(&case.scene, &case.bundles, &case.system);
    let mut radiance = Lu.solve(case.system.equation(), &mut ()).unwrap().radiance;
    radiance.values_mut().iter_mut().for_each(|value| *value *= 1.001);
    let duality = sensor.duality(&case.system, &radiance, &Lu, &mut ()).unwrap();
    assert!((duality.difference - 0.001 / 1.001).abs() < 1e-9, "{:e}", duality.difference);
}

#[test]
fn where_there_is_no_camera_and_all_emits_the_reflected_flux_is_read() {
    let square = scenes::polygon(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    let facing = scenes::polygon(&[[0.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, 1.0, 1.0], [1.0, 0.0, 1.0]]);
    let scene = scenes::scene_of(&[square, facing], false);
    let bundles = etendue::basis::Bundles::new(&scene, Resolution { patch_size: 0.5, n_directions: 1 }).unwrap();
    let system = etendue::assembly::assemble(&scene, &bundles, Exchange::default()).unwrap();
    let sensor = LinearSensor::of(&scene, &bundles, &system);
    assert_eq!((sensor.description.as_str(), sensor.unit), ("reflected flux of all surfaces", "W"));

    let radiance = Lu.solve(system.equation(), &mut ()).unwrap().radiance;
    let mut reflected = Block::zeros(bundles.n_bundles(), 1);
    system.transport().apply(&radiance, &mut reflected);
    let flux: f64 = reflected.column(0).iter().zip(system.etendue()).map(|(l, mu)| mu * l).sum();
    let duality = sensor.duality(&system, &radiance, &Lu, &mut ()).unwrap();
    assert!((duality.reading[0] / flux - 1.0).abs() < ROUNDING && duality.difference < ROUNDING);
}

/// A small study of a coarse case by these methods.
fn study_of(case: &Case, solvers: &[&str]) -> StudyOutcome {
    study_with(case, StudySettings { solvers: words(solvers), ..settings(case) })
}

fn words(list: &[&str]) -> Vec<String> {
    list.iter().map(|word| word.to_string()).collect()
}

/// One solver and the fewest samples.
fn settings(case: &Case) -> StudySettings {
    StudySettings {
        resolution: case.bundles.resolution(),
        solvers: words(&["lu"]),
        estimators: Vec::new(),
        n_levels: 1,
        tolerance: TOLERANCE,
        albedos: Vec::new(),
        albedo_budget: 1.0,
        exchange: case.settings,
        walk_samples: 4,
        path_samples: 4,
        significance: 1e-6,
        seed: 4711,
        gather: Gather { samples: 1, rays: 1, seed: 1 },
        n_bounces: 1,
    }
}

fn study_with(case: &Case, settings: StudySettings) -> StudyOutcome {
    let provenance = Provenance {
        version: String::new(),
        command: Vec::new(),
        scene: String::new(),
        scene_hash: String::new(),
        patch_size: case.bundles.resolution().patch_size,
        n_directions: 1,
        seed: 4711,
        settings: BTreeMap::new(),
    };
    study::run(&case.scene, &settings, provenance, &()).unwrap()
}

#[test]
fn what_is_foretold_happens() {
    for name in ["two-rooms", "corner-box"] {
        let outcome = study_of(scenes::find(name), &["lu", "neumann", "cg", "two-grid", "perron", "gauss-seidel"]);
        for run in &outcome.solvers[1..] {
            let points: Vec<(f64, f64)> =
                run.history.iter().filter_map(|point| Some((point.error, point.predicted?))).collect();
            if run.solver == "gauss-seidel" {
                assert!(points.is_empty(), "there is no theory of it here");
                continue;
            }
            assert_eq!(points.len(), run.history.len(), "{}", run.solver);
            for (k, (error, predicted)) in points.iter().enumerate() {
                let is_late = k >= points.len() / 2 && *error > 1e-10;
                match run.solver.as_str() {
                    // Late bounces hold only the leading eigenvectors, and those were found to 1e-8.
                    "neumann" if is_late => {
                        assert!((predicted / error - 1.0).abs() < 1e-3, "{name} {k}: {error:e} {predicted:e}");
                    }
                    // A bound but for the norm it is in.
                    "cg" => assert!(*error < 100.0 * predicted, "{name} {k}: {error:e} {predicted:e}"),
                    _ => {}
                }
            }
        }

        // What an accelerated method takes off at every step in the long run, within a tenth of its digits.
        for solver in ["two-grid", "perron"] {
            let run = outcome.solvers.iter().find(|run| run.solver == solver).unwrap();
            let (first, last) = (&run.history[0], run.history.last().unwrap());
            let digits = |ratio: f64| -ratio.log10();
            let (measured, foretold) =
                (digits(last.error / first.error), digits(last.predicted.unwrap() / first.predicted.unwrap()));
            assert!((foretold / measured - 1.0).abs() < 0.2, "{name} {solver}: {measured} {foretold}");
        }
    }
}

#[test]
fn time_runs_and_every_method_has_its_importance() {
    let outcome = study_of(scenes::find("corner-box"), &["lu", "cg", "gmres"]);
    for run in &outcome.solvers {
        let times: Vec<f64> = run.history.iter().map(|point| point.seconds).collect();
        assert!(
            times.windows(2).all(|pair| pair[0] <= pair[1]) && times.iter().all(|t| *t <= run.seconds),
            "{times:?}"
        );
        let adjoint = run.adjoint.as_ref().unwrap();
        // Both solutions stop at 10⁻¹² of what their sources are at most; the reading is no such maximum.
        assert!(adjoint.difference < 1e-9, "{}: {:e}", run.solver, adjoint.difference);
    }
    assert_eq!(outcome.duality.solver, outcome.reference_solver);
    assert!(outcome.duality.difference < ROUNDING);
}

/// Family-wise, of every verdict below; each is corrected for its own comparisons.
const SIGNIFICANCE: f64 = 1e-6;

#[test]
fn every_random_method_is_right_and_knows_its_error_beforehand() {
    for name in ["corner-box", "two-rooms"] {
        let case = scenes::find(name);
        let (estimators, walk_samples, path_samples) = (words(&["all"]), 1024, 256);
        let outcome = study_with(case, StudySettings { estimators, walk_samples, path_samples, ..settings(case) });
        let names: Vec<&str> = outcome.estimators.iter().map(|run| run.estimator.as_str()).collect();
        let known: Vec<&str> = study::estimator_names().filter(|name| *name != "sequential-walk").collect();
        assert_eq!(names, known);
        for run in &outcome.estimators {
            let id = format!("{name}, {}", run.estimator);
            assert!(run.refusal.is_none() && run.prediction_refusal.is_none(), "{id}: {:?}", run.refusal);
            let last = run.points.last().unwrap();
            assert!(run.points.windows(2).all(|p| p[0].seconds < p[1].seconds && p[0].steps < p[1].steps), "{id}");
            if run.truth == "continuous" {
                // They know no mesh, and so agree with one another better than with the matrix.
                let is_untested = ["path-tracer", "path-tracer-emitters"].contains(&run.estimator.as_str());
                assert_eq!(run.mesh.unwrap().p_value.is_none(), is_untested, "{id}");
                assert!(run.mesh.unwrap().p_value.is_none_or(|p| p >= SIGNIFICANCE), "{id}: {:?}", run.mesh);
                continue;
            }
            // In the bright rooms a last event is worth ten visits, and too few walks meet one for any comparison.
            let is_judged = run.n_comparisons > 0 || (name == "two-rooms" && run.estimator == "absorption-walk");
            assert!(run.p_value >= SIGNIFICANCE && is_judged, "{id}: |z| {}", run.worst_z);
            assert!(run.mesh.is_none(), "{id}");
            match run.estimator.as_str() {
                // Their samples depend on one another.
                "quasi-walk" | "stochastic-jacobi" => assert!(last.predicted.is_none(), "{id}"),
                // Weights telescope: nothing varies but the last digits.
                "guided-walk" => assert!(run.points.iter().all(|p| p.error < 1e-11) && run.variance.is_none(), "{id}"),
                _ => {
                    let variance = run.variance.unwrap_or_else(|| panic!("{id}: no variance"));
                    assert!(variance.p_value >= SIGNIFICANCE, "{id}: {variance:?}");
                    // So many samples are enough, and one fewer is not.
                    let error = |n: f64| last.predicted.unwrap() * (last.samples_per_bundle as f64 / n).sqrt();
                    assert!(error(run.samples_for_percent) <= 0.01 * (1.0 + ROUNDING), "{id}");
                    assert!(error(run.samples_for_percent - 1.0) > 0.01 || run.samples_for_percent == 1.0, "{id}");
                }
            }
        }
        let sequential = outcome.sequential.unwrap();
        assert!(sequential.factor < 0.5 && sequential.stop == "converged", "{name}: {sequential:?}");
        assert!(sequential.stages.last().unwrap().error < 1e-10, "{name}: {sequential:?}");
    }
}

#[test]
fn an_unknown_method_ends_a_study_before_it_begins() {
    let case = scenes::find("corner-box");
    let settings = StudySettings { estimators: words(&["collision-wolk"]), ..settings(case) };
    let provenance = study_of(case, &["lu"]).provenance;
    let refused = study::run(&case.scene, &settings, provenance, &());
    assert!(matches!(refused, Err(StudyError::UnknownEstimator { name, .. }) if name == "collision-wolk"));
}
