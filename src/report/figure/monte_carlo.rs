//! How fast each random method closes in, beside what its own error bars promise and the central limit theorem demands.

use super::axis::Axis;
use super::paint::text_width;
use super::palette::look;
use super::panel::{NORMAL, Panel, SMALL, spread};
use super::sheet::{Anchor, GREY, INK, Sheet, Stroke};
use crate::report::number::significant;
use crate::study::{EstimatorRun, SamplePoint};

const WIDTH: u32 = 860;
const HEIGHT: u32 = 450;

/// An error this many times its predicted statistical part has levelled off.
const LEVELLED: f64 = 1.5;

/// Measured error (markers) beside the predicted standard error (lines) of every estimator, against samples a bundle.
pub fn monte_carlo(estimators: &[EstimatorRun]) -> Sheet {
    let mut sheet = Sheet::new(WIDTH, HEIGHT);
    let points = || estimators.iter().flat_map(|run| &run.points);
    let reference = reference_line(estimators);
    let names = estimators.iter().map(|run| 1.13 * text_width(&run.estimator, NORMAL)).fold(96.0, f64::max).min(190.0);
    let panel = Panel {
        left: 56.0,
        top: 48.0,
        right: f64::from(WIDTH) - names - 28.0,
        bottom: f64::from(HEIGHT) - 50.0,
        x: Axis::log_tight(points().map(|p| p.samples_per_bundle as f64)),
        y: Axis::log_tight(
            points().flat_map(|p| [p.error, p.standard_error]).chain(reference.map(|line| 0.85 * line[1].1)),
        ),
    };
    panel.draw_axes(&mut sheet, "samples per bundle", "Error against the discrete solution", true);
    if points().next().is_none() {
        panel.note_empty(&mut sheet, "no estimator was run");
        return sheet;
    }

    // A run is a predicted and a measured line; samples none of which scored predict nothing.
    let predicted = |run: &EstimatorRun| {
        let known = |e: f64| if e > 0.0 { e } else { f64::NAN };
        run.points.iter().map(|p| (p.samples_per_bundle as f64, known(p.standard_error))).collect::<Vec<_>>()
    };
    let measured =
        |run: &EstimatorRun| run.points.iter().map(|p| (p.samples_per_bundle as f64, p.error)).collect::<Vec<_>>();

    // Show what N^(−1/2) looks like, below everything measured.
    if let Some(line) = reference {
        panel.line(&mut sheet, line, Stroke::solid(GREY, 1.0));
        if let Some((x, y)) = panel.place((line[0].0 * line[1].0).sqrt(), (line[0].1 * line[1].1).sqrt()) {
            sheet.words((x - 8.0, y + 12.0), "slope −½", SMALL, GREY, Anchor::End);
        }
    }

    // Show where a continuous estimator levels off: what the patches cannot resolve.
    for (i, run) in estimators.iter().enumerate() {
        let Some(level) = discretisation(run) else { continue };
        let (low, high) = panel.x.ends();
        panel.line(&mut sheet, [(low, level), (high, level)], Stroke::dashed(look(i).colour, 1.0, (1.5, 3.0)));
        if let Some((x, y)) = panel.place(low, level) {
            let text = format!("discretisation error, {}", significant(level, 2));
            sheet.words((x + 8.0, y - 10.0), text, SMALL, look(i).colour, Anchor::Start);
        }
        panel.line(&mut sheet, measured(run), Stroke::solid(look(i).colour, 0.75));
    }

    // Draw the promise as a line and the measurement as markers.
    for (i, run) in estimators.iter().enumerate() {
        panel.line(&mut sheet, predicted(run), look(i).stroke());
    }
    let mut clipped = false;
    for (i, run) in estimators.iter().enumerate() {
        clipped |= panel.markers(&mut sheet, &measured(run), look(i), 0.0);
    }
    if clipped {
        panel.note_clipped(&mut sheet);
    }

    // Name each where its measurements end.
    let last = |run: &EstimatorRun| measured(run).into_iter().rev().find_map(|(x, y)| panel.place(x, y));
    let ends: Vec<(usize, (f64, f64))> =
        estimators.iter().enumerate().filter_map(|(i, run)| Some((i, last(run)?))).collect();
    let wanted: Vec<f64> = ends.iter().map(|(_, end)| end.1).collect();
    let heights = spread(&wanted, 34.0, panel.top, panel.bottom - 26.0);
    for ((i, end), height) in ends.into_iter().zip(heights) {
        let (run, look) = (&estimators[i], look(i));
        sheet.line(vec![(end.0 + 6.0, end.1), (panel.right + 10.0, height)], Stroke::solid(look.colour, 0.75));
        sheet.bold_words((panel.right + 14.0, height), run.estimator.as_str(), NORMAL, look.colour, Anchor::Start);
        sheet.words((panel.right + 14.0, height + 15.0), format!("{} truth", run.truth), SMALL, GREY, Anchor::Start);
    }
    draw_key(&mut sheet, panel.right, panel.top - 19.0);
    sheet
}

/// Tells markers from lines, above the panel where no data is.
fn draw_key(sheet: &mut Sheet, right: f64, y: f64) {
    let promise = "predicted by its own standard error";
    let x = right - text_width(promise, SMALL);
    sheet.words((x, y), promise, SMALL, INK, Anchor::Start);
    sheet.line(vec![(x - 28.0, y), (x - 7.0, y)], Stroke::solid(INK, 1.75));
    let x = x - 42.0 - text_width("measured", SMALL);
    sheet.words((x, y), "measured", SMALL, INK, Anchor::Start);
    sheet.dot((x - 10.0, y), 3.75, INK);
}

/// The part of the last measured error that its standard error does not explain, where that is most of it and the run
/// estimates another truth than the discrete one.
fn discretisation(run: &EstimatorRun) -> Option<f64> {
    let SamplePoint { error, standard_error, .. } = *run.points.last()?;
    let levelled = error.is_finite() && standard_error >= 0.0 && error > LEVELLED * standard_error;
    (levelled && run.truth == "continuous").then(|| (error.powi(2) - standard_error.powi(2)).sqrt())
}

/// Two points of a line of slope −1/2 through all sample counts, at 0.6 times the lowest that anything comes to it.
fn reference_line(estimators: &[EstimatorRun]) -> Option<[(f64, f64); 2]> {
    let points = || estimators.iter().flat_map(|run| &run.points).filter(|p| p.samples_per_bundle > 0);
    let samples = || points().map(|p| p.samples_per_bundle as f64);
    let (first, last) = (samples().fold(f64::INFINITY, f64::min), samples().fold(0.0, f64::max));
    let scale = points()
        .flat_map(|p| [p.error, p.standard_error].map(|e| e * (p.samples_per_bundle as f64).sqrt()))
        .filter(|s| s.is_finite() && *s > 1e-17)
        .fold(f64::INFINITY, f64::min);
    (last > first && scale.is_finite()).then(|| [first, last].map(|n| (n, 0.6 * scale / n.sqrt())))
}
