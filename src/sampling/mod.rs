//! Random and quasi-random numbers and what is made of them. Knows no light.

mod kronecker;

pub use kronecker::{Kronecker, mix};
