//! Light that is shot, unknown by unknown, and what is left to shoot.

use crate::linalg::{Block, Equation};
use rayon::prelude::*;

/// L as shot so far, from L = 0, and r = E + K L − L.
pub(super) struct Shooting<'a> {
    equation: Equation<'a>,
    /// 1 − Kᵢᵢ.
    own: Block,
    /// μ, or 1 where the equation has none.
    pub weights: Vec<f64>,
    pub radiance: Block,
    pub residual: Block,
    columns: Block,
}

/// A shot about to be made.
pub(super) struct Shot {
    pub band: usize,
    pub unknown: usize,
    /// What the unknown has left, rᵢ.
    pub residual: f64,
    /// Σ μⱼ rⱼ: what all have left.
    pub power: f64,
}

impl<'a> Shooting<'a> {
    pub fn new(equation: Equation<'a>, own: Block) -> Self {
        let (n, n_bands) = (equation.n_unknowns(), equation.n_bands());
        Self {
            equation,
            own,
            weights: equation.self_adjoint.map_or_else(|| vec![1.0; n], |form| form.etendue.to_vec()),
            radiance: Block::zeros(n, n_bands),
            residual: equation.emission.clone(),
            columns: Block::zeros(n, n_bands),
        }
    }

    /// n shots in every band, each band on its own thread: the unknown with most left, μᵢ |rᵢ|, gives `relaxation` times what would leave it
    /// with nothing. Reads as many entries as one product.
    pub fn shoot(&mut self, relaxation: &(dyn Fn(&Shot) -> f64 + Sync)) {
        let n = self.radiance.n_rows().max(1);
        let (equation, own, weights) = (self.equation, &self.own, self.weights.as_slice());
        let bands = self.radiance.values_mut().par_chunks_mut(n).zip(self.residual.values_mut().par_chunks_mut(n));
        bands.zip(self.columns.values_mut().par_chunks_mut(n)).enumerate().for_each(|(band, ((l, r), column))| {
            for _ in 0..n {
                let Some(shot) = brightest(band, weights, r) else { break };
                let i = shot.unknown;
                let given = relaxation(&shot) * shot.residual / own.get(i, band);
                equation.transport.column(band, i, column);
                r.iter_mut().zip(column.iter()).for_each(|(r, k)| *r += k * given);
                r[i] -= given;
                l[i] += given;
            }
        });
    }
}

/// The unknown with most left to shoot, if any has.
fn brightest(band: usize, weights: &[f64], residual: &[f64]) -> Option<Shot> {
    let (mut unknown, mut most, mut total) = (0, 0.0, 0.0);
    for (i, (weight, r)) in weights.iter().zip(residual).enumerate() {
        let power = weight * r;
        total += power;
        if power.abs() > most {
            (unknown, most) = (i, power.abs());
        }
    }
    (most > 0.0).then(|| Shot { band, unknown, residual: residual[unknown], power: total })
}
