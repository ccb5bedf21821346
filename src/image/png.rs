//! 8-bit sRGB pictures for people to look at.

use super::{Image, ImageError, tone_map};

/// A PNG of a linear picture with 1 (grey) or 3 (red, green, blue) channels: every value times `exposure`, highlights
/// rolled off ([`roll_off`](super::roll_off)), sRGB transfer function, 8 bits. NaN and negative values are black.
pub fn encode_png(image: &Image, exposure: f64) -> Result<Vec<u8>, ImageError> {
    image.check()?;
    if !(exposure.is_finite() && exposure > 0.0) {
        return Err(ImageError::Exposure(exposure));
    }
    let colour = match image.channels.len() {
        1 => png::ColorType::Grayscale,
        3 => png::ColorType::Rgb,
        found => return Err(ImageError::Channels { found }),
    };
    let codes: Vec<u8> = image.values.iter().map(|value| tone_map(*value, exposure)).collect();
    encode(image.width, image.height, colour, &codes)
}

/// A PNG of ready sRGB codes, three bytes a pixel, rows from the top.
pub fn encode_rgb8(width: usize, height: usize, codes: &[u8]) -> Result<Vec<u8>, ImageError> {
    let needed = width.checked_mul(height).and_then(|n| n.checked_mul(3));
    if needed != Some(codes.len()) || codes.is_empty() {
        return Err(ImageError::Shape { width, height, n_channels: 3, n_values: codes.len() });
    }
    encode(width, height, png::ColorType::Rgb, codes)
}

fn encode(width: usize, height: usize, colour: png::ColorType, codes: &[u8]) -> Result<Vec<u8>, ImageError> {
    // State the size; a PNG side is below 2³¹, which codes held in memory can exceed only in absurd shapes.
    let side = |n: usize| {
        u32::try_from(n).map_err(|_| ImageError::Shape {
            width,
            height,
            n_channels: colour.samples(),
            n_values: codes.len(),
        })
    };
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, side(width)?, side(height)?);

    // Declare what the codes mean.
    encoder.set_color(colour);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);

    // Write all rows and close the stream.
    let mut writer = encoder.write_header()?;
    writer.write_image_data(codes)?;
    writer.finish()?;
    Ok(bytes)
}
