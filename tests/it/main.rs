//! Integration tests, through the public interface, in one binary.

mod estimator;
mod gallery;
