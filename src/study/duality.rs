//! A reading computed twice: from the light that arrives at the sensor, and from the importance that arrives at the lamps.
//!
//! ```text
//! M = ⟨W, L⟩ = ⟨E, J⟩,      L = E + K L,      J = W + K* J,      ⟨a, b⟩ = Σ μᵢ aᵢ bᵢ
//! ```
//!
//! The two share K and nothing else of their computation, so that their difference tells of both solutions and of the laws that make K*
//! the adjoint. Source: Veach (1997), §4.

use super::sensitivity::{Quantity, Sensor, weights};
use crate::assembly::{Gather, Measurement, System};
use crate::basis::Bundles;
use crate::linalg::{Block, LinearOperator, worst};
use crate::scene::{Scene, Surface};
use crate::solver::{Observer, SolveError, Solver};
use serde::Serialize;
use std::time::Instant;

/// Pixels that stand for a film: every k-th of a row and of a column.
const PIXELS: usize = 4096;

/// How they are gathered. W is what these rays make it, and the duality of that W is exact.
const GATHER: Gather = Gather { samples: 1, rays: 16, seed: 0 };

/// W of one sensor, n × bands.
#[derive(Clone, Debug)]
pub struct LinearSensor {
    /// What is read, in words.
    pub description: String,
    pub unit: &'static str,
    weights: Block,
}

/// Both sides of one reading.
#[derive(Clone, Debug, Serialize)]
pub struct Duality {
    /// What is read, in words.
    pub sensor: String,
    pub unit: &'static str,
    /// The method of both solutions.
    pub solver: String,
    /// ⟨W, L⟩, a number a band.
    pub reading: Vec<f64>,
    /// ⟨E, J⟩, likewise.
    pub dual_reading: Vec<f64>,
    /// |⟨W, L⟩ − ⟨E, J⟩| / |⟨W, L⟩|, the worst band.
    pub difference: f64,
    /// Why the adjoint solution stopped.
    pub stop: String,
    /// Products of the adjoint solution.
    pub products: f64,
    /// Of the adjoint solution.
    pub seconds: f64,
}

impl LinearSensor {
    /// What a scene is looked at with: the mean pixel of its camera; without one the mean irradiance of its first surface that does not
    /// emit; and where all emit the flux that they reflect.
    pub fn of(scene: &Scene, bundles: &Bundles, system: &System) -> Self {
        if let Some(sensor) = Self::camera(scene, bundles, system) {
            return sensor;
        }
        let is_dark = |surface: &Surface| surface.emission.iter().all(|e| *e == 0.0);
        match scene.surfaces().iter().position(is_dark) {
            Some(surface) => Self {
                description: format!("mean irradiance of '{}'", scene.surfaces()[surface].name),
                unit: "W m⁻²",
                weights: weights(scene, bundles, system, Sensor { quantity: Quantity::Irradiance, surface }),
            },
            None => Self::reflected_flux(system),
        }
    }

    /// The mean over pixels of the light that what they see reflects; `None` without a camera, and for one that sees nothing.
    fn camera(scene: &Scene, bundles: &Bundles, system: &System) -> Option<Self> {
        let measurement = Measurement::new(scene, bundles, GATHER)?;
        let film = &measurement.camera().film;
        let stride = ((film.width * film.height) as f64 / PIXELS as f64).sqrt().ceil().max(1.0) as usize;
        let (columns, rows) = (film.width.div_ceil(stride), film.height.div_ceil(stride));
        let mut weights = Block::zeros(system.n_bundles(), system.n_bands());
        let share = 1.0 / (columns * rows) as f64;
        for pixel in 0..columns * rows {
            let (x, y) = (stride * (pixel % columns), stride * (pixel / columns));
            let gathered = |bundle: usize, band: usize, weight: f64| {
                weights.column_mut(band)[bundle] += share * weight / system.etendue()[bundle];
            };
            measurement.pixel(x, y, |_, _| (), gathered);
        }
        let description = format!("mean of {columns} × {rows} pixels of the camera, reflected light");
        (weights.max_abs() > 0.0).then_some(Self { description, unit: "W m⁻² sr⁻¹", weights })
    }

    /// W = K* 1: ⟨W, L⟩ = ⟨1, K L⟩.
    fn reflected_flux(system: &System) -> Self {
        let mut weights = Block::zeros(system.n_bundles(), system.n_bands());
        system.transport().propagation().apply(system.transport().scattering().values(), &mut weights);
        Self { description: "reflected flux of all surfaces".to_string(), unit: "W", weights }
    }

    /// Both sides of the reading, `radiance` being this method's own answer. One adjoint solution.
    ///
    /// # Errors
    /// What the method refuses of the adjoint equation.
    pub fn duality(
        &self,
        system: &System,
        radiance: &Block,
        solver: &dyn Solver,
        observer: &mut dyn Observer,
    ) -> Result<Duality, SolveError> {
        let start = Instant::now();
        let adjoint = system.adjoint();
        let importance = solver.solve(adjoint.equation(&self.weights), observer)?;
        let seconds = start.elapsed().as_secs_f64();
        let reading = system.inner(&self.weights, radiance);
        let dual_reading = system.inner(system.emission(), &importance.radiance);
        Ok(Duality {
            sensor: self.description.clone(),
            unit: self.unit,
            solver: solver.name().to_string(),
            difference: difference(&reading, &dual_reading),
            reading,
            dual_reading,
            stop: importance.report.stop.to_string(),
            products: importance.report.products,
            seconds,
        })
    }
}

/// |a − b| / |a|, the worst band; two readings of nothing do not differ.
pub(super) fn difference(reading: &[f64], dual: &[f64]) -> f64 {
    worst(reading.iter().zip(dual).map(|(a, b)| if a == b { 0.0 } else { (a - b).abs() / a.abs() }))
}
