//! The Markov chain behind walks on the matrix: survival and steps.

use super::super::EstimatorError;
use crate::assembly::{Propagation, System};
use crate::linalg::{Block, LinearOperator};
use crate::sampling::AliasRows;
use std::sync::Arc;

/// A bundle loses light to sinks where its row of G lacks more than this: what closure leaves open.
const CLOSURE_TOLERANCE: f64 = 1e-12;

/// The tables that walks of any scoring share: survive bundle i with probability pᵢ = max over bands of aᵢ, step to j with probability
/// Gᵢⱼ.
#[derive(Debug)]
pub(super) struct Chain {
    pub n_bands: usize,
    /// G.
    pub propagation: Propagation,
    /// μ, m² sr.
    pub etendue: Arc<[f64]>,
    pub steps: AliasRows,
    /// p, n.
    pub survival: Vec<f64>,
    /// a, n × bands.
    pub albedo: Block,
    /// E, n × bands.
    pub emission: Block,
    /// True if T is symmetric, so that light also goes from i to j with probability Gᵢⱼ.
    pub is_reciprocal: bool,
}

impl Chain {
    /// Cost O(n²), 16 bytes an entry of G above zero.
    pub fn new(system: &System) -> Result<Self, EstimatorError> {
        let n = system.n_bundles();
        let albedo = system.transport().scattering().values().clone();
        let survival: Vec<f64> = (0..n).map(|i| albedo.row(i).fold(0.0, f64::max)).collect();
        check_walks_end(system, &survival)?;
        let propagation = system.transport().propagation().clone();
        let steps = AliasRows::new(n, n, |i, row| propagation.row(0, i, row)).map_err(EstimatorError::Propagation)?;
        Ok(Self {
            n_bands: system.n_bands(),
            propagation,
            etendue: system.etendue().into(),
            steps,
            survival,
            albedo,
            emission: system.emission().clone(),
            is_reciprocal: system.equation().self_adjoint.is_some(),
        })
    }

    pub fn n_bundles(&self) -> usize {
        self.survival.len()
    }

    /// a / p of every band, 0 where nothing survives.
    pub fn gain(&self, bundle: usize) -> impl Iterator<Item = f64> + '_ {
        let p = self.survival[bundle];
        self.albedo.row(bundle).map(move |a| if p > 0.0 { a / p } else { 0.0 })
    }

    /// K x. One product.
    pub fn transported(&self, x: &Block) -> Block {
        let mut image = Block::zeros(x.n_rows(), x.n_columns());
        self.propagation.apply(x, &mut image);
        image.values_mut().iter_mut().zip(self.albedo.values()).for_each(|(v, a)| *v *= a);
        image
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
