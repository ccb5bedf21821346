//! Cholesky factorization of the symmetrised equation, band by band.
//!
//! ```text
//! (I − M^½ S^½ G S^½ M^−½) v = M^½ S^½ G E,      L = E + S^½ M^−½ v
//! ```
//!
//! Needs the self-adjoint form and checks it by two products: a factorization that reads one triangle would not notice. The matrix is
//! symmetric because M G is, and positive definite where ρ(K) < 1. Writes it out in full. Cost ⅓ n³ a band, half of LU's.

use super::factored::Band;
use crate::linalg::{Block, CholeskyFactor, Dense, Equation, FactorError, SelfAdjoint, Sparse};
use crate::solver::report::{Work, conclude};
use crate::solver::self_adjoint::{CHECK, checked_form};
use crate::solver::{Observer, Solution, SolveError, Solver, Stop};
use rayon::prelude::*;

/// Cholesky by faer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cholesky;

impl Solver for Cholesky {
    fn name(&self) -> &'static str {
        "cholesky"
    }

    fn is_direct(&self) -> bool {
        true
    }

    fn solve(&self, equation: Equation<'_>, _: &mut dyn Observer) -> Result<Solution, SolveError> {
        solve_symmetrised(self.name(), equation, |form, band, weight| {
            Ok((Box::new(CholeskyFactor::new(&symmetrised(form, band, weight))?), None))
        })
    }
}

/// Factors and solves the symmetrised equation, band after band.
pub(super) fn solve_symmetrised(
    method: &'static str,
    equation: Equation<'_>,
    factor: impl Fn(SelfAdjoint<'_>, usize, &[f64]) -> Result<Band, FactorError>,
) -> Result<Solution, SolveError> {
    let form = checked_form(method, equation)?;
    let (n, n_bands) = (equation.n_unknowns(), equation.n_bands());
    let weight: Vec<f64> = form.etendue.iter().map(|mu| mu.sqrt()).collect();

    // The right-hand side for all bands at once.
    let (mut scratch, mut right) = (Block::zeros(n, n_bands), Block::zeros(n, n_bands));
    let mut n_applies = CHECK + form.right_side(equation.emission, &mut scratch, &mut right);

    let mut answer = Block::zeros(n, n_bands);
    let mut fullest = None;
    for band in 0..n_bands {
        let (factors, n_fill) =
            factor(form, band, &weight).map_err(|source| SolveError::Factor { method, band, source })?;
        fullest = fullest.max(n_fill);
        let mut v = Block::from_fn(n, 1, |i, _| weight[i] * right.get(i, band));
        factors.solve(&mut v);
        let unweighted = v.column(0).iter().zip(&weight).map(|(v, w)| v / w);
        answer.column_mut(band).iter_mut().zip(unweighted).for_each(|(u, v)| *u = v);
    }

    let mut radiance = Block::zeros(n, n_bands);
    n_applies += form.answer(equation.emission, &answer, &mut scratch, &mut radiance);
    let work = Work { n_applies, products: n_applies as f64, n_fill: fullest, ..Work::default() };
    conclude(method, equation, radiance, Stop::Direct, work, Vec::new())
}

/// I − M^½ S^½ G S^½ M^−½ of one band.
pub(super) fn symmetrised(form: SelfAdjoint<'_>, band: usize, weight: &[f64]) -> Dense {
    let n = weight.len();
    let root = Sparse::from_operator(form.scattering_root, band);
    let mut matrix = Dense::zeros(n, n);
    matrix.values_mut().par_chunks_mut(n.max(1)).enumerate().for_each_init(
        || (vec![0.0; n], vec![0.0; n]),
        |(row, mixed), (i, out)| {
            // Row i of S^½ G, mixed from the rows of G that the element of i couples.
            mixed.fill(0.0);
            let (columns, values) = root.row_entries(i);
            for (k, s) in columns.iter().zip(values) {
                form.propagation.row(band, *k as usize, row);
                mixed.iter_mut().zip(row.iter()).for_each(|(m, g)| *m += s * g);
            }
            // Times S^½ on the right, weighted and taken from the identity.
            for (l, m) in mixed.iter().enumerate() {
                let (columns, values) = root.row_entries(l);
                columns.iter().zip(values).for_each(|(j, s)| out[*j as usize] -= m * s);
            }
            out.iter_mut().zip(weight).for_each(|(v, w)| *v *= weight[i] / w);
            out[i] += 1.0;
        },
    );
    matrix
}
