//! Answers with their errors, for whoever needs one that is not another renderer's.

pub mod cases;
mod picture;

pub use picture::{pictures, to_image};
