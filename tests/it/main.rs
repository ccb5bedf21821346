//! The integration tests, one binary.

mod image;
mod report;
