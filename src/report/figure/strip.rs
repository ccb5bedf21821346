//! Pictures side by side, each with its caption below.

use super::paint::to_codes;
use super::sheet::{Anchor, INK, Sheet};
use crate::image::{Image, ImageError, encode_rgb8, tone_map};
use crate::report::ReportError;

/// The most pictures in one row.
const FULL_ROW: usize = 4;

/// In pixels of the PNG, two to a CSS pixel.
const GAP: usize = 16;
const CAPTION: usize = 48;

/// A PNG of all pictures (red, green, blue; all of one size) with the same exposure, at most four in a row.
pub fn strip(pictures: &[(String, &Image)], exposure: f64) -> Result<Vec<u8>, ReportError> {
    let Some((_, first)) = pictures.first() else {
        return Err(ImageError::Shape { width: 0, height: 0, n_channels: 3, n_values: 0 }.into());
    };
    let (width, height) = (first.width, first.height);
    let n_rows = pictures.len().div_ceil(FULL_ROW);
    let n_columns = pictures.len().div_ceil(n_rows);
    let corner = |i: usize| (GAP + (i % n_columns) * (width + GAP), GAP + (i / n_columns) * (height + CAPTION));

    // Write the captions on an empty sheet.
    let css = |pixels: usize| pixels.div_ceil(2) as u32;
    let mut sheet = Sheet::new(css(GAP + n_columns * (width + GAP)), css(GAP + n_rows * (height + CAPTION)));
    for (i, (caption, _)) in pictures.iter().enumerate() {
        let (x, y) = corner(i);
        let at = (0.5 * (x as f64 + 0.5 * width as f64), 0.5 * (y + height) as f64 + 12.0);
        sheet.words(at, caption.as_str(), 12.0, INK, Anchor::Middle);
    }

    // Lay the pictures above them.
    let (sheet_width, sheet_height, mut codes) = to_codes(&sheet)?;
    for (i, (_, picture)) in pictures.iter().enumerate() {
        if (picture.width, picture.height, picture.channels.len()) != (width, height, 3) {
            let Image { width, height, channels, values } = picture;
            let (n_channels, n_values) = (channels.len(), values.len());
            return Err(ImageError::Shape { width: *width, height: *height, n_channels, n_values }.into());
        }
        let (left, top) = corner(i);
        for (y, row) in picture.values.chunks(3 * width).take(height).enumerate() {
            let start = 3 * ((top + y) * sheet_width + left);
            for (code, value) in codes[start..].iter_mut().zip(row) {
                *code = tone_map(*value, exposure);
            }
        }
    }
    Ok(encode_rgb8(sheet_width, sheet_height, &codes)?)
}
