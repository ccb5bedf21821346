//! Random walks on the assembled matrix: the discrete truth.

mod chain;
mod gathering;

pub use gathering::{MatrixWalk, Scoring};
