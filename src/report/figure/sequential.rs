//! Sequential Monte Carlo: an error that falls exponentially with the work.

use super::axis::Axis;
use super::palette::look;
use super::panel::{NORMAL, Panel, SMALL};
use super::sheet::{Anchor, GREY, INK, Sheet, Stroke};
use crate::report::number::significant;
use crate::study::{SequentialPoint, SequentialRun};

const WIDTH: u32 = 860;
const HEIGHT: u32 = 330;

/// A step of a walk in the unit of its axis.
const MILLION: f64 = 1e6;

/// One number of a stage.
type Number = fn(&SequentialPoint) -> f64;

/// Error and residual after every stage, against products with K (left) and steps of walks (right).
pub fn sequential(run: &SequentialRun) -> Sheet {
    let mut sheet = Sheet::new(WIDTH, HEIGHT);
    let y = Axis::log_decades(run.stages.iter().flat_map(|stage| [stage.error, stage.residual]));
    let abscissae: [(&str, Number); 2] = [
        ("products with K, one a stage", |stage| stage.products as f64),
        ("steps of walks, millions", |stage| stage.steps as f64 / MILLION),
    ];
    for (column, (name, abscissa)) in abscissae.into_iter().enumerate() {
        let left = 60.0 + 345.0 * column as f64;
        let x = Axis::linear_from_zero(run.stages.iter().map(abscissa));
        let bottom = f64::from(HEIGHT) - 56.0;
        let panel = Panel { left, top: 48.0, right: left + 315.0, bottom, x, y: y.clone() };
        let title = if column == 0 { "Error and residual by stages" } else { "By steps" };
        panel.draw_axes(&mut sheet, name, title, column == 0);
        if run.stages.is_empty() {
            panel.note_empty(&mut sheet, run.refusal.as_ref().map_or("no stage was run", |_| "refused"));
            continue;
        }
        let series = |value: Number| run.stages.iter().map(|stage| (abscissa(stage), value(stage))).collect::<Vec<_>>();
        let (errors, residuals) = (series(|stage| stage.error), series(|stage| stage.residual));
        panel.line(&mut sheet, residuals, Stroke::dashed(GREY, 1.25, (4.0, 3.0)));
        panel.line(&mut sheet, errors.clone(), look(0).stroke());
        if panel.markers(&mut sheet, &errors, look(0), 0.0) {
            panel.note_clipped(&mut sheet);
        }
    }
    draw_key(&mut sheet, run);
    sheet
}

/// Names both lines, and how steep they are.
fn draw_key(sheet: &mut Sheet, run: &SequentialRun) {
    let x = f64::from(WIDTH) - 118.0;
    sheet.line(vec![(x, 66.0), (x + 20.0, 66.0)], look(0).stroke());
    look(0).marker(sheet, (x + 10.0, 66.0));
    sheet.words((x + 27.0, 66.0), "error", NORMAL, INK, Anchor::Start);
    sheet.line(vec![(x, 88.0), (x + 20.0, 88.0)], Stroke::dashed(GREY, 1.25, (4.0, 3.0)));
    sheet.words((x + 27.0, 88.0), "residual", NORMAL, INK, Anchor::Start);
    if run.factor.is_finite() {
        sheet.words((x, 116.0), format!("× {} a stage", significant(run.factor, 2)), SMALL, GREY, Anchor::Start);
    }
    sheet.words((x, 132.0), format!("{} walks each", run.n_walks), SMALL, GREY, Anchor::Start);
}
