//! From an outcome to all files of its report.

use super::figure::{
    Sheet, albedos, convergence, monte_carlo, refinement, sequential, spectrum, to_png, to_svg, truncation,
};
use super::page::{FigureOnPage, FiguresOnPage, page};
use super::picture::pictures;
use super::{Artifact, ReportError, SCHEMA, data};
use crate::study::{SpectrumOutcome, StudyOutcome};
use serde::Serialize;

/// `report.json`: the outcome, the version of its layout, and the names of the files beside it.
#[derive(Serialize)]
struct Document<'a> {
    schema: &'static str,
    #[serde(flatten)]
    outcome: &'a StudyOutcome,
    files: Vec<&'a str>,
}

/// All files of the report: `report.html` (self-contained), `report.json`, every figure as SVG, PNG and the CSV of its
/// numbers, the tables as CSV, and the pictures as float32 EXR and as PNG.
///
/// Pure: nothing is written, and equal outcomes give equal bytes. Numbers that are missing, NaN, zero or infinite are
/// shown as such. Errors: a picture whose values do not fill its shape, or one that has no pixels.
pub fn render(outcome: &StudyOutcome) -> Result<Vec<Artifact>, ReportError> {
    // Draw the figures, and write the numbers behind each.
    let mut files = Vec::new();
    let convergence =
        draw(&mut files, "convergence", convergence(&outcome.solvers), data::convergence(&outcome.solvers))?;
    let truncation =
        draw(&mut files, "truncation", truncation(&outcome.truncation), data::truncation(&outcome.truncation))?;
    let monte_carlo =
        draw(&mut files, "monte-carlo", monte_carlo(&outcome.estimators), data::monte_carlo(&outcome.estimators))?;
    let refinement =
        draw(&mut files, "refinement", refinement(&outcome.refinement), data::refinement(&outcome.refinement))?;

    let albedos = match &outcome.albedos {
        Some(study) => Some(draw(&mut files, "albedos", albedos(study), data::albedos(study))?),
        None => None,
    };

    let sequential = match &outcome.sequential {
        Some(run) => Some(draw(&mut files, "sequential", sequential(run), data::sequential(run))?),
        None => None,
    };

    // Write the tables.
    files.push(Artifact { name: "solvers.csv".into(), bytes: data::solvers(&outcome.solvers) });
    files.push(Artifact { name: "estimators.csv".into(), bytes: data::estimators(&outcome.estimators) });
    files.push(Artifact { name: "surfaces.csv".into(), bytes: data::surfaces(&outcome.refinement) });

    // Encode the pictures.
    let mut shown = None;
    if let Some(taken) = &outcome.pictures {
        let (on_page, encoded) = pictures(taken)?;
        shown = Some(on_page);
        files.extend(encoded);
    }

    // Compose the page, and list everything in report.json.
    let figures = FiguresOnPage { convergence, albedos, truncation, monte_carlo, sequential, refinement };
    let html = page(outcome, &figures, shown.as_ref(), &files);
    files.insert(0, Artifact { name: "report.html".into(), bytes: html.into_bytes() });
    let names = files.iter().map(|file| file.name.as_str()).collect();
    let json = serde_json::to_vec_pretty(&Document { schema: SCHEMA, outcome, files: names })?;
    files.insert(1, Artifact { name: "report.json".into(), bytes: json });
    Ok(files)
}

/// The figure of a spectrum as SVG, PNG and the CSV of its numbers.
pub fn spectrum_files(outcome: &SpectrumOutcome) -> Result<Vec<Artifact>, ReportError> {
    let mut files = Vec::new();
    draw(&mut files, "spectrum", spectrum(&outcome.bands), data::spectrum(&outcome.bands))?;
    Ok(files)
}

/// One figure as files, and as the page shows it.
fn draw(
    files: &mut Vec<Artifact>,
    name: &'static str,
    sheet: Sheet,
    csv: Vec<u8>,
) -> Result<FigureOnPage, ReportError> {
    let svg = to_svg(&sheet)?;
    files.push(Artifact { name: format!("{name}.svg"), bytes: svg.clone().into_bytes() });
    files.push(Artifact { name: format!("{name}.png"), bytes: to_png(&sheet)? });
    files.push(Artifact { name: format!("{name}.csv"), bytes: csv });
    Ok(FigureOnPage { name, svg })
}
