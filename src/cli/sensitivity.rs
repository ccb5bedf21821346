//! `etendue sensitivity`: what a sensor's reading hangs on.

use super::arguments::{Arguments, Sensitivity};
use super::exit::{Exit, Failure};
use super::memory;
use super::output;
use super::progress::Bars;
use super::provenance::provenance;
use super::scene::choose;
use crate::scene::Scene;
use crate::study::{
    Change, Property, Provenance, Quantity, SensitivityOutcome, Sensor, Watch, sensitivity_and_what_if,
};
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
    let has_changes = !asked.what_if.is_empty();
    let chosen = choose(&asked.scene, |scene, n| {
        // Factors a band; beside them the rows that change, their responses and the unit vectors that ask for these.
        let factors = if has_changes { 8 * scene.n_bands() as u64 + 24 } else { 0 };
        memory::to_solve(&*method, n).max(memory::with_square(n, factors))
    })?;
    let sensor = sensor(&chosen.scene, &asked.sensor)?;
    let changes = asked.what_if.iter().map(|text| change(&chosen.scene, text)).collect::<Result<Vec<_>, _>>()?;
    if let Some(path) = &asked.output {
        output::check_file(path)?;
    }

    let bars = Bars::new(arguments);
    let exchange = asked.scene.exchange();
    let (bundles, system) = chosen.assemble(arguments, exchange, &bars)?;
    bars.progress("solve", 0.0);
    let outcome = sensitivity_and_what_if(&chosen.scene, &bundles, &system, sensor, &*method, &changes)?;
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
    let wrong = |found: &str, expected: &str| {
        Failure::new(Exit::Input, format!("--sensor {text}: {found}\n  = expected: {expected}"))
    };
    let (quantity, name) = text.split_once(':').unwrap_or(("irradiance", text));
    let quantity = match quantity {
        "radiance" => Quantity::Radiance,
        "irradiance" => Quantity::Irradiance,
        other => return Err(wrong(&format!("'{other}' is no quantity"), "irradiance:SURFACE or radiance:SURFACE")),
    };
    let surface = surface(scene, name).map_err(|list| wrong(&format!("there is no surface '{name}'"), &list))?;
    Ok(Sensor { quantity, surface })
}

/// Understands `NAME.albedo=VALUES` and `NAME.emission=VALUES`, one value or one a band.
fn change(scene: &Scene, text: &str) -> Result<Change, Failure> {
    let wrong = |found: String, expected: &str| {
        Failure::new(Exit::Input, format!("--what-if {text}: {found}\n  = expected: {expected}"))
    };
    const FORM: &str = "SURFACE.albedo=VALUE or SURFACE.emission=VALUE";
    let parts = text.rsplit_once('=').and_then(|(place, values)| Some((place.rsplit_once('.')?, values)));
    let ((name, property), values) = parts.ok_or_else(|| wrong("this is no change of a surface".to_string(), FORM))?;
    let surface = surface(scene, name).map_err(|list| wrong(format!("there is no surface '{name}'"), &list))?;
    let (property, range, expected) = match property {
        "albedo" => (Property::Albedo, 0.0..=1.0, "albedos from 0 to 1"),
        "emission" => (Property::Emission, 0.0..=f64::MAX, "finite radiances, 0 or more"),
        other => return Err(wrong(format!("'{other}' is no property of a surface"), FORM)),
    };
    let value = |word: &str| match word.trim().parse::<f64>() {
        Ok(value) if range.contains(&value) => Ok(value),
        _ => Err(wrong(format!("'{word}' is out of range"), expected)),
    };
    let mut values = values.split(',').map(value).collect::<Result<Vec<f64>, _>>()?;
    let n_bands = scene.n_bands();
    if values.len() == 1 {
        values = vec![values[0]; n_bands];
    }
    if values.len() != n_bands {
        let expected = format!("one value, or one for each of {}", scene.bands().join(", "));
        return Err(wrong(format!("there are {} values", values.len()), &expected));
    }
    Ok(Change { name: text.to_string(), surface, property, values })
}

/// The number of the surface of this name, or the names that there are.
fn surface(scene: &Scene, name: &str) -> Result<usize, String> {
    let names = || scene.surfaces().iter().map(|surface| surface.name.as_str());
    let list = || names().map(|name| format!("'{name}'")).collect::<Vec<_>>().join(", ");
    names().position(|surface| surface == name).ok_or_else(|| format!("one of {}", list()))
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
    // What if, beside what the derivatives foretold.
    let label = outcome.what_ifs.iter().map(|what| what.change.chars().count()).chain([7]).max().unwrap_or(7);
    if !outcome.what_ifs.is_empty() {
        text += &format!("\n{:label$}{:16}{heads}\n", "what if", "");
    }
    for what in &outcome.what_ifs {
        let rows = [
            (what.change.as_str(), "exactly", Some(&what.reading)),
            ("", "first order", Some(&what.first_order)),
            ("", "solved afresh", what.fresh.as_ref()),
        ];
        for (name, way, values) in rows {
            let Some(values) = values else { continue };
            text += &format!("{name:label$}  {way:14}{}\n", numbers(values));
        }
    }
    let gaps =
        outcome.reading.iter().zip(&outcome.dual_reading).map(|(a, b)| (a - b).abs() / a.abs().max(f64::MIN_POSITIVE));
    let gap = gaps.fold(0.0, f64::max);
    let [forward, adjoint] = outcome.products;
    text + &format!(
        "\n⟨W, L⟩ and ⟨E, J⟩ differ by {gap:.1e} (relative); {forward} products with K, {adjoint} with K*\n"
    )
}
