//! `bsdf` and `emitter`: what a surface does to light, in linear sRGB.

use super::document::{Document, Element};
use super::object::{Kind, Object, Plugin};
use super::value;
use crate::scattering::{Brdf, Lambert};
use crate::scene::format::{Code, FormatError};
use std::sync::Arc;

static BSDFS: [Plugin; 2] = [
    Plugin { name: "diffuse", parameters: &[("reflectance", Kind::Colour)], parts: &[] },
    Plugin { name: "twosided", parameters: &[], parts: &[("bsdf", 2)] },
];
static EMITTERS: [Plugin; 1] = [Plugin { name: "area", parameters: &[("radiance", Kind::Colour)], parts: &[] }];

/// The reflectance of a surface of which nothing is said.
const DEFAULT_REFLECTANCE: f64 = 0.5;
/// The radiance of an emitter of which nothing is said.
const DEFAULT_RADIANCE: f64 = 1.0;
/// Linear sRGB of the spectrum that is 1 at every wavelength (illuminant E): row sums of the matrix from CIE XYZ,
/// ITU-R BT.709.
const ILLUMINANT_E: [f64; 3] = [
    3.240479 - 1.537150 - 0.498535,
    -0.969256 + 1.875991 + 0.041556, //
    0.055648 - 0.204043 + 1.057311,
];

/// What the two sides of a surface do to light; without a back it is black behind.
#[derive(Clone, Debug)]
pub(super) struct Material {
    pub front: Arc<dyn Brdf>,
    pub back: Option<Arc<dyn Brdf>>,
}

impl Default for Material {
    fn default() -> Self {
        Self { front: Arc::new(Lambert::grey(DEFAULT_REFLECTANCE, 3)), back: None }
    }
}

/// Reads a `bsdf`.
pub(super) fn material(document: &Document, element: &Element) -> Result<Material, FormatError> {
    let object = Object::open(document, element, &BSDFS)?;
    if object.plugin.name == "diffuse" {
        return Ok(Material { front: diffuse(&object)?, back: None });
    }

    // Take one nested material for both sides, or two for front and back.
    let sides: Vec<Arc<dyn Brdf>> = object
        .parts("bsdf")
        .map(|side| {
            let side = Object::open(document, side, &BSDFS)?;
            if side.plugin.name == "diffuse" {
                return diffuse(&side);
            }
            let found = format!("{} cannot stand inside {}", side.label(), object.label());
            Err(side.error(Code::MisplacedElement, "", found).expected("bsdf `diffuse`"))
        })
        .collect::<Result<_, _>>()?;
    match &sides[..] {
        [both] => Ok(Material { front: both.clone(), back: Some(both.clone()) }),
        [front, back] => Ok(Material { front: front.clone(), back: Some(back.clone()) }),
        _ => {
            let error = object.error(Code::MissingValue, "", "bsdf `twosided` needs a nested <bsdf>");
            Err(error.expected("one bsdf `diffuse` for both sides, or two for front and back"))
        }
    }
}

fn diffuse(object: &Object) -> Result<Arc<dyn Brdf>, FormatError> {
    let albedo = match object.given("reflectance") {
        Some(element) => colour(object, element, [1.0; 3], ("reflectance", 1.0, "within [0, 1]"))?,
        None => vec![DEFAULT_REFLECTANCE; 3],
    };
    Ok(Arc::new(Lambert::new(albedo)))
}

/// Reads an `emitter`: radiance in each band, W m⁻² sr⁻¹.
pub(super) fn radiance(document: &Document, element: &Element) -> Result<Vec<f64>, FormatError> {
    let object = Object::open(document, element, &EMITTERS)?;
    match object.given("radiance") {
        Some(element) => colour(&object, element, ILLUMINANT_E, ("radiance", f64::MAX, "finite and not negative")),
        None => Ok(vec![DEFAULT_RADIANCE; 3]),
    }
}

/// Reads a colour; `uniform` is what the spectrum that is 1 everywhere has in each band.
fn colour(
    object: &Object,
    element: &Element,
    uniform: [f64; 3],
    (name, high, range): (&str, f64, &str),
) -> Result<Vec<f64>, FormatError> {
    let document = object.document;
    let attribute = document.required(element, "value")?;
    if element.tag == "spectrum" && attribute.value.contains(':') {
        let error = document.error(Code::UnsupportedValue, &attribute.value_span, "spectra by wavelength are not read");
        return Err(error.expected("one number for every wavelength, or <rgb>"));
    }
    let counts: &[usize] = if element.tag == "rgb" { &[1, 3] } else { &[1] };
    let numbers = value::numbers(document, attribute, counts)?;
    if let Some(number) = numbers.iter().find(|number| !(0.0..=high).contains(*number)) {
        let found = format!("`{name}` is {number}");
        return Err(document.error(Code::OutOfRange, &attribute.value_span, found).expected(range));
    }
    Ok(match numbers[..] {
        [number] if element.tag == "spectrum" => uniform.map(|u| u * number).to_vec(),
        [number] => vec![number; 3],
        _ => numbers,
    })
}
