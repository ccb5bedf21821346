//! `etendue study`: the main job.

use super::arguments::{Arguments, Study};
use super::exit::{Exit, Failure};
use super::output;
use super::progress::Bars;
use super::provenance::provenance;
use super::scene::choose;
use super::summary::summary;
use crate::assembly::Gather;
use crate::study::{SolverRun, StudyOutcome, StudySettings};
use crate::{report, solver, study};
use std::path::PathBuf;

/// Family-wise significance of the comparisons.
const SIGNIFICANCE: f64 = 1e-6;

/// Bounces shown one by one.
const N_BOUNCES: usize = 5;

pub fn run(arguments: &Arguments, study: &Study, command: Vec<String>) -> Result<(), Failure> {
    study::check_albedos(&study.albedo)?;
    let estimators = study::choose_estimators(&study.estimators)?;
    let chosen = choose(&study.scene, |scene, n| study::memory_estimate(scene, n, N_BOUNCES, &estimators))?;
    let scene = &chosen.scene;
    let folder = study.output.clone().unwrap_or_else(|| PathBuf::from("out").join(folder_name(scene.name())));
    output::check_folder(&folder)?;
    report::check_folder(&folder)?;
    if !arguments.quiet {
        chosen.announce();
        output::error(&format!(
            "seed {}, tolerance {:e}, up to {} walks and {} paths a bundle (--seed, --tolerance, --walk-samples, \
             --path-samples)",
            study.scene.seed, study.tolerance, study.walk_samples, study.path_samples
        ));
    }

    let seed = study.scene.seed;
    let settings = StudySettings {
        resolution: chosen.resolution,
        solvers: solvers(&study.solvers),
        estimators,
        n_levels: 3,
        tolerance: study.tolerance,
        albedos: study.albedo.clone(),
        albedo_budget: study.max_products as f64,
        exchange: study.scene.exchange(),
        walk_samples: study.walk_samples,
        path_samples: study.path_samples,
        significance: SIGNIFICANCE,
        seed,
        gather: Gather { samples: 16, rays: 16, seed },
        n_bounces: N_BOUNCES,
    };
    let provenance = provenance(&chosen, command, &settings.exchange, describe(&settings));
    let bars = Bars::new(arguments);
    let outcome = study::run(scene, &settings, provenance, &bars)?;
    drop(bars);

    // Write the folder whole, then say what is in it.
    let artifacts = report::render(&outcome)?;
    report::write_whole(&folder, &artifacts)?;
    if arguments.json {
        // As written, and not parsed and written again: every digit counts.
        let json = artifacts.iter().find(|artifact| artifact.name == "report.json");
        let text = json.map(|artifact| String::from_utf8_lossy(&artifact.bytes)).unwrap_or_default();
        output::print(&format!("{}\n", text.trim_end()))?;
    } else if !arguments.quiet {
        output::print(&summary(&outcome, &folder))?;
    }
    check_converged(&outcome)
}

/// The report is there either way; whether every solver got where it should, the exit code says.
fn check_converged(outcome: &StudyOutcome) -> Result<(), Failure> {
    let unfinished = |run: &&SolverRun| !["direct", "converged", "refused"].contains(&run.stop.as_str());
    let names: Vec<String> =
        outcome.solvers.iter().filter(unfinished).map(|run| format!("{} ({})", run.solver, run.stop)).collect();
    if names.is_empty() {
        return Ok(());
    }
    let message = format!("not converged: {}\n  = the report was written all the same", names.join(", "));
    Err(Failure::new(Exit::NotConverged, message))
}

/// The last part of a scene's name that can name a folder.
fn folder_name(scene: &str) -> String {
    let safe = |c: char| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '-' };
    let name: String = scene.chars().map(safe).collect();
    let name = name.trim_start_matches('.');
    if name.is_empty() { "scene".to_string() } else { name.to_string() }
}

/// The methods asked for, the first direct one before all others: it is the reference.
fn solvers(asked: &[String]) -> Vec<String> {
    let all: Vec<(&str, bool)> = solver::all(1.0).iter().map(|method| (method.name(), method.is_direct())).collect();
    let is_asked = |name: &str| asked.iter().any(|word| word == name || word == "all");
    let mut chosen: Vec<(&str, bool)> = all.iter().copied().filter(|(name, _)| is_asked(name)).collect();
    match chosen.iter().position(|(_, is_direct)| *is_direct) {
        Some(first) => chosen[..=first].rotate_right(1),
        None => chosen.splice(0..0, all.iter().copied().find(|(_, is_direct)| *is_direct)).for_each(drop),
    }
    chosen.into_iter().map(|(name, _)| name.to_string()).collect()
}

fn describe(settings: &StudySettings) -> [(&'static str, String); 11] {
    let albedos = match &settings.albedos[..] {
        [] => "the scene's own".to_string(),
        list => list.iter().map(f64::to_string).collect::<Vec<_>>().join(", "),
    };
    [
        ("solvers", settings.solvers.join(", ")),
        ("estimators", settings.estimators.join(", ")),
        ("solver_tolerance", format!("{:e}", settings.tolerance)),
        ("albedos", albedos),
        ("products_at_an_albedo", settings.albedo_budget.to_string()),
        ("walk_samples_a_bundle", settings.walk_samples.to_string()),
        ("path_samples_a_bundle", settings.path_samples.to_string()),
        ("significance", format!("{:e}", settings.significance)),
        ("camera_rays_a_pixel", settings.gather.samples.to_string()),
        ("gather_rays_a_camera_ray", settings.gather.rays.to_string()),
        ("refinement_levels", settings.n_levels.to_string()),
    ]
}
