//! How many directions K has, without all of its singular values.
//!
//! ```text
//! ‖A − Q Qᵀ A‖ ≤ δ      ⇒      σₖ(Qᵀ A) ≤ σₖ(A) ≤ σₖ(Qᵀ A) + δ
//! ```
//!
//! with A = M^½ K M^−½, Q from random vectors, and δ = 4 max ‖(A − Q Qᵀ A) ω‖ over sixteen vectors ω of independent entries, uniform and of
//! variance 1: for any unit v the density of ⟨v, ω⟩ is below 0.41 (Ball 1986), so that ‖A − Q Qᵀ A‖ exceeds δ with a probability below
//! (2 · 0.41 / 4)¹⁶ < 1e-11. Cost n² (2 rank + 16) and n rank², where all singular values take some 10 n³. Source: Halko, Martinsson and Tropp
//! (2011), §4.3.

use super::super::SolveError;
use super::leading::weighed;
use crate::linalg::{Block, Dense, Equation, LinearOperator, Range, max_abs, singular_values};

/// δ over the largest image of what was tried.
const SAFETY: f64 = 4.0;

/// δ that is aimed at, over the smallest singular value that counts.
const SHARP: f64 = 0.25;

/// Products with A, and as many with Aᵀ, that find its size.
const POWER_STEPS: usize = 8;

/// low ≤ rank ≤ high: of the singular values that exceed a tolerance times the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RankBounds {
    pub low: usize,
    pub high: usize,
    /// δ, which holds with a probability of 1 − 1e-11.
    pub missing: f64,
    /// Products of K or its transpose with one vector.
    pub n_products: usize,
}

/// Bounds on the effective rank of one band of K in the norm of étendue, at a tolerance above 0, see [`super::effective_rank`]. Writes K
/// out, 8 n² bytes.
///
/// # Errors
/// Entries that are not finite.
pub fn rank_bounds(equation: Equation<'_>, band: usize, tolerance: f64, seed: u64) -> Result<RankBounds, SolveError> {
    let failed = |source| SolveError::Factor { method: "rank", band, source };
    let matrix = weighed(equation, band);
    matrix.check_finite().map_err(failed)?;
    let range = Range::find(&matrix, SHARP / SAFETY * tolerance * size(&matrix), seed);
    let n_products = range.n_products + 2 * POWER_STEPS;

    // All dimensions, or all that are reached, leave out nothing but rounding.
    let n = equation.n_unknowns();
    let found = singular_values(&range.coefficients).map_err(failed)?;
    let first = found.first().copied().unwrap_or(0.0);
    let missing = if range.rank() == n { n as f64 * f64::EPSILON * first } else { SAFETY * range.missing };
    let low = found.iter().filter(|value| **value > tolerance * (first + missing)).count();
    let high = if missing > tolerance * first {
        n
    } else {
        found.iter().filter(|value| **value + missing > tolerance * first).count()
    };
    Ok(RankBounds { low, high, missing, n_products })
}

/// ‖A‖ from below, by the power method on Aᵀ A.
fn size(matrix: &Dense) -> f64 {
    let n = matrix.n_rows();
    let mut x = Block::from_fn(n, 1, |_, _| 1.0);
    let mut y = Block::zeros(n, 1);
    let norm = |x: &Block| x.values().iter().map(|v| v * v).sum::<f64>().sqrt();
    let mut size = 0.0;
    for _ in 0..POWER_STEPS {
        let scale = norm(&x);
        if scale == 0.0 || max_abs(x.values()).is_nan() {
            break;
        }
        x.values_mut().iter_mut().for_each(|v| *v /= scale);
        matrix.apply(&x, &mut y);
        size = norm(&y);
        matrix.apply_transpose(&y, &mut x);
    }
    size
}
