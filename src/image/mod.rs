//! Pixels with named channels, and the files that hold them. Knows no light.

mod error;
mod exr;
mod png;
mod tone;

pub use error::ImageError;
pub use exr::{decode_exr, encode_exr};
pub use png::{encode_png, encode_rgb8};
pub use tone::{choose_exposure, roll_off, srgb_decode, srgb_encode, tone_map};

/// A rectangle of pixels with named f64 channels; row 0 is at the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    pub width: usize,
    pub height: usize,
    /// Channel names, e.g. `["R", "G", "B"]`.
    pub channels: Vec<String>,
    /// Pixel-interleaved: value of channel c at (x, y) is at (y · width + x) · channels.len() + c.
    pub values: Vec<f64>,
}

impl Image {
    /// All zeros.
    pub fn zeros(width: usize, height: usize, channels: Vec<String>) -> Self {
        let values = vec![0.0; width * height * channels.len()];
        Self { width, height, channels, values }
    }

    /// The channels of one pixel.
    pub fn pixel(&self, x: usize, y: usize) -> &[f64] {
        let n = self.channels.len();
        &self.values[(y * self.width + x) * n..][..n]
    }

    pub fn pixel_mut(&mut self, x: usize, y: usize) -> &mut [f64] {
        let n = self.channels.len();
        &mut self.values[(y * self.width + x) * n..][..n]
    }

    /// Refuses a picture without pixels and one whose values do not fill its shape (both fields are public).
    fn check(&self) -> Result<(), ImageError> {
        let Self { width, height, channels, values } = self;
        let needed = width.checked_mul(*height).and_then(|n| n.checked_mul(channels.len()));
        if needed == Some(values.len()) && !values.is_empty() {
            return Ok(());
        }
        Err(ImageError::Shape { width: *width, height: *height, n_channels: channels.len(), n_values: values.len() })
    }
}
