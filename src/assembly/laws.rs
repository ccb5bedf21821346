//! The four laws, measured on the assembled matrices.

use super::System;
use crate::linalg::{LinearOperator, worst};

/// Worst relative violation of each law; zero is perfect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Laws {
    /// max |Tᵢⱼ − Tⱼᵢ| / max(Tᵢⱼ, Tⱼᵢ). R is diagonal here, so its symmetry is structural.
    pub reciprocity: f64,
    /// max |Σⱼ Tᵢⱼ + sinksᵢ − μᵢ| / μᵢ.
    pub closure: f64,
    /// max(0, −Tᵢⱼ, −Rᵢⱼ) relative to μᵢ.
    pub positivity: f64,
    /// max(0, Σₒ Rₒᵢ − μᵢ) / μᵢ.
    pub conservation: f64,
}

impl Laws {
    /// Reads every stored entry once. Cost O(entries).
    pub(super) fn measure(system: &System) -> Self {
        let n = system.n_bundles();
        let etendue = system.etendue();
        let (mut reciprocity, mut closure, mut positivity): (f64, f64, f64) = (0.0, 0.0, 0.0);
        let mut column = vec![0.0; n];
        for (i, mu) in etendue.iter().enumerate() {
            // The stored column against the stored row, not one of them read twice.
            system.exchange().column(0, i, &mut column);
            let mut sum = 0.0;
            system.exchange().for_each_in_row(i, |j, t| {
                let mirrored = column[j];
                let scale = t.abs().max(mirrored.abs());
                if scale != 0.0 {
                    reciprocity = larger(reciprocity, (t - mirrored).abs() / scale);
                }
                positivity = larger(positivity, -t / mu);
                sum += t;
            });
            let lost: f64 = system.sinks().row(i).sum();
            closure = larger(closure, ((sum + lost) / mu - 1.0).abs());
        }

        let albedos = system.transport().scattering().values();
        let conservation = worst(albedos.values().iter().map(|albedo| albedo - 1.0));
        positivity = larger(positivity, worst(albedos.values().iter().map(|albedo| -albedo)));
        Self { reciprocity, closure, positivity, conservation }
    }
}

/// The larger of the two; NaN if either is.
fn larger(a: f64, b: f64) -> f64 {
    worst([a, b].into_iter())
}
