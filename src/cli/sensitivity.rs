//! `etendue sensitivity`: what a sensor's reading hangs on.

use super::arguments::{Arguments, Sensitivity};
use super::exit::{Exit, Failure};
use super::memory;
use super::output;
use super::progress::Bars;
use super::provenance::provenance;
use super::scene::choose;
use crate::scene::Scene;
use crate::study::{Provenance, Quantity, SensitivityOutcome, Sensor, Watch, sensitivity};
use serde::Serialize;

/// What `sensitivity --json` prints.
#[derive(Serialize)]
struct Record<'a> {
    schema: &'static str,
    scene: &'a str,
    sensor: &'a str,
    unit: &'static str,
    bands: &'a [String],
    #[serde(flatten)]
    outcome: SensitivityOutcome,
    provenance: Provenance,
}

pub fn run(arguments: &Arguments, asked: &Sensitivity, command: Vec<String>) -> Result<(), Failure> {
    let method = asked.method.solver()?;
    let chosen = choose(&asked.scene, |_, n| memory::to_solve(&*method, n))?;
    let sensor = sensor(&chosen.scene, &asked.sensor)?;
    if let Some(path) = &asked.output {
        output::check_file(path)?;
    }

    let bars = Bars::new(arguments);
    let exchange = asked.scene.exchange();
    let (bundles, system) = chosen.assemble(arguments, exchange, &bars)?;
    bars.progress("solve", 0.0);
    let outcome = sensitivity(&chosen.scene, &bundles, &system, sensor, &*method)?;
    bars.progress("solve", 1.0);
    drop(bars);

    let settings =
        [("solver", method.name().to_string()), ("solver_tolerance", format!("{:e}", asked.method.tolerance))];
    let unit = match sensor.quantity {
        Quantity::Radiance => "W m⁻² sr⁻¹",
        Quantity::Irradiance => "W m⁻²",
    };
    let record = Record {
        schema: "etendue.sensitivity/1",
        scene: chosen.scene.name(),
        sensor: &asked.sensor,
        unit,
        bands: chosen.scene.bands(),
        outcome,
        provenance: provenance(&chosen, command, &exchange, settings),
    };
    let text = serde_json::to_string(&record).map_err(|e| Failure::new(Exit::Internal, e.to_string()))? + "\n";
    if let Some(path) = &asked.output {
        output::write_file(path, text.as_bytes())?;
    }
    output::print(&if arguments.json { text } else { table(&record) })
}

/// Understands `irradiance:NAME` and `radiance:NAME`.
fn sensor(scene: &Scene, text: &str) -> Result<Sensor, Failure> {
    let names = || scene.surfaces().iter().map(|surface| surface.name.as_str());
    let wrong = |found: &str, expected: &str| {
        Failure::new(Exit::Input, format!("--sensor {text}: {found}\n  = expected: {expected}"))
    };
    let (quantity, name) = text.split_once(':').unwrap_or(("irradiance", text));
    let quantity = match quantity {
        "radiance" => Quantity::Radiance,
        "irradiance" => Quantity::Irradiance,
        other => return Err(wrong(&format!("'{other}' is no quantity"), "irradiance:SURFACE or radiance:SURFACE")),
    };
    let surface = names().position(|surface| surface == name).ok_or_else(|| {
        let list = names().map(|name| format!("'{name}'")).collect::<Vec<_>>().join(", ");
        wrong(&format!("there is no surface '{name}'"), &format!("one of {list}"))
    })?;
    Ok(Sensor { quantity, surface })
}

/// Derivatives by surface, side by side.
fn table(record: &Record) -> String {
    let Record { sensor, unit, bands, outcome, .. } = record;
    let width = outcome.surfaces.iter().map(|s| s.surface.chars().count()).chain([7]).max().unwrap_or(7);
    let columns = 12 * bands.len();
    let numbers = |values: &[f64]| values.iter().map(|v| format!("{v:>12.4e}")).collect::<String>();
    let heads: String = bands.iter().map(|band| format!("{band:>12}")).collect();
    let mut text = format!("{sensor}, {unit}\n{:width$}{}\n\n", "reading", numbers(&outcome.reading));
    text += &format!("{:width$}{:>columns$}  {:>columns$}\n", "", "d reading / d albedo", "d reading / d emission");
    text += &format!("{:width$}{heads}  {heads}\n", "surface");
    for surface in &outcome.surfaces {
        let (albedo, emission) = (numbers(&surface.albedo), numbers(&surface.emission));
        text += &format!("{:width$}{albedo}  {emission}\n", surface.surface);
    }
    let gaps =
        outcome.reading.iter().zip(&outcome.dual_reading).map(|(a, b)| (a - b).abs() / a.abs().max(f64::MIN_POSITIVE));
    let gap = gaps.fold(0.0, f64::max);
    let [forward, adjoint] = outcome.products;
    text + &format!(
        "\n⟨W, L⟩ and ⟨E, J⟩ differ by {gap:.1e} (relative); {forward} products with K, {adjoint} with K*\n"
    )
}
