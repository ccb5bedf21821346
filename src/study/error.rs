//! Why a study ends early.

use crate::assembly::AssemblyError;
use crate::basis::BasisError;
use crate::solver::SolveError;
use thiserror::Error;

/// A study that could not be finished.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum StudyError {
    #[error(transparent)]
    Basis(#[from] BasisError),
    #[error(transparent)]
    Assembly(#[from] AssemblyError),
    #[error(transparent)]
    Solve(#[from] SolveError),
    #[error("a study needs at least one solver")]
    NoSolver,
}
