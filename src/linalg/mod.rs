//! Operators, blocks of vectors, factorizations. The only door to `faer`, `sprs` and `nalgebra`.

mod block;
mod equation;
mod operator;

pub use block::Block;
pub use equation::{Equation, SelfAdjoint};
pub use operator::LinearOperator;
