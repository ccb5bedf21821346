//! How fast each iterative solver closes in: true error and residual against work, side by side on one scale.

use super::axis::Axis;
use super::paint::text_width;
use super::palette::look;
use super::panel::{NORMAL, Panel, SMALL};
use super::sheet::{Anchor, GREY, INK, Sheet};
use crate::report::number::products;
use crate::study::{HistoryPoint, SolverRun};

const WIDTH: u32 = 900;
const HEIGHT: u32 = 430;
const LEFT: f64 = 52.0;
const TOP: f64 = 48.0;
const FOOT: f64 = 50.0;
const BETWEEN: f64 = 26.0;

/// Where the largest work exceeds the smallest by this, products are drawn on a logarithmic axis.
const LOGARITHMIC_FROM: f64 = 12.0;

/// Error (left) and residual (right) of every solver with a history, against products with K.
pub fn convergence(solvers: &[SolverRun]) -> Sheet {
    let mut sheet = Sheet::new(WIDTH, HEIGHT);
    let runs: Vec<&SolverRun> = solvers.iter().filter(|run| !run.history.is_empty()).collect();
    let points = || runs.iter().flat_map(|run| &run.history);

    // Share both axes between the two panels.
    let x = products_axis(&runs);
    let y = Axis::log_decades(points().flat_map(|p| [p.error, p.residual]));
    let names = runs.iter().map(|run| text_width(&run.solver, NORMAL)).fold(60.0, f64::max);
    let key = f64::from(WIDTH) - names.min(170.0) - 44.0;
    let panel_width = 0.5 * (key - 18.0 - LEFT - BETWEEN);
    let panel = |left: f64| Panel {
        left,
        top: TOP,
        right: left + panel_width,
        bottom: f64::from(HEIGHT) - FOOT,
        x: x.clone(),
        y: y.clone(),
    };

    // Draw every solver into both.
    let (errors, residuals) = (panel(LEFT), panel(LEFT + panel_width + BETWEEN));
    draw(&mut sheet, &errors, &runs, "Error against the direct solution", true, |p| p.error);
    draw(&mut sheet, &residuals, &runs, "Residual", false, |p| p.residual);

    // Name them at the right, the quickest first.
    let mut order: Vec<usize> = (0..runs.len()).collect();
    order.sort_by(|a, b| work(runs[*a]).total_cmp(&work(runs[*b])));
    let step = (f64::from(HEIGHT) - FOOT - TOP) / (order.len().max(1) as f64);
    let step = step.min(40.0);
    for (row, i) in order.into_iter().enumerate() {
        let y = TOP + 10.0 + step * row as f64;
        sheet.line(vec![(key, y), (key + 24.0, y)], look(i).stroke());
        look(i).marker(&mut sheet, (key + 12.0, y));
        sheet.words((key + 32.0, y), runs[i].solver.as_str(), NORMAL, INK, Anchor::Start);
        if step >= 28.0 {
            sheet.words(
                (key + 32.0, y + 14.0),
                format!("{} products", products(work(runs[i]))),
                SMALL,
                GREY,
                Anchor::Start,
            );
        }
    }
    sheet
}

fn draw(
    sheet: &mut Sheet,
    panel: &Panel,
    runs: &[&SolverRun],
    name: &str,
    y_labels: bool,
    value: impl Fn(&HistoryPoint) -> f64,
) {
    panel.draw_axes(sheet, "products with K", name, y_labels);
    if runs.is_empty() {
        panel.note_empty(sheet, "no iterative solver was run");
    }

    // Lines first, so that no line crosses a marker.
    let series = |run: &SolverRun| run.history.iter().map(|p| (p.products, value(p))).collect::<Vec<_>>();
    for (i, run) in runs.iter().enumerate() {
        panel.line(sheet, series(run), look(i).stroke());
    }
    let mut clipped = false;
    for (i, run) in runs.iter().enumerate() {
        clipped |= panel.markers(sheet, &series(run), look(i), i as f64 / runs.len() as f64);
    }
    if clipped {
        panel.note_clipped(sheet);
    }
}

/// Products at the end of a run.
fn work(run: &SolverRun) -> f64 {
    run.history.last().map_or(0.0, |p| p.products)
}

/// Linear while all runs take similar work; logarithmic, from one product on, where they differ by magnitudes.
fn products_axis(runs: &[&SolverRun]) -> Axis {
    let ends = || runs.iter().map(|run| work(run)).filter(|w| w.is_finite() && *w > 0.0);
    let (least, most) = (ends().fold(f64::INFINITY, f64::min), ends().fold(0.0, f64::max));
    if most > LOGARITHMIC_FROM * least { Axis::log_tight([1.0, most]) } else { Axis::linear_from_zero(ends()) }
}
