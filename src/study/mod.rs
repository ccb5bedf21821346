//! Experiments: what varies, what is held, what is recorded.

mod error;
mod memory;
mod outcome;
mod provenance;
mod refinement;
mod repairs;
mod run;
mod sensitivity;
mod spectrum;
mod watch;

pub use error::StudyError;
pub use memory::memory_estimate;
pub use outcome::{
    EstimatorRun, ExchangeSummary, HistoryPoint, LawsMeasured, Pictures, Refinement, RefinementLevel, RepairRun,
    SamplePoint, SolverRun, StudyOutcome, SurfaceMean, Truncation,
};
pub use provenance::Provenance;
pub use refinement::surface_means;
pub use run::{StudySettings, run, tessellations};
pub use sensitivity::{Quantity, SensitivityOutcome, Sensor, SurfaceSensitivity, sensitivity, weights};
pub use spectrum::{BandSpectrum, Bounces, Counted, SpectrumOutcome, spectrum};
pub use watch::Watch;
