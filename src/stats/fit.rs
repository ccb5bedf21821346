//! Straight lines through points, and power laws as straight lines of logarithms.

use serde::Serialize;
use thiserror::Error;

/// y = intercept + slope · x.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Line {
    pub slope: f64,
    pub intercept: f64,
    /// Standard error of the slope, from the scatter about the line; infinite for two points, whose scatter is unknown.
    pub slope_standard_error: f64,
    pub n_points: usize,
}

/// Why points have no line.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum FitError {
    #[error("{n_x} abscissae but {n_y} ordinates")]
    Length { n_x: usize, n_y: usize },
    #[error("a line needs at least 2 points, found {found}")]
    TooFewPoints { found: usize },
    #[error("point {point} is ({x:e}, {y:e}): coordinates must be finite")]
    NotFinite { point: usize, x: f64, y: f64 },
    #[error("point {point} is ({x:e}, {y:e}): a power law needs both above zero")]
    NotPositive { point: usize, x: f64, y: f64 },
    #[error("all points have the same abscissa {x:e}")]
    Vertical { x: f64 },
}

/// The least-squares line through (x, y), every point weighed alike.
///
/// # Errors
/// Lengths that differ, fewer than two points, a coordinate that is not finite, abscissae all equal.
pub fn fit_line(x: &[f64], y: &[f64]) -> Result<Line, FitError> {
    let n_points = x.len();
    if n_points != y.len() {
        return Err(FitError::Length { n_x: n_points, n_y: y.len() });
    }
    if n_points < 2 {
        return Err(FitError::TooFewPoints { found: n_points });
    }
    let points = || x.iter().copied().zip(y.iter().copied());
    if let Some((point, (x, y))) = points().enumerate().find(|(_, (x, y))| !(x.is_finite() && y.is_finite())) {
        return Err(FitError::NotFinite { point, x, y });
    }

    // Centre first: sums of squares about the means do not cancel.
    let n = n_points as f64;
    let (x_mean, y_mean) = (x.iter().sum::<f64>() / n, y.iter().sum::<f64>() / n);
    let x_squares: f64 = x.iter().map(|x| (x - x_mean).powi(2)).sum();
    if x_squares == 0.0 {
        return Err(FitError::Vertical { x: x[0] });
    }
    let slope = points().map(|(x, y)| (x - x_mean) * (y - y_mean)).sum::<f64>() / x_squares;
    let intercept = y_mean - slope * x_mean;

    // The scatter about the line, over the n − 2 points it is not fitted to.
    let squared_residuals: f64 = points().map(|(x, y)| (y - y_mean - slope * (x - x_mean)).powi(2)).sum();
    let slope_standard_error =
        if n_points == 2 { f64::INFINITY } else { (squared_residuals / (n - 2.0) / x_squares).sqrt() };
    Ok(Line { slope, intercept, slope_standard_error, n_points })
}

/// The power law y = e^intercept · x^slope, as the least-squares line through (ln x, ln y).
///
/// # Errors
/// Those of [`fit_line`], and coordinates that are not above zero.
pub fn fit_power_law(x: &[f64], y: &[f64]) -> Result<Line, FitError> {
    let not_positive = |v: &f64| v.is_nan() || *v <= 0.0;
    if let Some((point, (&x, &y))) = x.iter().zip(y).enumerate().find(|(_, (x, y))| not_positive(x) || not_positive(y))
    {
        return Err(FitError::NotPositive { point, x, y });
    }
    let ln = |values: &[f64]| values.iter().map(|v| v.ln()).collect::<Vec<_>>();
    fit_line(&ln(x), &ln(y))
}
