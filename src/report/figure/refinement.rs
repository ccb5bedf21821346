//! How the matrix closes in on the scene as its patches shrink.

use super::axis::Axis;
use super::palette::look;
use super::panel::{NORMAL, Panel, SMALL};
use super::sheet::{Anchor, GREY, INK, Sheet, Stroke};
use crate::report::number::{count, significant, trimmed, with_error};
use crate::study::Refinement;

const WIDTH: u32 = 860;
const HEIGHT: u32 = 440;

/// Difference of the surface means from the path tracer's, against patch size, with the fitted order and the noise.
pub fn refinement(study: &Refinement) -> Sheet {
    let mut sheet = Sheet::new(WIDTH, HEIGHT);
    let levels = &study.levels;
    let fit = Fit::of(study);
    let sizes = || levels.iter().map(|l| l.patch_size);
    let labels = levels
        .iter()
        .filter(|l| l.patch_size > 0.0)
        .map(|l| (l.patch_size, format!("{}\n{} bundles", trimmed(l.patch_size, 3), count(l.n_bundles as u64))))
        .collect();
    let panel = Panel {
        left: 56.0,
        top: 48.0,
        right: f64::from(WIDTH) - 28.0,
        bottom: f64::from(HEIGHT) - 64.0,
        x: Axis::log_tight(sizes().flat_map(|h| [0.9 * h, h / 0.9])).with_labels(labels),
        y: Axis::log_tight(
            levels.iter().flat_map(|l| [0.7 * l.noise, l.error - l.noise, l.error + l.noise]).filter(|v| *v > 0.0),
        ),
    };
    if levels.is_empty() {
        panel.draw_axes(&mut sheet, "patch size", "Difference from the path tracer", true);
        panel.note_empty(&mut sheet, "the scene was not refined");
        return sheet;
    }

    // Shade what the path tracer's noise hides.
    let noise: Vec<(f64, f64)> = levels.iter().map(|l| (l.patch_size, l.noise)).filter(|(_, e)| *e > 0.0).collect();
    if let (Some(coarsest), Some(finest)) = (noise.first(), noise.last()) {
        let (low, high) = panel.x.ends();
        let foot = panel.y.ends().0;
        let edge = [(high, coarsest.1)].into_iter().chain(noise.iter().copied()).chain([(low, finest.1)]);
        let outline = [(high, foot)].into_iter().chain(edge).chain([(low, foot)]);
        sheet.area(outline.filter_map(|(x, y)| panel.place(x, y)).collect(), GREY, 0.13);
        if let Some((x, y)) = panel.place(high, coarsest.1) {
            sheet.words((x - 8.0, y + 11.0), "noise of the path tracer", SMALL, GREY, Anchor::End);
        }
    }
    panel.draw_axes(&mut sheet, "patch size", "Difference of the surface means from the path tracer", true);

    // Draw the fitted order and the triangle that shows it.
    if let Some(fit) = fit {
        let (low, high) = panel.x.ends();
        panel.line(&mut sheet, [low, high].map(|h| (h, fit.at(h))), Stroke::dashed(look(1).colour, 1.5, (5.0, 3.5)));
        draw_slope(&mut sheet, &panel, &fit, study);
    }

    // Draw what was measured, with its noise as whiskers.
    for level in levels.iter().filter(|l| l.noise.is_finite()) {
        let ends = [level.error - level.noise, level.error + level.noise];
        let whisker: Vec<_> = ends.iter().filter_map(|e| panel.place(level.patch_size, e.max(0.0))).collect();
        for (x, y) in &whisker {
            sheet.line(vec![(x - 4.0, *y), (x + 4.0, *y)], Stroke::solid(look(0).colour, 1.25));
        }
        sheet.line(whisker, Stroke::solid(look(0).colour, 1.25));
    }
    let points: Vec<(f64, f64)> = levels.iter().map(|l| (l.patch_size, l.error)).collect();
    if panel.markers(&mut sheet, &points, look(0), 0.0) {
        panel.note_clipped(&mut sheet);
    }
    sheet
}

/// error = scale · patch_size^order.
struct Fit {
    scale: f64,
    order: f64,
}

impl Fit {
    /// The study's own order, through the geometric mean of its levels.
    fn of(study: &Refinement) -> Option<Self> {
        let order = study.observed_order;
        let logs = study.levels.iter().map(|l| l.error.ln() - order * l.patch_size.ln());
        let usable: Vec<f64> = logs.filter(|v| v.is_finite()).collect();
        let mean = usable.iter().sum::<f64>() / usable.len() as f64;
        (usable.len() > 1 && order.is_finite() && mean.is_finite()).then(|| Self { scale: mean.exp(), order })
    }

    fn at(&self, patch_size: f64) -> f64 {
        self.scale * patch_size.powf(self.order)
    }
}

/// A triangle under the fit between the two coarsest levels, its legs one and the order long, and the order in words.
fn draw_slope(sheet: &mut Sheet, panel: &Panel, fit: &Fit, study: &Refinement) {
    let [coarse, fine, ..] = &study.levels[..] else { return };
    let (near, far) = (0.9 * coarse.patch_size, 1.15 * fine.patch_size);
    let below = 0.72;
    let corners = [(far, below * fit.at(far)), (near, below * fit.at(far)), (near, below * fit.at(near))];
    let placed: Vec<_> = corners.iter().filter_map(|(x, y)| panel.place(*x, *y)).collect();
    let [start, corner, top] = placed[..] else { return };
    if corner.1 - top.1 > 12.0 {
        sheet.line(vec![start, corner, top, start], Stroke::solid(GREY, 1.0));
        sheet.words((0.5 * (start.0 + corner.0), corner.1 + 9.0), "1", SMALL, GREY, Anchor::Middle);
        sheet.words((corner.0 + 6.0, 0.5 * (corner.1 + top.1)), significant(fit.order, 3), SMALL, GREY, Anchor::Start);
    }
    let text = format!("observed order {}", with_error(study.observed_order, study.order_standard_error));
    sheet.bold_words((panel.left + 14.0, panel.top + 16.0), text, NORMAL, look(1).colour, Anchor::Start);
    if study.finest_error.is_finite() {
        let text = format!("estimated error of the finest level {}", significant(study.finest_error, 2));
        sheet.words((panel.left + 14.0, panel.top + 33.0), text, SMALL, INK, Anchor::Start);
    }
}
