//! Factored once, solved for many right-hand sides.

use crate::linalg::{Block, Dense, Equation, FactorError, Factorization};
use crate::solver::attempt::Again;
use crate::solver::report::Work;
use crate::solver::{Attempt, SolveError, refine};

/// What one band of an equation is factored into, and the entries stored if they were fewer than all.
pub(super) type Band = (Box<dyn Factorization>, Option<usize>);

/// The factors of I − K in every band.
pub struct Factored {
    bands: Vec<Box<dyn Factorization>>,
    /// μ, where the equation came with it.
    etendue: Option<Vec<f64>>,
    n_fill: Option<usize>,
}

impl Factored {
    pub(super) fn new(
        method: &'static str,
        equation: Equation<'_>,
        factor: impl Fn(Equation<'_>, usize) -> Result<Band, FactorError>,
    ) -> Result<Self, SolveError> {
        let mut factored =
            Self { bands: Vec::new(), etendue: equation.self_adjoint.map(|form| form.etendue.to_vec()), n_fill: None };
        for band in 0..equation.n_bands() {
            let (factors, n_fill) =
                factor(equation, band).map_err(|source| SolveError::Factor { method, band, source })?;
            factored.bands.push(factors);
            factored.n_fill = factored.n_fill.max(n_fill);
        }
        Ok(factored)
    }

    /// L of L = E + K L for every column of E; column c is of band c mod bands, so that a block holds any number of emissions. Cost 2 n²
    /// a column for full factors.
    ///
    /// # Panics
    /// If E has another number of rows than K.
    pub fn solve(&self, emission: &Block) -> Block {
        self.each_column(emission, |factors, x| factors.solve(x))
    }

    /// J of J = W + K* J likewise, K* being the adjoint in the étendue inner product; where the equation came without étendue, the plain
    /// transpose.
    pub fn solve_adjoint(&self, measurement: &Block) -> Block {
        let ones = vec![1.0; measurement.n_rows()];
        let etendue = self.etendue.as_deref().unwrap_or(&ones);
        self.each_column(measurement, |factors, x| {
            x.column_mut(0).iter_mut().zip(etendue).for_each(|(x, mu)| *x *= mu);
            factors.solve_transpose(x);
            x.column_mut(0).iter_mut().zip(etendue).for_each(|(x, mu)| *x /= mu);
        })
    }

    /// (I − K)⁻¹ of one band times these columns.
    pub(super) fn solve_band(&self, band: usize, mut columns: Block) -> Block {
        self.bands[band].solve(&mut columns);
        columns
    }

    /// Entries of the factors of the fullest band, if they are stored sparsely.
    pub fn n_fill(&self) -> Option<usize> {
        self.n_fill
    }

    fn each_column(&self, right: &Block, solve: impl Fn(&dyn Factorization, &mut Block)) -> Block {
        let mut answer = Block::zeros(right.n_rows(), right.n_columns());
        let mut column = Block::zeros(right.n_rows(), 1);
        for c in 0..right.n_columns() {
            column.column_mut(0).copy_from_slice(right.column(c));
            solve(&*self.bands[c % self.bands.len()], &mut column);
            answer.column_mut(c).copy_from_slice(column.column(0));
        }
        answer
    }
}

/// Factors and solves band after band, keeping one band's factors at a time, or all where they may be needed again.
pub(super) fn eliminate<'a>(
    method: &'static str,
    equation: Equation<'a>,
    factor: impl Fn(Equation<'_>, usize) -> Result<Band, FactorError>,
) -> Result<Attempt<'a>, SolveError> {
    let mut radiance = equation.emission.clone();
    let mut work = Work::default();
    let mut column = Block::zeros(equation.n_unknowns(), 1);
    let mut kept = Vec::new();
    for band in 0..equation.n_bands() {
        let (factors, n_fill) = factor(equation, band).map_err(|source| SolveError::Factor { method, band, source })?;
        work.n_fill = work.n_fill.max(n_fill);
        substitute(&*factors, &mut column, radiance.column_mut(band));
        if refine::may_be_needed(equation) {
            kept.push(factors);
        }
    }
    let again = (!kept.is_empty()).then(|| {
        let again = move |r: &Block, correction: &mut Block, _: &mut Work| {
            correction.copy_from(r);
            for (band, factors) in kept.iter().enumerate() {
                substitute(&**factors, &mut column, correction.column_mut(band));
            }
        };
        Box::new(again) as Again<'a>
    });
    Ok(Attempt::direct(radiance, work, again))
}

/// x ← A⁻¹ x, by way of a block of one column.
pub(super) fn substitute(factors: &dyn Factorization, column: &mut Block, x: &mut [f64]) {
    column.column_mut(0).copy_from_slice(x);
    factors.solve(column);
    x.copy_from_slice(column.column(0));
}

/// I − K of one band, written out.
pub(super) fn one_minus_transport(equation: Equation<'_>, band: usize) -> Dense {
    let mut matrix = Dense::from_operator(equation.transport, band);
    matrix.values_mut().iter_mut().for_each(|v| *v = -*v);
    for i in 0..equation.n_unknowns() {
        matrix.row_mut(i)[i] += 1.0;
    }
    matrix
}
