//! Pairs of polygons, with or without something between, and families of such pairs in one parameter.

use super::answer::{Answers, Demand};
use super::error::CaseError;
use super::limit::{EVEN, LINEAR, Refinement, extrapolate, refine};
use super::model::{Body, EXACT, Model, Shape, WHOLE, Walls};
use super::reader::{Case, Geometry};
use super::revolution::{disk, sectors};
use super::value::Value;
use crate::geometry::{Frame, Polygon, Vec3};

/// Lengths of the strips that stand for an infinite one: their form factors run in powers of 1/length.
const LENGTHS: [usize; 6] = [512, 1024, 2048, 4096, 8192, 16384];

/// Error at which the refinement of a disk ends, and that of form factors past it.
const ENOUGH: f64 = 1e-7;
const PAST_A_DISK: f64 = 1e-9;

/// Steps of central differences, in units of the parameter: the differences run in even powers of the step.
const DIFFERENCE_STEPS: [f64; 6] = [0.25, 0.2, 0.16, 0.125, 0.1, 0.08];

/// `polygon_pair`: F_12, F_21, areas, F_12 without the occluders; with `occluding_disk`, also F from 1 to the disk.
pub fn pair(case: &Case) -> Result<Answers, CaseError> {
    let geometry = &case.geometry;
    let (one, two) = (geometry.polygon("polygon_1")?, geometry.polygon("polygon_2")?);
    let occluders = geometry.polygons("occluders")?;
    if geometry.has("occluding_disk") {
        return pair_past_a_disk(&geometry.part("occluding_disk")?, &one, &two);
    }
    let model = Model::new(bodies(&one, &two, &occluders), Walls::Open, EXACT)?;
    let factors = model.form_factors();
    let error = model.form_factor_error();
    let demand = Demand::Digits;
    let mut answers = Answers::new(demand);
    answers.number("F_12", factors[0][1], error * factors[0][1].abs().max(f64::from(u8::from(model.is_occluded()))));
    answers.number("F_21", factors[1][0], error * factors[1][0].abs().max(f64::from(u8::from(model.is_occluded()))));
    answers.number("area_1", model.areas()[0], 0.0);
    answers.number("area_2", model.areas()[1], 0.0);
    if !occluders.is_empty() {
        let open = Model::new(bodies(&one, &two, &[]), Walls::Open, EXACT)?;
        let factor = open.form_factors()[0][1];
        answers.number("F_12_unoccluded", factor, open.form_factor_error() * factor);
    }
    Ok(answers)
}

fn bodies(one: &Polygon, two: &Polygon, occluders: &[Polygon]) -> Vec<Body> {
    let mut bodies = vec![Body::black(vec![one.clone()]), Body::black(vec![two.clone()])];
    if !occluders.is_empty() {
        bodies.push(Body::black(occluders.to_vec()));
    }
    bodies
}

/// The disk stands for itself as polygons of more and more corners. F_1_disk is to the side of it that faces polygon 1.
fn pair_past_a_disk(fields: &Geometry, one: &Polygon, two: &Polygon) -> Result<Answers, CaseError> {
    let (centre, radius) = (fields.point("center")?, fields.length("radius")?);
    let mut normal = fields.direction("normal")?;
    if normal.dot(one.centroid() - centre) < 0.0 {
        normal = -normal;
    }
    let levels = [8, 12, 16, 24, 32, 48, 64, 96, 128];
    let limits = refine(Refinement { levels: &levels, powers: EVEN, enough: ENOUGH }, |n| {
        let blocker = disk(&Frame::about(normal), centre, radius, &sectors(n))?;
        let shape = Shape { bodies: bodies(one, two, &[blocker]), ..Shape::default() };
        let model = Model::folded(shape, WHOLE, |from, _| from == 0, PAST_A_DISK)?;
        let factors = model.form_factors();
        Ok((vec![factors[0][1], factors[0][2]], model.noise()))
    })?;
    let open = Model::new(bodies(one, two, &[]), Walls::Open, EXACT)?;
    let factor = open.form_factors()[0][1];
    let mut answers = Answers::new(Demand::Estimate);
    answers.number("F_12", limits[0].value, limits[0].error);
    answers.number("F_1_disk", limits[1].value, limits[1].error);
    answers.number("F_12_unoccluded", factor, open.form_factor_error() * factor);
    Ok(answers)
}

/// The form factor from the first to the second of two rectangles in the open, and its relative error.
fn factor(one: Vec<Vec3>, two: Vec<Vec3>) -> Result<(f64, f64), CaseError> {
    let polygon = |corners, what: &str| {
        Polygon::new(corners).map_err(|source| CaseError::Polygon { what: what.to_string(), source })
    };
    let bodies = bodies(&polygon(one, "first rectangle")?, &polygon(two, "second rectangle")?, &[]);
    let model = Model::new(bodies, Walls::Open, EXACT)?;
    Ok((model.form_factors()[0][1], model.form_factor_error()))
}

/// The floor [0, a] × [0, b] at z = 0, facing up.
fn floor(a: f64, b: f64) -> Vec<Vec3> {
    vec![Vec3::ZERO, Vec3::new(a, 0.0, 0.0), Vec3::new(a, b, 0.0), Vec3::new(0.0, b, 0.0)]
}

/// The same rectangle at height h, facing down.
fn ceiling(a: f64, b: f64, h: f64) -> Vec<Vec3> {
    floor(a, b).into_iter().rev().map(|v| v + h * Vec3::Z).collect()
}

/// The wall [0, 1] × [low, high] (y, z) at x = 0, facing the unit floor.
fn wall(low: f64, high: f64) -> Vec<Vec3> {
    vec![Vec3::new(0.0, 0.0, low), Vec3::new(0.0, 1.0, low), Vec3::new(0.0, 1.0, high), Vec3::new(0.0, 0.0, high)]
}

/// `rectangle_family`: F of a pair of unit squares that one parameter moves, and its derivative by central differences that are
/// extrapolated to step 0. Which pair it is stands in the note.
pub fn rectangle_family(case: &Case) -> Result<Answers, CaseError> {
    let parameter = case.geometry.length("parameter_value")?;
    let note = case.geometry.text("note")?;
    let moved: fn(f64) -> (Vec<Vec3>, Vec<Vec3>) = match note.get(..4) {
        Some("d/dh") => |h| (floor(1.0, 1.0), ceiling(1.0, 1.0, h)),
        Some("d/dw") => |w| (floor(1.0, 1.0), wall(0.0, w)),
        Some("d/dg") => |g| (floor(1.0, 1.0), wall(g, 1.0 + g)),
        _ => return Err(CaseError::Needs("a parameter that it knows: h, w or g")),
    };
    let at = |value: f64| {
        let (one, two) = moved(value);
        factor(one, two)
    };
    let (value, error) = at(parameter)?;
    let steps = DIFFERENCE_STEPS.map(|share| share * parameter);
    let mut slopes = Vec::new();
    for step in steps {
        // The distance between the two places as it is after rounding.
        let (above, below) = (parameter + step, parameter - step);
        slopes.push((at(above)?.0 - at(below)?.0) / (above - below));
    }
    let slope_error = f64::EPSILON * value / steps[steps.len() - 1];
    let limit = extrapolate(&steps, &slopes, EVEN, &[slope_error; DIFFERENCE_STEPS.len()]);
    let mut answers = Answers::new(Demand::Digits);
    answers.number("F", value, error * value);
    answers.number("dF", limit.value, limit.error);
    Ok(answers)
}

/// `polygon_family`: facing strips of width 1 and gap 1, of lengths that stand in the names of the values.
pub fn strip_family(case: &Case) -> Result<Answers, CaseError> {
    let strips = |length: f64| factor(floor(1.0, length), ceiling(1.0, length, 1.0));
    let mut answers = Answers::new(Demand::Digits);
    for name in case.values.keys() {
        let Some(length) = name.strip_prefix("F_12_L=") else { continue };
        match length.parse::<f64>() {
            Ok(length) if length.is_finite() && length > 0.0 => {
                let (value, error) = strips(length)?;
                answers.number(name, value, error * value);
            }
            _ if length == "inf" => {
                let ends = Refinement { levels: &LENGTHS, powers: LINEAR, enough: 0.0 };
                let limits = refine(ends, |n| strips(n as f64).map(|(value, error)| (vec![value], error * value)))?;
                answers.number(name, limits[0].value, limits[0].error);
            }
            _ => {}
        }
    }
    Ok(answers)
}

/// `cube_grid`: one patch a cell of n × n cells a face, in the order of `B_by_patch`.
pub fn cube_grid(case: &Case) -> Result<Answers, CaseError> {
    let n = case.geometry.count("n", 64)?;
    let faces = super::cube::faces(1.0);
    let albedo = case.geometry.number("rho")?;
    let mut bodies = Vec::new();
    let mut index = Vec::new();
    for (f, face) in faces.iter().enumerate() {
        for i in 0..n {
            for j in 0..n {
                let span = |k: usize| [k as f64 / n as f64, (k + 1) as f64 / n as f64];
                let polygon = face.cell(span(i), span(j))?;
                bodies.push(Body {
                    polygons: vec![polygon],
                    albedo,
                    exitance: if f == 0 { 1.0 } else { 0.0 },
                    exchanges: true,
                });
                index.push([f, i, j]);
            }
        }
    }
    let model = Model::new(bodies, Walls::Closed, EXACT)?;
    let radiosity = model.radiosity(&model.radiance()?);
    let mut answers = Answers::new(Demand::Digits);
    let rows = index.iter().zip(&radiosity).map(|([f, i, j], b)| vec![*f as f64, *i as f64, *j as f64, *b]);
    answers.add("B_by_patch", Value::rows(rows), model.form_factor_error());
    let means = radiosity.chunks(n * n).map(|face| face.iter().sum::<f64>() / (n * n) as f64);
    answers.add("face_average_B", Value::numbers(means), model.form_factor_error());
    Ok(answers)
}
