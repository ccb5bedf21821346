//! Integration tests, through the public interface, in one binary; a module a subject.

mod compare;
mod equations;
mod exchange;
mod form_factors;
mod format;
mod gallery;
mod image;
mod laws;
mod medium;
mod operators;
mod patches;
mod refinement;
mod report;
mod sampling;
mod scattering;
mod scenes;
mod solvers;
mod sphere;
mod stats;
mod threads;
mod tracing;
