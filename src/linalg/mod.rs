//! Operators, blocks of vectors, factorizations. The only door to `faer`, `sprs` and `nalgebra`.

mod block;
mod dense;
mod diagonal;
mod eigen;
mod equation;
mod factor;
mod matrix;
mod operator;
mod sparse;

pub use block::{Block, max_abs, worst};
pub use dense::Dense;
pub use diagonal::Diagonal;
pub use eigen::symmetric_eigenvalues;
pub use equation::{Equation, SelfAdjoint};
pub use factor::{CholeskyFactor, FactorError, LuFactor, NalgebraLu};
pub use matrix::Matrix;
pub use operator::LinearOperator;
pub use sparse::Sparse;
