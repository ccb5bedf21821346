//! `transform`: a list of affine maps, the first applied first.

use super::document::{Document, Element};
use super::value;
use crate::geometry::{Affine3, Mat3, Vec3};
use crate::scene::format::error::quoted;
use crate::scene::format::{Code, FormatError};

const STEPS: [&str; 5] = ["translate", "rotate", "scale", "matrix", "lookat"];

/// The map that a `transform` element describes; that of an empty one is the identity.
pub(super) fn read(document: &Document, element: &Element) -> Result<Affine3, FormatError> {
    let mut transform = Affine3::IDENTITY;
    for step in element.children.iter().map(|c| &document.elements[*c]) {
        document.check_no_children(step)?;
        transform = match step.tag.as_str() {
            "translate" => Affine3::from_translation(value::vector(document, step, &[], Some(0.0))?),
            "scale" => Affine3::from_scale(value::vector(document, step, &[], Some(1.0))?),
            "rotate" => rotate(document, step)?,
            "matrix" => matrix(document, step)?,
            "lookat" => look_at(document, step)?,
            other => {
                let found = format!("{} is not a step of a transform", quoted(other));
                let error = document.error(Code::UnknownElement, &step.span, found);
                return Err(error.expected_one_of(other, &STEPS));
            }
        } * transform;
        if !transform.is_finite() {
            return Err(document.error(Code::InvalidTransform, &step.span, "the transform is not finite from here on"));
        }
    }
    Ok(transform)
}

fn rotate(document: &Document, step: &Element) -> Result<Affine3, FormatError> {
    let axis = value::vector(document, step, &["angle"], Some(0.0))?;
    let degrees = value::number(document, document.required(step, "angle")?)?;
    let Some(axis) = axis.try_normalize() else {
        return Err(document.error(Code::InvalidTransform, &step.span, "the axis of rotation has no length"));
    };
    Ok(Affine3::from_mat3(turn(axis, degrees)))
}

/// The rotation about a unit vector (Rodrigues); multiples of 90° are exact.
fn turn(axis: Vec3, degrees: f64) -> Mat3 {
    let (sine, cosine) = match degrees.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        _ => degrees.to_radians().sin_cos(),
    };
    let turned = |v: Vec3| v * cosine + axis.cross(v) * sine + axis * (axis.dot(v) * (1.0 - cosine));
    Mat3::from_cols(turned(Vec3::X), turned(Vec3::Y), turned(Vec3::Z))
}

fn matrix(document: &Document, step: &Element) -> Result<Affine3, FormatError> {
    document.check_attributes(step, &["value"], &[])?;
    let attribute = document.required(step, "value")?;
    let m = value::numbers(document, attribute, &[9, 16])?;
    let n = if m.len() == 16 { 4 } else { 3 };
    let column = |j: usize| Vec3::new(m[j], m[n + j], m[2 * n + j]);
    if n == 3 {
        return Ok(Affine3::from_mat3(Mat3::from_cols(column(0), column(1), column(2))));
    }
    if m[12..] != [0.0, 0.0, 0.0, 1.0] {
        let found = format!("the last row of the matrix is {} {} {} {}", m[12], m[13], m[14], m[15]);
        let error = document.error(Code::InvalidTransform, &attribute.value_span, found);
        return Err(error.expected("an affine transform, with the last row 0 0 0 1"));
    }
    Ok(Affine3::from_cols(column(0), column(1), column(2), column(3)))
}

/// The frame that looks from `origin` to `target` along its z axis, its y axis as near `up` as can be.
fn look_at(document: &Document, step: &Element) -> Result<Affine3, FormatError> {
    document.check_attributes(step, &["origin", "target", "up"], &[])?;
    let point = |name| -> Result<Vec3, FormatError> {
        Ok(Vec3::from_slice(&value::numbers(document, document.required(step, name)?, &[3])?))
    };
    let (origin, target, up) = (point("origin")?, point("target")?, point("up")?);
    let fail = |found: &str| document.error(Code::InvalidTransform, &step.span, found);
    let forward = (target - origin).try_normalize().ok_or_else(|| fail("`origin` and `target` are the same point"))?;
    let left = up.cross(forward).try_normalize().ok_or_else(|| fail("`up` points along the line of sight"))?;
    Ok(Affine3::from_cols(left, forward.cross(left), forward, origin))
}
