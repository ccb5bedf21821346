//! Laws of every closed scene, on gallery scenes and on cubes of mixed albedos: uniform solutions and the identities of group G.

use super::answer::{Answers, Demand};
use super::cube;
use super::error::CaseError;
use super::model::{Body, EXACT, Model, Walls};
use super::reader::Case;
use super::value::Value;

/// Cells of every face, along both of its axes.
const CELLS: usize = 3;

/// Albedos of the isothermal enclosure, a face each: "arbitrary in [0, 1)".
pub const ALBEDOS: [f64; 6] = [0.0, 0.9, 0.5, 0.25, 0.75, 0.99];

/// A box of three different sides, its faces cut into cells, albedo and exitance by face.
pub fn closed_box(albedo: [f64; 6], exitance: [f64; 6]) -> Result<Model, CaseError> {
    let span = |k: usize| [k as f64 / CELLS as f64, (k + 1) as f64 / CELLS as f64];
    let mut bodies = Vec::new();
    for (f, face) in cube::faces(1.0).iter().enumerate() {
        let cells =
            (0..CELLS * CELLS).map(|k| face.cell(span(k / CELLS), span(k % CELLS))).collect::<Result<_, _>>()?;
        bodies.push(Body { polygons: cells, albedo: albedo[f], exitance: exitance[f], exchanges: true });
    }
    Model::new(bodies, Walls::Closed, EXACT)
}

/// The value furthest from the mean of all: where one number stands for a whole field, the worst of the field is told.
fn furthest(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter().copied().max_by(|a, b| (a - mean).abs().total_cmp(&(b - mean).abs())).unwrap_or(f64::NAN)
}

/// `any_closed_scene`: the white furnace where 'rho' is a number, else the isothermal enclosure.
pub fn uniform(case: &Case) -> Result<Answers, CaseError> {
    if case.geometry.has("brdf") {
        return Err(CaseError::Needs("directions"));
    }
    let mut answers = Answers::new(Demand::Digits);
    let Ok(albedo) = case.geometry.number("rho") else {
        let model = closed_box(ALBEDOS, ALBEDOS.map(|albedo| 1.0 - albedo))?;
        let radiance = model.radiance()?;
        let (b, h) = (model.radiosity(&radiance), model.irradiance(&radiance));
        let net: Vec<f64> = b.iter().zip(&h).map(|(b, h)| b - h).collect();
        answers.number("B", furthest(&b), model.form_factor_error());
        answers.number("irradiance", furthest(&h), model.form_factor_error());
        answers.number("net_flux", furthest(&net), model.form_factor_error());
        return Ok(answers);
    };
    let exitance = case.geometry.number("E")?;
    let model = closed_box([albedo; 6], [exitance; 6])?;
    let radiance = model.radiance()?;
    let b = model.radiosity(&radiance);
    let error = model.form_factor_error() / (1.0 - albedo);
    answers.number("B", furthest(&b), error);
    answers.number("irradiance", furthest(&model.irradiance(&radiance)), error);
    for name in case.values.keys() {
        let Some(last) = name.strip_prefix("neumann_partial_sums_0_to_").and_then(|n| n.parse::<usize>().ok()) else {
            continue;
        };
        let sums = model.neumann_sums(last.min(10_000));
        answers.add(name, Value::numbers(sums.iter().map(|sum| furthest(sum))), error);
    }
    // Count bounces until what is missing is a millionth of the whole.
    let (mut term, mut sum, mut bounces) = (model.system.emission().clone(), model.system.emission().clone(), 0u32);
    let missing = |sum: &crate::linalg::Block| {
        let left = radiance.values().iter().zip(sum.values()).map(|(whole, sum)| (whole - sum) / whole);
        left.fold(0.0, f64::max)
    };
    while missing(&sum) > 1e-6 && bounces < 1_000_000 {
        term = model.bounce(&term);
        sum.add_scaled(1.0, &term);
        bounces += 1;
    }
    answers.number("bounces_to_1e-6_relative", f64::from(bounces), 0.0);
    Ok(answers)
}
