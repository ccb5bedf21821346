//! What can go wrong between an outcome and a folder of files.

use crate::image::ImageError;
use std::path::PathBuf;
use thiserror::Error;

/// Why a report could not be made or written.
#[derive(Debug, Error)]
pub enum ReportError {
    #[error("the figure could not be drawn")]
    Figure(#[source] Box<dyn std::error::Error + Send + Sync>),
    #[error("the built-in font is unreadable")]
    Font,
    #[error("a picture could not be encoded")]
    Image(#[from] ImageError),
    #[error("the outcome could not be written as JSON")]
    Json(#[from] serde_json::Error),
    #[error("'{0}' cannot name a file of a report: it must be a plain file name, used once")]
    ArtifactName(String),
    #[error("{} has no name that a folder could take", path.display())]
    Nameless { path: PathBuf },
    #[error("{} is a file, not a folder; it is left as it is", path.display())]
    NotAFolder { path: PathBuf },
    #[error("{} is not a report ({reason}); it is left as it is", path.display())]
    NotAReport { path: PathBuf, reason: Foreign },
    #[error("{}: {action} failed", path.display())]
    Write { path: PathBuf, action: &'static str, source: std::io::Error },
    #[error("{}: neither could the new report take its place nor the old one be put back; the old one is in {}", path.display(), kept.display())]
    NotRestored { path: PathBuf, kept: PathBuf, source: std::io::Error },
}

/// What in a folder shows that it is not a report of ours.
#[derive(Debug, Error, PartialEq, Eq)]
pub enum Foreign {
    #[error("it holds no readable report.json with a list of its files")]
    NoManifest,
    #[error("it holds '{0}', which its report.json does not list")]
    Stranger(String),
}
