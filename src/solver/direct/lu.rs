//! Gaussian elimination with partial pivoting, band by band.
//!
//! ```text
//! P (I − K) = L U
//! ```
//!
//! Needs I − K to have an inverse; writes it out in full: 8 n² bytes twice. Cost ⅔ n³ a band by faer; the nalgebra twin is an
//! independent check and several times slower. Loses digits as absorption falls: the condition number is up to 2 / (1 − albedo).

use super::factored::{Band, Factored, eliminate, one_minus_transport};
use crate::linalg::{Equation, FactorError, LuFactor, NalgebraLu};
use crate::solver::{Attempt, Observer, SolveError, Solver};

/// LU by faer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lu;

/// LU by nalgebra.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LuNalgebra;

impl Lu {
    /// The factors of every band: 8 n² bytes each.
    ///
    /// # Errors
    /// A matrix that is singular or not finite.
    pub fn factor(&self, equation: Equation<'_>) -> Result<Factored, SolveError> {
        Factored::new(self.name(), equation, factor)
    }
}

impl Solver for Lu {
    fn name(&self) -> &'static str {
        "lu"
    }

    fn is_direct(&self) -> bool {
        true
    }

    fn attempt<'a>(&self, equation: Equation<'a>, _: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        eliminate(self.name(), equation, factor)
    }
}

impl Solver for LuNalgebra {
    fn name(&self) -> &'static str {
        "lu-nalgebra"
    }

    fn is_direct(&self) -> bool {
        true
    }

    fn attempt<'a>(&self, equation: Equation<'a>, _: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        eliminate(self.name(), equation, |equation, band| {
            Ok((Box::new(NalgebraLu::new(&one_minus_transport(equation, band))?), None))
        })
    }
}

fn factor(equation: Equation<'_>, band: usize) -> Result<Band, FactorError> {
    Ok((Box::new(LuFactor::new(&one_minus_transport(equation, band))?), None))
}
