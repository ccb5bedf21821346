//! What a finite number of bounces leaves out, and what was known about that beforehand.

use super::axis::Axis;
use super::palette::{Look, look};
use super::panel::{NORMAL, Panel, SMALL, spread};
use super::sheet::{Anchor, GREY, Point, Sheet, Stroke};
use crate::report::number::significant;
use crate::study::Truncation;

const WIDTH: u32 = 860;
const HEIGHT: u32 = 420;

/// Truncation error of the Neumann series beside its bound, against bounces.
pub fn truncation(series: &[Truncation]) -> Sheet {
    let mut sheet = Sheet::new(WIDTH, HEIGHT);
    let panel = Panel {
        left: 52.0,
        top: 48.0,
        right: f64::from(WIDTH) - 132.0,
        bottom: f64::from(HEIGHT) - 50.0,
        x: Axis::linear_from_zero(series.iter().map(|t| t.bounces as f64)),
        y: Axis::log_decades(series.iter().flat_map(|t| [t.error, t.bound])),
    };
    panel.draw_axes(&mut sheet, "bounces kept", "Truncation error of the Neumann series", true);
    if series.is_empty() {
        panel.note_empty(&mut sheet, "the series was not recorded");
        return sheet;
    }
    let errors: Vec<(f64, f64)> = series.iter().map(|t| (t.bounces as f64, t.error)).collect();
    let bounds: Vec<(f64, f64)> = series.iter().map(|t| (t.bounces as f64, t.bound)).collect();
    let (error_look, bound_look) = (look(0), look(1));

    // Tint what lies between the error and its bound.
    let upper = bounds.iter().filter_map(|(x, y)| panel.place(*x, *y));
    let lower = errors.iter().rev().filter_map(|(x, y)| panel.place(*x, *y));
    sheet.area(upper.chain(lower).collect(), bound_look.colour, 0.09);

    // Draw both, the bound without markers: it was computed, not measured.
    panel.line(&mut sheet, bounds.iter().copied(), Stroke { width: 1.75, ..bound_look.dashed() });
    panel.line(&mut sheet, errors.iter().copied(), error_look.stroke());
    if panel.markers(&mut sheet, &errors, error_look, 0.0) {
        panel.note_clipped(&mut sheet);
    }

    // Name them where they end.
    let lines = [(&errors, error_look, "error"), (&bounds, bound_look, "bound")];
    let ends: Vec<_> = lines.into_iter().filter_map(|line| Some((line, end(&panel, line.0)?))).collect();
    let wanted: Vec<f64> = ends.iter().map(|(_, end)| end.1).collect();
    let heights = spread(&wanted, 34.0, panel.top, panel.bottom - 26.0);
    for (((points, look, name), end), height) in ends.into_iter().zip(heights) {
        name_line(&mut sheet, end, (panel.right + 10.0, height), look, name, fall(points));
    }
    sheet
}

fn name_line(sheet: &mut Sheet, end: Point, at: Point, look: Look, name: &str, fall: Option<f64>) {
    sheet.line(vec![(end.0 + 6.0, end.1), at], Stroke::solid(look.colour, 0.75));
    sheet.bold_words((at.0 + 4.0, at.1), name, NORMAL, look.colour, Anchor::Start);
    if let Some(factor) = fall {
        let text = format!("× {} a bounce", significant(factor, 2));
        sheet.words((at.0 + 4.0, at.1 + 15.0), text, SMALL, GREY, Anchor::Start);
    }
}

/// The last drawn point of a line.
fn end(panel: &Panel, points: &[(f64, f64)]) -> Option<Point> {
    points.iter().rev().find_map(|(x, y)| panel.place(*x, *y))
}

/// The factor by which a line falls with every bounce, over the second half of what rounding has not touched.
fn fall(points: &[(f64, f64)]) -> Option<f64> {
    let clean: Vec<(f64, f64)> = points.iter().copied().take_while(|(_, y)| y.is_finite() && *y > 1e-13).collect();
    let (first, last) = (clean.get(clean.len() / 2)?, clean.last()?);
    (last.0 > first.0).then(|| (last.1 / first.1).powf(1.0 / (last.0 - first.0)))
}
