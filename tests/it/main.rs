//! Integration tests, through the public interface, in one binary; a module a subject.
#![allow(clippy::unwrap_used, clippy::type_complexity)]
// Reference values are given to more digits than an f64 holds.
#![allow(clippy::excessive_precision, clippy::approx_constant, clippy::single_range_in_vec_init)]

mod acceleration;
mod check;
mod cli;
mod closure;
mod compare;
mod defects;
mod enclosure;
mod equations;
mod estimator;
mod exchange;
mod form_factors;
mod format;
mod gallery;
mod image;
mod laws;
mod matrices;
mod medium;
mod operators;
mod orbits;
mod pairs;
mod patches;
mod refinement;
mod report;
mod rooms;
mod sampling;
mod scattering;
mod scenes;
mod sensitivity;
mod shadows;
mod shafts;
mod solvers;
mod spectrum;
mod sphere;
mod stats;
mod threads;
mod tracing;
