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
//! ## The rooms, top to bottom
//!
//! A room uses only rooms further down; `tests/tidy.rs` reads the sources and fails on an arrow that runs up.
//!
//! | room | what it is for |
//! |---|---|
//! | `cli` | arguments in, exit codes out; the only room that prints |
//! | [`report`] | figures and pages |
//! | [`study`] | experiments: what varies, what is held, what is recorded |
//! | [`oracle`] | answers for whoever needs one that is not another renderer's |
//! | [`compare`] | norms, z-scores, equivalence, rates |
//! | [`solver`] | deterministic answers, one file a method |
//! | [`estimator`] | random answers: paths, walks on the matrix |
//! | [`assembly`] | scene + basis → T, S, E, W |
//! | [`basis`] | finite ray bundles: elements × bins of directions |
//! | [`gallery`] | scenes with known answers, and their derivations |
//! | [`scene`] | surfaces, emitters, camera; files |
//! | [`scattering`], [`medium`] | how light turns, how it fades |
//! | [`geometry`] | polygons and rays |
//! | [`linalg`] | operators, blocks of vectors, factorizations |
//! | [`image`], [`sampling`], [`stats`] | pixels, random numbers, hypothesis tests |
//!
//! ## The heart of it
//!
//! ```
//! use etendue::assembly::{Exchange, assemble};
//! use etendue::basis::{Bundles, Resolution};
//! use etendue::gallery;
//! use etendue::solver::{Cg, Solver};
//!
//! let scene = gallery::cornell_box();
//! let bundles = Bundles::new(&scene, Resolution { patch_size: 1.0, n_directions: 1 })?;
//! let system = assemble(&scene, &bundles, Exchange::default())?;
//! let answer = Cg { tolerance: 1e-12 }.solve(system.equation(), &mut ())?;
//! assert!(answer.report.true_residual <= 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
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

/// The README's example, kept true by running it.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
