//! What light that is yet to be shot will come to on average.

use crate::linalg::{Block, Equation};
use crate::solver::report::Work;

/// The ambient radiance of an enclosure with so much left to shoot: Σ μ r / Σ μ a, a the share that a row loses.
pub(super) struct Ambient {
    /// Σⱼ Kᵢⱼ, n × bands: the albedo of the unknown, in a closed scene.
    pub gain: Block,
    /// Σ μ a of each band.
    losses: Vec<f64>,
}

impl Ambient {
    /// From the absorption; where that is not given, by one product.
    pub fn new(equation: Equation<'_>, weights: &[f64], work: &mut Work) -> Self {
        let (n, n_bands) = (equation.n_unknowns(), equation.n_bands());
        let gain = match equation.absorption {
            Some(absorption) => Block::from_fn(n, n_bands, |i, band| 1.0 - absorption.get(i, band)),
            None => {
                let mut gain = Block::zeros(n, n_bands);
                equation.transport.apply(&Block::from_fn(n, n_bands, |_, _| 1.0), &mut gain);
                work.count_applies(1);
                gain
            }
        };
        let loss = |i: usize, band: usize| match equation.absorption {
            Some(absorption) => absorption.get(i, band),
            None => 1.0 - gain.get(i, band),
        };
        let losses = (0..n_bands).map(|band| weights.iter().enumerate().map(|(i, mu)| mu * loss(i, band)).sum());
        let losses = losses.collect();
        Self { gain, losses }
    }

    /// Ambient radiance of a band that has Σ μ r = `power` left; none where the enclosure loses nothing.
    pub fn radiance(&self, band: usize, power: f64) -> f64 {
        if self.losses[band] > 0.0 { power / self.losses[band] } else { 0.0 }
    }
}
