//! What if some rows of K were others: an answer without factoring again.
//!
//! ```text
//! K' = K + U V,      U = (eᵢ) for the rows i that change, V what is added to them
//! (I − K')⁻¹ E = x + Z (I − V Z)⁻¹ V x,      x = (I − K)⁻¹ E,      Z = (I − K)⁻¹ U
//! ```
//!
//! One albedo changes the rows of its bundles by multiples of the rows of G; a lamp changes no row, only E. Cost for m rows: m solutions
//! with the old factors, and ⅔ m³. Source: Sherman and Morrison (1950); Woodbury (1950).

use super::Factored;
use crate::linalg::{Block, Dense, LinearOperator, LuFactor};
use crate::solver::SolveError;

const METHOD: &str = "what-if";

/// Rows of K of one band, and what is added to them.
#[derive(Clone, Debug)]
pub struct RowChange {
    pub band: usize,
    /// Which rows, each once.
    pub rows: Vec<usize>,
    /// V, as many rows as change, n columns.
    pub change: Dense,
}

impl Factored {
    /// L of the changed equation for the emission of that band, n × 1, from the factors of the old one.
    ///
    /// # Errors
    /// A change that makes the equation singular.
    ///
    /// # Panics
    /// If V has not a row for every row that changes, or not a column for every unknown.
    pub fn what_if(&self, what: &RowChange, emission: &[f64]) -> Result<Vec<f64>, SolveError> {
        let (n, m) = (emission.len(), what.rows.len());
        assert_eq!((what.change.n_rows(), what.change.n_columns()), (m, n));
        let x = self.solve_band(what.band, Block::from_fn(n, 1, |i, _| emission[i]));
        if m == 0 {
            return Ok(x.column(0).to_vec());
        }

        // Z, and I − V Z.
        let unit = Block::from_fn(n, m, |i, k| if what.rows[k] == i { 1.0 } else { 0.0 });
        let responses = self.solve_band(what.band, unit);
        let mut fed_back = Block::zeros(m, m);
        what.change.apply(&responses, &mut fed_back);
        let matrix = Dense::from_fn(m, m, |r, c| if r == c { 1.0 } else { 0.0 } - fed_back.get(r, c));
        let factor = LuFactor::new(&matrix);
        let factor = factor.map_err(|source| SolveError::Factor { method: METHOD, band: what.band, source })?;

        let mut weights = Block::zeros(m, 1);
        what.change.apply(&x, &mut weights);
        factor.solve(&mut weights);
        let mut answer = x.column(0).to_vec();
        for (k, weight) in weights.column(0).iter().enumerate() {
            answer.iter_mut().zip(responses.column(k)).for_each(|(l, z)| *l += weight * z);
        }
        Ok(answer)
    }
}
