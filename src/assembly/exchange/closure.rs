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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Stream;

    /// A closed system with noise of a few per cent on every entry is closed again, and stays symmetric.
    #[test]
    fn noisy_rows_are_closed_by_one_diagonal() {
        let n = 40;
        let mut stream = Stream::new(0x636c_6f73, 0, 0);
        // T = a aᵀ + lost a: rows sum to a (Σ a + lost).
        let a: Vec<f64> = (0..n).map(|_| 0.5 + stream.uniform()).collect();
        let (total, lost): (f64, f64) = (a.iter().sum(), 3.0);
        let etendue: Vec<f64> = a.iter().map(|a| a * (total + lost)).collect();
        let upper: Vec<Vec<(u32, f64)>> = (0..n)
            .map(|i| (i..n).map(|j| (j as u32, a[i] * a[j] * (1.0 + 0.1 * (stream.uniform() - 0.5)))).collect())
            .collect();
        let raw = Matrix::symmetric(&upper);
        let raw_sinks = Block::from_fn(n, 2, |i, _| 0.5 * lost * a[i]);
        let (mut exchange, mut sinks) = (raw.clone(), raw_sinks.clone());
        assert!(violation(&exchange, &sinks, &etendue) > 1e-3);

        let (repair, scale) = repair(&mut exchange, &mut sinks, &etendue);
        // A row of forty terms in f64.
        assert!(repair.after < 1e-14 && violation(&exchange, &sinks, &etendue) < 1e-14, "{repair:?}");
        let strongest = scale.iter().map(|d| (d - 1.0).abs()).fold(0.0, f64::max);
        assert!(repair.strongest == strongest && strongest > 1e-4 && strongest < 0.05, "{repair:?}");
        let (mut row, mut column, mut before) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        for i in 0..n {
            exchange.row(0, i, &mut row);
            exchange.column(0, i, &mut column);
            raw.row(0, i, &mut before);
            assert_eq!(row, column);
            assert!((0..n).all(|j| row[j] == before[j] * (scale[i] * scale[j])));
            assert_eq!(sinks.get(i, 0), raw_sinks.get(i, 0) * scale[i]);
        }
    }

    #[test]
    fn closed_rows_are_left_alone() {
        let upper = vec![vec![(1, 0.75)], vec![]];
        let (mut exchange, mut sinks) = (Matrix::symmetric(&upper), Block::from_fn(2, 2, |_, sink| 0.25 * sink as f64));
        let (repair, scale) = repair(&mut exchange, &mut sinks, &[1.0, 1.0]);
        assert_eq!(repair, Repair { after: 0.0, sweeps: 0, strongest: 0.0 });
        assert_eq!(scale, [1.0, 1.0]);
        assert_eq!(exchange, Matrix::symmetric(&upper));
    }
}
