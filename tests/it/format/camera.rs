//! The camera of a file, against rays of Mitsuba 3.9.1.

use super::{LAMP, ROUNDING, code, scene};
use etendue::geometry::Vec3;
use etendue::scene::format::Code;
use etendue::scene::{Camera, PixelFilter};

fn sensor(parameters: &str, film: &str) -> Result<Camera, etendue::scene::format::FormatError> {
    let film = format!(r#"<film type="hdrfilm">{film}</film>"#);
    let scene = scene(&format!(r#"{LAMP}<sensor type="perspective">{parameters}{film}</sensor>"#))?;
    Ok(scene.camera().expect("the scene has a sensor").clone())
}

fn size(width: usize, height: usize) -> String {
    format!(r#"<integer name="width" value="{width}"/><integer name="height" value="{height}"/>"#)
}

fn direction(camera: &Camera, across: f64, down: f64) -> Vec3 {
    camera.ray(across * camera.film.width as f64, down * camera.film.height as f64).direction.normalize()
}

/// Directions that Mitsuba printed with three decimals.
fn assert_direction(camera: &Camera, (across, down): (f64, f64), expected: [f64; 3]) {
    let found = direction(camera, across, down);
    let half_a_digit = 0.5e-3 + 1e-6;
    assert!((found - Vec3::from_array(expected)).abs().max_element() < half_a_digit, "{found} {expected:?}");
}

#[test]
fn pictures_have_the_sides_of_mitsuba() {
    let plain = sensor("", &size(40, 20)).unwrap();
    assert_direction(&plain, (0.0, 0.0), [0.355, 0.178, 0.918]);
    assert_direction(&plain, (1.0, 0.0), [-0.355, 0.178, 0.918]);
    assert_direction(&plain, (0.0, 1.0), [0.355, -0.178, 0.918]);

    let to_world = |steps: &str| format!(r#"<transform name="to_world">{steps}</transform>"#);
    let looking = sensor(&to_world(r#"<lookat origin="0,1,4" target="0,0,0" up="0,1,0"/>"#), &size(40, 20)).unwrap();
    assert_eq!(looking.origin, Vec3::new(0.0, 1.0, 4.0));
    assert_direction(&looking, (0.0, 0.0), [-0.355, -0.05, -0.933]);
    assert_direction(&looking, (0.0, 1.0), [-0.355, -0.395, -0.847]);
    assert_eq!(looking.right, Vec3::X);

    let mirrored = sensor(&to_world(r#"<scale x="-1"/>"#), &size(40, 20)).unwrap();
    assert_direction(&mirrored, (0.0, 0.0), [-0.355, 0.178, 0.918]);
}

#[test]
fn the_field_of_view_is_measured_along_its_axis() {
    let fov = |axis: &str| format!(r#"<float name="fov" value="60"/><string name="fov_axis" value="{axis}"/>"#);
    let wide = [("x", 0.485), ("y", 0.707), ("diagonal", 0.447), ("smaller", 0.707), ("larger", 0.485)];
    for (axis, x) in wide {
        let camera = sensor(&fov(axis), &size(40, 20)).unwrap();
        let corner = direction(&camera, 0.0, 0.0);
        assert!((corner.x - x).abs() < 0.5e-3 + 1e-6, "{axis} {corner}");
        assert!((corner.x - 2.0 * corner.y).abs() < ROUNDING, "{axis} {corner}");
    }
    let tall = [("x", 0.354), ("y", 0.243), ("diagonal", 0.224), ("smaller", 0.354), ("larger", 0.243)];
    for (axis, x) in tall {
        let corner = direction(&sensor(&fov(axis), &size(20, 40)).unwrap(), 0.0, 0.0);
        assert!((corner.x - x).abs() < 0.5e-3 + 1e-6, "{axis} {corner}");
    }
    let default = sensor(r#"<float name="fov" value="60"/>"#, &size(40, 20)).unwrap();
    assert!((default.tangent_half_width - 30f64.to_radians().tan()).abs() < ROUNDING);
    for lens in ["50mm", "50"] {
        let camera = sensor(&format!(r#"<string name="focal_length" value="{lens}"/>"#), &size(40, 20)).unwrap();
        assert_eq!(camera, sensor("", &size(40, 20)).unwrap());
    }
}

#[test]
fn films_and_filters_have_the_defaults_of_mitsuba() {
    let plain = scene(&format!(r#"{LAMP}<sensor type="perspective"/>"#)).unwrap().camera().unwrap().film.clone();
    assert_eq!((plain.width, plain.height), (768, 576));
    let filter = |element: &str| sensor("", element).unwrap().film.filter;
    let gaussian = PixelFilter::Gaussian { standard_deviation: 0.5 };
    assert_eq!((plain.filter, filter("")), (gaussian, gaussian));
    let cases = [
        (r#"<rfilter type="box"/>"#, PixelFilter::Box { radius: 0.5 }),
        (r#"<rfilter type="tent"/>"#, PixelFilter::Tent { radius: 1.0 }),
        (r#"<rfilter type="tent"><float name="radius" value="2"/></rfilter>"#, PixelFilter::Tent { radius: 2.0 }),
        (
            r#"<rfilter type="gaussian"><float name="stddev" value="0.25"/></rfilter>"#,
            PixelFilter::Gaussian { standard_deviation: 0.25 },
        ),
        (r#"<rfilter type="mitchell"/>"#, PixelFilter::Mitchell { b: 1.0 / 3.0, c: 1.0 / 3.0 }),
        (
            r#"<rfilter type="mitchell"><float name="B" value="0"/></rfilter>"#,
            PixelFilter::Mitchell { b: 0.0, c: 1.0 / 3.0 },
        ),
        (r#"<rfilter type="catmullrom"/>"#, PixelFilter::CatmullRom),
        (r#"<rfilter type="lanczos"/>"#, PixelFilter::Lanczos { lobes: 3.0 }),
        (r#"<rfilter type="lanczos"><integer name="lobes" value="2"/></rfilter>"#, PixelFilter::Lanczos { lobes: 2.0 }),
    ];
    for (element, expected) in cases {
        assert_eq!(filter(element), expected, "{element}");
    }
    let whole =
        format!(r#"{}<integer name="crop_width" value="40"/><integer name="crop_offset_x" value="0"/>"#, size(40, 20));
    assert!(sensor("", &whole).is_ok());
}

#[test]
fn cameras_that_cannot_be_are_refused() {
    let refused = |parameters: &str, film: &str| code(sensor(parameters, film));
    let to_world = |steps: &str| format!(r#"<transform name="to_world">{steps}</transform>"#);
    let both = r#"<float name="fov" value="60"/><string name="focal_length" value="50mm"/>"#;
    let cases = [
        (to_world(r#"<scale value="2"/>"#), "", Code::InvalidTransform),
        (to_world(r#"<matrix value="1 0.5 0 0 1 0 0 0 1"/>"#), "", Code::InvalidTransform),
        (r#"<float name="fov" value="180"/>"#.into(), "", Code::OutOfRange),
        (r#"<float name="fov" value="0"/>"#.into(), "", Code::OutOfRange),
        (both.into(), "", Code::RepeatedValue),
        (r#"<string name="fov_axis" value="x"/>"#.into(), "", Code::MissingValue),
        (r#"<float name="fov" value="9"/><string name="fov_axis" value="z"/>"#.into(), "", Code::InvalidWord),
        (r#"<string name="focal_length" value="mm"/>"#.into(), "", Code::InvalidNumber),
        (r#"<float name="principal_point_offset_x" value="0.1"/>"#.into(), "", Code::UnsupportedValue),
        (r#"<float name="near_clip" value="0"/>"#.into(), "", Code::OutOfRange),
        (r#"<float name="far_clip" value="0.001"/>"#.into(), "", Code::OutOfRange),
        ("".into(), r#"<integer name="crop_width" value="7"/>"#, Code::UnsupportedValue),
        ("".into(), r#"<integer name="width" value="0"/>"#, Code::OutOfRange),
        ("".into(), r#"<integer name="width" value="1000000000"/>"#, Code::OutOfRange),
        ("".into(), r#"<float name="width" value="8"/>"#, Code::WrongType),
        ("".into(), r#"<string name="pixel_format" value="cmyk"/>"#, Code::InvalidWord),
        ("".into(), r#"<rfilter type="tent"><float name="radius" value="0"/></rfilter>"#, Code::OutOfRange),
        ("".into(), r#"<rfilter type="tent"/><rfilter type="box"/>"#, Code::RepeatedValue),
    ];
    for (parameters, film, expected) in cases {
        assert_eq!(refused(&parameters, film), Some(expected), "{parameters} {film}");
    }
    let two = format!(r#"{LAMP}<sensor type="perspective"/><sensor type="perspective"/>"#);
    assert_eq!(code(scene(&two)), Some(Code::RepeatedValue));
}
