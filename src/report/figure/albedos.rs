//! What light that takes ever longer to die costs each method: products against albedo.

use super::axis::Axis;
use super::families::{Group, groups};
use super::paint::text_width;
use super::palette::{Look, look};
use super::panel::{NORMAL, Panel, SMALL, spread};
use super::sheet::{Anchor, GREY, INK, Point, Sheet, Stroke};
use crate::report::number::{count, trimmed};
use crate::study::{AlbedoLevel, AlbedoStudy, SolverRun};

const WIDTH: u32 = 920;
const LEFT: f64 = 52.0;
const TOP: f64 = 48.0;
const FOOT: f64 = 64.0;

/// Room for names at the right of a panel.
const NAMES: f64 = 178.0;

/// Height of a panel, alone and where there are several.
const HEIGHTS: (f64, f64) = (300.0, 220.0);

/// From the foot of one panel to the head of the next.
const ROW_GAP: f64 = 100.0;

/// Height of a name, and of the lane of a method that ran out of products.
const LANE: f64 = 16.0;

/// Labels nearer than this share of the axis would run into each other.
const CLOSEST_LABELS: f64 = 0.1;

const GUIDE: Stroke = Stroke { colour: GREY, width: 0.75, dash: None };
const BUDGET: Stroke = Stroke { colour: INK, width: 0.75, dash: Some((5.0, 3.5)) };

/// One panel: its methods, by their places in a level, and those of them that ran out of products somewhere.
struct Part {
    group: Group,
    members: Vec<(usize, Look)>,
    lanes: Vec<usize>,
}

/// Products of every iterative method against 1 − albedo, whiter to the right. What ran out of its budget has a lane of its own above it.
pub fn albedos(study: &AlbedoStudy) -> Sheet {
    let runs: Vec<&SolverRun> = study.levels.first().map_or(Vec::new(), |level| level.runs.iter().collect());
    let drawn: Vec<usize> = (0..runs.len()).filter(|i| runs[*i].kind != "direct").collect();
    let part = |group: Group| {
        let members: Vec<(usize, Look)> =
            group.members.iter().enumerate().map(|(k, place)| (drawn[*place], look(k))).collect();
        let is_out = |i: &usize| study.levels.iter().any(|level| is_unfinished(&level.runs[*i]));
        let lanes = members.iter().map(|(i, _)| *i).filter(is_out).collect();
        Part { group, members, lanes }
    };
    let parts: Vec<Part> = groups(drawn.iter().map(|i| runs[*i])).into_iter().map(part).collect();

    // Lay the panels out, the lanes of a row above them.
    let n_columns = parts.len().min(2);
    let height = if parts.len() > 1 { HEIGHTS.1 } else { HEIGHTS.0 };
    let rows: Vec<&[Part]> = parts.chunks(n_columns).collect();
    let heads = rows.iter().map(|row| row.iter().map(|part| part.lanes.len()).max().unwrap_or(0) as f64 * LANE);
    let heads: Vec<f64> = heads.collect();
    let has_free_cell = parts.len() == 3;
    let foot = if has_free_cell { FOOT } else { FOOT + 30.0 };
    let total = TOP + heads.iter().sum::<f64>() + rows.len() as f64 * (height + ROW_GAP) - ROW_GAP + foot;
    let mut sheet = Sheet::new(WIDTH, total.ceil() as u32);

    // Share the axes between all panels.
    let all = drawn.iter().flat_map(|i| study.levels.iter().map(|level| level.runs[*i].products));
    let x = abscissa(study, parts.len() == 1);
    let y = Axis::log_tight(all.filter(|v| *v <= study.budget).chain([0.7 * study.budget])).up_to(study.budget);
    let width = f64::from(WIDTH) / n_columns as f64;
    let mut top = TOP;
    for (row, head) in rows.iter().zip(heads) {
        for (column, part) in row.iter().enumerate() {
            let (left, right) = (LEFT + column as f64 * width, (column + 1) as f64 * width - NAMES);
            let (x, y) = (x.clone(), y.clone());
            let panel = Panel { left, top: top + head, right, bottom: top + head + height, x, y };
            draw(&mut sheet, &panel, study, part);
        }
        top += head + height + ROW_GAP;
    }
    let words = key_words(study);
    let mut places = [(18.0, total - 18.0); 4];
    for (k, place) in places.iter_mut().enumerate() {
        if has_free_cell {
            *place = (LEFT + width, top - height - ROW_GAP + 24.0 + 26.0 * k as f64);
        } else {
            place.0 += words[..k].iter().map(|text| text_width(text, SMALL) + 46.0).sum::<f64>();
        }
    }
    draw_key(&mut sheet, &words, places);
    sheet
}

fn draw(sheet: &mut Sheet, panel: &Panel, study: &AlbedoStudy, part: &Part) {
    let Part { group, members, lanes } = part;
    let title = match group.title {
        "" => "Products with K".to_string(),
        family => format!("{family}: products with K"),
    };
    let head = panel.top - LANE * lanes.len() as f64;
    panel.draw_axes_under(sheet, "1 − albedo, whiter →", &title, true, head);
    if members.is_empty() {
        panel.note_empty(sheet, "no iterative method was run");
        return;
    }
    let lane_of = |i: usize| {
        let lane = lanes.iter().position(|lane| *lane == i).unwrap_or(0);
        panel.top - LANE * (lane as f64 + 0.5)
    };
    if !lanes.is_empty() {
        let corners = [(panel.left, head), (panel.right, head), (panel.right, panel.top), (panel.left, panel.top)];
        sheet.area(corners.to_vec(), GREY, 0.1);
    }
    panel.line(sheet, [panel.x.ends().0, panel.x.ends().1].map(|x| (x, study.budget)), BUDGET);
    draw_guides(sheet, panel, study);

    // A line is dashed on its way to where a method ran out; the lane has its marker.
    let place = |level: usize, i: usize| -> Option<Point> {
        let AlbedoLevel { albedo, runs } = &study.levels[level];
        let at = panel.place(1.0 - albedo, runs[i].products)?;
        Some(if is_unfinished(&runs[i]) { (at.0, lane_of(i)) } else { at })
    };
    for (i, look) in members {
        for pair in study.levels.windows(2) {
            let ends = [&pair[0], &pair[1]];
            // What was refused has no products, which are then not a number.
            let within = |products: f64| if products > study.budget { study.budget } else { products };
            let line = ends.map(|level| (1.0 - level.albedo, within(level.runs[*i].products)));
            match ends.map(|level| is_unfinished(&level.runs[*i])) {
                [false, false] => panel.line(sheet, line, look.stroke()),
                [true, true] => {}
                _ => panel.line(sheet, line, Stroke::dashed(look.colour, 1.0, (2.5, 2.5))),
            }
        }
    }
    let n_levels = study.levels.len();
    for (i, look) in members {
        for level in 0..n_levels {
            let Some(at) = place(level, *i) else { continue };
            if is_unfinished(&study.levels[level].runs[*i]) {
                look.unfinished(sheet, at);
            } else {
                look.marker(sheet, at);
            }
        }
    }

    // Name every method, those that have no point at all in grey.
    let ends: Vec<Option<Point>> =
        members.iter().map(|(i, _)| (0..n_levels).rev().find_map(|level| place(level, *i))).collect();
    let wanted: Vec<f64> = ends.iter().map(|end| end.map_or(panel.bottom, |at| at.1)).collect();
    let heights = spread(&wanted, LANE, head + 0.5 * LANE, panel.bottom);
    for (((i, look), end), height) in members.iter().zip(ends).zip(heights) {
        let run = &study.levels[n_levels - 1].runs[*i];
        if let Some(end) = end {
            let clear = if is_unfinished(run) { 16.0 } else { 6.0 };
            sheet.line(vec![(end.0 + clear, end.1), (panel.right + 10.0, height)], Stroke::solid(look.colour, 0.75));
        }
        let name = if run.refusal.is_some() { format!("{} (refused)", run.solver) } else { run.solver.clone() };
        let colour = if end.is_some() { look.colour } else { GREY };
        sheet.words((panel.right + 14.0, height), name, NORMAL, colour, Anchor::Start);
    }
}

/// What came to an end other than its own.
fn is_unfinished(run: &SolverRun) -> bool {
    !["converged", "direct", "refused"].contains(&run.stop.as_str())
}

/// What theory makes of a closed scene: the logarithm of the tolerance over 1 − albedo, and half of it over the root.
fn draw_guides(sheet: &mut Sheet, panel: &Panel, study: &AlbedoStudy) {
    let (low, high) = panel.x.ends();
    let digits = (1.0 / study.tolerance).ln();
    for (scale, power) in [(digits, 1.0), (0.5 * (digits + 2.0_f64.ln()), 0.5)] {
        // From the darkest end to the budget, or the whitest end.
        let whitest = low.max((scale / study.budget).powf(1.0 / power));
        if whitest < high {
            panel.line(sheet, [high, whitest].map(|x| (x, scale * x.powf(-power))), GUIDE);
        }
    }
}

fn key_words(study: &AlbedoStudy) -> [String; 4] {
    [
        format!("budget, {} products", count(study.budget as u64)),
        "not there within it".to_string(),
        "ln(1/ε) / (1 − a), a closed scene's bounces".to_string(),
        "½ ln(2/ε) / √(1 − a), its best polynomial".to_string(),
    ]
}

/// What all panels share.
fn draw_key(sheet: &mut Sheet, words: &[String; 4], places: [Point; 4]) {
    let [budget, unfinished, first, second] = places;
    let mut line = |(x, y): Point, rise: f64, stroke| sheet.line(vec![(x, y + rise), (x + 26.0, y - rise)], stroke);
    line(budget, 0.0, BUDGET);
    line(first, 7.0, GUIDE);
    line(second, 3.5, GUIDE);
    look(0).unfinished(sheet, (unfinished.0 + 8.0, unfinished.1));
    for (text, (x, y)) in words.iter().zip(places) {
        sheet.words((x + 34.0, y), text, SMALL, INK, Anchor::Start);
    }
}

/// 1 − albedo, whiter to the right, labelled where it was looked at, with the albedo where there is room for it.
fn abscissa(study: &AlbedoStudy, is_wide: bool) -> Axis {
    let values: Vec<f64> = study.levels.iter().map(|level| 1.0 - level.albedo).collect();
    let axis = Axis::log_tight(values.iter().copied()).reversed();
    let places: Vec<f64> = values.iter().filter_map(|value| axis.fraction(*value)).collect();
    if places.is_empty() || places.windows(2).any(|pair| (pair[1] - pair[0]).abs() < CLOSEST_LABELS) {
        return axis;
    }
    let label = |albedo: f64| {
        let second = if is_wide { format!("\na = {albedo}") } else { String::new() };
        trimmed(1.0 - albedo, 3) + &second
    };
    axis.with_labels(study.levels.iter().map(|level| (1.0 - level.albedo, label(level.albedo))).collect())
}
