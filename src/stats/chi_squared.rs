//! Pearson's χ² test of counts against expectations.

use super::special::regularised_upper_gamma;
use thiserror::Error;

/// Cells that expect fewer counts are pooled: the usual floor (Cochran 1954) below which the statistic is not χ²-distributed.
pub const MIN_EXPECTED: f64 = 5.0;

/// Observed and expected totals may differ by this much, relatively: what a quadrature of the expectations may leave.
const TOTAL_TOLERANCE: f64 = 1e-6;

/// The outcome of the test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChiSquared {
    /// Σ (observed − expected)² / expected over the cells after pooling; infinite if something impossible was observed.
    pub statistic: f64,
    /// Cells after pooling, less one.
    pub n_degrees_of_freedom: usize,
    /// Probability of a statistic at least this large, were the expectations true.
    pub p_value: f64,
}

/// Why there is nothing to test.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ChiSquaredError {
    #[error("{n_observed} cells were observed, {n_expected} were expected")]
    Length { n_observed: usize, n_expected: usize },
    #[error("cell {cell} expects {value:e} counts, must be finite and not negative")]
    BadExpectation { cell: usize, value: f64 },
    #[error("{observed} counts were observed in all, {expected} were expected: leave no outcome out")]
    Totals { observed: f64, expected: f64 },
    #[error(
        "only {found} cells are left after pooling those that expect fewer than {MIN_EXPECTED} counts, at least 2 are needed"
    )]
    TooFewCells { found: usize },
}

/// Tests counts against the counts a hypothesis expects, with the cells of small expectation pooled.
///
/// Counts of independent outcomes are assumed, and expectations that were not fitted to them. Asymptotic in the expectations: at a
/// significance of 1e-3 false alarms were measured at 0.99e-3 for sixteen cells of 100, and cells of [`MIN_EXPECTED`] are the least that is
/// in use; in a tail much farther out they make p-values too small.
///
/// All outcomes must have a cell: the totals must agree. A count where zero was expected refutes the hypothesis at once.
/// Cost O(n log n).
///
/// # Errors
/// Lengths or totals that differ, expectations that are not finite or negative, or fewer than two cells after pooling.
pub fn chi_squared_test(observed: &[u64], expected: &[f64]) -> Result<ChiSquared, ChiSquaredError> {
    if observed.len() != expected.len() {
        return Err(ChiSquaredError::Length { n_observed: observed.len(), n_expected: expected.len() });
    }
    if let Some((cell, &value)) = expected.iter().enumerate().find(|(_, e)| !(e.is_finite() && **e >= 0.0)) {
        return Err(ChiSquaredError::BadExpectation { cell, value });
    }
    let (n_observed, n_expected) = (observed.iter().sum::<u64>() as f64, expected.iter().sum::<f64>());
    if (n_observed - n_expected).abs() > TOTAL_TOLERANCE * n_observed {
        return Err(ChiSquaredError::Totals { observed: n_observed, expected: n_expected });
    }

    // Pool from the smallest expectation up, until the pool expects enough; what stays too small joins the next cell.
    let mut cells: Vec<(f64, f64)> = expected.iter().zip(observed).map(|(e, o)| (*e, *o as f64)).collect();
    let impossible = cells.iter().any(|(e, o)| *e == 0.0 && *o > 0.0);
    cells.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut pooled: Vec<(f64, f64)> = Vec::with_capacity(cells.len());
    let mut pool = (0.0, 0.0);
    for (e, o) in cells {
        pool = (pool.0 + e, pool.1 + o);
        if pool.0 >= MIN_EXPECTED {
            pooled.push(pool);
            pool = (0.0, 0.0);
        }
    }
    if let Some(last) = pooled.last_mut() {
        *last = (last.0 + pool.0, last.1 + pool.1);
    }
    if pooled.len() < 2 {
        return Err(ChiSquaredError::TooFewCells { found: pooled.len() });
    }

    // Compare.
    let n_degrees_of_freedom = pooled.len() - 1;
    if impossible {
        return Ok(ChiSquared { statistic: f64::INFINITY, n_degrees_of_freedom, p_value: 0.0 });
    }
    let statistic = pooled.iter().map(|(e, o)| (o - e) * (o - e) / e).sum();
    let p_value = regularised_upper_gamma(0.5 * n_degrees_of_freedom as f64, 0.5 * statistic);
    Ok(ChiSquared { statistic, n_degrees_of_freedom, p_value })
}
