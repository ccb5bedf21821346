//! Closure, Σⱼ Tᵢⱼ + sinksᵢ = μᵢ, as it comes out of the exchange before any repair.

use crate::linalg::{Block, LinearOperator, Matrix, worst};

/// max |Σⱼ Tᵢⱼ + sinksᵢ − μᵢ| / μᵢ. One product with T.
pub fn violation(exchange: &Matrix, sinks: &Block, etendue: &[f64]) -> f64 {
    worst(row_totals(exchange, sinks).iter().zip(etendue).map(|(total, mu)| (total / mu - 1.0).abs()))
}

/// Σⱼ Tᵢⱼ + sinksᵢ, m² sr. One product with T.
pub fn row_totals(exchange: &Matrix, sinks: &Block) -> Vec<f64> {
    let flow = row_sums(exchange);
    (0..flow.n_rows()).map(|i| flow.get(i, 0) + sinks.row(i).sum::<f64>()).collect()
}

/// The bundle that exchanges most with others over its étendue, if that is more than sampling can explain: a quarter and ten
/// standard errors.
pub fn overfull(exchange: &Matrix, etendue: &[f64], variance: &[f64]) -> Option<(usize, f64)> {
    let flow = row_sums(exchange);
    let fullness = |i: usize| flow.get(i, 0) / etendue[i];
    let excess = |i: &usize| fullness(*i) - 1.25 - 10.0 * variance[*i].sqrt() / etendue[*i];
    let fullest = (0..etendue.len()).max_by(|i, j| excess(i).total_cmp(&excess(j)))?;
    (excess(&fullest) > 0.0).then(|| (fullest, fullness(fullest)))
}

/// T 1, n × 1.
pub fn row_sums(exchange: &Matrix) -> Block {
    let n = exchange.n_rows();
    let mut flow = Block::zeros(n, 1);
    exchange.apply(&Block::from_fn(n, 1, |_, _| 1.0), &mut flow);
    flow
}
