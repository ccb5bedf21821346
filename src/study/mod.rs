//! Experiments: what varies, what is held, what is recorded.

mod outcome;
mod provenance;

pub use outcome::{
    EstimatorRun, ExchangeSummary, HistoryPoint, LawsMeasured, Pictures, Refinement, RefinementLevel, SamplePoint,
    SolverRun, StudyOutcome, SurfaceMean, Truncation,
};
pub use provenance::Provenance;
