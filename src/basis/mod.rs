//! Finite ray bundles: elements × bins of directions, and their étendue.
//!
//! An *element* is one side of a surface patch, one medium cell, or the environment; a *bundle* is an element and one of its bins
//! of directions. Bundles are numbered element by element, bin by bin.

mod bundles;
mod directions;
mod grid;
mod hierarchy;

pub use bundles::{BasisError, Bundles, Element, Patch, Resolution};
pub use directions::{Directions, DirectionsError};
