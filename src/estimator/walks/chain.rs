//! The Markov chain behind walks that gather: survival and steps.

use super::super::EstimatorError;
use crate::assembly::System;
use crate::linalg::LinearOperator;
use crate::sampling::AliasRows;

/// A bundle loses light to sinks where its row of G lacks more than this: what closure leaves open.
const CLOSURE_TOLERANCE: f64 = 1e-12;

/// The tables that walks of any scoring share.
#[derive(Debug)]
pub(super) struct Chain {
    pub n_bands: usize,
    pub steps: AliasRows,
    /// n × (1 + 2 bands), row by row: p, then a / p and E of every band.
    pub bundles: Vec<f64>,
}

impl Chain {
    /// Cost O(n²), 16 bytes an entry of G above zero.
    pub fn new(system: &System) -> Result<Self, EstimatorError> {
        let (n, n_bands) = (system.n_bundles(), system.n_bands());
        let albedo = system.transport().scattering().values();
        let survival: Vec<f64> = (0..n).map(|i| albedo.row(i).fold(0.0, f64::max)).collect();
        check_walks_end(system, &survival)?;

        // Write out p, a / p and E bundle by bundle.
        let mut bundles = Vec::with_capacity(n * (1 + 2 * n_bands));
        for (i, &p) in survival.iter().enumerate() {
            bundles.push(p);
            bundles.extend(albedo.row(i).map(|a| if p > 0.0 { a / p } else { 0.0 }));
            bundles.extend(system.emission().row(i));
        }
        let propagation = system.transport().propagation();
        let steps = AliasRows::new(n, n, |i, row| propagation.row(0, i, row)).map_err(EstimatorError::Propagation)?;
        Ok(Self { n_bands, steps, bundles })
    }
}

/// Every bundle must be able to reach one where walks end. Light goes both ways (T = Tᵀ), so search back from those.
fn check_walks_end(system: &System, survival: &[f64]) -> Result<(), EstimatorError> {
    let ends_walks = |i: usize| {
        let lost: f64 = system.sinks().row(i).sum();
        survival[i] < 1.0 || lost > CLOSURE_TOLERANCE * system.etendue()[i]
    };
    let mut ends: Vec<bool> = (0..survival.len()).map(ends_walks).collect();
    let mut frontier: Vec<usize> = (0..survival.len()).filter(|i| ends[*i]).collect();
    while let Some(i) = frontier.pop() {
        system.exchange().for_each_in_row(i, |j, exchange| {
            if exchange > 0.0 && !ends[j] {
                ends[j] = true;
                frontier.push(j);
            }
        });
    }
    match ends.iter().position(|ends| !ends) {
        None => Ok(()),
        Some(bundle) => Err(EstimatorError::NeverEnds { bundle }),
    }
}
