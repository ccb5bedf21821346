//! Random walks on the assembled matrix: the discrete truth.

mod chain;
mod gathering;
mod guided;
mod jacobi;
mod measuring;
mod multilevel;
mod oracle;
mod quasi;
mod scoring;
mod sequential;
mod shooting;

pub use gathering::MatrixWalk;
pub use guided::GuidedWalk;
pub use jacobi::StochasticJacobi;
pub use measuring::MeasuringWalk;
pub use multilevel::{LevelReport, Multilevel, MultilevelEstimate, NestingError};
pub use oracle::{OracleError, Order, Prediction};
pub use quasi::QuasiWalk;
pub use scoring::Scoring;
pub use sequential::{Sequential, SequentialEstimate, SequentialStop, Stage};
pub use shooting::ShootingWalk;
