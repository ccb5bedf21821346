//! What if one surface had another albedo, or another emission: the reading then, exactly and by its derivatives.
//!
//! Exactly: from the factors of the equation as it is, by Woodbury's formula; see [`crate::solver::Factored::what_if`]. By derivatives:
//! M + Σ ∂M/∂albedoᵢ Δalbedoᵢ + Σ ∂M/∂Eᵢ ΔEᵢ, which is exact for emission and off by O(Δ²) for albedo.

use crate::assembly::{Sensitivity, System};
use crate::basis::Bundles;
use crate::linalg::{Block, Dense, Equation, LinearOperator};
use crate::scene::{Scene, Side};
use crate::solver::{Gth, RowChange, SolveError, Solver};
use serde::Serialize;

/// Up to so many unknowns a what-if is solved afresh, too.
const FRESH_UP_TO: usize = 3000;

/// What of a surface changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Property {
    /// Of every side that reflects.
    Albedo,
    /// Of the front.
    Emission,
}

/// One surface made another.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// As its author wrote it.
    pub name: String,
    /// Number of the surface.
    pub surface: usize,
    pub property: Property,
    /// What it becomes, a number a band: albedos in [0, 1], or W m⁻² sr⁻¹.
    pub values: Vec<f64>,
}

/// The reading after a change, a number a band.
#[derive(Clone, Debug, Serialize)]
pub struct WhatIf {
    pub change: String,
    /// From the old factors.
    pub reading: Vec<f64>,
    /// From the derivatives.
    pub first_order: Vec<f64>,
    /// From a solution of the changed equation; absent where that is dear.
    pub fresh: Option<Vec<f64>>,
    /// Rows of K that change.
    pub n_rows: usize,
}

/// The readings of `measurement` after each change on its own. `reading` and `derivatives` are those of the system as it is.
///
/// Factors I − K once, ⅔ n³ a band without subtraction; a change of m rows then costs m solutions, and a fresh one by `solver` up to some
/// thousand unknowns.
///
/// # Errors
/// A system, or a changed one, without a steady state.
pub(super) fn what_ifs(
    scene: &Scene,
    bundles: &Bundles,
    system: &System,
    measurement: &Block,
    (reading, derivatives): (&[f64], &Sensitivity),
    changes: &[Change],
    solver: &dyn Solver,
) -> Result<Vec<WhatIf>, SolveError> {
    if changes.is_empty() {
        return Ok(Vec::new());
    }
    let factored = Gth.factor(system.equation())?;
    let n_bands = system.n_bands();
    let mut found = Vec::with_capacity(changes.len());
    for change in changes {
        let (albedo, emission) = changed(scene, bundles, system, change);
        let moved = |new: &Block, old: &Block| {
            let mut difference = new.clone();
            difference.add_scaled(-1.0, old);
            difference
        };
        let albedo_step = moved(&albedo, system.transport().scattering().values());
        let emission_step = moved(&emission, system.emission());

        // By the derivatives.
        let along = |derivative: &Block, step: &Block, band: usize| -> f64 {
            derivative.column(band).iter().zip(step.column(band)).map(|(d, s)| d * s).sum()
        };
        let first_order = (0..n_bands).map(|band| {
            let by_albedo = along(&derivatives.albedo, &albedo_step, band);
            reading[band] + by_albedo + along(&derivatives.emission, &emission_step, band)
        });
        let first_order = first_order.collect();

        // By the old factors.
        let mut radiance = Block::zeros(system.n_bundles(), n_bands);
        let mut n_rows = 0;
        for band in 0..n_bands {
            let rows = row_change(system, band, albedo_step.column(band));
            n_rows = n_rows.max(rows.rows.len());
            radiance.column_mut(band).copy_from_slice(&factored.what_if(&rows, emission.column(band))?);
        }

        // Afresh.
        let fresh = if system.n_bundles() <= FRESH_UP_TO {
            let other = system.with_albedo(albedo);
            let answer = solver.solve(Equation { emission: &emission, ..other.equation() }, &mut ())?;
            Some(system.inner(measurement, &answer.radiance))
        } else {
            None
        };
        let reading = system.inner(measurement, &radiance);
        found.push(WhatIf { change: change.name.clone(), reading, first_order, fresh, n_rows });
    }
    Ok(found)
}

/// Albedo and emission of every bundle after a change.
fn changed(scene: &Scene, bundles: &Bundles, system: &System, change: &Change) -> (Block, Block) {
    let (mut albedo, mut emission) = (system.transport().scattering().values().clone(), system.emission().clone());
    for i in 0..system.n_bundles() {
        let Some(patch) = bundles.patch(bundles.element_of(i).0) else { continue };
        if scene.facets()[patch.facet].surface != change.surface {
            continue;
        }
        let is_black = scene.surface_of(patch.facet).brdf(patch.side).is_none();
        for (band, value) in change.values.iter().enumerate() {
            match change.property {
                Property::Albedo if !is_black => albedo.set(i, band, *value),
                Property::Emission if patch.side == Side::Front => emission.set(i, band, *value),
                _ => {}
            }
        }
    }
    (albedo, emission)
}

/// K = S G: a step of the albedo of a bundle adds as much of its row of G to its row of K.
fn row_change(system: &System, band: usize, step: &[f64]) -> RowChange {
    let n = system.n_bundles();
    let rows: Vec<usize> = (0..n).filter(|i| step[*i] != 0.0).collect();
    let mut change = Dense::zeros(rows.len(), n);
    for (k, i) in rows.iter().enumerate() {
        system.transport().propagation().row(0, *i, change.row_mut(k));
        change.row_mut(k).iter_mut().for_each(|v| *v *= step[*i]);
    }
    RowChange { band, rows, change }
}
