//! Where a sequence of finer and finer polygons is heading.

use super::error::CaseError;
use crate::linalg::{Block, Dense, LuFactor};

/// A limit and the error that is estimated for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    pub value: f64,
    pub error: f64,
}

/// The estimate is the last change of the extrapolation, which measures the error before it; ten times that leaves room for sequences
/// that are not quite even.
const SAFETY: f64 = 10.0;

/// One order more improves an extrapolation by no more than this: a change that is smaller still is luck.
const SUDDEN: f64 = 0.1;

/// Extrapolates values at these steps to step 0 by the polynomial in step^power through all of them (Richardson; Neville's scheme).
///
/// The estimate is the largest of the last change, times ten, of a share of the change before, and of the difference to the polynomial
/// that has a linear term in place of the highest power; plus the given error of the values themselves, amplified as the scheme amplifies it. One value is its
/// own limit, of unknown error.
pub fn extrapolate(steps: &[f64], values: &[f64], power: f64, value_error: f64) -> Limit {
    let n = values.len();
    if n < 2 {
        return Limit { value: values.first().copied().unwrap_or(f64::NAN), error: f64::INFINITY };
    }
    let (best, noise) = neville(steps, values, power, value_error);
    let value = best[n - 1];
    let change = |k: usize| (best[k] - best[k - 1]).abs();
    let last = change(n - 1).max(if n > 2 { SUDDEN * change(n - 2) } else { 0.0 });
    let odd = if power == 1.0 || n < 3 { 0.0 } else { (value - with_linear_term(steps, values, power)).abs() };
    Limit { value, error: (SAFETY * last).max(odd) + noise }
}

/// The limit of the interpolant with the powers 0, 1, power, 2 power, … of the step; NaN where the steps do not determine it.
fn with_linear_term(steps: &[f64], values: &[f64], power: f64) -> f64 {
    let n = values.len();
    let exponent = |j: usize| if j < 2 { j as f64 } else { power * (j - 1) as f64 };
    let matrix = Dense::from_fn(n, n, |i, j| (steps[i] / steps[0]).powf(exponent(j)));
    let mut x = Block::from_fn(n, 1, |i, _| values[i]);
    match LuFactor::new(&matrix) {
        Ok(factor) => {
            factor.solve(&mut x);
            x.get(0, 0)
        }
        Err(_) => f64::NAN,
    }
}

/// The extrapolations through the last 1, 2, … n values, and the noise of the last of them.
fn neville(steps: &[f64], values: &[f64], power: f64, value_error: f64) -> (Vec<f64>, f64) {
    let x: Vec<f64> = steps.iter().map(|step| step.powf(power)).collect();
    let n = values.len();
    let mut column = values.to_vec();
    let mut noise = vec![value_error; n];
    let mut best = vec![column[n - 1]];
    for k in 1..n {
        for i in 0..n - k {
            let share = x[i + k] / (x[i] - x[i + k]);
            column[i] = column[i + 1] + share * (column[i + 1] - column[i]);
            noise[i] = (1.0 + share.abs()) * noise[i + 1] + share.abs() * noise[i];
        }
        best.push(column[n - 1 - k]);
    }
    (best, noise[0])
}

/// Computes lists of values at finer and finer resolutions, and extrapolates each of them: `compute(n)` at every n of `levels`, the step
/// being 1/n.
///
/// # Errors
/// What `compute` returns.
pub fn refine(
    levels: &[usize],
    power: f64,
    mut compute: impl FnMut(usize) -> Result<(Vec<f64>, f64), CaseError>,
) -> Result<Vec<Limit>, CaseError> {
    let mut table: Vec<Vec<f64>> = Vec::new();
    let mut value_error: f64 = 0.0;
    for n in levels {
        let (values, error) = compute(*n)?;
        value_error = value_error.max(error);
        table.push(values);
    }
    let steps: Vec<f64> = levels.iter().map(|n| 1.0 / *n as f64).collect();
    let n_values = table.first().map_or(0, Vec::len);
    let limit = |k: usize| {
        let column: Vec<f64> = table.iter().map(|row| row[k]).collect();
        extrapolate(&steps, &column, power, value_error * column[column.len() - 1].abs())
    };
    Ok((0..n_values).map(limit).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polynomial_in_the_step_is_extrapolated_exactly_and_a_rough_one_within_its_estimate() {
        let steps = [1.0, 0.5, 0.25, 0.125];
        let smooth = steps.map(|h: f64| 3.0 + h.powi(2) - 2.0 * h.powi(4));
        let limit = extrapolate(&steps, &smooth, 2.0, 0.0);
        // Rounding of values near 3, amplified a few times.
        assert!((limit.value - 3.0).abs() < 1e-14, "{limit:?}");
        let rough = steps.map(|h: f64| 3.0 + h.powf(1.5));
        let limit = extrapolate(&steps, &rough, 2.0, 0.0);
        assert!((limit.value - 3.0).abs() < limit.error && limit.error < 0.1, "{limit:?}");
    }
}
