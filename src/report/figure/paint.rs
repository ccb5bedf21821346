//! A sheet becomes SVG and PNG: the same strokes on two plotters backends.

use super::sheet::{Anchor, Colour, Mark, Point, Sheet, Stroke};
use crate::image::encode_rgb8;
use crate::report::ReportError;
use plotters::coord::Shift;
use plotters::element::DashedPathElement;
use plotters::prelude::{
    BitMapBackend, Circle, Color, DrawingArea, DrawingAreaErrorKind, DrawingBackend, IntoDrawingArea, PathElement,
    Polygon, RGBColor, SVGBackend, ShapeStyle, Text,
};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontDesc, FontFamily, FontStyle, TextStyle, register_font};
use std::sync::OnceLock;

/// Device pixels to a CSS pixel on either canvas. Plotters rounds to whole device pixels, so the SVG is drawn large and
/// shown small; the PNG is drawn large and averaged down, which smooths its edges.
const FINENESS: u32 = 4;

/// Device pixels averaged into one pixel of the PNG, along either side: PNGs hold 2 pixels to a CSS pixel.
const AVERAGED: u32 = 2;

/// Plotters' font size over the em it results in.
const SIZE_PER_EM: f64 = 1.24;

/// Plotters' bitmap hangs vertically centred words this many ems higher than its SVG does.
const BITMAP_RISE: f64 = 0.15;

const FONT: &str = "sans-serif";

/// The figure as a self-contained SVG document.
pub fn to_svg(sheet: &Sheet) -> Result<String, ReportError> {
    // Draw large.
    let mut svg = String::new();
    let size = (sheet.width * FINENESS, sheet.height * FINENESS);
    paint(sheet, &SVGBackend::with_string(&mut svg, size).into_drawing_area(), 0.0)?;

    // Show small, in the reader's own font.
    let large = format!("width=\"{}\" height=\"{}\"", size.0, size.1);
    let small = format!("width=\"{}\" height=\"{}\"", sheet.width, sheet.height);
    let fonts = "font-family=\"system-ui, 'Segoe UI', 'Helvetica Neue', Arial, 'DejaVu Sans', sans-serif\"";
    Ok(svg.replacen(&large, &small, 1).replace("font-family=\"sans-serif\"", fonts))
}

/// The figure as a PNG with 2 pixels to a CSS pixel.
pub fn to_png(sheet: &Sheet) -> Result<Vec<u8>, ReportError> {
    let (width, height, codes) = to_codes(sheet)?;
    Ok(encode_rgb8(width, height, &codes)?)
}

/// Width, height and sRGB codes of the figure with 2 pixels to a CSS pixel.
pub fn to_codes(sheet: &Sheet) -> Result<(usize, usize, Vec<u8>), ReportError> {
    // Draw large.
    let (width, height) = (sheet.width * FINENESS, sheet.height * FINENESS);
    let mut fine = vec![255_u8; 3 * width as usize * height as usize];
    paint(sheet, &BitMapBackend::with_buffer(&mut fine, (width, height)).into_drawing_area(), BITMAP_RISE)?;

    // Average blocks of device pixels.
    let (width, side) = (width as usize, AVERAGED as usize);
    let (out_width, out_height) = (width / side, height as usize / side);
    let mut codes = Vec::with_capacity(3 * out_width * out_height);
    let mut sums = vec![0_u16; 3 * out_width];
    for rows in fine.chunks_exact(3 * width * side) {
        sums.fill(0);
        for row in rows.chunks_exact(3 * width) {
            for (sums, block) in sums.chunks_exact_mut(3).zip(row.chunks_exact(3 * side)) {
                for pixel in block.chunks_exact(3) {
                    sums.iter_mut().zip(pixel).for_each(|(sum, code)| *sum += u16::from(*code));
                }
            }
        }
        codes.extend(sums.iter().map(|sum| (sum / (AVERAGED * AVERAGED) as u16) as u8));
    }
    Ok((out_width, out_height, codes))
}

/// Draws every mark; `rise` is how many ems the backend hangs words too high.
fn paint<DB>(sheet: &Sheet, canvas: &DrawingArea<DB, Shift>, rise: f64) -> Result<(), ReportError>
where
    DB: DrawingBackend<ErrorType: 'static>,
{
    register_fonts()?;
    canvas.fill(&RGBColor(255, 255, 255)).map_err(figure_error)?;
    for mark in &sheet.marks {
        match mark {
            Mark::Line { points, stroke } => draw_line(canvas, points, stroke),
            Mark::Area { points, colour, opacity } => {
                let style = ShapeStyle { color: rgb(*colour).mix(*opacity), filled: true, stroke_width: 0 };
                canvas.draw(&Polygon::new(points.iter().map(device).collect::<Vec<_>>(), style))
            }
            Mark::Dot { at, radius, colour } => {
                canvas.draw(&Circle::new(device(at), scaled(*radius), rgb(*colour).filled()))
            }
            Mark::Words { at, text, size, colour, anchor, bold } => {
                let at = device(&(at.0, at.1 + rise * size));
                canvas.draw(&Text::new(text.as_str(), at, text_style(*size, *colour, *anchor, *bold)))
            }
        }
        .map_err(figure_error)?;
    }
    canvas.present().map_err(figure_error)
}

fn draw_line<DB: DrawingBackend>(
    canvas: &DrawingArea<DB, Shift>,
    points: &[Point],
    stroke: &Stroke,
) -> Result<(), DrawingAreaErrorKind<DB::ErrorType>> {
    let style = ShapeStyle { color: rgb(stroke.colour).to_rgba(), filled: false, stroke_width: scaled(stroke.width) };
    let points: Vec<(i32, i32)> = points.iter().map(device).collect();
    match stroke.dash {
        None => canvas.draw(&PathElement::new(points, style)),
        Some((dash, gap)) => canvas.draw(&DashedPathElement::new(points, scaled(dash), scaled(gap), style)),
    }
}

/// The width of a text in CSS pixels, as the built-in font sets it.
pub fn text_width(text: &str, size: f64) -> f64 {
    let font = FontDesc::new(FontFamily::Name(FONT), f64::from(FINENESS) * size * SIZE_PER_EM, FontStyle::Normal);
    let measured = register_fonts().ok().and_then(|()| font.box_size(text).ok());
    // Without the font, half an em a letter is a fair guess.
    measured.map_or(0.5 * size * text.chars().count() as f64, |(width, _)| f64::from(width) / f64::from(FINENESS))
}

fn text_style(size: f64, colour: Colour, anchor: Anchor, bold: bool) -> TextStyle<'static> {
    let style = if bold { FontStyle::Bold } else { FontStyle::Normal };
    let horizontal = match anchor {
        Anchor::Start => HPos::Left,
        Anchor::Middle => HPos::Center,
        Anchor::End => HPos::Right,
    };
    let font = FontDesc::new(FontFamily::Name(FONT), f64::from(FINENESS) * size * SIZE_PER_EM, style);
    font.color(&rgb(colour)).pos(Pos::new(horizontal, VPos::Center))
}

fn register_fonts() -> Result<(), ReportError> {
    static REGISTERED: OnceLock<bool> = OnceLock::new();
    let registered = REGISTERED.get_or_init(|| {
        register_font(FONT, FontStyle::Normal, dejavu::sans::regular()).is_ok()
            && register_font(FONT, FontStyle::Bold, dejavu::sans::bold()).is_ok()
    });
    registered.then_some(()).ok_or(ReportError::Font)
}

fn device(point: &Point) -> (i32, i32) {
    let round = |v: f64| (v * f64::from(FINENESS)).round() as i32;
    (round(point.0), round(point.1))
}

fn scaled(length: f64) -> u32 {
    (length * f64::from(FINENESS)).round().max(1.0) as u32
}

fn rgb((r, g, b): Colour) -> RGBColor {
    RGBColor(r, g, b)
}

fn figure_error<E: std::error::Error + Send + Sync + 'static>(error: DrawingAreaErrorKind<E>) -> ReportError {
    ReportError::Figure(Box::new(error))
}
