//! How fast each random method closes in, by samples and by the clock, beside what was foretold and what the central limit theorem demands.

use super::axis::Axis;
use super::paint::text_width;
use super::palette::look;
use super::panel::{NORMAL, Panel, SMALL, spread};
use super::sheet::{Anchor, Colour, GREY, INK, Sheet, Stroke};
use crate::report::number::{seconds, significant};
use crate::study::{Approach, EstimatorRun, SamplePoint};

const WIDTH: u32 = 980;
const LEFT: f64 = 56.0;
const TOP: f64 = 62.0;
const FOOT: f64 = 56.0;
const BETWEEN: f64 = 30.0;

/// Height of a panel, alone and where there are several.
const HEIGHTS: (f64, f64) = (340.0, 236.0);

/// From the foot of one panel to the top of the next.
const ROW_GAP: f64 = 92.0;

/// More methods than this are told apart by nobody.
const TOGETHER: usize = 5;

/// An error this many times its predicted statistical part has levelled off.
const LEVELLED: f64 = 1.5;

/// Errors below this are what rounding leaves of no variance at all, and no axis reaches down to them.
const NO_VARIANCE: f64 = 1e-10;

/// Methods of other panels, for comparison.
const CONTEXT: Stroke = Stroke { colour: (214, 214, 210), width: 1.0, dash: None };

/// Methods that share a row of panels, by their places in the list.
struct Group {
    title: &'static str,
    members: Vec<usize>,
}

/// Measured error (markers) beside the standard error foretold or measured (lines) of every estimator, against samples a bundle (left) and
/// seconds (right); a row of panels an approach where there are many.
pub fn monte_carlo(estimators: &[EstimatorRun]) -> Sheet {
    let rows = groups(estimators);
    let height = if rows.len() > 1 { HEIGHTS.1 } else { HEIGHTS.0 };
    let total = TOP + rows.len() as f64 * height + (rows.len() - 1) as f64 * ROW_GAP + FOOT;
    let mut sheet = Sheet::new(WIDTH, total.ceil() as u32);

    // Share the axes between all panels.
    let reference = reference_line(estimators);
    let points = || estimators.iter().filter(|run| !is_exact(run)).flat_map(|run| &run.points);
    let errors = points().flat_map(|p| [p.error, promise(p)]).chain(reference.map(|line| 0.85 * line[1].1));
    let y = Axis::log_tight(errors);
    let axes = [
        Axis::log_tight(points().map(|p| p.samples_per_bundle as f64)),
        Axis::log_tight(points().map(|p| p.seconds).filter(|s| *s > 1e-6)),
    ];
    let wide = |run: &EstimatorRun| (1.13 * text_width(&run.estimator, NORMAL)).max(text_width(&detail(run), SMALL));
    let names = estimators.iter().map(wide).fold(96.0, f64::max).min(210.0);
    let right = f64::from(WIDTH) - names - 38.0;
    let width = 0.5 * (right - LEFT - BETWEEN);

    for (row, group) in rows.iter().enumerate() {
        let top = TOP + row as f64 * (height + ROW_GAP);
        let panel = |column: usize| {
            let left = LEFT + column as f64 * (width + BETWEEN);
            Panel { left, top, right: left + width, bottom: top + height, x: axes[column].clone(), y: y.clone() }
        };
        let [by_samples, by_seconds] = [panel(0), panel(1)];
        draw(&mut sheet, &by_samples, estimators, group, true);
        draw(&mut sheet, &by_seconds, estimators, group, false);
        if let Some(line) = reference {
            show_reference(&mut sheet, &by_samples, line);
        }
        name_members(&mut sheet, &by_seconds, estimators, group);
        note_exact(&mut sheet, &by_samples, estimators, group);
    }
    draw_key(&mut sheet, right);
    sheet
}

/// All runs together while they are few, else by approach.
fn groups(runs: &[EstimatorRun]) -> Vec<Group> {
    if runs.len() <= TOGETHER {
        return vec![Group { title: "", members: (0..runs.len()).collect() }];
    }
    let of = |(approach, title): (Approach, &'static str)| Group {
        title,
        members: (0..runs.len()).filter(|i| runs[*i].approach == approach).collect(),
    };
    let all = [
        (Approach::Gathering, "Walks from the bundles"),
        (Approach::Shooting, "Particles from the lamps"),
        (Approach::Guided, "Even or guided walks"),
        (Approach::Paths, "Light paths in the scene"),
    ];
    all.into_iter().map(of).filter(|group| !group.members.is_empty()).collect()
}

/// One group in colour, all others behind it in grey.
fn draw(sheet: &mut Sheet, panel: &Panel, runs: &[EstimatorRun], group: &Group, by_samples: bool) {
    let what = if by_samples { "error by samples" } else { "error by time" };
    let title = if group.title.is_empty() { capitalised(what) } else { format!("{}: {what}", group.title) };
    panel.draw_axes(sheet, if by_samples { "samples per bundle" } else { "seconds" }, &title, by_samples);
    if runs.iter().all(|run| run.points.is_empty()) {
        panel.note_empty(sheet, "no estimator was run");
        return;
    }
    let abscissa = |p: &SamplePoint| if by_samples { p.samples_per_bundle as f64 } else { p.seconds };
    let series = |run: &EstimatorRun, value: &dyn Fn(&SamplePoint) -> f64| {
        run.points.iter().map(|p| (abscissa(p), value(p))).collect::<Vec<_>>()
    };
    for (_, run) in runs.iter().enumerate().filter(|(i, run)| !group.members.contains(i) && !is_exact(run)) {
        panel.line(sheet, series(run, &|p| p.error), CONTEXT);
    }

    // Show where continuous methods level off: what the patches cannot resolve.
    let members =
        || group.members.iter().enumerate().map(|(k, i)| (look(k), &runs[*i])).filter(|(_, run)| !is_exact(run));
    let level = members().filter_map(|(_, run)| discretisation(run)).fold(f64::INFINITY, f64::min);
    if level.is_finite() {
        let (low, high) = panel.x.ends();
        panel.line(sheet, [(low, level), (high, level)], Stroke::dashed(GREY, 1.0, (1.5, 3.0)));
        if let Some((x, y)) = panel.place(low, level).filter(|_| by_samples) {
            let text = format!("discretisation error, {}", significant(level, 2));
            sheet.words((x + 8.0, y + 11.0), text, SMALL, GREY, Anchor::Start);
        }
    }

    // Draw the promise as a line, foretold or measured, and the error as markers.
    for (look, run) in members() {
        let stroke = if run.points.iter().any(|p| p.predicted.is_some()) {
            look.stroke()
        } else {
            Stroke::dashed(look.colour, 1.25, (4.0, 3.0))
        };
        // Samples none of which scored promise nothing.
        let known = |e: f64| if e > 0.0 { e } else { f64::NAN };
        panel.line(sheet, series(run, &|p| known(promise(p))), stroke);
        if discretisation(run).is_some() {
            panel.line(sheet, series(run, &|p| p.error), Stroke::solid(look.colour, 0.75));
        }
    }
    let mut clipped = false;
    for (look, run) in members() {
        clipped |= panel.markers(sheet, &series(run, &|p| p.error), look, 0.0);
    }
    if clipped && by_samples {
        panel.note_clipped(sheet);
    }
}

/// Names each method of a group beside where its measurements end, and says what it came to.
fn name_members(sheet: &mut Sheet, panel: &Panel, runs: &[EstimatorRun], group: &Group) {
    let foot = panel.bottom - 14.0;
    let end = |run: &EstimatorRun| {
        run.points.iter().rev().find_map(|p| panel.place(p.seconds, p.error)).filter(|_| !is_exact(run))
    };
    let ends: Vec<_> = group.members.iter().map(|i| end(&runs[*i])).collect();
    let wanted: Vec<f64> = ends.iter().map(|end| end.map_or(foot, |end| end.1)).collect();
    let gap = ((foot - panel.top) / (wanted.len().max(2) - 1) as f64).min(34.0);
    let heights = spread(&wanted, gap, panel.top, foot);
    for (k, (i, height)) in group.members.iter().zip(heights).enumerate() {
        let (run, look) = (&runs[*i], look(k));
        let x = panel.right + 22.0;
        match ends[k] {
            Some(end) => {
                sheet.line(vec![(end.0 + 6.0, end.1), (x - 14.0, height)], Stroke::solid(look.colour, 0.6));
                look.marker(sheet, (x - 8.0, height));
            }
            None => sheet.words((x - 8.0, height), "–", NORMAL, GREY, Anchor::Middle),
        }
        sheet.bold_words((x + 2.0, height), run.estimator.as_str(), NORMAL, readable(look.colour), Anchor::Start);
        if gap >= 26.0 {
            sheet.words((x + 2.0, height + 14.0), detail(run), SMALL, GREY, Anchor::Start);
        }
    }
}

/// Says of methods without variance that they have none: their error is rounding, and would stretch every axis.
fn note_exact(sheet: &mut Sheet, panel: &Panel, runs: &[EstimatorRun], group: &Group) {
    let exact = group.members.iter().map(|i| &runs[*i]).filter(|run| is_exact(run));
    for (line, run) in exact.enumerate() {
        let error = run.points.iter().map(|p| p.error).fold(0.0, f64::max);
        let text = format!("{}: no variance, off by {} at any number", run.estimator, significant(error, 2));
        let at = (panel.right - 4.0, panel.top + 12.0 + 15.0 * line as f64);
        sheet.words(at, text, SMALL, GREY, Anchor::End);
    }
}

/// Shows what N^(−1/2) looks like, below everything measured.
fn show_reference(sheet: &mut Sheet, panel: &Panel, line: [(f64, f64); 2]) {
    panel.line(sheet, line, Stroke::solid(GREY, 1.0));
    if let Some((x, y)) = panel.place((line[0].0 * line[1].0).sqrt(), (line[0].1 * line[1].1).sqrt()) {
        sheet.words((x - 8.0, y + 12.0), "slope −½", SMALL, GREY, Anchor::End);
    }
}

/// Tells markers from lines, above the panels where no data is.
fn draw_key(sheet: &mut Sheet, right: f64) {
    let (y, mut x) = (16.0, right);
    for (text, dash) in [("its own standard error", Some((4.0, 3.0))), ("foretold by the variance of the walk", None)] {
        x -= text_width(text, SMALL);
        sheet.words((x, y), text, SMALL, INK, Anchor::Start);
        let stroke = Stroke { colour: INK, width: 1.5, dash };
        sheet.line(vec![(x - 30.0, y), (x - 7.0, y)], stroke);
        x -= 46.0;
    }
    x -= text_width("measured error", SMALL);
    sheet.words((x, y), "measured error", SMALL, INK, Anchor::Start);
    sheet.dot((x - 11.0, y), 3.75, INK);
}

/// The line under the markers: what was foretold, else what the samples say of themselves.
fn promise(point: &SamplePoint) -> f64 {
    point.predicted.unwrap_or(point.standard_error)
}

/// Whether nothing varies but the last digits.
fn is_exact(run: &EstimatorRun) -> bool {
    !run.points.is_empty() && run.points.iter().all(|p| p.error >= 0.0 && p.error < NO_VARIANCE)
}

/// What a method came to.
fn detail(run: &EstimatorRun) -> String {
    match (run.points.last(), &run.refusal) {
        (_, Some(_)) => "refused".into(),
        (None, None) => "no samples".into(),
        (Some(last), None) => format!("{} after {}", significant(last.error, 2), seconds(run.seconds)),
    }
}

/// Dark enough for words on white.
fn readable(colour: Colour) -> Colour {
    let darker = |c: u8| (f64::from(c) * 0.78) as u8;
    (darker(colour.0), darker(colour.1), darker(colour.2))
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
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
    let shown = || estimators.iter().filter(|run| !is_exact(run));
    let points = || shown().flat_map(|run| &run.points).filter(|p| p.samples_per_bundle > 0);
    let samples = || points().map(|p| p.samples_per_bundle as f64);
    let (first, last) = (samples().fold(f64::INFINITY, f64::min), samples().fold(0.0, f64::max));
    let scale = points()
        .flat_map(|p| [p.error, p.standard_error].map(|e| e * (p.samples_per_bundle as f64).sqrt()))
        .filter(|s| s.is_finite() && *s > 1e-17)
        .fold(f64::INFINITY, f64::min);
    (last > first && scale.is_finite()).then(|| [first, last].map(|n| (n, 0.6 * scale / n.sqrt())))
}
