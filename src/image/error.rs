//! What can be wrong with a picture or its file.

use thiserror::Error;

/// Why a picture could not be encoded or decoded.
#[derive(Debug, Error)]
pub enum ImageError {
    #[error("a picture of {width} × {height} pixels and {n_channels} channels cannot hold {n_values} values")]
    Shape { width: usize, height: usize, n_channels: usize, n_values: usize },
    #[error("a PNG shows 1 or 3 channels, not {found}")]
    Channels { found: usize },
    #[error("exposure must be finite and above zero, not {0}")]
    Exposure(f64),
    #[error("two channels are named '{0}'")]
    DuplicateChannel(String),
    #[error("not a readable EXR file")]
    Exr(#[source] exr::error::Error),
    #[error(
        "the EXR header announces {announced} bytes of pixels, more than the {allowed} that {file} bytes of file can hold"
    )]
    ExrAnnouncesTooMuch { announced: u128, allowed: u128, file: usize },
    #[error("the EXR file uses {0}, which is not read here")]
    ExrUnsupported(&'static str),
    #[error("the PNG could not be encoded")]
    Png(#[from] png::EncodingError),
}
