//! `etendue solve`: one scene, one method, the light field as JSON or as a table.

use super::arguments::{Arguments, Solve};
use super::exit::{Exit, Failure};
use super::output;
use super::progress::Bars;
use super::scene::{Chosen, choose};
use crate::assembly::{Exchange, System, assemble_watched};
use crate::basis::Bundles;
use crate::linalg::Block;
use crate::scene::{Scene, Side};
use crate::solver::{self, Iteration, Solution, Stop};
use crate::study::{Provenance, Watch, tessellations};
use serde::Serialize;
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::time::Instant;

/// What `solve --json` prints. Shapes and units are those of the crate's front page.
#[derive(Serialize)]
struct Record<'a> {
    schema: &'static str,
    scene: &'a str,
    n_bundles: usize,
    n_bands: usize,
    bands: &'a [String],
    bundles: Vec<BundleRecord<'a>>,
    laws: LawsRecord,
    report: ReportRecord,
    notes: Vec<String>,
    provenance: Provenance,
}

#[derive(Serialize)]
struct BundleRecord<'a> {
    element: usize,
    surface: &'a str,
    side: &'static str,
    centre: [f64; 3],
    normal: [f64; 3],
    area: f64,
    bin: usize,
    etendue: f64,
    emission: Vec<f64>,
    radiance: Vec<f64>,
    irradiance: Vec<f64>,
}

#[derive(Serialize)]
struct LawsRecord {
    reciprocity: f64,
    closure: f64,
    positivity: f64,
    conservation: f64,
}

#[derive(Serialize)]
struct ReportRecord {
    solver: &'static str,
    stop: String,
    n_iterations: usize,
    n_applies: usize,
    n_adjoint_applies: usize,
    products: f64,
    true_residual: f64,
    /// Bound on ‖L − (I − K)⁻¹E‖∞ / ‖L‖∞; null where absorption is too small for one.
    error_bound: Option<f64>,
    seconds: f64,
}

pub fn run(arguments: &Arguments, solve: &Solve, command: Vec<String>) -> Result<(), Failure> {
    // Direct methods write the matrix out, and its factors.
    let method = solver::all(solve.tolerance).into_iter().find(|method| method.name() == solve.solver);
    let method = method.ok_or_else(|| Failure::new(Exit::Usage, format!("no solver '{}'", solve.solver)))?;
    let factors = if method.is_direct() { 16 } else { 0 };
    let needed =
        |n: usize| System::memory_estimate(n).saturating_add((n as u64).saturating_pow(2).saturating_mul(factors));
    let chosen = choose(&solve.scene, needed)?;
    let Chosen { scene, resolution, n_bundles, is_preset } = &chosen;
    if !arguments.quiet {
        let preset = if *is_preset { " (preset)" } else { "" };
        output::error(&format!(
            "{}: {n_bundles} bundles at patch size {}{preset}",
            scene.name(),
            resolution.patch_size
        ));
        tessellations(scene).iter().for_each(|sentence| output::error(&format!("note: {sentence}")));
    }

    let bars = Bars::new(arguments);
    let settings = Exchange { seed: solve.scene.seed, ..Exchange::default() };
    let bundles = Bundles::new(scene, *resolution)?;
    let system = assemble_watched(scene, &bundles, settings, &|done| bars.progress("assemble", done))?;

    // Solve, within the budget of products.
    let budget = solve.max_products.map_or(f64::INFINITY, |n| n as f64);
    let mut observer = |iteration: Iteration<'_>| {
        if iteration.products >= budget { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let start = Instant::now();
    let solution = method.solve(system.equation(), &mut observer)?;
    let seconds = start.elapsed().as_secs_f64();

    let settings = BTreeMap::from([
        ("solver".to_string(), method.name().to_string()),
        ("tolerance".to_string(), format!("{:e}", solve.tolerance)),
        ("exchange".to_string(), format!("{settings:?}")),
    ]);
    let provenance = Provenance {
        version: env!("CARGO_PKG_VERSION").to_string(),
        command,
        scene: scene.name().to_string(),
        scene_hash: scene.hash(),
        patch_size: resolution.patch_size,
        n_directions: resolution.n_directions,
        seed: solve.scene.seed,
        settings,
    };
    if arguments.json || solve.output.is_some() {
        let record = record(scene, &bundles, &system, &solution, seconds, provenance);
        let text = serde_json::to_string(&record).map_err(|e| Failure::new(Exit::Internal, e.to_string()))? + "\n";
        match &solve.output {
            Some(path) => output::write_file(path, text.as_bytes())?,
            None => output::print(&text)?,
        }
    } else {
        output::print(&table(scene, &bundles, &system, &solution, seconds))?;
    }

    if matches!(solution.report.stop, Stop::Budget | Stop::Observer) {
        let (products, residual) = (solution.report.products, solution.report.true_residual);
        let message = format!("{} stopped after {products} products at residual {residual:.2e}", method.name());
        return Err(Failure::new(Exit::NotConverged, message));
    }
    Ok(())
}

fn record<'a>(
    scene: &'a Scene,
    bundles: &Bundles,
    system: &System,
    solution: &Solution,
    seconds: f64,
    provenance: Provenance,
) -> Record<'a> {
    let irradiance = system.irradiance(&solution.radiance);
    let report = &solution.report;
    let laws = system.laws();
    Record {
        schema: "etendue.solve/1",
        scene: scene.name(),
        n_bundles: bundles.n_bundles(),
        n_bands: scene.n_bands(),
        bands: scene.bands(),
        bundles: (0..bundles.n_bundles())
            .filter_map(|i| bundle(scene, bundles, system, &solution.radiance, &irradiance, i))
            .collect(),
        laws: LawsRecord {
            reciprocity: laws.reciprocity,
            closure: laws.closure,
            positivity: laws.positivity,
            conservation: laws.conservation,
        },
        report: ReportRecord {
            solver: report.method,
            stop: report.stop.to_string(),
            n_iterations: report.n_iterations,
            n_applies: report.n_applies,
            n_adjoint_applies: report.n_adjoint_applies,
            products: report.products,
            true_residual: report.true_residual,
            error_bound: report.bracket.as_ref().map(|bracket| bracket.relative_width(&solution.radiance)),
            seconds,
        },
        notes: tessellations(scene),
        provenance,
    }
}

fn bundle<'a>(
    scene: &'a Scene,
    bundles: &Bundles,
    system: &System,
    radiance: &Block,
    irradiance: &Block,
    i: usize,
) -> Option<BundleRecord<'a>> {
    let (element, bin) = bundles.element_of(i);
    let patch = bundles.patch(element)?;
    Some(BundleRecord {
        element,
        surface: &scene.surface_of(patch.facet).name,
        side: match patch.side {
            Side::Front => "front",
            Side::Back => "back",
        },
        centre: patch.polygon.centroid().to_array(),
        normal: patch.polygon.normal().to_array(),
        area: patch.polygon.area(),
        bin,
        etendue: system.etendue()[i],
        emission: system.emission().row(i).collect(),
        radiance: radiance.row(i).collect(),
        irradiance: irradiance.row(i).collect(),
    })
}

/// Mean radiance and irradiance by surface, and how they were come by.
fn table(scene: &Scene, bundles: &Bundles, system: &System, solution: &Solution, seconds: f64) -> String {
    let irradiance = system.irradiance(&solution.radiance);
    let (means, _) = crate::study::surface_means(scene, bundles, &solution.radiance, None);
    let (incident, _) = crate::study::surface_means(scene, bundles, &irradiance, None);
    let width = scene.surfaces().iter().map(|s| s.name.chars().count()).max().unwrap_or(0).max(7);
    let columns = 11 * scene.n_bands();
    let mut text = format!("{:width$}  {:>columns$}  {:>columns$}\n", "surface", "mean radiance", "mean irradiance");
    for (s, surface) in scene.surfaces().iter().enumerate() {
        let numbers = |block: &Block| block.row(s).map(|v| format!("{v:11.4e}")).collect::<String>();
        text += &format!("{:width$}  {}  {}\n", surface.name, numbers(&means), numbers(&incident));
    }
    let (report, laws) = (&solution.report, system.laws());
    text += &format!(
        "\n{} ({}): {} products, residual {:.1e}, {seconds:.3} s\n",
        report.method, report.stop, report.products, report.true_residual
    );
    text += &format!(
        "laws: reciprocity {:.1e}, closure {:.1e}, positivity {:.1e}, conservation {:.1e}\n",
        laws.reciprocity, laws.closure, laws.positivity, laws.conservation
    );
    text
}
