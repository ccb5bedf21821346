//! Pixels with named channels, and the files that hold them. Knows no light.

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
}
