//! Cholesky factorization of the symmetrised equation, band by band.
//!
//! ```text
//! (I − M^½ S^½ G S^½ M^−½) v = M^½ S^½ G E,      L = E + S^½ M^−½ v
//! ```
//!
//! Needs the self-adjoint form and checks it by two products: a factorization that reads one triangle would not notice. The matrix is
//! symmetric because M G is, and positive definite where ρ(K) < 1. Writes it out in full. Cost ⅓ n³ a band, half of LU's.

use super::factored::{Band, substitute};
use crate::linalg::{Block, CholeskyFactor, Dense, Equation, FactorError, Factorization, SelfAdjoint, Sparse};
use crate::solver::attempt::Again;
use crate::solver::report::Work;
use crate::solver::self_adjoint::{CHECK, checked_form};
use crate::solver::{Attempt, Observer, SolveError, Solver, refine};
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

    fn attempt<'a>(&self, equation: Equation<'a>, _: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        solve_symmetrised(self.name(), equation, |form, band, weight| {
            Ok((Box::new(CholeskyFactor::new(&Symmetrised::new(form, band, weight).dense())?), None))
        })
    }
}

/// Factors and solves the symmetrised equation, band after band; keeps the factors where they may be needed again.
pub(super) fn solve_symmetrised<'a>(
    method: &'static str,
    equation: Equation<'a>,
    factor: impl Fn(SelfAdjoint<'_>, usize, &[f64]) -> Result<Band, FactorError>,
) -> Result<Attempt<'a>, SolveError> {
    let form = checked_form(method, equation)?;
    let (n, n_bands) = (equation.n_unknowns(), equation.n_bands());
    let weight: Vec<f64> = form.etendue.iter().map(|mu| mu.sqrt()).collect();

    // The right-hand side for all bands at once.
    let zeros = || Block::zeros(n, n_bands);
    let (mut scratch, mut right, mut radiance) = (zeros(), zeros(), zeros());
    let mut work = Work::default();
    work.count_applies(CHECK + form.right_side(equation.emission, &mut scratch, &mut right));

    let mut kept = Vec::new();
    let mut column = Block::zeros(n, 1);
    for band in 0..n_bands {
        let (factors, n_fill) =
            factor(form, band, &weight).map_err(|source| SolveError::Factor { method, band, source })?;
        work.n_fill = work.n_fill.max(n_fill);
        substitute_weighted(&*factors, &weight, &mut column, right.column_mut(band));
        if refine::may_be_needed(equation) {
            kept.push(factors);
        }
    }
    work.count_applies(form.answer(equation.emission, &right, &mut scratch, &mut radiance));

    let again = (!kept.is_empty()).then(|| {
        let again = move |r: &Block, correction: &mut Block, work: &mut Work| {
            work.count_applies(form.right_side(r, &mut scratch, &mut right));
            for (band, factors) in kept.iter().enumerate() {
                substitute_weighted(&**factors, &weight, &mut column, right.column_mut(band));
            }
            work.count_applies(form.answer(r, &right, &mut scratch, correction));
        };
        Box::new(again) as Again<'a>
    });
    Ok(Attempt::direct(radiance, work, again))
}

/// u ← M^−½ C⁻ᵀ C⁻¹ M^½ u of one band.
fn substitute_weighted(factors: &dyn Factorization, weight: &[f64], column: &mut Block, u: &mut [f64]) {
    u.iter_mut().zip(weight).for_each(|(u, w)| *u *= w);
    substitute(factors, column, u);
    u.iter_mut().zip(weight).for_each(|(u, w)| *u /= w);
}

/// I − M^½ S^½ G S^½ M^−½ of one band, row by row.
pub(super) struct Symmetrised<'a> {
    form: SelfAdjoint<'a>,
    /// M^½.
    weight: &'a [f64],
    /// S^½.
    root: Sparse,
}

impl<'a> Symmetrised<'a> {
    pub fn new(form: SelfAdjoint<'a>, band: usize, weight: &'a [f64]) -> Self {
        Self { form, weight, root: Sparse::from_operator(form.scattering_root, band) }
    }

    /// out ← row i; `row` and `mixed` are room to work in.
    pub fn write_row(&self, i: usize, [row, mixed]: [&mut [f64]; 2], out: &mut [f64]) {
        // Row i of S^½ G, mixed from the rows of G that the element of i couples.
        mixed.fill(0.0);
        let (columns, values) = self.root.row_entries(i);
        for (k, s) in columns.iter().zip(values) {
            self.form.propagation.row(0, *k as usize, row);
            mixed.iter_mut().zip(row.iter()).for_each(|(m, g)| *m += s * g);
        }
        // Times S^½ on the right, weighted and taken from the identity.
        out.fill(0.0);
        for (l, m) in mixed.iter().enumerate().filter(|(_, m)| **m != 0.0) {
            let (columns, values) = self.root.row_entries(l);
            columns.iter().zip(values).for_each(|(j, s)| out[*j as usize] -= m * s);
        }
        out.iter_mut().zip(self.weight).for_each(|(v, w)| *v *= self.weight[i] / w);
        out[i] += 1.0;
    }

    fn dense(&self) -> Dense {
        let n = self.weight.len();
        let mut matrix = Dense::zeros(n, n);
        matrix.values_mut().par_chunks_mut(n.max(1)).enumerate().for_each_init(
            || (vec![0.0; n], vec![0.0; n]),
            |(row, mixed), (i, out)| self.write_row(i, [row, mixed], out),
        );
        matrix
    }
}
