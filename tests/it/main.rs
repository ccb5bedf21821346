//! Integration tests, through the public interface, in one binary; a module a subject.

mod cli;
mod compare;
mod format;
mod gallery;
mod image;
mod medium;
mod report;
mod sampling;
mod scattering;
mod sphere;
mod stats;
