//! Why a matrix file was refused.

use std::fmt;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// A matrix file that was refused: what, where, what instead.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{}", self.show())]
pub struct MatrixFileError {
    pub code: MatrixFileCode,
    pub file: PathBuf,
    pub place: Place,
    /// What was found, in one line.
    pub found: String,
    /// What would have been accepted.
    pub expected: String,
}

/// What is wrong with a matrix file. The printed form is stable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MatrixFileCode {
    Unreadable,
    UnknownFormat,
    TooLarge,
    Malformed,
    InvalidNumber,
    OutOfRange,
    Truncated,
    WrongShape,
}

/// Where in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    File,
    /// Line and column of a text file, from 1.
    Text { line: usize, column: usize },
}

impl MatrixFileError {
    pub(super) fn new(
        code: MatrixFileCode,
        file: &Path,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self { code, file: file.to_path_buf(), place: Place::File, found: found.into(), expected: expected.into() }
    }

    /// Of files that do not fit together.
    pub fn shape(file: &Path, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::new(MatrixFileCode::WrongShape, file, found, expected)
    }

    pub(super) fn at(self, line: usize, column: usize) -> Self {
        Self { place: Place::Text { line, column }, ..self }
    }

    fn show(&self) -> String {
        let place = match self.place {
            Place::File => String::new(),
            Place::Text { line, column } => format!(":{line}:{column}"),
        };
        format!(
            "error[{}]: {}\n --> {}{place}\n  = expected: {}",
            self.code,
            self.found.escape_debug(),
            self.file.display(),
            self.expected
        )
    }
}

impl fmt::Display for MatrixFileCode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Unreadable => "E0601-unreadable-matrix",
            Self::UnknownFormat => "E0602-unknown-matrix-format",
            Self::TooLarge => "E0603-matrix-too-large",
            Self::Malformed => "E0604-malformed-matrix",
            Self::InvalidNumber => "E0605-invalid-entry",
            Self::OutOfRange => "E0606-entry-out-of-range",
            Self::Truncated => "E0607-truncated-matrix",
            Self::WrongShape => "E0608-wrong-shape",
        })
    }
}
