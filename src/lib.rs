//! # etendue
//!
//! Light transport as linear algebra. A small scene is cut into finite ray bundles; one bounce of light is an explicit
//! matrix K; the light field solves
//!
//! ```text
//! L = E + K L,      K = S G,      L = (I − K)⁻¹ E = E + K E + K² E + …
//! ```
//!
//! and that one equation is solved directly, iteratively, by truncated series and by Monte Carlo.
//!
//! ## The letters
//!
//! | math | meaning | in code | shape, unit |
//! |---|---|---|---|
//! | L | outgoing radiance, one coefficient a bundle | `radiance` | n × bands, W m⁻² sr⁻¹ |
//! | E | emitted radiance | `emission` | n × bands |
//! | G | propagation: outgoing → incident radiance | `propagation` | n × n, 1 |
//! | S | local scattering: incident → outgoing | `scattering` | n × n, block-diagonal by element |
//! | K = S G | transport: one bounce | `transport` | n × n |
//! | W | measurement: outgoing radiance → pixels | `measurement` | m × n |
//! | μ | étendue of a bundle | `etendue` | n, m² sr |
//! | T = M G, M = diag(μ) | exchange: étendue flowing between bundles, symmetric | `exchange` | n × n, m² sr |
//! | R = M S | scattering in étendue form, symmetric | `redistribution` | block-diagonal |
//!
//! (Arvo 1995 and Veach 1997 write K for our S and T for our K.)
//!
//! ## The rooms, in reading order
//!
//! Each room uses only rooms further down this list; `tests/tidy.rs` reads the sources and fails on an arrow that runs up.
#![forbid(unsafe_code)]

pub mod assembly;
pub mod basis;
#[doc(hidden)]
pub mod cli;
pub mod compare;
pub mod estimator;
pub mod gallery;
pub mod geometry;
pub mod image;
pub mod linalg;
pub mod medium;
pub mod oracle;
pub mod report;
pub mod sampling;
pub mod scattering;
pub mod scene;
pub mod solver;
pub mod stats;
pub mod study;
