//! `etendue.solve/1`: a solved light field as one JSON object.

use crate::assembly::System;
use crate::basis::Bundles;
use crate::scene::{Scene, Side};
use crate::solver::{Solution, SolveReport, Stop};
use crate::study::{Duality, Provenance, tessellations};
use serde::Serialize;

/// What `solve --json` prints. Shapes and units are those of the crate's front page; lengths in metres.
#[derive(Serialize)]
pub struct Record<'a> {
    schema: &'static str,
    scene: &'a str,
    n_bundles: usize,
    n_bands: usize,
    /// Names of the bands, in the order of every array that has one number a band.
    bands: &'a [String],
    /// In the order of the unknowns.
    bundles: Vec<SolvedRecord<'a>>,
    laws: LawsRecord,
    exchange: ExchangeRecord,
    report: ReportRecord,
    /// One reading by L and by importance, both by this method; null where it refused the adjoint equation.
    duality: Option<&'a Duality>,
    /// What stands for what: tessellated shapes.
    notes: Vec<String>,
    provenance: Provenance,
}

#[derive(Serialize)]
struct SolvedRecord<'a> {
    #[serde(flatten)]
    bundle: BundleRecord<'a>,
    /// W m⁻² sr⁻¹.
    radiance: Vec<f64>,
    /// W m⁻².
    irradiance: Vec<f64>,
}

/// One unknown.
#[derive(Serialize)]
pub struct BundleRecord<'a> {
    element: usize,
    surface: &'a str,
    /// "front" or "back".
    side: &'static str,
    centre: [f64; 3],
    normal: [f64; 3],
    area: f64,
    bin: usize,
    /// m² sr.
    etendue: f64,
    /// W m⁻² sr⁻¹.
    emission: Vec<f64>,
}

#[derive(Serialize)]
struct LawsRecord {
    // Worst relative violation of each, as measured.
    reciprocity: f64,
    closure: f64,
    positivity: f64,
    conservation: f64,
}

/// How good T was before its closure was repaired: the laws hold after it however poor it was.
#[derive(Serialize)]
struct ExchangeRecord {
    n_pairs: usize,
    n_clear: usize,
    n_hidden: usize,
    n_integrated: usize,
    n_sampled: usize,
    /// Pairs, facing each other or not, that whole clusters settled.
    n_by_clusters: usize,
    /// Relative to the pair's T, the worst pair.
    quadrature_error: f64,
    /// Error that partly visible pairs leave in a row sum, relative to μ, root mean square over bundles.
    visibility_error: f64,
    closure_before_repair: f64,
    /// Largest change of a row's scale by the repair.
    repair_strength: f64,
}

#[derive(Serialize)]
pub struct ReportRecord {
    pub solver: &'static str,
    pub stop: String,
    n_iterations: usize,
    n_applies: usize,
    n_adjoint_applies: usize,
    pub products: f64,
    pub true_residual: f64,
    /// Bound on ‖L − (I − K)⁻¹E‖∞ / ‖L‖∞; null where absorption is too small for one.
    pub error_bound: Option<f64>,
    pub seconds: f64,
}

impl ReportRecord {
    pub fn new(report: &SolveReport, seconds: f64) -> Self {
        Self {
            solver: report.method,
            stop: spoken(report.stop).to_string(),
            n_iterations: report.n_iterations,
            n_applies: report.n_applies,
            n_adjoint_applies: report.n_adjoint_applies,
            products: report.products,
            true_residual: report.true_residual,
            error_bound: report.bracket.as_ref().map(|bracket| bracket.relative_width()),
            seconds,
        }
    }
}

/// The record of a solve that took so many seconds.
pub fn record<'a>(
    scene: &'a Scene,
    bundles: &Bundles,
    system: &System,
    (solution, seconds): (&Solution, f64),
    duality: Option<&'a Duality>,
    provenance: Provenance,
) -> Record<'a> {
    let irradiance = system.irradiance(&solution.radiance);
    let (laws, exchange) = (system.laws(), system.report());
    Record {
        schema: "etendue.solve/1",
        scene: scene.name(),
        n_bundles: bundles.n_bundles(),
        n_bands: scene.n_bands(),
        bands: scene.bands(),
        bundles: bundle_records(scene, bundles, system)
            .into_iter()
            .enumerate()
            .map(|(i, bundle)| SolvedRecord {
                bundle,
                radiance: solution.radiance.row(i).collect(),
                irradiance: irradiance.row(i).collect(),
            })
            .collect(),
        laws: LawsRecord {
            reciprocity: laws.reciprocity,
            closure: laws.closure,
            positivity: laws.positivity,
            conservation: laws.conservation,
        },
        exchange: ExchangeRecord {
            n_pairs: exchange.n_pairs,
            n_clear: exchange.n_clear,
            n_hidden: exchange.n_hidden,
            n_integrated: exchange.n_integrated,
            n_sampled: exchange.n_sampled,
            n_by_clusters: exchange.n_by_clusters,
            quadrature_error: exchange.quadrature_error,
            visibility_error: exchange.visibility_error,
            closure_before_repair: exchange.closure_before_repair,
            repair_strength: exchange.repair.map_or(0.0, |repair| repair.strongest),
        },
        report: ReportRecord::new(&solution.report, seconds),
        duality,
        notes: tessellations(scene),
        provenance,
    }
}

/// What the unknowns are, in their order.
pub fn bundle_records<'a>(scene: &'a Scene, bundles: &Bundles, system: &System) -> Vec<BundleRecord<'a>> {
    (0..bundles.n_bundles()).filter_map(|i| bundle(scene, bundles, system, i)).collect()
}

fn bundle<'a>(scene: &'a Scene, bundles: &Bundles, system: &System, i: usize) -> Option<BundleRecord<'a>> {
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
    })
}

/// Of this program's solves, only `--max-products` makes the observer stop one: its budget.
pub fn spoken(stop: Stop) -> Stop {
    if stop == Stop::Observer { Stop::Budget } else { stop }
}
