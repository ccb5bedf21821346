//! Random walks on the assembled matrix: the discrete truth.

mod chain;
mod gathering;
mod jacobi;
mod measuring;
mod scoring;
mod shooting;

pub use gathering::MatrixWalk;
pub use jacobi::StochasticJacobi;
pub use measuring::MeasuringWalk;
pub use scoring::Scoring;
pub use shooting::ShootingWalk;
