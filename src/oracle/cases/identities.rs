//! Identities that hold in any scene, measured on a box of mixed albedos and on a gallery scene with a block in the way.

use super::answer::Identity;
use super::closed::{ALBEDOS, closed_box};
use super::error::CaseError;
use super::model::{Body, EXACT, Model, Walls};
use super::reader::Case;
use crate::gallery;
use crate::geometry::{Polygon, Vec3};
use crate::linalg::{Block, Dense, LinearOperator, LuFactor};
use crate::solver::SolveError;
use std::f64::consts::PI;

/// Rounding of sums over a row, relative: some tens of ulp.
const ROUNDING: f64 = 1e-14;

/// Absolute error of partly visible pairs here: the identities hold whatever it is.
const ROUGH: f64 = 1e-3;

/// The identity of a case's family: the worst defect found, and what is allowed.
///
/// # Errors
/// A family that is not known.
pub fn check(case: &Case) -> Result<Identity, CaseError> {
    let defect: fn(&Model) -> Result<f64, CaseError> = match case.family.as_str() {
        "identity_reciprocity" => |model| Ok(model.system.laws().reciprocity),
        "identity_adjoint" => adjoint,
        "identity_monotone_neumann" => monotone,
        "identity_energy" => energy,
        "identity_spectral_radius" => return spectral_radius(),
        "identity_subdivision" => return subdivision(),
        "identity_isothermal" => return isothermal(),
        _ => return Err(CaseError::Needs("an identity that is known here")),
    };
    // Solutions are right to the rounding of a row times the condition of I − K.
    let allowed = match case.family.as_str() {
        "identity_reciprocity" | "identity_monotone_neumann" => 0.0,
        _ => ROUNDING * 2.0 / (1.0 - largest_albedo()),
    };
    let mut worst: f64 = 0.0;
    for model in [closed_box(ALBEDOS, [1.0, 0.0, 0.5, 0.0, 0.25, 0.0])?, corner_box(false)?] {
        worst = worst.max(defect(&model)?);
    }
    Ok(Identity { defect: worst, allowed })
}

fn largest_albedo() -> f64 {
    ALBEDOS.into_iter().fold(0.0, f64::max)
}

/// The gallery's box with a block in it, in its first band; with `isothermal`, every surface emits 1 − albedo.
fn corner_box(isothermal: bool) -> Result<Model, CaseError> {
    let scene = gallery::corner_box();
    let body = |surface: &crate::scene::Surface| {
        let albedo = surface.front.lambertian().map_or(0.0, |albedos| albedos[0]);
        let exitance = if isothermal { 1.0 - albedo } else { PI * surface.emission[0] };
        Body { polygons: surface.polygons.clone(), albedo, exitance, exchanges: true }
    };
    Model::new(scene.surfaces().iter().map(body).collect(), Walls::Closed, ROUGH)
}

/// ⟨W, (I − K)⁻¹ E⟩ against ⟨(I − Kᵀ)⁻¹ W, E⟩, relative, for a W that is nowhere even.
fn adjoint(model: &Model) -> Result<f64, CaseError> {
    let n = model.system.n_bundles();
    let weights: Vec<f64> = (0..n).map(|i| 1.0 + (0.7 * i as f64).sin()).collect();
    let transport = Dense::from_operator(model.system.transport(), 0);
    let matrix = Dense::from_fn(n, n, |i, j| f64::from(u8::from(i == j)) - transport.get(j, i));
    let factor = LuFactor::new(&matrix).map_err(|source| SolveError::Factor { method: "lu", band: 0, source })?;
    let mut importance = Block::from_fn(n, 1, |i, _| weights[i]);
    factor.solve(&mut importance);
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let forward = dot(&weights, model.radiance()?.column(0));
    let backward = dot(importance.column(0), model.system.emission().column(0));
    Ok((forward / backward - 1.0).abs())
}

/// By how much a partial sum falls below the one before, or exceeds the solution by more than rounding; relative to the solution.
fn monotone(model: &Model) -> Result<f64, CaseError> {
    let solution = model.radiance()?;
    let rounding = ROUNDING * 2.0 / (1.0 - largest_albedo());
    let mut term = model.system.emission().clone();
    let mut sum = term.clone();
    let mut worst: f64 = 0.0;
    for _ in 0..200 {
        let before = sum.clone();
        term = model.bounce(&term);
        sum.add_scaled(1.0, &term);
        for ((now, before), whole) in sum.values().iter().zip(before.values()).zip(solution.values()) {
            let excess = (now / whole - 1.0 - rounding).max(0.0);
            worst = worst.max((before - now) / whole).max(excess);
        }
    }
    Ok(worst)
}

/// Σ A E against Σ A (1 − albedo) H, relative.
fn energy(model: &Model) -> Result<f64, CaseError> {
    let radiance = model.radiance()?;
    let incident = model.system.irradiance(&radiance);
    let etendue = model.system.etendue();
    let (mut emitted, mut absorbed) = (0.0, 0.0);
    for (i, mu) in etendue.iter().enumerate() {
        emitted += mu * PI * model.system.emission().get(i, 0);
        absorbed += mu * (incident.get(i, 0) - PI * (radiance.get(i, 0) - model.system.emission().get(i, 0)));
    }
    Ok((absorbed / emitted - 1.0).abs())
}

/// A uniform closed scene has the spectral radius of its albedo, a mixed one no more than the largest, two facing plates ±λ.
fn spectral_radius() -> Result<Identity, CaseError> {
    let uniform = (closed_box([0.5; 6], [1.0; 6])?.spectral_radius() / 0.5 - 1.0).abs();
    let mixed = (closed_box(ALBEDOS, [1.0; 6])?.spectral_radius() - largest_albedo()).max(0.0);
    let plates = plates(1)?;
    let entry = |i: usize, j: usize| {
        let mut row = vec![0.0; 2];
        plates.system.transport().row(0, i, &mut row);
        row[j]
    };
    // K = ((0, a), (b, 0)) has eigenvalues ±√(a b), and 0 on its diagonal makes their sum 0.
    let trace = (entry(0, 0) + entry(1, 1)).abs();
    Ok(Identity { defect: uniform.max(mixed).max(trace), allowed: 10.0 * ROUNDING })
}

/// Two facing unit squares, each in n × n cells.
fn plates(n: usize) -> Result<Model, CaseError> {
    let cell = |i: usize, j: usize, z: f64| {
        let at = |i: usize, j: usize| Vec3::new(i as f64 / n as f64, j as f64 / n as f64, z);
        let mut corners = vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        if z > 0.0 {
            corners.reverse();
        }
        Polygon::new(corners).map_err(|source| CaseError::Polygon { what: "cell".to_string(), source })
    };
    let plate = |z: f64| {
        let polygons = (0..n * n).map(|k| cell(k / n, k % n, z)).collect::<Result<_, _>>()?;
        Ok::<_, CaseError>(Body { polygons, albedo: 0.5, exitance: 1.0, exchanges: true })
    };
    Model::new(vec![plate(0.0)?, plate(0.375)?], Walls::Open, EXACT)
}

/// T of two squares whole and in cells, relative.
fn subdivision() -> Result<Identity, CaseError> {
    let whole = plates(1)?.flows()[0][1];
    let mut defect: f64 = 0.0;
    for n in [2, 3, 5] {
        defect = defect.max((plates(n)?.flows()[0][1] / whole - 1.0).abs());
    }
    Ok(Identity { defect, allowed: 1e-12 })
}

/// E = 1 − albedo gives B = 1.
fn isothermal() -> Result<Identity, CaseError> {
    let models = [closed_box(ALBEDOS, ALBEDOS.map(|albedo| 1.0 - albedo))?, corner_box(true)?];
    let mut defect: f64 = 0.0;
    for model in &models {
        let radiance = model.radiance()?;
        defect = radiance.values().iter().fold(defect, |worst, l| worst.max((PI * l - 1.0).abs()));
    }
    Ok(Identity { defect, allowed: ROUNDING / (1.0 - largest_albedo()) })
}
