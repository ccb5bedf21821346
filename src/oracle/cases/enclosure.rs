//! Enclosures of polygons, one patch each: form factors, discrete radiosity, and the identities of linear algebra on them.

use super::answer::{Answers, Demand};
use super::error::CaseError;
use super::model::{Body, Model, Walls};
use super::reader::{Case, Geometry};
use super::value::Value;
use crate::linalg::{Block, Dense, LinearOperator, LuFactor, symmetric_eigenvalues};
use crate::solver::SolveError;
use std::f64::consts::PI;

/// Everything `enclosure_polygons` cases ask for, by name.
pub fn answers(case: &Case) -> Result<Answers, CaseError> {
    let geometry = &case.geometry;
    let bodies = bodies(geometry)?;
    let (albedo, exitance): (Vec<f64>, Vec<f64>) = bodies.iter().map(|body| (body.albedo, body.exitance)).unzip();
    let model = Model::new(bodies, Walls::Closed, occluded(case))?;
    let factors = model.form_factors();
    let error = model.form_factor_error();
    let mut answers = Answers::new(Demand::Digits);
    answers.add("areas", Value::numbers(model.areas().iter().copied()), 0.0);
    answers.add("row_sums", Value::numbers(factors.iter().map(|row| row.iter().sum())), error);
    let spectrum = spectrum(&model, &vec![1.0; albedo.len()]);
    answers.number("eigenvalue_max", spectrum[0], error);
    answers.add("eigenvalues", Value::numbers(spectrum), error);
    if albedo.len() == 6 {
        answers.number("F_opposite", factors[0][1], error);
        answers.number("F_adjacent", factors[0][2], error);
    }
    if albedo.len() == 12 {
        let box_to_walls = factors[6..].iter().map(|row| row[..6].to_vec());
        answers.add("F_box_to_walls_18_digits", Value::rows(box_to_walls), error);
    }
    answers.add("F", Value::rows(factors), error);
    if geometry.has("E") {
        radiosity(case, &model, &albedo, &exitance, error, &mut answers)?;
    }
    // Whatever else was read off the geometry, a case gets the values it has names for.
    answers.values.retain(|name, _| case.values.contains_key(name));
    Ok(answers)
}

/// Absolute error asked for of partly visible pairs: two digits beyond those of the case, for what solving does to them.
fn occluded(case: &Case) -> f64 {
    0.1f64.powi(case.digits_certain.clamp(1, 11) as i32 + 2)
}

fn bodies(geometry: &Geometry) -> Result<Vec<Body>, CaseError> {
    let polygons = geometry.polygons("patches")?;
    let list = |field: &str| match geometry.has(field) {
        true => geometry.numbers(field),
        false => Ok(vec![0.0; polygons.len()]),
    };
    let (albedo, exitance) = (list("rho")?, list("E")?);
    if albedo.len() != polygons.len() || exitance.len() != polygons.len() {
        return Err(CaseError::Geometry { field: "rho".to_string(), problem: "and 'E' must have one number a patch" });
    }
    let body = |((polygon, albedo), exitance)| Body { polygons: vec![polygon], albedo, exitance, exchanges: true };
    Ok(polygons.into_iter().zip(albedo).zip(exitance).map(body).collect())
}

/// Eigenvalues of diag(albedo) F, largest first: those of the symmetric √albedo T √albedo / (π √(A A')).
pub(super) fn spectrum(model: &Model, albedo: &[f64]) -> Vec<f64> {
    let (flows, areas) = (model.flows(), model.areas());
    let entry = |i: usize, j: usize| flows[i][j] / PI * (albedo[i] * albedo[j] / (areas[i] * areas[j])).sqrt();
    symmetric_eigenvalues(&Dense::from_fn(albedo.len(), albedo.len(), entry))
}

/// Solutions, partial sums, adjoints and gradients of the discrete system, one unknown a surface.
fn radiosity(
    case: &Case,
    model: &Model,
    albedo: &[f64],
    exitance: &[f64],
    error: f64,
    answers: &mut Answers,
) -> Result<(), CaseError> {
    let radiance = model.radiance()?;
    let (b, h) = (model.radiosity(&radiance), model.irradiance(&radiance));
    let areas = model.areas();
    for (name, value) in &case.values {
        // "neumann_partial_sums_0_to_10" holds the sums for 0, 1, …, 10 bounces, "neumann_partial_sums [n, B...]" those for every n it names.
        if let Some(last) = name.strip_prefix("neumann_partial_sums_0_to_").and_then(|last| last.parse::<usize>().ok())
        {
            answers.add(name, Value::rows(model.neumann_sums(last.min(1000))), error);
        } else if name == "neumann_partial_sums [n, B...]" {
            let first = |row: &Value| row.items()?.first()?.number().filter(|n| (0.0..=1000.0).contains(n));
            let counts: Vec<usize> =
                value.items().unwrap_or_default().iter().filter_map(first).map(|n| n as usize).collect();
            let sums = model.neumann_sums(counts.iter().copied().max().unwrap_or(0));
            let rows = counts.iter().map(|n| std::iter::once(*n as f64).chain(sums[*n].iter().copied()).collect());
            answers.add(name, Value::rows(rows), error);
        }
    }
    let emitted: f64 = exitance.iter().zip(areas).map(|(e, area)| e * area).sum();
    let absorbed: f64 = albedo.iter().zip(&h).zip(areas).map(|((a, h), area)| (1.0 - a) * h * area).sum();
    // One number stands for both: the absorbed flux, which had to be computed.
    answers.number("emitted_flux=absorbed_flux", absorbed, (absorbed - emitted).abs());

    let spectrum = spectrum(model, albedo);
    answers.number("spectral_radius", spectrum.iter().fold(0.0, |worst: f64, value| worst.max(value.abs())), error);
    answers.add("eigenvalues_of_rho_F", Value::numbers(spectrum), error);
    answers.number("max_rho", albedo.iter().copied().fold(0.0, f64::max), 0.0);
    let mut row = vec![0.0; model.system.n_bundles()];
    let norm = (0..row.len()).map(|i| {
        model.system.transport().row(0, i, &mut row);
        row.iter().map(|entry| entry.abs()).sum::<f64>()
    });
    answers.number("norm_inf_of_K", norm.fold(0.0, f64::max), error);

    if case.geometry.has("W") {
        let weights = case.geometry.numbers("W")?;
        adjoint(case, model, &weights, (albedo, exitance, &b, &h), error, answers)?;
    }
    answers.add("B", Value::numbers(b), error);
    answers.add("H", Value::numbers(h), error);
    Ok(())
}

/// Y = (I − Kᵀ)⁻¹ W, J = ⟨W, B⟩ = ⟨E, Y⟩, and the derivatives of J: ∂J/∂E = Y, ∂J/∂albedo = Y H, ∂J/∂T by both of the entries that share it.
fn adjoint(
    case: &Case,
    model: &Model,
    weights: &[f64],
    (albedo, exitance, b, h): (&[f64], &[f64], &[f64], &[f64]),
    error: f64,
    answers: &mut Answers,
) -> Result<(), CaseError> {
    let n = model.n_surfaces();
    if weights.len() != n || model.system.n_bundles() != n {
        return Err(CaseError::Geometry { field: "W".to_string(), problem: "must have one number a patch" });
    }
    let y = solve(n, |i, j| transport(model, j, i), weights)?;
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let size = y.iter().fold(0.0, |worst: f64, y| worst.max(y.abs()));
    answers.number("J=<W,B>", dot(weights, b), error * size);
    answers.number("<E,Y>", dot(exitance, &y), error * size);
    answers.add("dJ/dE", Value::numbers(y.iter().copied()), error * size);
    answers.add("dJ/drho", Value::numbers(y.iter().zip(h).map(|(y, h)| y * h)), error * size);

    // Weighted by area the adjoint equation is (I − F diag(albedo)) y = W/A: K with the albedo moved to the other side.
    let areas = model.areas();
    let factors = model.form_factors();
    let shares: Vec<f64> = weights.iter().zip(areas).map(|(w, area)| w / area).collect();
    let importance = solve(n, |i, j| factors[i][j] * albedo[j], &shares)?;
    answers.add("area_weighted_importance=(I-F rho)^-1 (W/A)", Value::numbers(importance), error * size);

    for name in case.values.keys() {
        // "dJ/dS_0_3 (…)": S_03 = S_30 = A_0 F_03 moved together.
        let Some(pair) = name.strip_prefix("dJ/dS_").and_then(|rest| rest.split(' ').next()) else { continue };
        let indices: Vec<usize> = pair.split('_').filter_map(|index| index.parse().ok()).filter(|k| *k < n).collect();
        let [i, j] = indices[..] else { continue };
        let slope = y[i] * albedo[i] * b[j] / areas[i] + y[j] * albedo[j] * b[i] / areas[j];
        answers.number(name, slope, error * size);
    }
    answers.add("adjoint_Y=(I-K^T)^-1 W", Value::numbers(y), error * size);
    Ok(())
}

fn transport(model: &Model, i: usize, j: usize) -> f64 {
    let mut row = vec![0.0; model.system.n_bundles()];
    model.system.transport().row(0, i, &mut row);
    row[j]
}

/// (I − A) x = right.
pub(super) fn solve(n: usize, entry: impl Fn(usize, usize) -> f64, right: &[f64]) -> Result<Vec<f64>, CaseError> {
    let matrix = Dense::from_fn(n, n, |i, j| f64::from(u8::from(i == j)) - entry(i, j));
    let mut x = Block::from_fn(n, 1, |i, _| right[i]);
    let factor = LuFactor::new(&matrix).map_err(|source| SolveError::Factor { method: "lu", band: 0, source })?;
    factor.solve(&mut x);
    Ok(x.column(0).to_vec())
}
