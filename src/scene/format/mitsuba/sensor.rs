//! `sensor` and `film`: the camera.

use super::document::{Document, Element};
use super::object::{Kind, Object, Plugin};
use super::{renderer, value};
use crate::scene::format::error::quoted;
use crate::scene::format::number::parse_number;
use crate::scene::format::{Code, FormatError};
use crate::scene::{Camera, Film, PixelFilter};

static SENSORS: [Plugin; 1] = [Plugin {
    name: "perspective",
    parameters: &[
        ("fov", Kind::Float),
        ("fov_axis", Kind::Text),
        ("focal_length", Kind::Text),
        ("near_clip", Kind::Float),
        ("far_clip", Kind::Float),
        ("focus_distance", Kind::Float),
        ("principal_point_offset_x", Kind::Float),
        ("principal_point_offset_y", Kind::Float),
        ("to_world", Kind::Transform),
    ],
    parts: &[("film", 1), ("sampler", 1)],
}];
static FILMS: [Plugin; 1] = [Plugin {
    name: "hdrfilm",
    parameters: &[
        ("width", Kind::Integer),
        ("height", Kind::Integer),
        ("crop_offset_x", Kind::Integer),
        ("crop_offset_y", Kind::Integer),
        ("crop_width", Kind::Integer),
        ("crop_height", Kind::Integer),
        ("file_format", Kind::Text),
        ("pixel_format", Kind::Text),
        ("component_format", Kind::Text),
        ("sample_border", Kind::Boolean),
        ("compensate", Kind::Boolean),
    ],
    parts: &[("rfilter", 1)],
}];
static FILTERS: [Plugin; 6] = [
    Plugin { name: "box", parameters: &[], parts: &[] },
    Plugin { name: "tent", parameters: &[("radius", Kind::Float)], parts: &[] },
    Plugin { name: "gaussian", parameters: &[("stddev", Kind::Float)], parts: &[] },
    Plugin { name: "mitchell", parameters: &[("B", Kind::Float), ("C", Kind::Float)], parts: &[] },
    Plugin { name: "catmullrom", parameters: &[], parts: &[] },
    Plugin { name: "lanczos", parameters: &[("lobes", Kind::Integer)], parts: &[] },
];

const AXES: [&str; 5] = ["x", "y", "diagonal", "smaller", "larger"];
/// A sensor without field of view has a 50 mm lens.
const DEFAULT_FOCAL_LENGTH: f64 = 50.0;
/// Diagonal of the 36 mm × 24 mm frame behind a focal length, squared.
const FRAME_DIAGONAL_SQUARED: f64 = 36.0 * 36.0 + 24.0 * 24.0;
/// Default size of a film in pixels.
const DEFAULT_SIZE: (i64, i64) = (768, 576);
/// A film may have this many pixels on a side.
const MAX_SIDE: i64 = 1 << 16;
/// A camera's frame may be this far from orthonormal: what ten digits of a matrix leave.
const FRAME_TOLERANCE: f64 = 1e-6;

/// Reads a `sensor`.
pub(super) fn camera(document: &Document, element: &Element) -> Result<Camera, FormatError> {
    // Read the film and check what steers a renderer only.
    let object = Object::open(document, element, &SENSORS)?;
    for sampler in object.parts("sampler") {
        renderer::check_sampler(document, sampler)?;
    }
    let film = match object.parts("film").next() {
        Some(element) => film(document, element)?,
        None => default_film(),
    };
    check_clipping(&object)?;
    for name in ["principal_point_offset_x", "principal_point_offset_y"] {
        if object.number(name)?.is_some_and(|offset| offset != 0.0) {
            return Err(object.error(Code::UnsupportedValue, name, format!("`{name}` is not zero")).expected("0"));
        }
    }

    // Split the field of view over the film's sides.
    let aspect = film.width as f64 / film.height as f64;
    let tangent_half_width = tangent_half_width(&object, aspect)?;

    // Take the frame from the transform: x appears on the left of the picture, y points up in it, z along the line of
    // sight.
    let to_world = object.transform("to_world")?;
    let axes = [to_world.matrix3.x_axis, to_world.matrix3.y_axis, to_world.matrix3.z_axis];
    let skewed = |i: usize| axes[i].dot(axes[(i + 1) % 3]).abs() > FRAME_TOLERANCE;
    let scaled = |i: usize| (axes[i].length() - 1.0).abs() > FRAME_TOLERANCE;
    if let Some(axis) = (0..3).find(|i| skewed(*i) || scaled(*i)) {
        let found = format!("the camera's axis {axis} is scaled or sheared, its length is {}", axes[axis].length());
        return Err(object
            .error(Code::InvalidTransform, "to_world", found)
            .expected("rotations and translations only"));
    }
    let (forward, up) = (axes[2].normalize(), axes[1].reject_from(axes[2]).normalize());
    let left = up.cross(forward);
    let right = if left.dot(axes[0]) > 0.0 { -left } else { left };
    Ok(Camera {
        origin: to_world.translation,
        forward,
        right,
        up,
        tangent_half_width,
        tangent_half_height: tangent_half_width / aspect,
        film,
    })
}

/// The clipping distances bound what a renderer sees; the scene has no such bound.
fn check_clipping(object: &Object) -> Result<(), FormatError> {
    let near = object.number("near_clip")?.unwrap_or(1e-2);
    let far = object.number("far_clip")?.unwrap_or(1e4);
    for (name, distance) in [("near_clip", near), ("far_clip", far - near)] {
        if distance <= 0.0 {
            let found = format!("clipping from {near} to {far}");
            return Err(object.error(Code::OutOfRange, name, found).expected("0 < near_clip < far_clip"));
        }
    }
    Ok(())
}

/// Tangent of half the horizontal field of view.
fn tangent_half_width(object: &Object, aspect: f64) -> Result<f64, FormatError> {
    let across_diagonal = |tangent: f64| tangent / (1.0 + 1.0 / (aspect * aspect)).sqrt();
    let Some(degrees) = object.number("fov")? else {
        if object.value("fov_axis").is_some() {
            let error = object.error(Code::MissingValue, "fov_axis", "`fov_axis` is given without `fov`");
            return Err(error.expected("`fov` beside it, or `focal_length` alone"));
        }
        let millimetres = focal_length(object)?;
        return Ok(across_diagonal(0.5 * FRAME_DIAGONAL_SQUARED.sqrt() / millimetres));
    };
    if object.value("focal_length").is_some() {
        let error = object.error(Code::RepeatedValue, "focal_length", "`focal_length` is given beside `fov`");
        return Err(error.expected("either of them"));
    }
    if !(degrees > 0.0 && degrees < 180.0) {
        return Err(object
            .error(Code::OutOfRange, "fov", format!("`fov` is {degrees}"))
            .expected("degrees between 0 and 180"));
    }
    let tangent = (0.5 * degrees).to_radians().tan();
    let axis = object.value("fov_axis").map(|a| value::word(object.document, a, &AXES)).transpose()?;
    Ok(match AXES[axis.unwrap_or(0)] {
        "x" => tangent,
        "y" => tangent * aspect,
        "diagonal" => across_diagonal(tangent),
        "smaller" if aspect > 1.0 => tangent * aspect,
        "larger" if aspect <= 1.0 => tangent * aspect,
        _ => tangent,
    })
}

fn focal_length(object: &Object) -> Result<f64, FormatError> {
    let Some(attribute) = object.value("focal_length") else { return Ok(DEFAULT_FOCAL_LENGTH) };
    let word = attribute.value.trim();
    let number = parse_number(word.strip_suffix("mm").unwrap_or(word));
    number.ok().filter(|millimetres| *millimetres > 0.0).ok_or_else(|| {
        let found = format!("{} is not a focal length", quoted(word));
        object.error(Code::InvalidNumber, "focal_length", found).expected("millimetres above zero, e.g. 50mm")
    })
}

fn default_film() -> Film {
    Film { width: DEFAULT_SIZE.0 as usize, height: DEFAULT_SIZE.1 as usize, filter: default_filter() }
}

fn default_filter() -> PixelFilter {
    PixelFilter::Gaussian { standard_deviation: 0.5 }
}

/// Reads a `film`.
fn film(document: &Document, element: &Element) -> Result<Film, FormatError> {
    // Take its size; a crop must be the whole of it.
    let object = Object::open(document, element, &FILMS)?;
    let side = |name: &str, default| {
        let n = object.integer(name)?.unwrap_or(default);
        if (1..=MAX_SIDE).contains(&n) {
            return Ok(n);
        }
        Err(object
            .error(Code::OutOfRange, name, format!("`{name}` is {n}"))
            .expected(format!("1 to {MAX_SIDE} pixels")))
    };
    let (width, height) = (side("width", DEFAULT_SIZE.0)?, side("height", DEFAULT_SIZE.1)?);
    for (name, whole) in [("crop_offset_x", 0), ("crop_offset_y", 0), ("crop_width", width), ("crop_height", height)] {
        if let Some(n) = object.integer(name)?.filter(|n| *n != whole) {
            let error = object.error(Code::UnsupportedValue, name, format!("`{name}` is {n}: crops are not read"));
            return Err(error.expected(format!("{whole}, the whole film")));
        }
    }

    // Check the words that say how a renderer would store it.
    let words: [(&str, &[&str]); 3] = [
        ("file_format", &["openexr", "exr", "rgbe", "pfm"]),
        ("pixel_format", &["luminance", "luminance_alpha", "rgb", "rgba", "xyz", "xyza"]),
        ("component_format", &["float16", "float32", "uint32"]),
    ];
    for (name, words) in words {
        if let Some(attribute) = object.value(name) {
            value::word(document, attribute, words)?;
        }
    }
    let filter = object.parts("rfilter").next().map(|e| filter(document, e)).transpose()?;
    Ok(Film { width: width as usize, height: height as usize, filter: filter.unwrap_or_else(default_filter) })
}

/// Reads an `rfilter`.
fn filter(document: &Document, element: &Element) -> Result<PixelFilter, FormatError> {
    let object = Object::open(document, element, &FILTERS)?;
    let length = |name: &str, default| {
        let length = object.number(name)?.unwrap_or(default);
        if length > 0.0 {
            return Ok(length);
        }
        Err(object.error(Code::OutOfRange, name, format!("`{name}` is {length}")).expected("a number above zero"))
    };
    Ok(match object.plugin.name {
        "box" => PixelFilter::Box { radius: 0.5 },
        "tent" => PixelFilter::Tent { radius: length("radius", 1.0)? },
        "gaussian" => PixelFilter::Gaussian { standard_deviation: length("stddev", 0.5)? },
        "catmullrom" => PixelFilter::CatmullRom,
        "mitchell" => PixelFilter::Mitchell {
            b: object.number("B")?.unwrap_or(1.0 / 3.0),
            c: object.number("C")?.unwrap_or(1.0 / 3.0),
        },
        _ => {
            let lobes = object.integer("lobes")?.unwrap_or(3);
            if !(1..=16).contains(&lobes) {
                let error = object.error(Code::OutOfRange, "lobes", format!("`lobes` is {lobes}"));
                return Err(error.expected("1 to 16"));
            }
            PixelFilter::Lanczos { lobes: lobes as f64 }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_lens_sees_the_diagonal_of_the_frame() {
        // 50 mm on a 36 mm × 24 mm frame: exactly 36/100 on a film of the frame's aspect.
        let across = 0.5 * FRAME_DIAGONAL_SQUARED.sqrt() / DEFAULT_FOCAL_LENGTH / (1.0f64 + 1.0 / 2.25).sqrt();
        assert!((across - 0.36).abs() < 4.0 * f64::EPSILON, "{across}");
    }
}
