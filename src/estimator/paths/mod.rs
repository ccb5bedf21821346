//! Light paths in the scene itself: the continuous truth.

mod bidirectional;
mod density;
mod emitters;
mod glossy;
mod heuristic;
mod lanes;
mod light_tracer;
mod path_tracer;
mod photon;
mod reflection;
mod roulette;
mod stage;
mod wave;
mod white;

pub use bidirectional::Bidirectional;
pub use density::{Kernel, PhotonDensity};
pub use heuristic::Heuristic;
pub use light_tracer::LightTracer;
pub use path_tracer::{PathTracer, Sampling};
pub use roulette::Roulette;
