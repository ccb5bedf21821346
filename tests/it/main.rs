//! Integration tests, one binary; a module a subject.

mod compare;
mod medium;
mod sampling;
mod scattering;
mod sphere;
mod stats;
