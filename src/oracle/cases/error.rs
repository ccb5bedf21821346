//! What can be wrong with a file of cases, and why a case has no answer.

use crate::assembly::AssemblyError;
use crate::basis::BasisError;
use crate::geometry::PolygonError;
use crate::scene::SceneError;
use crate::solver::SolveError;
use thiserror::Error;

/// A file of cases that cannot be used, with the position that is wrong.
#[derive(Debug, Error)]
pub enum CasesError {
    #[error("line {line}, column {column}: not JSON: {message}")]
    Syntax { line: usize, column: usize, message: String },
    #[error("the file must be a list of cases")]
    NotAList,
    #[error("case {index} (counted from 0{}): '{field}' {problem}", name(.id))]
    Field { index: usize, id: Option<String>, field: &'static str, problem: &'static str },
    #[error("two cases are named '{id}'")]
    DuplicateId { id: String },
}

fn name(id: &Option<String>) -> String {
    id.as_ref().map(|id| format!(", '{id}'")).unwrap_or_default()
}

/// Why one case was not answered.
#[derive(Debug, Error)]
pub enum CaseError {
    /// A later capability is missing.
    #[error("needs {0}")]
    Needs(&'static str),
    #[error("geometry field '{field}' {problem}")]
    Geometry { field: String, problem: &'static str },
    #[error("{what}: {source}")]
    Polygon { what: String, source: PolygonError },
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Basis(#[from] BasisError),
    #[error(transparent)]
    Assembly(#[from] AssemblyError),
    #[error(transparent)]
    Solve(#[from] SolveError),
}
