//! Repair of closure: T is changed so that every row sums to μ.
//!
//! The default is symmetric scaling, T ← D T D with D diagonal: it keeps T symmetric and non-negative. The others are what is found
//! elsewhere, kept to be compared with it; each says which law it breaks.

use super::closure::{row_sums, row_totals};
use crate::linalg::{Block, LinearOperator, Matrix, worst};

/// Rows closer to μ than this need no further sweep: eight ulp, what summing a row leaves.
const CLOSED: f64 = 2e-15;

/// Sweeps at most.
const SWEEPS: usize = 500;

/// How T is made to close.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RepairMethod {
    /// T ← D T D. Sinkhorn (1964); the symmetric fixed point dᵢ ← √(dᵢ μᵢ / rowᵢ) is Knight, Ruiz and Uçar (2014), "A symmetry
    /// preserving algorithm for matrix scaling".
    Symmetric,
    /// Row scaling T ← D T and the mean with the transpose, T ← ½ (T + Tᵀ), in turn until both hold: Tᵢⱼ ← Tᵢⱼ ½ (dᵢ + dⱼ), dᵢ = μᵢ / rowᵢ.
    /// Source: Taylor and Luck (1995), "Comparison of reciprocity and closure enforcement methods for radiation view factors".
    Alternating,
    /// The symmetric change of least Σ (ΔTᵢⱼ / Tᵢⱼ)², ΔTᵢⱼ = Tᵢⱼ² (λᵢ + λⱼ). Entries may turn negative where rows are far off: breaks
    /// *positivity*. Source: Larsen and Howell (1986), "Least-squares smoothing of direct-exchange areas in zonal analysis".
    LeastSquares,
    /// Every row over its sum, T ← D T: breaks *reciprocity*, and with it every statement that rests on a self-adjoint K.
    Rows,
}

impl RepairMethod {
    /// The default first.
    pub const ALL: [Self; 4] = [Self::Symmetric, Self::Alternating, Self::LeastSquares, Self::Rows];

    pub fn name(self) -> &'static str {
        match self {
            Self::Symmetric => "symmetric scaling",
            Self::Alternating => "alternating",
            Self::LeastSquares => "least squares",
            Self::Rows => "row scaling",
        }
    }
}

/// What the repair did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repair {
    /// max |rowᵢ − μᵢ| / μᵢ left.
    pub after: f64,
    pub sweeps: usize,
    /// max |dᵢ − 1|.
    pub strongest: f64,
}

/// Repairs T and its sinks (one column a sink) by any method; returns the sweeps, or steps of conjugate gradients, it took.
pub fn repair_by(method: RepairMethod, exchange: &mut Matrix, sinks: &mut Block, etendue: &[f64]) -> usize {
    match method {
        RepairMethod::Symmetric => repair(exchange, sinks, etendue).0.sweeps,
        RepairMethod::Alternating => alternate(exchange, sinks, etendue),
        RepairMethod::LeastSquares => least_squares(exchange, sinks, etendue),
        RepairMethod::Rows => {
            let d = row_scale(exchange, sinks, etendue);
            exchange.map_entries(|r, _, t| t * d[r]);
            map_sinks(sinks, |i, sink| sink * d[i]);
            1
        }
    }
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
    for sweep in 0..SWEEPS {
        // Measure the rows of D T D plus D · sinks.
        exchange.apply(&scale, &mut flow);
        let d = scale.column_mut(0);
        let row = |i: usize, d: f64| d * (flow.get(i, 0) + lost[i]);
        let open = worst((0..n).map(|i| (row(i, d[i]) / etendue[i] - 1.0).abs()));
        if open < best {
            best = open;
            best_scale.column_mut(0).copy_from_slice(d);
            repair.sweeps = sweep;
        } else if sweep > 20 && open < 1e-13 {
            break;
        }
        if open <= CLOSED || open.is_nan() {
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
    exchange.map_entries(|r, c, t| t * (d[r] * d[c]));
    map_sinks(sinks, |i, sink| sink * d[i]);
    (repair, d.to_vec())
}

/// dᵢ = μᵢ / rowᵢ, 1 for empty rows.
fn row_scale(exchange: &Matrix, sinks: &Block, etendue: &[f64]) -> Vec<f64> {
    let totals = row_totals(exchange, sinks);
    totals.iter().zip(etendue).map(|(total, mu)| if *total > 0.0 { mu / total } else { 1.0 }).collect()
}

fn alternate(exchange: &mut Matrix, sinks: &mut Block, etendue: &[f64]) -> usize {
    for sweep in 0..SWEEPS {
        let d = row_scale(exchange, sinks, etendue);
        if worst(d.iter().map(|d| (d - 1.0).abs())) <= CLOSED {
            return sweep;
        }
        exchange.map_entries(|r, c, t| t * (0.5 * (d[r] + d[c])));
        map_sinks(sinks, |i, sink| sink * d[i]);
    }
    SWEEPS
}

/// Solves (W + diag(W 1 + sinks²)) λ = μ − row, W = T², by conjugate gradients with the diagonal as preconditioner.
fn least_squares(exchange: &mut Matrix, sinks: &mut Block, etendue: &[f64]) -> usize {
    let n = etendue.len();
    let mut weight = exchange.clone();
    weight.map_entries(|_, _, t| t * t);
    let of_row = row_sums(&weight);
    let diagonal: Vec<f64> = (0..n).map(|i| of_row.get(i, 0) + sinks.row(i).map(|s| s * s).sum::<f64>()).collect();
    let totals = row_totals(exchange, sinks);
    let mut residual: Vec<f64> = etendue.iter().zip(&totals).map(|(mu, total)| mu - total).collect();

    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let precondition =
        |r: &[f64]| -> Vec<f64> { r.iter().zip(&diagonal).map(|(r, d)| if *d > 0.0 { r / d } else { 0.0 }).collect() };
    let mut multiplier = vec![0.0; n];
    let mut step = Block::zeros(n, 1);
    let mut image = Block::zeros(n, 1);
    step.column_mut(0).copy_from_slice(&precondition(&residual));
    let mut gain = dot(&residual, step.column(0));
    let mut n_steps = 0;
    while n_steps < SWEEPS && worst(residual.iter().zip(etendue).map(|(r, mu)| (r / mu).abs())) > CLOSED && gain > 0.0 {
        weight.apply(&step, &mut image);
        let p = step.column(0);
        let image: Vec<f64> = (0..n).map(|i| image.get(i, 0) + diagonal[i] * p[i]).collect();
        let length = gain / dot(p, &image);
        for i in 0..n {
            multiplier[i] += length * p[i];
            residual[i] -= length * image[i];
        }
        let next = precondition(&residual);
        let next_gain = dot(&residual, &next);
        for (p, next) in step.column_mut(0).iter_mut().zip(next) {
            *p = next + next_gain / gain * *p;
        }
        gain = next_gain;
        n_steps += 1;
    }
    exchange.map_entries(|r, c, t| t + t * t * (multiplier[r] + multiplier[c]));
    map_sinks(sinks, |i, sink| sink + sink * sink * multiplier[i]);
    n_steps
}

fn map_sinks(sinks: &mut Block, map: impl Fn(usize, f64) -> f64) {
    for s in 0..sinks.n_columns() {
        sinks.column_mut(s).iter_mut().enumerate().for_each(|(i, sink)| *sink = map(i, *sink));
    }
}

#[cfg(test)]
mod tests {
    use super::super::closure::violation;
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

    /// Every method closes; each keeps the laws it says it keeps, and moves T by the size of its noise.
    #[test]
    fn every_method_closes_and_keeps_what_it_says() {
        let n = 30;
        let mut stream = Stream::new(0x7265_7061, 0, 0);
        let a: Vec<f64> = (0..n).map(|_| 0.5 + stream.uniform()).collect();
        let total: f64 = a.iter().sum();
        let etendue: Vec<f64> = a.iter().map(|a| a * (total + 2.0)).collect();
        let upper: Vec<Vec<(u32, f64)>> = (0..n)
            .map(|i| (i..n).map(|j| (j as u32, a[i] * a[j] * (1.0 + 0.02 * (stream.uniform() - 0.5)))).collect())
            .collect();
        let raw = Matrix::symmetric(&upper);
        let raw_sinks = Block::from_fn(n, 2, |i, _| a[i]);
        for method in RepairMethod::ALL {
            let (mut exchange, mut sinks) = (raw.clone(), raw_sinks.clone());
            repair_by(method, &mut exchange, &mut sinks, &etendue);
            // A row of thirty terms in f64.
            assert!(violation(&exchange, &sinks, &etendue) < 1e-14, "{}", method.name());
            let (mut row, mut column, mut before) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
            let mut is_symmetric = true;
            for i in 0..n {
                exchange.row(0, i, &mut row);
                exchange.column(0, i, &mut column);
                raw.row(0, i, &mut before);
                is_symmetric &= row == column;
                assert!((0..n).all(|j| (row[j] / before[j] - 1.0).abs() < 0.01), "{}", method.name());
            }
            assert_eq!(is_symmetric, method != RepairMethod::Rows, "{}", method.name());
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
