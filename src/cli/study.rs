//! `etendue study`: the main job.

use super::arguments::{Arguments, Study};
use super::exit::{Exit, Failure};
use super::output;
use super::progress::Bars;
use super::scene::{Chosen, choose};
use crate::assembly::{Exchange, Gather, System};
use crate::estimator::MatrixWalk;
use crate::study::{Provenance, StudyOutcome, StudySettings, tessellations};
use crate::{report, study};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Family-wise significance of the comparisons.
const SIGNIFICANCE: f64 = 1e-6;

pub fn run(arguments: &Arguments, study: &Study, command: Vec<String>) -> Result<(), Failure> {
    // A study holds the matrix, its factors, its tables for walks, and a second matrix for comparison.
    let needed = |n: usize| {
        let square = (n as u64).saturating_mul(n as u64);
        System::memory_estimate(n)
            .saturating_add(square.saturating_mul(24))
            .saturating_add(MatrixWalk::memory_estimate(n))
    };
    let Chosen { scene, resolution, n_bundles, is_preset } = choose(&study.scene, needed)?;
    let folder = study.output.clone().unwrap_or_else(|| PathBuf::from("out").join(folder_name(scene.name())));
    report::check_folder(&folder)?;
    if !arguments.quiet {
        let preset = if is_preset { " (preset)" } else { "" };
        output::error(&format!(
            "{}: {n_bundles} bundles at patch size {}{preset}",
            scene.name(),
            resolution.patch_size
        ));
        tessellations(&scene).iter().for_each(|sentence| output::error(&format!("note: {sentence}")));
    }

    let seed = study.scene.seed;
    let settings = StudySettings {
        resolution,
        n_levels: 3,
        tolerance: study.tolerance,
        exchange: Exchange { seed, ..Exchange::default() },
        walk_samples: study.walk_samples,
        path_samples: study.path_samples,
        significance: SIGNIFICANCE,
        seed,
        gather: Gather { samples: 16, rays: 16, seed },
        n_bounces: 6,
    };
    let provenance = Provenance {
        version: env!("CARGO_PKG_VERSION").to_string(),
        command,
        scene: scene.name().to_string(),
        scene_hash: scene.hash(),
        patch_size: resolution.patch_size,
        n_directions: resolution.n_directions,
        seed,
        settings: describe(&settings),
    };
    let bars = Bars::new(arguments);
    let outcome = study::run(&scene, &settings, provenance, &bars)?;

    // Write the folder whole, then say what is in it.
    let artifacts = report::render(&outcome)?;
    report::write_whole(&folder, &artifacts)?;
    if arguments.json {
        let json = artifacts.iter().find(|artifact| artifact.name == "report.json");
        let bytes = json.map(|artifact| artifact.bytes.as_slice()).unwrap_or_default();
        let object: serde_json::Value =
            serde_json::from_slice(bytes).map_err(|e| Failure::new(Exit::Internal, e.to_string()))?;
        return output::print(&format!("{object}\n"));
    }
    if arguments.quiet { Ok(()) } else { output::print(&summary(&outcome, &folder)) }
}

/// The last part of a scene's name that can name a folder.
fn folder_name(scene: &str) -> String {
    let safe = |c: char| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '-' };
    let name: String = scene.chars().map(safe).collect();
    let name = name.trim_start_matches('.');
    if name.is_empty() { "scene".to_string() } else { name.to_string() }
}

fn describe(settings: &StudySettings) -> BTreeMap<String, String> {
    let StudySettings { exchange, gather, .. } = settings;
    BTreeMap::from(
        [
            ("solver tolerance", format!("{:e}", settings.tolerance)),
            ("quadrature tolerance", format!("{:e}", exchange.tolerance)),
            ("visibility rays a pair", exchange.visibility_rays.to_string()),
            ("sink rays a patch", exchange.sink_rays.to_string()),
            ("walk samples a bundle", settings.walk_samples.to_string()),
            ("path samples a bundle", settings.path_samples.to_string()),
            ("significance", format!("{:e}", settings.significance)),
            ("camera rays a pixel", gather.samples.to_string()),
            ("gather rays a camera ray", gather.rays.to_string()),
            ("refinement levels", settings.n_levels.to_string()),
        ]
        .map(|(name, value)| (name.to_string(), value)),
    )
}

/// What a person wants to know first.
fn summary(outcome: &StudyOutcome, folder: &Path) -> String {
    let mut text = format!("{:14} {:>9} {:>10} {:>10} {:>10}\n", "solver", "products", "seconds", "residual", "error");
    for run in &outcome.solvers {
        text += &format!(
            "{:14} {:>9.1} {:>10.3} {:>10.1e} {:>10.1e}  {}\n",
            run.solver, run.products, run.seconds, run.true_residual, run.error, run.stop
        );
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
    text += &format!(
        "\nmatrix against path tracer: order {:.2}, finest mesh within {:.2} % of the continuous truth, surface means {}\n",
        refinement.observed_order,
        100.0 * refinement.finest_error,
        if refinement.agrees { "agree" } else { "DISAGREE" }
    );
    text + &format!("\n{}\n", folder.join("report.html").display())
}
