//! Integration tests, through the public interface, in one binary; a module a subject.
#![allow(clippy::unwrap_used, clippy::type_complexity)]
// Reference values are given to more digits than an f64 holds.
#![allow(clippy::excessive_precision, clippy::approx_constant, clippy::single_range_in_vec_init)]

mod compare;
mod estimator;
mod format;
mod gallery;
mod image;
mod medium;
mod report;
mod sampling;
mod scattering;
mod sphere;
mod stats;
