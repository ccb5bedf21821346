//! Gaussian elimination with partial pivoting, band by band.
//!
//! ```text
//! P (I − K) = L U
//! ```
//!
//! Needs I − K to have an inverse; writes it out in full: 8 n² bytes twice. Cost ⅔ n³ a band by faer; the nalgebra twin is an
//! independent check and several times slower. Loses digits as absorption falls: the condition number is up to 2 / (1 − albedo).

use super::report::{Work, conclude};
use super::{Observer, Solution, SolveError, Solver, Stop};
use crate::linalg::{Block, Dense, Equation, FactorError, LuFactor, NalgebraLu};

/// LU by faer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lu;

/// LU by nalgebra.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LuNalgebra;

impl Solver for Lu {
    fn name(&self) -> &'static str {
        "lu"
    }

    fn is_direct(&self) -> bool {
        true
    }

    fn solve(&self, equation: Equation<'_>, _: &mut dyn Observer) -> Result<Solution, SolveError> {
        eliminate(self.name(), equation, |matrix, x| LuFactor::new(matrix).map(|factor| factor.solve(x)))
    }
}

impl Solver for LuNalgebra {
    fn name(&self) -> &'static str {
        "lu-nalgebra"
    }

    fn is_direct(&self) -> bool {
        true
    }

    fn solve(&self, equation: Equation<'_>, _: &mut dyn Observer) -> Result<Solution, SolveError> {
        eliminate(self.name(), equation, |matrix, x| NalgebraLu::new(matrix).map(|factor| factor.solve(x)))
    }
}

/// Writes out I − K and solves it with E, for every band.
fn eliminate(
    method: &'static str,
    equation: Equation<'_>,
    solve: impl Fn(&Dense, &mut Block) -> Result<(), FactorError>,
) -> Result<Solution, SolveError> {
    let n = equation.n_unknowns();
    let mut radiance = Block::zeros(n, equation.n_bands());
    for band in 0..equation.n_bands() {
        let mut matrix = Dense::from_operator(equation.transport, band);
        matrix.values_mut().iter_mut().for_each(|v| *v = -*v);
        for i in 0..n {
            matrix.row_mut(i)[i] += 1.0;
        }
        let mut x = Block::from_fn(n, 1, |i, _| equation.emission.get(i, band));
        solve(&matrix, &mut x).map_err(|source| SolveError::Factor { method, band, source })?;
        radiance.column_mut(band).copy_from_slice(x.column(0));
    }
    conclude(method, equation, radiance, Stop::Direct, Work::default(), Vec::new())
}
