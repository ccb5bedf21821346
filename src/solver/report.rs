//! An answer and how it was come by.

use super::{Bracket, SolveError, bracket};
use crate::linalg::{Block, Doubled, Equation, Residual, max_abs, worst};
use std::fmt;

/// Why a solver stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// A factorization gave the answer.
    Direct,
    /// The residual fell below the tolerance.
    Converged,
    /// The products ran out first.
    Budget,
    /// The residual no longer falls.
    Stagnated,
    /// The observer said so.
    Observer,
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Direct => "direct",
            Self::Converged => "converged",
            Self::Budget => "budget",
            Self::Stagnated => "stagnated",
            Self::Observer => "observer",
        })
    }
}

/// L and the report on it.
#[derive(Clone, Debug)]
pub struct Solution {
    /// L, n × bands, W m⁻² sr⁻¹.
    pub radiance: Block,
    pub report: SolveReport,
}

/// What a solve cost and how good it is. Solvers do not time themselves: whoever calls them does.
#[derive(Clone, Debug)]
pub struct SolveReport {
    pub method: &'static str,
    pub stop: Stop,
    pub n_iterations: usize,
    /// Products with K (all bands at once).
    pub n_applies: usize,
    /// Products with K* (all bands at once).
    pub n_adjoint_applies: usize,
    /// Work in units of one product with K or K*: entries touched / entries of K. Methods that read single rows or columns count here.
    pub products: f64,
    /// Corrections that the answer needed once the method had ended: their work is counted above.
    pub n_refinements: usize,
    /// Entries of the factors of the fullest band, where a sparse factorization stored them.
    pub n_fill: Option<usize>,
    /// Residual by iteration, as the method knew it.
    pub history: Vec<f64>,
    /// ‖E + K L − L‖∞ / ‖E‖∞, worst band, recomputed (by one more product, not counted): where the absorption is known without the digits
    /// that subtracting takes, and before L was rounded to what is returned.
    pub true_residual: f64,
    /// L − below ≤ (I − K)⁻¹E ≤ L + above, whatever the method did; `None` where a row of K gains 1 or more.
    pub bracket: Option<Bracket>,
}

/// Work counts, as a method keeps them; their meaning is that of [`SolveReport`].
#[derive(Clone, Copy, Debug, Default)]
pub struct Work {
    pub n_iterations: usize,
    pub n_applies: usize,
    pub n_adjoint_applies: usize,
    pub products: f64,
    pub n_fill: Option<usize>,
}

impl Work {
    /// Counts whole products with K.
    pub fn count_applies(&mut self, n: usize) {
        self.n_applies += n;
        self.products += n as f64;
    }

    /// Counts whole products with K*.
    pub fn count_adjoint_applies(&mut self, n: usize) {
        self.n_adjoint_applies += n;
        self.products += n as f64;
    }

    /// Adds what another piece of work came to.
    pub(super) fn add(&mut self, other: &Work) {
        self.n_iterations += other.n_iterations;
        self.n_applies += other.n_applies;
        self.n_adjoint_applies += other.n_adjoint_applies;
        self.products += other.products;
        self.n_fill = self.n_fill.max(other.n_fill);
    }
}

/// Writes the report on an answer and its residual, as it was evaluated last.
#[allow(clippy::too_many_arguments)]
pub(super) fn conclude(
    method: &'static str,
    equation: Equation<'_>,
    radiance: Doubled,
    (residual, r): (&Residual<'_>, &Block),
    stop: Stop,
    work: Work,
    history: Vec<f64>,
    n_refinements: usize,
) -> Result<Solution, SolveError> {
    let true_residual = relative_residual(equation.emission, r);
    if !true_residual.is_finite() {
        return Err(SolveError::NotFinite { method, iteration: work.n_iterations });
    }
    let report = SolveReport {
        method,
        stop,
        n_iterations: work.n_iterations,
        n_applies: work.n_applies,
        n_adjoint_applies: work.n_adjoint_applies,
        products: work.products,
        n_refinements,
        n_fill: work.n_fill,
        history,
        true_residual,
        bracket: bracket::around(equation, &radiance, residual, r),
    };
    Ok(Solution { radiance: radiance.high, report })
}

/// max over bands of ‖r‖∞ / ‖E‖∞; NaN if any entry is NaN.
pub(super) fn relative_residual(emission: &Block, residual: &Block) -> f64 {
    worst((0..emission.n_columns()).map(|band| band_residual(emission, residual, band)))
}

/// ‖r‖∞ / ‖E‖∞ of one band; a band that emits nothing has residual 0 or ∞.
pub(super) fn band_residual(emission: &Block, residual: &Block, band: usize) -> f64 {
    let r = max_abs(residual.column(band));
    if r == 0.0 { 0.0 } else { r / max_abs(emission.column(band)) }
}
