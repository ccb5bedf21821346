//! `etendue study`: the main job.

use super::arguments::{Arguments, Study};
use super::exit::{Exit, Failure};
use super::output;
use super::progress::Bars;
use super::provenance::provenance;
use super::scene::choose;
use crate::assembly::Gather;
use crate::study::{SolverRun, StudyOutcome, StudySettings};
use crate::{report, solver, study};
use std::path::{Path, PathBuf};

/// Family-wise significance of the comparisons.
const SIGNIFICANCE: f64 = 1e-6;

/// Bounces shown one by one.
const N_BOUNCES: usize = 5;

pub fn run(arguments: &Arguments, study: &Study, command: Vec<String>) -> Result<(), Failure> {
    let chosen = choose(&study.scene, |scene, n| study::memory_estimate(scene, n, N_BOUNCES))?;
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
        n_levels: 3,
        tolerance: study.tolerance,
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

fn describe(settings: &StudySettings) -> [(&'static str, String); 8] {
    [
        ("solvers", settings.solvers.join(", ")),
        ("solver_tolerance", format!("{:e}", settings.tolerance)),
        ("walk_samples_a_bundle", settings.walk_samples.to_string()),
        ("path_samples_a_bundle", settings.path_samples.to_string()),
        ("significance", format!("{:e}", settings.significance)),
        ("camera_rays_a_pixel", settings.gather.samples.to_string()),
        ("gather_rays_a_camera_ray", settings.gather.rays.to_string()),
        ("refinement_levels", settings.n_levels.to_string()),
    ]
}

/// What a person wants to know first.
fn summary(outcome: &StudyOutcome, folder: &Path) -> String {
    let width = outcome.solvers.iter().map(|run| run.solver.len()).fold(14, usize::max);
    let mut text =
        format!("{:width$} {:>9} {:>10} {:>10} {:>10}\n", "solver", "products", "seconds", "residual", "error");
    for run in &outcome.solvers {
        let products = if run.kind == "direct" || run.refusal.is_some() {
            "–".to_string()
        } else {
            format!("{:.1}", run.products)
        };
        text += &format!(
            "{:width$} {products:>9} {:>10.3} {:>10.1e} {:>10.1e}  {}\n",
            run.solver, run.seconds, run.true_residual, run.error, run.stop
        );
        run.refusal.iter().for_each(|refusal| text += &format!("{:width$}   {refusal}\n", ""));
    }
    text += &format!("\n{:26} {:>9} {:>10} {:>10} {:>10}\n", "estimator", "slope", "seconds", "worst |z|", "p");
    for run in &outcome.estimators {
        let name = format!("{} ({})", run.estimator, run.truth);
        text += &format!(
            "{name:26} {:>9.2} {:>10.3} {:>10.2} {:>10.1e}\n",
            run.slope, run.seconds, run.worst_z, run.p_value
        );
    }
    let refinement = &outcome.refinement;
    let order = match refinement.observed_order {
        order if order.is_nan() => "no order observed".to_string(),
        order => format!("order {order:.2}"),
    };
    let finding = match refinement.finest_error {
        error if error.is_nan() => "one mesh alone tells no discretisation error".to_string(),
        error => {
            let verdict = if refinement.agrees { "agree" } else { "DISAGREE" };
            format!("{order}, finest mesh {:.2} % off the continuous truth, surface means {verdict}", 100.0 * error)
        }
    };
    text += &format!("\nmatrix against path tracer: {finding}\n");
    text + &format!("\n{}\n", folder.join("report.html").display())
}
