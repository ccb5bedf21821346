//! One pass over the unknowns, each from the newest values of the others.

use crate::linalg::{Block, Equation, max_abs, worst};
use rayon::prelude::*;

/// Which way a pass goes.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Order {
    Forward,
    Backward,
}

/// What every band's pass needs and leaves behind; allocated once a solve.
pub(super) struct Sweep<'a> {
    equation: Equation<'a>,
    /// 1 − Kᵢᵢ.
    own: Block,
    rows: Block,
    /// ‖r‖∞ / ‖E‖∞ met by each band, each equation's just before its turn.
    pub residuals: Vec<f64>,
}

impl<'a> Sweep<'a> {
    pub fn new(equation: Equation<'a>, own: Block) -> Self {
        let (n, n_bands) = (equation.n_unknowns(), equation.n_bands());
        Self { equation, own, rows: Block::zeros(n, n_bands), residuals: vec![0.0; n_bands] }
    }

    /// Lᵢ ← Lᵢ + ω rᵢ / (1 − Kᵢᵢ) for every unknown in turn, each band on its own thread with its own ω. Reads K once.
    pub fn pass(&mut self, radiance: &mut Block, order: Order, relaxation: &[f64]) {
        let n = radiance.n_rows().max(1);
        let (equation, own) = (self.equation, &self.own);
        let columns = radiance.values_mut().par_chunks_mut(n).zip(self.rows.values_mut().par_chunks_mut(n));
        columns.zip(self.residuals.par_iter_mut()).enumerate().for_each(|(band, ((l, row), residual))| {
            *residual = pass_band(equation, band, own.column(band), order, relaxation[band], l, row);
        });
    }
}

/// One pass over one band: the largest residual met, relative to ‖E‖∞.
fn pass_band(
    equation: Equation<'_>,
    band: usize,
    own: &[f64],
    order: Order,
    relaxation: f64,
    radiance: &mut [f64],
    row: &mut [f64],
) -> f64 {
    let emission = equation.emission.column(band);
    let n = radiance.len();
    let mut largest = 0.0;
    for k in 0..n {
        let i = if order == Order::Forward { k } else { n - 1 - k };
        equation.transport.row(band, i, row);
        let gathered: f64 = row.iter().zip(radiance.iter()).map(|(k, l)| k * l).sum();
        let residual = emission[i] + gathered - radiance[i];
        radiance[i] += relaxation * residual / own[i];
        largest = worst([largest, residual.abs()].into_iter());
    }
    let scale = max_abs(emission);
    if largest == 0.0 { 0.0 } else { largest / scale }
}
