//! Scenes with known answers, each with its derivation.
//!
//! One module a scene: it opens with the geometry, and derives the exact answer where there is one. [`list`] is the
//! catalogue with every parameter filled in; the functions beside it build single scenes and take their parameters.
//!
//! Lengths are metres; y is up, except between the parallel plates and around the floating block, which keep the
//! coordinates of their references.
//! Closed scenes face inward, blocks in them outward, and nothing in a closed scene covers anything else.

mod cases;
pub mod cornell_box;
pub mod corner_box;
mod entry;
mod exact;
pub mod floating_block;
pub mod furnace_cube;
pub mod furnace_sphere;
mod matte;
pub mod maze;
pub mod parallel_plates;
mod shape;
pub mod spherical_crater;
pub mod two_rooms;

pub use cases::CASES;
pub use cornell_box::cornell_box;
pub use corner_box::corner_box;
pub use entry::{Entry, closest, find, list};
pub use exact::{Continuous, Exact, MeanRadiance, PointRadiance, UniformPatches, emitted_power};
pub use floating_block::floating_block;
pub use furnace_cube::{furnace_cube, furnace_exact};
pub use furnace_sphere::furnace_sphere;
pub use maze::maze;
pub use parallel_plates::{parallel_plates, parallel_plates_exact};
pub use spherical_crater::{spherical_crater, spherical_crater_exact};
pub use two_rooms::two_rooms;
