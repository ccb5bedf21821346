//! Colours, markers and dashes that stay apart in print and for the colour-blind.
//!
//! Colours: Okabe and Ito, "Color universal design" (2008), without the yellow, which is too pale on white.

use super::sheet::{Colour, Point, Sheet, Stroke, WHITE};

const COLOURS: [Colour; 7] =
    [(0, 114, 178), (213, 94, 0), (0, 158, 115), (204, 121, 167), (230, 159, 0), (86, 180, 233), (34, 34, 34)];

const SHAPES: [Shape; 5] = [Shape::Circle, Shape::Square, Shape::Triangle, Shape::Diamond, Shape::Inverted];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    Circle,
    Square,
    Triangle,
    Diamond,
    Inverted,
}

/// How one series looks.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    pub colour: Colour,
    shape: Shape,
    open: bool,
}

/// The look of the series with this number: 35 of them differ in colour and shape together.
pub fn look(series: usize) -> Look {
    Look {
        colour: COLOURS[series % COLOURS.len()],
        shape: SHAPES[series % SHAPES.len()],
        open: (series / SHAPES.len()) % 2 == 1,
    }
}

impl Look {
    /// A line in this look.
    pub fn stroke(&self) -> Stroke {
        Stroke::solid(self.colour, 1.75)
    }

    pub fn dashed(&self) -> Stroke {
        Stroke::dashed(self.colour, 1.5, (5.0, 3.5))
    }

    /// A marker with a white rim that lifts it off its line.
    pub fn marker(&self, sheet: &mut Sheet, at: Point) {
        self.shape_at(sheet, at, 5.0, WHITE);
        self.shape_at(sheet, at, 3.75, self.colour);
        if self.open {
            self.shape_at(sheet, at, 2.0, WHITE);
        }
    }

    /// The same in another colour.
    pub fn in_colour(self, colour: Colour) -> Self {
        Self { colour, ..self }
    }

    /// A marker in this shape, empty for what is below zero.
    pub fn signed_marker(&self, sheet: &mut Sheet, at: Point, is_negative: bool) {
        Self { open: is_negative, ..*self }.marker(sheet, at);
    }

    /// An arrow head that points up from an empty marker: the value is larger, nobody knows by how much.
    pub fn unfinished(&self, sheet: &mut Sheet, (x, y): Point) {
        self.shape_at(sheet, (x, y), 4.0, self.colour);
        self.shape_at(sheet, (x, y), 2.6, WHITE);
        let x = x + 10.0;
        sheet.line(vec![(x, y + 4.5), (x, y - 2.0)], Stroke::solid(self.colour, 1.25));
        sheet.area(vec![(x - 3.0, y - 0.5), (x + 3.0, y - 0.5), (x, y - 5.5)], self.colour, 1.0);
    }

    fn shape_at(&self, sheet: &mut Sheet, (x, y): Point, radius: f64, colour: Colour) {
        let corners: &[Point] = match self.shape {
            Shape::Circle => return sheet.dot((x, y), radius, colour),
            Shape::Square => &[(-0.86, -0.86), (0.86, -0.86), (0.86, 0.86), (-0.86, 0.86)],
            Shape::Triangle => &[(0.0, -1.2), (1.08, 0.72), (-1.08, 0.72)],
            Shape::Diamond => &[(0.0, -1.22), (1.22, 0.0), (0.0, 1.22), (-1.22, 0.0)],
            Shape::Inverted => &[(0.0, 1.2), (1.08, -0.72), (-1.08, -0.72)],
        };
        sheet.area(corners.iter().map(|(dx, dy)| (x + radius * dx, y + radius * dy)).collect(), colour, 1.0);
    }
}
