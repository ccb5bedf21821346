//! Matrices as files: Matrix Market, NumPy, Radiance.
//!
//! What is read is refused rather than guessed at, holds no more memory than the caller allows, and has no entry that is not finite. What is
//! written reads back to the same bits.

mod error;
mod matrix_market;
mod npy;
mod npz;
mod radiance;

pub use error::{MatrixFileCode, MatrixFileError, Place};

use super::{Dense, LinearOperator, Matrix, Sparse};
use std::fmt;
use std::path::Path;

/// How a matrix is laid out in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MatrixFormat {
    /// `.mtx`: text, `coordinate real general` where sparse, `array real general` where full. Source: Boisvert, Pozo and Remington (1996).
    MatrixMarket,
    /// `.npz`: an array named `data`, or what `scipy.sparse.load_npz` reads as CSR.
    Npz,
    /// Radiance's matrix format: a text header with NROWS, NCOLS, NCOMP and FORMAT, then doubles, row by row.
    Radiance,
}

impl MatrixFormat {
    pub const ALL: [Self; 3] = [Self::MatrixMarket, Self::Npz, Self::Radiance];

    /// What its files end in, without the dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::MatrixMarket => "mtx",
            Self::Npz => "npz",
            Self::Radiance => "rmx",
        }
    }

    /// How many components, which share rows and columns, one file holds: as many as there are, or one.
    pub fn holds_components(self) -> bool {
        self == Self::Radiance
    }

    /// The bytes of a file that holds these matrices of one shape: one, or any number in Radiance's format.
    pub fn write(self, components: &[&Matrix]) -> Vec<u8> {
        match self {
            Self::MatrixMarket => matrix_market::write(components[0]),
            Self::Npz => npz::write(components[0]),
            Self::Radiance => radiance::write(components),
        }
    }
}

impl fmt::Display for MatrixFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::MatrixMarket => "mtx",
            Self::Npz => "npz",
            Self::Radiance => "radiance",
        })
    }
}

/// Reads a file by its ending: its components, all of one shape; one but for Radiance's format. `limit` bounds the bytes that the file and
/// the matrices may hold.
///
/// # Errors
/// What is no such file, with its place; what would hold more than the limit.
pub fn read_matrix(path: &Path, limit: u64) -> Result<Vec<Matrix>, MatrixFileError> {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    let format = MatrixFormat::ALL.into_iter().find(|format| format.extension() == ending);
    let format = format.ok_or_else(|| {
        let endings = MatrixFormat::ALL.map(|format| format!(".{}", format.extension())).join(", ");
        let found = if ending.is_empty() { "a file without an ending".to_string() } else { format!("`.{ending}`") };
        MatrixFileError::new(MatrixFileCode::UnknownFormat, path, found, format!("a file ending in {endings}"))
    })?;

    let unreadable = |found: String| {
        MatrixFileError::new(MatrixFileCode::Unreadable, path, found, "a regular file that may be read")
    };
    let metadata = std::fs::metadata(path).map_err(|error| unreadable(error.kind().to_string()))?;
    if !metadata.is_file() {
        return Err(unreadable("no regular file".to_string()));
    }
    let source = Source { path, limit };
    source.afford(metadata.len() as u128)?;
    let bytes = std::fs::read(path).map_err(|error| unreadable(error.kind().to_string()))?;
    let left = Source { path, limit: limit.saturating_sub(bytes.len() as u64) };
    match format {
        MatrixFormat::MatrixMarket => matrix_market::read(&left, &bytes).map(|matrix| vec![matrix]),
        MatrixFormat::Npz => npz::read(&left, bytes).map(|matrix| vec![matrix]),
        MatrixFormat::Radiance => radiance::read(&left, &bytes),
    }
}

/// BLAKE3 of a file's bytes, hexadecimal.
pub fn content_hash(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

/// The file that is read, and what may be held for it.
struct Source<'a> {
    path: &'a Path,
    limit: u64,
}

impl Source<'_> {
    fn error(&self, code: MatrixFileCode, found: impl Into<String>, expected: impl Into<String>) -> MatrixFileError {
        MatrixFileError::new(code, self.path, found, expected)
    }

    /// Refuses what would take more than is allowed, before it is taken.
    fn afford(&self, n_bytes: u128) -> Result<(), MatrixFileError> {
        if n_bytes <= u128::from(self.limit) {
            return Ok(());
        }
        let found = format!("a matrix that takes {n_bytes} bytes");
        Err(self.error(MatrixFileCode::TooLarge, found, format!("at most {} bytes: allow more memory", self.limit)))
    }

    /// A full matrix from its entries, row by row.
    fn dense(&self, n_rows: usize, n_columns: usize, values: Vec<f64>) -> Result<Matrix, MatrixFileError> {
        if let Some(at) = values.iter().position(|v| !v.is_finite()) {
            let found = format!("entry ({}, {}) is {}", at / n_columns, at % n_columns, values[at]);
            return Err(self.error(MatrixFileCode::InvalidNumber, found, "finite numbers"));
        }
        Ok(Matrix::Dense(Dense::from_values(n_rows, n_columns, values)))
    }

    /// A sparse matrix from its rows, in any order within each.
    fn sparse(&self, n_columns: usize, mut rows: Vec<Vec<(u32, f64)>>) -> Result<Matrix, MatrixFileError> {
        for (r, row) in rows.iter_mut().enumerate() {
            row.sort_unstable_by_key(|entry| entry.0);
            if let Some(pair) = row.windows(2).find(|pair| pair[0].0 == pair[1].0) {
                let found = format!("entry ({r}, {}) is given twice", pair[0].0);
                return Err(self.error(MatrixFileCode::Malformed, found, "every entry once"));
            }
            if let Some((c, v)) = row.iter().find(|(_, v)| !v.is_finite()) {
                let found = format!("entry ({r}, {c}) is {v}");
                return Err(self.error(MatrixFileCode::InvalidNumber, found, "finite numbers"));
            }
        }
        Ok(Matrix::Sparse(Sparse::from_rows(n_columns, &rows)))
    }
}

/// Bytes that a sparse matrix takes while it is read: rows of entries, then CSR.
fn sparse_bytes(n_rows: u128, n_entries: u128) -> u128 {
    n_rows * 40 + n_entries * (16 * 2 + 12)
}
