//! Why a study ends early.

use crate::assembly::AssemblyError;
use crate::basis::BasisError;
use crate::estimator::{EstimatorError, MergeError};
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
    #[error(transparent)]
    Estimator(#[from] EstimatorError),
    #[error(transparent)]
    Merge(#[from] MergeError),
    #[error("a study needs at least one estimator and one sample")]
    NoEstimator,
    #[error("no estimator '{name}'; there are {known}, and all of them by 'all'")]
    UnknownEstimator { name: String, known: String },
    #[error("a study needs at least one solver")]
    NoSolver,
    #[error("an albedo of {albedo} is out of range: 0 ≤ albedo < 1, for at 1 nothing is absorbed")]
    AlbedoOutOfRange { albedo: f64 },
}
