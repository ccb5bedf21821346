//! What is left out by whoever stops after so many bounces.

use super::outcome::Truncation;
use crate::assembly::System;
use crate::compare::relative_max;
use crate::linalg::{Block, LinearOperator, max_abs};

/// The Neumann series cut after 0, 1, 2, … bounces: its error, and the bound ‖Kᵏ⁺¹E‖∞ / (1 − ‖K‖∞) that needs no answer.
pub(super) fn truncate(system: &System, truth: &Block, limit: usize) -> Vec<Truncation> {
    let transport = system.transport();
    let (n, n_bands) = (system.n_bundles(), system.n_bands());
    let ones = Block::from_fn(n, n_bands, |_, _| 1.0);
    let mut next = Block::zeros(n, n_bands);
    transport.apply(&ones, &mut next);
    let gain: Vec<f64> = next.columns().map(max_abs).collect();

    let mut sum = system.emission().clone();
    let mut term = system.emission().clone();
    let mut series = Vec::new();
    for bounces in 0..limit {
        transport.apply(&term, &mut next);
        std::mem::swap(&mut term, &mut next);
        let bound_of = |band: usize| max_abs(term.column(band)) / (1.0 - gain[band]).max(0.0);
        let bound = (0..n_bands).map(bound_of).fold(0.0, f64::max) / truth.max_abs();
        let error = relative_max(&sum, truth);
        series.push(Truncation { bounces, error, bound });
        if error < 1e-14 {
            break;
        }
        sum.add_scaled(1.0, &term);
    }
    series
}
