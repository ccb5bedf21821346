//! Light paths in the scene itself: the continuous truth.

mod emitters;
mod heuristic;
mod light_tracer;
mod path_tracer;
mod reflection;
mod roulette;
mod stage;
mod white;

pub use heuristic::Heuristic;
pub use light_tracer::LightTracer;
pub use path_tracer::{PathTracer, Sampling};
pub use roulette::Roulette;
