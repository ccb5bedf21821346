//! Figures and pages: an outcome in, files out. All of it is pure but [`write_whole`], which puts the files in a folder.

mod csv;
mod data;
mod error;
pub mod figure;
mod folder;
mod number;
mod page;
mod picture;
mod render;

pub use error::{Foreign, ReportError};
pub use folder::{MANIFEST, check_folder, write_whole};
pub use render::{render, spectrum_files};

/// One file of a report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Artifact {
    /// A plain file name.
    pub name: String,
    pub bytes: Vec<u8>,
}

/// Version of the layout of `report.json`.
pub const SCHEMA: &str = "etendue.study/1";
