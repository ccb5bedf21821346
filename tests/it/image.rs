//! Pictures survive their files, and hostile files end in errors.

use etendue::image::{Image, ImageError, decode_exr, encode_exr, encode_png, encode_rgb8};
use proptest::prelude::*;

/// A picture with values of every magnitude that float32 holds.
fn gradient(width: usize, height: usize, channels: &[&str]) -> Image {
    let mut image = Image::zeros(width, height, channels.iter().map(|c| c.to_string()).collect());
    for (i, value) in image.values.iter_mut().enumerate() {
        *value = f64::from(((i % 250) as f32 - 125.0).exp2() * (1.0 + i as f32 * 1e-3));
    }
    image
}

#[test]
fn exr_returns_every_float32_exactly() {
    for channels in [&["R", "G", "B"][..], &["Y"], &["R", "G", "B", "A"], &["450nm", "550nm", "650nm", "750nm"]] {
        let mut image = gradient(17, 9, channels);
        image.values[0] = f64::from(f32::MIN_POSITIVE);
        image.values[1] = -1.5;
        assert_eq!(decode_exr(&encode_exr(&image).unwrap()).unwrap(), image, "{channels:?}");
    }
}

#[test]
fn exr_does_not_depend_on_the_thread_count_or_run() {
    let image = gradient(64, 64, &["R", "G", "B"]);
    assert_eq!(encode_exr(&image).unwrap(), encode_exr(&image).unwrap());
}

/// Black compresses best of all: the bound on what a file can hold must not refuse it.
#[test]
fn exr_reads_a_large_black_picture() {
    let image = Image::zeros(2048, 2048, vec!["Y".into()]);
    assert_eq!(decode_exr(&encode_exr(&image).unwrap()).unwrap(), image);
}

#[test]
fn truncated_exr_is_an_error_at_every_length() {
    let bytes = encode_exr(&gradient(8, 5, &["R", "G", "B"])).unwrap();
    for length in 0..bytes.len() {
        assert!(decode_exr(&bytes[..length]).is_err(), "{length} of {} bytes were read as a picture", bytes.len());
    }
}

/// The data window is set to 2³⁰ × 2³⁰ pixels in a file of a few hundred bytes.
#[test]
fn exr_that_announces_too_much_is_refused_before_allocation() {
    let mut bytes = encode_exr(&gradient(8, 5, &["Y"])).unwrap();
    let side = ((1_i32 << 30) - 1).to_le_bytes();
    for name in [b"dataWindow\0box2i\0".as_slice(), b"displayWindow\0box2i\0"] {
        let at = bytes.windows(name.len()).position(|w| w == name).unwrap() + name.len() + 4 + 8;
        bytes[at..at + 4].copy_from_slice(&side);
        bytes[at + 4..at + 8].copy_from_slice(&side);
    }
    assert!(matches!(decode_exr(&bytes), Err(ImageError::ExrAnnouncesTooMuch { .. } | ImageError::Exr(_))));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Any few bytes of a valid file overwritten: a picture or an error, never a panic.
    #[test]
    fn damaged_exr_never_panics(damage in prop::collection::vec((0_usize..1000, any::<u8>()), 1..12)) {
        let mut bytes = encode_exr(&gradient(8, 5, &["R", "G", "B"])).unwrap();
        let length = bytes.len();
        for (at, byte) in damage {
            bytes[at % length] = byte;
        }
        let _ = decode_exr(&bytes);
    }

    #[test]
    fn noise_is_not_a_picture(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        prop_assert!(decode_exr(&bytes).is_err());
    }
}

/// Reads a PNG back with the reference decoder: its width, height and codes.
fn decode_png(bytes: &[u8]) -> (u32, u32, Vec<u8>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut codes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut codes).unwrap();
    codes.truncate(info.buffer_size());
    (info.width, info.height, codes)
}

#[test]
fn png_shows_exposed_srgb() {
    let mut image = Image::zeros(3, 1, ["R", "G", "B"].map(String::from).to_vec());
    image.pixel_mut(0, 0).copy_from_slice(&[0.09, 0.0, -1.0]);
    image.pixel_mut(1, 0).copy_from_slice(&[f64::NAN, f64::INFINITY, 1e300]);
    image.pixel_mut(2, 0).copy_from_slice(&[0.107_930_25; 3]);

    // 18 % grey is code 118 and 21.6 % is code 128; NaN is black, and everything too bright is white.
    let (width, height, codes) = decode_png(&encode_png(&image, 2.0).unwrap());
    assert_eq!((width, height), (3, 1));
    assert_eq!(codes, [118, 0, 0, 0, 255, 255, 128, 128, 128]);
}

#[test]
fn png_of_ready_codes_returns_them() {
    let codes: Vec<u8> = (0..5 * 4 * 3).map(|i| (i * 4) as u8).collect();
    assert_eq!(decode_png(&encode_rgb8(5, 4, &codes).unwrap()), (5, 4, codes));
}

#[test]
fn pictures_that_make_no_sense_are_refused_by_name() {
    let rgb = gradient(4, 4, &["R", "G", "B"]);
    for exposure in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(encode_png(&rgb, exposure), Err(ImageError::Exposure(_))));
    }
    assert!(matches!(encode_png(&gradient(4, 4, &["a", "b"]), 1.0), Err(ImageError::Channels { found: 2 })));
    assert!(matches!(encode_exr(&gradient(4, 4, &["a", "a"])), Err(ImageError::DuplicateChannel(name)) if name == "a"));
    let empty = Image::zeros(0, 4, vec!["Y".into()]);
    assert!(matches!(encode_exr(&empty), Err(ImageError::Shape { .. })));
    assert!(matches!(encode_png(&empty, 1.0), Err(ImageError::Shape { .. })));
    let short = Image { values: vec![0.0; 5], ..rgb };
    assert!(matches!(encode_exr(&short), Err(ImageError::Shape { n_values: 5, .. })));
}
