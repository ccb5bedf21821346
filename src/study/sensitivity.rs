//! What a sensor hangs on: derivatives of its reading with respect to every surface's albedo and emission.

use super::what_if::{Change, WhatIf, what_ifs};
use crate::assembly::System;
use crate::basis::Bundles;
use crate::linalg::{Block, LinearOperator};
use crate::scene::{Scene, Side};
use crate::solver::{SolveError, Solver};
use serde::Serialize;
use std::f64::consts::PI;

/// What is read, a number a band.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Mean radiance that leaves the surface, W m⁻² sr⁻¹.
    Radiance,
    /// Mean irradiance of the surface, W m⁻².
    Irradiance,
}

/// The mean of a quantity over a surface, both of its sides where both reflect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sensor {
    pub quantity: Quantity,
    /// Number of the surface.
    pub surface: usize,
}

/// A reading and its derivatives.
#[derive(Clone, Debug, Serialize)]
pub struct SensitivityOutcome {
    /// ⟨W, L⟩, a number a band.
    pub reading: Vec<f64>,
    /// ⟨E, J⟩, the same by the adjoint.
    pub dual_reading: Vec<f64>,
    /// In the scene's order.
    pub surfaces: Vec<SurfaceSensitivity>,
    /// The reading after each change that was asked for.
    pub what_ifs: Vec<WhatIf>,
    /// Products with K, and with K*.
    pub products: [f64; 2],
}

/// Derivatives with respect to one surface, a number a band.
#[derive(Clone, Debug, Serialize)]
pub struct SurfaceSensitivity {
    pub surface: String,
    /// ∂M/∂albedo, in the unit of the reading.
    pub albedo: Vec<f64>,
    /// ∂M/∂E, in the unit of the reading a W m⁻² sr⁻¹.
    pub emission: Vec<f64>,
}

/// Solves for radiance and for the sensor's importance, one solution each, and reads all derivatives off them.
///
/// # Errors
/// An equation that the solver cannot answer.
pub fn sensitivity(
    scene: &Scene,
    bundles: &Bundles,
    system: &System,
    sensor: Sensor,
    solver: &dyn Solver,
) -> Result<SensitivityOutcome, SolveError> {
    sensitivity_and_what_if(scene, bundles, system, sensor, solver, &[])
}

/// [`sensitivity`], and the reading after each of some changes on its own: exactly, by the derivatives, and afresh where that is cheap.
///
/// # Errors
/// An equation that the solver cannot answer, as it is or changed.
pub fn sensitivity_and_what_if(
    scene: &Scene,
    bundles: &Bundles,
    system: &System,
    sensor: Sensor,
    solver: &dyn Solver,
    changes: &[Change],
) -> Result<SensitivityOutcome, SolveError> {
    let measurement = weights(scene, bundles, system, sensor);
    let forward = solver.solve(system.equation(), &mut ())?;
    let backward = solver.solve(system.adjoint().equation(&measurement), &mut ())?;
    let derivatives = system.sensitivity(&forward.radiance, &backward.radiance);

    // Add them up over the bundles that a surface's albedo and emission are those of.
    let (n_surfaces, n_bands) = (scene.surfaces().len(), system.n_bands());
    let mut surfaces: Vec<SurfaceSensitivity> = (0..n_surfaces)
        .map(|s| SurfaceSensitivity {
            surface: scene.surfaces()[s].name.clone(),
            albedo: vec![0.0; n_bands],
            emission: vec![0.0; n_bands],
        })
        .collect();
    for i in 0..system.n_bundles() {
        let Some(patch) = bundles.patch(bundles.element_of(i).0) else { continue };
        let surface = &mut surfaces[scene.facets()[patch.facet].surface];
        for band in 0..n_bands {
            surface.albedo[band] += derivatives.albedo.get(i, band);
            if patch.side == Side::Front {
                surface.emission[band] += derivatives.emission.get(i, band);
            }
        }
    }
    let reading = system.inner(&measurement, &forward.radiance);
    let what_ifs = what_ifs(scene, bundles, system, &measurement, (&reading, &derivatives), changes, solver)?;
    Ok(SensitivityOutcome {
        reading,
        dual_reading: system.inner(system.emission(), &backward.radiance),
        surfaces,
        what_ifs,
        products: [forward.report.products, backward.report.products],
    })
}

/// W of a sensor, n × bands: the reading is ⟨W, L⟩ = Σ μᵢ Wᵢ Lᵢ.
pub fn weights(scene: &Scene, bundles: &Bundles, system: &System, sensor: Sensor) -> Block {
    let (n, n_bands) = (system.n_bundles(), system.n_bands());
    let is_read = |i: usize| {
        let patch = bundles.patch(bundles.element_of(i).0);
        patch.is_some_and(|patch| scene.facets()[patch.facet].surface == sensor.surface)
    };
    let total: f64 = (0..n).filter(|i| is_read(*i)).map(|i| system.etendue()[i]).sum();
    let mean = Block::from_fn(n, n_bands, |i, _| if is_read(i) { 1.0 / total } else { 0.0 });
    match sensor.quantity {
        Quantity::Radiance => mean,
        Quantity::Irradiance => {
            // ⟨x, π G L⟩ = ⟨π G x, L⟩.
            let mut gathered = Block::zeros(n, n_bands);
            system.transport().propagation().apply(&mean, &mut gathered);
            gathered.values_mut().iter_mut().for_each(|w| *w *= PI);
            gathered
        }
    }
}
