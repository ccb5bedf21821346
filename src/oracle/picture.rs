//! What the camera sees of a solved light field.

use crate::assembly::Measurement;
use crate::image::Image;
use crate::linalg::Block;

/// The picture of each field: emission seen directly plus W applied to the field. The first picture is the emission alone.
///
/// With fields E, E + K E, …, L the pictures show the scene after 0, 1, 2, … and all bounces. `progress` hears the finished share.
pub fn pictures(measurement: &Measurement, fields: &[&Block], progress: &(dyn Fn(f64) + Sync)) -> Vec<Image> {
    let mut blocks = measurement.apply(fields, progress).into_iter();
    let seen = blocks.next().unwrap_or_default();
    let with_emission = blocks.map(|mut gathered| {
        gathered.add_scaled(1.0, &seen);
        gathered
    });
    let film = &measurement.camera().film;
    let (width, height) = (film.width, film.height);
    let all: Vec<Block> = with_emission.collect();
    std::iter::once(&seen).chain(&all).map(|block| to_image(block, width, height)).collect()
}

/// Pixels × bands as an image; three bands are named R, G, B, others by number.
pub fn to_image(pixels: &Block, width: usize, height: usize) -> Image {
    let n_bands = pixels.n_columns();
    let channels = match n_bands {
        1 => vec!["Y".to_string()],
        3 => ["R", "G", "B"].map(String::from).to_vec(),
        _ => (0..n_bands).map(|band| format!("band{band}")).collect(),
    };
    let mut image = Image::zeros(width, height, channels);
    for y in 0..height {
        for x in 0..width {
            for (slot, value) in image.pixel_mut(x, y).iter_mut().zip(pixels.row(y * width + x)) {
                *slot = value;
            }
        }
    }
    image
}
