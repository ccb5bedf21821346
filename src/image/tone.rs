//! From linear radiance to what a screen shows: exposure, highlight roll-off, the sRGB transfer function.

use super::Image;

/// Fraction of the lit pixels that the chosen exposure keeps below [`ROLL_OFF_START`].
const EXPOSED_FRACTION: f64 = 0.95;

/// Where the highlight roll-off leaves the straight line.
const ROLL_OFF_START: f64 = 0.8;

/// The factor that brings the 95th percentile of the lit pixels (by their brightest channel) to 0.8, where the
/// highlight roll-off begins: 95 % of the picture is then shown as it is, and a lamp in view does not darken the room.
///
/// Black and non-finite pixels (the void around an open scene) are not counted; a picture without any light gets 1.
/// Cost: one partial sort of the pixels.
pub fn choose_exposure(image: &Image) -> f64 {
    let n_channels = image.channels.len().max(1);
    let brightest = |pixel: &[f64]| pixel.iter().copied().fold(0.0, f64::max);
    let mut lit: Vec<f64> =
        image.values.chunks(n_channels).map(brightest).filter(|v| *v > 0.0 && v.is_finite()).collect();
    if lit.is_empty() {
        return 1.0;
    }
    let rank = ((lit.len() - 1) as f64 * EXPOSED_FRACTION).round() as usize;
    let (_, percentile, _) = lit.select_nth_unstable_by(rank, f64::total_cmp);
    let exposure = ROLL_OFF_START / *percentile;
    if exposure.is_finite() && exposure > 0.0 { exposure } else { 1.0 }
}

/// Compresses highlights: v below 0.8, and above it 0.8 + 0.2 (1 − exp(−(v − 0.8) / 0.2)), which goes on with slope 1
/// and tends to 1. Negative values and NaN become 0.
pub fn roll_off(value: f64) -> f64 {
    let room = 1.0 - ROLL_OFF_START;
    if value > ROLL_OFF_START { 1.0 - room * (-(value - ROLL_OFF_START) / room).exp() } else { value.max(0.0) }
}

/// The sRGB transfer function (IEC 61966-2-1): linear in [0, 1] to encoded in [0, 1], values outside clamped.
pub fn srgb_encode(linear: f64) -> f64 {
    let v = linear.clamp(0.0, 1.0);
    if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
}

/// The inverse of [`srgb_encode`].
pub fn srgb_decode(encoded: f64) -> f64 {
    let v = encoded.clamp(0.0, 1.0);
    if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

/// One linear value as an 8-bit sRGB code: exposure, roll-off, transfer function, rounding.
pub fn tone_map(value: f64, exposure: f64) -> u8 {
    (255.0 * srgb_encode(roll_off(value * exposure))).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Codes of the sRGB standard: black, the end of the straight piece, middle grey (18 %) and white.
    #[test]
    fn srgb_has_its_known_codes() {
        for (linear, code) in
            [(0.0, 0), (0.003_130_8, 10), (0.18, 118), (0.215_860_5, 128), (1.0, 255), (7.0, 255), (-1.0, 0)]
        {
            assert_eq!((255.0 * srgb_encode(linear)).round() as u8, code, "linear {linear}");
        }
    }

    #[test]
    fn srgb_decodes_what_it_encodes() {
        // Rounding of two power functions, and the 1e-8 gap between the standard's two pieces.
        let tolerance = 1e-7;
        for code in 0..=255 {
            let encoded = f64::from(code) / 255.0;
            assert!((srgb_encode(srgb_decode(encoded)) - encoded).abs() < tolerance, "code {code}");
        }
    }

    #[test]
    fn roll_off_is_straight_then_smooth_and_never_falls() {
        assert_eq!(roll_off(0.5), 0.5);
        assert_eq!(roll_off(f64::NAN), 0.0);
        assert_eq!(roll_off(f64::INFINITY), 1.0);
        let samples: Vec<f64> = (0..4000).map(|i| roll_off(f64::from(i) * 1e-3)).collect();
        assert!(samples.windows(2).all(|w| w[0] <= w[1] && w[1] - w[0] <= 1.001e-3));
    }

    /// 100 pixels of which 96 hold 0.5 and four a lamp: the lamp does not count.
    #[test]
    fn exposure_ignores_a_lamp_and_the_void() {
        let mut image = Image::zeros(20, 10, vec!["Y".into()]);
        image.values[..96].fill(0.5);
        image.values[96..100].fill(1e4);
        assert_eq!(choose_exposure(&image), 1.6);
        assert_eq!(choose_exposure(&Image::zeros(3, 3, vec!["Y".into()])), 1.0);
        image.values.fill(f64::NAN);
        assert_eq!(choose_exposure(&image), 1.0);
    }
}
