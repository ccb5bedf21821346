//! Symmetric repair of closure: T ← D T D with D diagonal, so that every row sums to μ.
//!
//! Keeps T symmetric and non-negative, which row scaling and additive corrections do not. Source: Sinkhorn (1964); the symmetric
//! fixed point dᵢ ← √(dᵢ μᵢ / rowᵢ) is Knight, Ruiz and Uçar (2014), "A symmetry preserving algorithm for matrix scaling".

use crate::linalg::{Block, LinearOperator, Matrix};

/// Rows closer to μ than this need no further sweep: eight ulp, what summing a row leaves.
const CLOSED: f64 = 2e-15;

/// What the repair did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repair {
    /// max |rowᵢ − μᵢ| / μᵢ left.
    pub after: f64,
    pub sweeps: usize,
    /// max |dᵢ − 1|.
    pub strongest: f64,
}

/// max |Σⱼ Tᵢⱼ + sinksᵢ − μᵢ| / μᵢ. One product with T.
pub fn violation(exchange: &Matrix, sinks: &Block, etendue: &[f64]) -> f64 {
    let n = etendue.len();
    let ones = Block::from_fn(n, 1, |_, _| 1.0);
    let mut flow = Block::zeros(n, 1);
    exchange.apply(&ones, &mut flow);
    let row = |i: usize| flow.get(i, 0) + sinks.row(i).sum::<f64>();
    (0..n).map(|i| (row(i) / etendue[i] - 1.0).abs()).fold(0.0, f64::max)
}

/// Scales the exchange and what is lost to sinks (one column a sink) until every row of both sums to its étendue, or until no sweep
/// helps any more: what it did, and the diagonal of D. Cost: two passes over T a sweep.
pub fn repair(exchange: &mut Matrix, sinks: &mut Block, etendue: &[f64]) -> (Repair, Vec<f64>) {
    let n = etendue.len();
    let mut scale = Block::from_fn(n, 1, |_, _| 1.0);
    let mut flow = Block::zeros(n, 1);
    let lost: Vec<f64> = (0..n).map(|i| sinks.row(i).sum()).collect();
    let mut repair = Repair { after: 0.0, sweeps: 0, strongest: 0.0 };
    let mut best = f64::INFINITY;
    let mut best_scale = scale.clone();
    for sweep in 0..500 {
        // Measure the rows of D T D plus D · sinks.
        exchange.apply(&scale, &mut flow);
        let d = scale.column_mut(0);
        let row = |i: usize, d: f64| d * (flow.get(i, 0) + lost[i]);
        let worst = (0..n).map(|i| (row(i, d[i]) / etendue[i] - 1.0).abs()).fold(0.0, f64::max);
        if worst < best {
            best = worst;
            best_scale.column_mut(0).copy_from_slice(d);
            repair.sweeps = sweep;
        } else if sweep > 20 && worst < 1e-13 {
            break;
        }
        if worst <= CLOSED {
            break;
        }
        for (i, d) in d.iter_mut().enumerate() {
            let sum = row(i, *d);
            if sum > 0.0 {
                *d *= (etendue[i] / sum).sqrt();
            }
        }
    }

    repair.after = best;
    let d = best_scale.column(0);
    repair.strongest = d.iter().map(|d| (d - 1.0).abs()).fold(0.0, f64::max);
    exchange.scale_symmetric(d);
    for s in 0..sinks.n_columns() {
        sinks.column_mut(s).iter_mut().zip(d).for_each(|(s, d)| *s *= d);
    }
    (repair, d.to_vec())
}
