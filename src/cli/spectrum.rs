//! `etendue spectrum`: how fast light dies away.

use super::arguments::{Arguments, Spectrum};
use super::exit::Failure;
use super::memory;
use super::output;
use super::progress::Bars;
use super::provenance::provenance;
use super::scene::choose;
use crate::report::{check_folder, spectrum_files};
use crate::study::{Provenance, SpectrumOutcome, Watch, spectrum};
use serde::Serialize;
use std::path::PathBuf;

/// What `spectrum --json` prints.
#[derive(Serialize)]
pub struct Record<'a> {
    schema: &'static str,
    scene: &'a str,
    #[serde(flatten)]
    outcome: &'a SpectrumOutcome,
    files: Vec<String>,
    provenance: Provenance,
}

pub fn run(arguments: &Arguments, asked: &Spectrum, command: Vec<String>) -> Result<(), Failure> {
    // The matrix in full and its decompositions, where it is small enough for them.
    let chosen = choose(&asked.scene, |_, n| memory::with_square(n, 24))?;
    let name = chosen.scene.name();
    let folder = asked.output.clone().unwrap_or_else(|| PathBuf::from("out").join(format!("{name}-spectrum")));
    output::check_folder(&folder)?;
    check_folder(&folder)?;

    let bars = Bars::new(arguments);
    let exchange = asked.scene.exchange();
    let (_, system) = chosen.assemble(arguments, exchange, &bars)?;
    let outcome = spectrum(&system, chosen.scene.bands(), asked.pairs, asked.tolerance, &|done| {
        bars.progress("spectrum", done);
    })?;
    drop(bars);

    let files = spectrum_files(&outcome)?;
    let settings = [("eigenpairs", asked.pairs.to_string()), ("eigen_tolerance", format!("{:e}", asked.tolerance))];
    let record = Record {
        schema: "etendue.spectrum/1",
        scene: name,
        outcome: &outcome,
        files: output::report_names(&files),
        provenance: provenance(&chosen, command, &exchange, settings),
    };
    let text = output::write_report(&folder, files, &record)?;
    if arguments.json {
        return output::print(&text);
    }
    output::print(&format!("{}\n{}\n", table(&outcome), folder.join("spectrum.svg").display()))
}

fn table(outcome: &SpectrumOutcome) -> String {
    let mut text = String::new();
    for band in &outcome.bands {
        let [low, high] = band.radius;
        let middle = 0.5 * (low + high);
        text += &format!("{}\n  spectral radius   {middle:.12} ± {:.1e}\n", band.band, 0.5 * (high - low));
        let eigenvalues = band.eigenvalues.iter().map(|[re, im]| match im {
            0.0 => format!("{re:.6}"),
            im => format!("{re:.6}{im:+.6}i"),
        });
        text += &format!("  eigenvalues       {}\n", eigenvalues.collect::<Vec<_>>().join("  "));
        let singular = band.singular_values.iter().map(|value| format!("{value:.6}"));
        text += &format!("  singular values   {}\n", singular.collect::<Vec<_>>().join("  "));
        if let Some(condition) = band.condition {
            text += &format!("  condition of I−K  {condition:.4}\n");
        }
        if let Some(ranks) = &band.effective_rank {
            let ranks = ranks.iter().map(|rank| format!("{} at {:.0e}", rank.count, rank.tolerance));
            let ranks = ranks.collect::<Vec<_>>().join(", ");
            text += &format!("  effective rank    {ranks}, of {}\n", outcome.n_bundles);
        }
        let shown = |n: Option<usize>| n.map_or("–".to_string(), |n| n.to_string());
        let bounces = band.bounces.iter().map(|b| {
            format!("{} (by absorption {}) for {:.0e}", shown(b.by_spectrum), shown(b.by_absorption), b.tolerance)
        });
        text += &format!("  bounces enough    {}\n", bounces.collect::<Vec<_>>().join(", "));
    }
    text + &format!("\n{} products with K or K*\n", outcome.products)
}
