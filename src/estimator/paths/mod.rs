//! Light paths in the scene itself: the continuous truth.

mod emitters;
mod path_tracer;
mod stage;

pub use path_tracer::PathTracer;
