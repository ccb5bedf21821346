//! How fast each iterative solver closes in: its true error against work and against time, beside what the spectrum foretold.

use super::axis::Axis;
use super::families::{Group, groups};
use super::paint::text_width;
use super::palette::look;
use super::panel::{NORMAL, Panel, SMALL};
use super::sheet::{Anchor, GREY, INK, Sheet, Stroke};
use crate::report::number::{products, seconds};
use crate::study::{HistoryPoint, SolverRun};

const WIDTH: u32 = 920;
const LEFT: f64 = 52.0;
const TOP: f64 = 58.0;
const FOOT: f64 = 50.0;
const BETWEEN: f64 = 26.0;

/// Height of a panel, alone and where there are several.
const HEIGHTS: (f64, f64) = (330.0, 236.0);

/// From the foot of one panel to the top of the next.
const ROW_GAP: f64 = 88.0;

/// Where the largest work exceeds the smallest by this, products are drawn on a logarithmic axis.
const LOGARITHMIC_FROM: f64 = 12.0;

/// Steps of a clock that are worth drawing.
const SHORTEST: f64 = 1e-5;

/// Methods of other panels, for comparison.
const CONTEXT: Stroke = Stroke { colour: (214, 214, 210), width: 1.0, dash: None };

/// Error of every solver with a history, against products with K (left) and seconds (right); a row of panels a family where there are
/// many.
pub fn convergence(solvers: &[SolverRun]) -> Sheet {
    let runs: Vec<&SolverRun> = solvers.iter().filter(|run| !run.history.is_empty()).collect();
    let rows = groups(runs.iter().copied());
    let height = if rows.len() > 1 { HEIGHTS.1 } else { HEIGHTS.0 };
    let total = TOP + rows.len() as f64 * height + (rows.len() - 1) as f64 * ROW_GAP + FOOT;
    let mut sheet = Sheet::new(WIDTH, total.ceil() as u32);

    // Share the axes between all panels.
    let points = || runs.iter().flat_map(|run| &run.history);
    let y = Axis::log_decades(points().map(|p| p.error));
    let axes = [products_axis(&runs), seconds_axis(&runs)];
    let wide = |run: &&SolverRun| text_width(&run.solver, NORMAL).max(text_width(&took(run), SMALL));
    let names = runs.iter().map(wide).fold(60.0, f64::max);
    let key = f64::from(WIDTH) - names.min(190.0) - 40.0;
    let width = 0.5 * (key - 18.0 - LEFT - BETWEEN);

    for (row, group) in rows.iter().enumerate() {
        let top = TOP + row as f64 * (height + ROW_GAP);
        for (column, x) in axes.iter().enumerate() {
            let left = LEFT + column as f64 * (width + BETWEEN);
            let panel = Panel { left, top, right: left + width, bottom: top + height, x: x.clone(), y: y.clone() };
            draw(&mut sheet, &panel, &runs, group, column == 0);
        }
        draw_key(&mut sheet, &runs, group, (key, top), height);
    }
    if points().any(|p| p.predicted.is_some()) {
        note_predictions(&mut sheet, key - 18.0);
    }
    sheet
}

/// One group's methods in colour, all others behind them in grey.
fn draw(sheet: &mut Sheet, panel: &Panel, runs: &[&SolverRun], group: &Group, by_products: bool) {
    let what = if by_products { "error against products" } else { "error against time" };
    let title = if group.title.is_empty() { capitalised(what) } else { format!("{}: {what}", group.title) };
    panel.draw_axes(sheet, if by_products { "products with K" } else { "seconds" }, &title, by_products);
    if runs.is_empty() {
        panel.note_empty(sheet, "no iterative solver was run");
    }
    let abscissa = |p: &HistoryPoint| if by_products { p.products } else { p.seconds };
    let series = |run: &SolverRun| run.history.iter().map(|p| (abscissa(p), p.error)).collect::<Vec<_>>();
    for (_, run) in runs.iter().enumerate().filter(|(i, _)| !group.members.contains(i)) {
        panel.line(sheet, series(run), CONTEXT);
    }

    // What was foretold lies below what was measured, and no line crosses a marker.
    for (k, i) in group.members.iter().enumerate() {
        let foretold = runs[*i].history.iter().map(|p| (abscissa(p), p.predicted.unwrap_or(f64::NAN)));
        // Where rounding ends the measured curve, the other has nothing to be held against.
        let foot = panel.y.ends().0;
        let foretold = foretold.map(|(x, y)| (x, if y < foot { f64::NAN } else { y }));
        panel.line(sheet, foretold, Stroke::dashed(look(k).colour, 1.0, (2.5, 2.5)));
    }
    for (k, i) in group.members.iter().enumerate() {
        panel.line(sheet, series(runs[*i]), look(k).stroke());
    }
    let mut clipped = false;
    for (k, i) in group.members.iter().enumerate() {
        clipped |= panel.markers(sheet, &series(runs[*i]), look(k), k as f64 / group.members.len() as f64);
    }
    if clipped {
        panel.note_clipped(sheet);
    }
}

/// The methods of a group, the quickest first, with what they took where there is room for it.
fn draw_key(sheet: &mut Sheet, runs: &[&SolverRun], group: &Group, (key, top): (f64, f64), height: f64) {
    let mut order: Vec<usize> = (0..group.members.len()).collect();
    let run = |k: usize| runs[group.members[k]];
    order.sort_by(|a, b| work(run(*a)).total_cmp(&work(run(*b))));
    let step = (height / order.len().max(1) as f64).min(40.0);
    for (row, k) in order.into_iter().enumerate() {
        let y = top + 10.0 + step * row as f64;
        sheet.line(vec![(key, y), (key + 24.0, y)], look(k).stroke());
        look(k).marker(sheet, (key + 12.0, y));
        sheet.words((key + 32.0, y), run(k).solver.as_str(), NORMAL, INK, Anchor::Start);
        if step >= 28.0 {
            sheet.words((key + 32.0, y + 14.0), took(run(k)), SMALL, GREY, Anchor::Start);
        }
    }
}

/// Says once, above the right panel, what thin dashes are.
fn note_predictions(sheet: &mut Sheet, right: f64) {
    let text = "foretold by the spectrum of K";
    let x = right - text_width(text, SMALL);
    sheet.words((x, 14.0), text, SMALL, GREY, Anchor::Start);
    sheet.line(vec![(x - 30.0, 14.0), (x - 7.0, 14.0)], Stroke::dashed(GREY, 1.0, (2.5, 2.5)));
}

/// Products at the end of a run.
fn work(run: &SolverRun) -> f64 {
    run.history.last().map_or(0.0, |p| p.products)
}

fn took(run: &SolverRun) -> String {
    format!("{} products, {}", products(work(run)), seconds(run.seconds))
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

/// Linear while all runs take similar work; logarithmic, from one product on, where they differ by magnitudes.
fn products_axis(runs: &[&SolverRun]) -> Axis {
    let ends = || runs.iter().map(|run| work(run)).filter(|w| w.is_finite() && *w > 0.0);
    let (least, most) = (ends().fold(f64::INFINITY, f64::min), ends().fold(0.0, f64::max));
    if most > LOGARITHMIC_FROM * least { Axis::log_tight([1.0, most]) } else { Axis::linear_from_zero(ends()) }
}

/// Logarithmic, from the first look at any solver to the last.
fn seconds_axis(runs: &[&SolverRun]) -> Axis {
    let ends = runs.iter().flat_map(|run| [run.history.first(), run.history.last()]).flatten();
    Axis::log_tight(ends.map(|p| p.seconds.max(SHORTEST)))
}
