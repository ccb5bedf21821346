//! What a figure is made of: lines, areas, dots and words, at positions in CSS pixels.
//!
//! A figure fills a sheet once; the sheet then becomes SVG and PNG through the same strokes (see `paint`).

/// A position in CSS pixels, (0, 0) at the top left.
pub type Point = (f64, f64);

/// Red, green, blue.
pub type Colour = (u8, u8, u8);

pub const INK: Colour = (34, 34, 34);
pub const GREY: Colour = (110, 110, 110);
pub const RULE: Colour = (226, 226, 226);
pub const WHITE: Colour = (255, 255, 255);

/// How a line is drawn: colour, width, and the lengths of dash and gap if it is dashed.
#[derive(Clone, Copy, Debug)]
pub struct Stroke {
    pub colour: Colour,
    pub width: f64,
    pub dash: Option<(f64, f64)>,
}

/// Which part of a text sits at its position; vertically it is always centred.
#[derive(Clone, Copy, Debug)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

/// One stroke of the pen.
#[derive(Clone, Debug)]
pub enum Mark {
    Line { points: Vec<Point>, stroke: Stroke },
    Area { points: Vec<Point>, colour: Colour, opacity: f64 },
    Dot { at: Point, radius: f64, colour: Colour },
    Words { at: Point, text: String, size: f64, colour: Colour, anchor: Anchor, bold: bool },
}

/// A figure before it is a file.
#[derive(Clone, Debug)]
pub struct Sheet {
    pub width: u32,
    pub height: u32,
    pub marks: Vec<Mark>,
}

impl Stroke {
    pub fn solid(colour: Colour, width: f64) -> Self {
        Self { colour, width, dash: None }
    }

    pub fn dashed(colour: Colour, width: f64, dash: (f64, f64)) -> Self {
        Self { colour, width, dash: Some(dash) }
    }
}

impl Sheet {
    /// An empty sheet of this size in CSS pixels.
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, marks: Vec::new() }
    }

    /// A line through at least two points; fewer draw nothing.
    pub fn line(&mut self, points: Vec<Point>, stroke: Stroke) {
        if points.len() > 1 {
            self.marks.push(Mark::Line { points, stroke });
        }
    }

    /// A filled polygon; fewer than three points draw nothing.
    pub fn area(&mut self, points: Vec<Point>, colour: Colour, opacity: f64) {
        if points.len() > 2 {
            self.marks.push(Mark::Area { points, colour, opacity });
        }
    }

    /// A filled circle.
    pub fn dot(&mut self, at: Point, radius: f64, colour: Colour) {
        self.marks.push(Mark::Dot { at, radius, colour });
    }

    /// Words, `size` the em in pixels.
    pub fn words(&mut self, at: Point, text: impl Into<String>, size: f64, colour: Colour, anchor: Anchor) {
        self.marks.push(Mark::Words { at, text: text.into(), size, colour, anchor, bold: false });
    }

    /// The same in bold.
    pub fn bold_words(&mut self, at: Point, text: impl Into<String>, size: f64, colour: Colour, anchor: Anchor) {
        self.marks.push(Mark::Words { at, text: text.into(), size, colour, anchor, bold: true });
    }
}
