//! Sparse elimination, band by band.
//!
//! ```text
//! P (I − K) Q = L U,      P (I − M^½ S^½ G S^½ M^−½) Pᵀ = C Cᵀ
//! ```
//!
//! Only what is not zero is stored and eliminated, in an order that keeps the factors sparse; the report tells how many entries they came
//! to (`n_fill`). Pays where most patches do not see each other; in an open room K is full, and so are its factors, at several times the
//! cost of the dense methods. Cost: that of the fill. LU needs I − K to have an inverse, Cholesky the self-adjoint form, which it checks by
//! two products, and ρ(K) < 1. Source: Gilbert and Peierls (1988); Davis (2006), chapters 4 and 6; by faer.

use super::cholesky::{Symmetrised, solve_symmetrised};
use super::factored::{Band, Factored, eliminate};
use crate::linalg::{Equation, FactorError, Factorization, Sparse, SparseCholeskyFactor, SparseLuFactor};
use crate::solver::{Attempt, Observer, SolveError, Solver};

/// Sparse LU by faer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SparseLu;

/// Sparse Cholesky by faer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SparseCholesky;

impl SparseLu {
    /// The factors of every band.
    ///
    /// # Errors
    /// A matrix that is singular or not finite.
    pub fn factor(&self, equation: Equation<'_>) -> Result<Factored, SolveError> {
        Factored::new(self.name(), equation, factor)
    }
}

impl Solver for SparseLu {
    fn name(&self) -> &'static str {
        "sparse-lu"
    }

    fn is_direct(&self) -> bool {
        true
    }

    fn attempt<'a>(&self, equation: Equation<'a>, _: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        eliminate(self.name(), equation, factor)
    }
}

impl Solver for SparseCholesky {
    fn name(&self) -> &'static str {
        "sparse-cholesky"
    }

    fn is_direct(&self) -> bool {
        true
    }

    fn attempt<'a>(&self, equation: Equation<'a>, _: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        solve_symmetrised(self.name(), equation, |form, band, weight| {
            let (rows, n) = (Symmetrised::new(form, band, weight), weight.len());
            let matrix = Sparse::from_row_fn(n, n, |i, out| {
                let (mut row, mut mixed) = (vec![0.0; n], vec![0.0; n]);
                rows.write_row(i, [&mut row, &mut mixed], out);
            });
            let factor = SparseCholeskyFactor::new(&matrix)?;
            let n_fill = factor.n_entries();
            Ok((Box::new(factor) as Box<dyn Factorization>, Some(n_fill)))
        })
    }
}

/// I − K of one band with its nonzeros, and the diagonal whatever it is.
fn factor(equation: Equation<'_>, band: usize) -> Result<Band, FactorError> {
    let transport = Sparse::from_operator(equation.transport, band);
    let row = |i: usize| {
        let (columns, values) = transport.row_entries(i);
        let mut row: Vec<(u32, f64)> = columns.iter().zip(values).map(|(c, v)| (*c, -v)).collect();
        match row.binary_search_by_key(&(i as u32), |entry| entry.0) {
            Ok(k) => row[k].1 += 1.0,
            Err(k) => row.insert(k, (i as u32, 1.0)),
        }
        row
    };
    let n = equation.n_unknowns();
    let rows: Vec<_> = (0..n).map(row).collect();
    let factor = SparseLuFactor::new(&Sparse::from_rows(n, &rows))?;
    let n_fill = factor.n_entries();
    Ok((Box::new(factor), Some(n_fill)))
}
