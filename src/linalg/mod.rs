//! Operators, blocks of vectors, factorizations. The only door to `faer`, `sprs` and `nalgebra`.

mod adjoint;
mod block;
mod dense;
mod diagonal;
mod eigen;
mod equation;
mod factor;
mod gth;
mod hierarchy;
mod loss;
mod matrix;
mod operator;
mod schur;
mod scratch;
mod share;
mod single;
mod sparse;
mod sparse_factor;

pub use adjoint::Adjoint;
pub use block::{Block, max_abs, worst};
pub use dense::Dense;
pub use diagonal::Diagonal;
pub use eigen::symmetric_eigenvalues;
pub use equation::{Equation, SelfAdjoint, Unknown};
pub use factor::{CholeskyFactor, FactorError, Factorization, LuFactor, NalgebraLu};
pub use gth::GthFactor;
pub use hierarchy::{Aggregation, Hierarchy};
pub use loss::LossFactor;
pub use matrix::Matrix;
pub use operator::LinearOperator;
pub use schur::{SmallPair, eigenpairs, singular_values, symmetric_eigenpairs};
pub use scratch::Scratch;
pub use single::SingleLuFactor;
pub use sparse::Sparse;
pub use sparse_factor::{SparseCholeskyFactor, SparseLuFactor};
