//! OpenEXR: linear float32 channels, for programs to read.

use super::{Image, ImageError};
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Layer, LayerAttributes, MetaData, ReadChannels, ReadLayers,
    SmallVec, Text, WritableImage, read,
};
use std::io::Cursor;

/// The most that one byte of an EXR file can say about its pixels: deflate expands at most 1032 times.
const MOST_EXPANSION: u128 = 1100;

/// Channels in the order people expect; all others follow by name.
const USUAL_ORDER: [&str; 5] = ["R", "G", "B", "A", "Y"];

/// A scanline OpenEXR file with one float32 channel for each of the picture's, under the same names, ZIP-compressed
/// without loss. What exceeds float32 becomes infinite.
pub fn encode_exr(image: &Image) -> Result<Vec<u8>, ImageError> {
    image.check()?;

    // Pull the interleaved channels apart.
    let n_channels = image.channels.len();
    let mut channels: SmallVec<[AnyChannel<FlatSamples>; 4]> = SmallVec::new();
    for (c, name) in image.channels.iter().enumerate() {
        if image.channels[..c].contains(name) {
            return Err(ImageError::DuplicateChannel(name.clone()));
        }
        let samples = image.values.iter().skip(c).step_by(n_channels).map(|v| *v as f32).collect();
        channels.push(AnyChannel::new(Text::from(name.as_str()), FlatSamples::F32(samples)));
    }

    // Write one layer, in one thread so that the bytes do not depend on their number.
    let size = (image.width, image.height);
    let layer = Layer::new(size, LayerAttributes::default(), Encoding::SMALL_LOSSLESS, AnyChannels::sort(channels));
    let mut bytes = Cursor::new(Vec::new());
    exr::image::Image::from_layer(layer).write().non_parallel().to_buffered(&mut bytes).map_err(ImageError::Exr)?;
    Ok(bytes.into_inner())
}

/// Reads the first layer of a scanline OpenEXR file, channels in the order R, G, B, A, Y, then by name.
///
/// The bytes are not trusted: memory is bounded by what a file of this length can hold, and everything malformed is an
/// error. Tiles, deep data and subsampled channels are refused.
pub fn decode_exr(bytes: &[u8]) -> Result<Image, ImageError> {
    check_header(bytes)?;

    // Read every channel of the first layer.
    let picture = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(ImageError::Exr)?;
    let layer = picture.layer_data;

    // Put the channels in the usual order.
    let mut channels: Vec<(String, FlatSamples)> =
        layer.channel_data.list.into_iter().map(|c| (c.name.to_string(), c.sample_data)).collect();
    let place = |name: &str| USUAL_ORDER.iter().position(|usual| *usual == name).unwrap_or(USUAL_ORDER.len());
    channels.sort_by(|(a, _), (b, _)| place(a).cmp(&place(b)).then_with(|| a.cmp(b)));

    // Interleave them.
    let names = channels.iter().map(|(name, _)| name.clone()).collect();
    let mut image = Image::zeros(layer.size.width(), layer.size.height(), names);
    let n_channels = channels.len();
    for (c, (_, samples)) in channels.iter().enumerate() {
        for (slot, value) in image.values.iter_mut().skip(c).step_by(n_channels).zip(samples.values_as_f32()) {
            *slot = f64::from(value);
        }
    }
    image.check()?;
    Ok(image)
}

/// Refuses what is not read here and what announces more than it can hold, before anything is allocated for it.
fn check_header(bytes: &[u8]) -> Result<(), ImageError> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(ImageError::Exr)?;
    let mut announced: u128 = 0;
    for header in &meta.headers {
        if header.deep {
            return Err(ImageError::ExrUnsupported("deep data"));
        }
        if header.blocks.has_tiles() {
            return Err(ImageError::ExrUnsupported("tiles"));
        }
        if header.channels.list.iter().any(|c| c.sampling.x() != 1 || c.sampling.y() != 1) {
            return Err(ImageError::ExrUnsupported("subsampled channels"));
        }
        let (width, height) = (header.layer_size.width() as u128, header.layer_size.height() as u128);
        announced += width * height * header.channels.bytes_per_pixel as u128;
    }
    let allowed = MOST_EXPANSION * bytes.len() as u128;
    if announced > allowed {
        return Err(ImageError::ExrAnnouncesTooMuch { announced, allowed, file: bytes.len() });
    }
    Ok(())
}
