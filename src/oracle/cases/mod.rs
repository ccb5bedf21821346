//! Reference cases: files of scenes with known answers, answered by the general machinery and judged.
//!
//! A case's numbers come out of its geometry alone, through scene, bundles, exchange and solve; what is curved stands as polygons of
//! finer and finer cut, extrapolated, with an estimate of the error that is left. The reference is read for its names and shapes,
//! and to be compared with.

mod answer;
mod blocker;
mod closed;
mod continuous;
mod cube;
mod enclosure;
mod error;
mod identities;
mod limit;
mod model;
mod points;
mod polygons;
mod reader;
mod revolution;
mod round;
mod runner;
mod shells;
mod symmetry;
mod value;

pub use answer::{Outcome, Verdict};
pub use error::{CaseError, CasesError};
pub use reader::{Case, Geometry, read};
pub use runner::run;
pub use value::Value;
