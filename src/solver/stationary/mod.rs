//! Methods that repeat one and the same step.

mod ambient;
mod chebyshev;
mod gauss_seidel;
mod interval;
mod jacobi;
mod neumann;
mod overshoot;
mod progressive;
mod richardson;
mod shooting;
mod sor;
mod southwell;
mod sweep;

pub use chebyshev::Chebyshev;
pub use gauss_seidel::{GaussSeidel, SymmetricGaussSeidel};
pub use jacobi::Jacobi;
pub(super) use jacobi::one_minus_diagonal;
pub use neumann::Neumann;
pub use overshoot::Overshooting;
pub use progressive::Progressive;
pub use richardson::Richardson;
pub use sor::Sor;
pub use southwell::Southwell;
