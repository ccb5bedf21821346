//! A pair of axes and what is drawn between them.

use super::axis::Axis;
use super::palette::Look;
use super::sheet::{Anchor, Colour, GREY, INK, Point, RULE, Sheet, Stroke};

/// Words beside axes.
pub const SMALL: f64 = 11.0;
/// Words in the figure.
pub const NORMAL: f64 = 12.0;

/// Markers along one line are at least this far apart.
const MARKER_SPACING: f64 = 26.0;

/// A rectangle of the sheet with an axis along the bottom and one up the left side.
#[derive(Clone, Debug)]
pub struct Panel {
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
    pub x: Axis,
    pub y: Axis,
}

impl Panel {
    /// Where a pair of numbers is drawn; `None` where either is not finite. Outside the axes: moved to their end.
    pub fn place(&self, x: f64, y: f64) -> Option<Point> {
        let (x, y) = (self.x.fraction(x)?, self.y.fraction(y)?);
        Some((self.left + x * (self.right - self.left), self.bottom - y * (self.bottom - self.top)))
    }

    /// Rules, ticks, labels and the names of the axes: the upright one's above its top end, so that nobody tilts a head.
    /// Without `y_labels` the upright axis stays bare (it shares its neighbour's).
    pub fn draw_axes(&self, sheet: &mut Sheet, x_name: &str, y_name: &str, y_labels: bool) {
        self.draw_axes_under(sheet, x_name, y_name, y_labels, self.top);
    }

    /// The same where something above the panel, up to `head`, belongs to it.
    pub fn draw_axes_under(&self, sheet: &mut Sheet, x_name: &str, y_name: &str, y_labels: bool, head: f64) {
        // Rule the panel at the labelled numbers.
        for (value, name) in &self.y.labels {
            let Some((_, y)) = self.place(self.x.ends().0, *value) else { continue };
            sheet.line(vec![(self.left, y), (self.right, y)], Stroke::solid(RULE, 1.0));
            if y_labels {
                sheet.words((self.left - 8.0, y), name, SMALL, INK, Anchor::End);
            }
        }
        for value in self.y.ticks.iter().filter(|_| y_labels) {
            let Some((_, y)) = self.place(self.x.ends().0, *value) else { continue };
            sheet.line(vec![(self.left - 4.0, y), (self.left, y)], Stroke::solid(GREY, 0.75));
        }

        // Mark and label the lower axis.
        let foot = self.y.ends().0;
        for value in &self.x.ticks {
            let Some((x, _)) = self.place(*value, foot) else { continue };
            sheet.line(vec![(x, self.bottom), (x, self.bottom + 3.0)], Stroke::solid(GREY, 0.75));
        }
        for (value, name) in &self.x.labels {
            let Some((x, _)) = self.place(*value, foot) else { continue };
            sheet.line(vec![(x, self.bottom), (x, self.bottom + 5.0)], Stroke::solid(INK, 1.0));
            for (line, text) in name.lines().enumerate() {
                let colour = if line == 0 { INK } else { GREY };
                sheet.words((x, self.bottom + 15.0 + 14.0 * line as f64), text, SMALL, colour, Anchor::Middle);
            }
        }
        sheet.line(vec![(self.left, self.bottom), (self.right, self.bottom)], Stroke::solid(INK, 1.0));

        // Name both.
        sheet.words((0.5 * (self.left + self.right), self.name_height()), x_name, NORMAL, INK, Anchor::Middle);
        let start = if y_labels { self.left - 36.0 } else { self.left };
        sheet.bold_words((start.max(8.0), head - 19.0), y_name, NORMAL, INK, Anchor::Start);
    }

    /// A line through the points, broken where a number is missing; points closer than half a pixel are merged.
    pub fn line(&self, sheet: &mut Sheet, points: impl IntoIterator<Item = (f64, f64)>, stroke: Stroke) {
        let mut run: Vec<Point> = Vec::new();
        let mut points = points.into_iter().peekable();
        while let Some((x, y)) = points.next() {
            let last = points.peek().is_none();
            match self.place(x, y) {
                Some(at) if last || run.last().is_none_or(|before| distance(*before, at) > 0.5) => run.push(at),
                Some(_) => {}
                None => sheet.line(std::mem::take(&mut run), stroke),
            }
        }
        sheet.line(run, stroke);
    }

    /// Markers at the points, thinned to a readable spacing, the last always. `phase`, from 0 to 1, staggers the markers of
    /// lines that lie on one another. Returns whether any was moved to the foot of the panel because it is too small for
    /// the axis; those are marked by an arrow head.
    pub fn markers(&self, sheet: &mut Sheet, points: &[(f64, f64)], look: Look, phase: f64) -> bool {
        let placed: Vec<(Point, bool)> =
            points.iter().filter_map(|(x, y)| Some((self.place(*x, *y)?, self.y.clips(*y)))).collect();
        let (mut before, mut spacing) = (placed.first().map(|(at, _)| *at), phase * MARKER_SPACING);
        let mut clipped = false;
        for (i, (at, below)) in placed.iter().enumerate() {
            clipped |= below;
            let last = i + 1 == placed.len();
            let to_last = placed.last().map_or(f64::INFINITY, |(end, _)| distance(*at, *end));
            let far = before.is_none_or(|point| distance(point, *at) >= spacing) && to_last >= 0.6 * MARKER_SPACING;
            if far || last {
                if *below {
                    arrow_down(sheet, *at, look.colour);
                } else {
                    look.marker(sheet, *at);
                }
                (before, spacing) = (Some(*at), MARKER_SPACING);
            }
        }
        clipped
    }

    /// Says what the arrow heads at the foot mean, below the axis where no data is.
    pub fn note_clipped(&self, sheet: &mut Sheet) {
        let (x, y) = (self.left, self.name_height());
        arrow_down(sheet, (x + 4.5, y + 4.0), GREY);
        sheet.words((x + 13.0, y), "below 10⁻¹⁷", SMALL, GREY, Anchor::Start);
    }

    /// Where the name of the lower axis is written: under its labels, which may have several lines.
    fn name_height(&self) -> f64 {
        let depth = self.x.labels.iter().map(|(_, name)| name.lines().count()).max().unwrap_or(1);
        self.bottom + 21.0 + 14.0 * depth as f64
    }

    /// Says in the middle of the panel why it is empty.
    pub fn note_empty(&self, sheet: &mut Sheet, text: &str) {
        let at = (0.5 * (self.left + self.right), 0.5 * (self.top + self.bottom));
        sheet.words(at, text, NORMAL, GREY, Anchor::Middle);
    }
}

fn arrow_down(sheet: &mut Sheet, (x, y): Point, colour: Colour) {
    sheet.area(vec![(x - 4.5, y - 7.0), (x + 4.5, y - 7.0), (x, y)], colour, 1.0);
}

pub fn distance(a: Point, b: Point) -> f64 {
    (a.0 - b.0).hypot(a.1 - b.1)
}

/// Heights for labels that would like to be at `wanted`, at least `gap` apart and between `top` and `bottom`: neighbours
/// that collide are spread evenly about their common centre. Order is kept; where there is no room, they run past the bottom.
pub fn spread(wanted: &[f64], gap: f64, top: f64, bottom: f64) -> Vec<f64> {
    // Sort, and merge colliding neighbours into blocks (first, count, centre) until none collide.
    let mut order: Vec<usize> = (0..wanted.len()).collect();
    order.sort_by(|a, b| wanted[*a].total_cmp(&wanted[*b]));
    let mut blocks: Vec<(usize, usize, f64)> = Vec::new();
    let settle = |centre: f64, n: usize| {
        let half = 0.5 * gap * (n as f64 - 1.0);
        centre.min(bottom - half).max(top + half)
    };
    for (place, i) in order.iter().enumerate() {
        blocks.push((place, 1, settle(wanted[*i], 1)));
        while let [.., (first, n, above), (_, m, below)] = blocks[..] {
            if below - above >= 0.5 * gap * (n + m) as f64 {
                break;
            }
            blocks.truncate(blocks.len() - 2);
            let centre = (above * n as f64 + below * m as f64) / (n + m) as f64;
            blocks.push((first, n + m, settle(centre, n + m)));
        }
    }

    // Lay the members of each block out.
    let mut heights = vec![0.0; wanted.len()];
    for (first, n, centre) in blocks {
        for k in 0..n {
            heights[order[first + k]] = centre + gap * (k as f64 - 0.5 * (n as f64 - 1.0));
        }
    }
    heights
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_keep_apart_and_in_order() {
        let heights = spread(&[50.0, 10.0, 52.0, 51.0, 200.0], 14.0, 0.0, 100.0);
        let mut sorted = heights.clone();
        sorted.sort_by(f64::total_cmp);
        assert!(sorted.windows(2).all(|w| w[1] - w[0] >= 14.0 - 1e-9), "{heights:?}");
        assert!(heights[1] < heights[0] && heights[0] < heights[3] && heights[3] < heights[2]);
        assert!(sorted[0] >= 0.0 && sorted[4] <= 100.0);
        assert_eq!(heights[1], 10.0);
    }
}
