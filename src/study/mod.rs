//! Experiments: what varies, what is held, what is recorded.

mod agreement;
mod albedo;
mod duality;
mod error;
mod estimation;
mod estimators;
mod foretold;
mod memory;
mod methods;
mod outcome;
mod provenance;
mod refinement;
mod repairs;
mod run;
mod sensitivity;
mod sequential;
mod spectrum;
mod truncation;
mod watch;
mod what_if;

pub use albedo::{albedo_study, check_albedos};
pub use duality::{Duality, LinearSensor};
pub use error::StudyError;
pub use estimators::{Approach, UNBOUNDED, choose_estimators, estimator_names};
pub use memory::memory_estimate;
pub use outcome::{
    AdjointRun, AlbedoLevel, AlbedoStudy, EstimatorRun, ExchangeSummary, Family, HistoryPoint, LawsMeasured,
    MeshAgreement, Pictures, Refinement, RefinementLevel, RepairRun, SamplePoint, SequentialPoint, SequentialRun,
    SolverRun, StudyOutcome, SurfaceMean, Truncation, VarianceAgreement,
};
pub use provenance::Provenance;
pub use refinement::surface_means;
pub use run::{StudySettings, run, tessellations};
pub use sensitivity::{
    Quantity, SensitivityOutcome, Sensor, SurfaceSensitivity, sensitivity, sensitivity_and_what_if, weights,
};
pub use spectrum::{BandSpectrum, Bounces, Counted, SpectrumOutcome, spectrum};
pub use watch::Watch;
pub use what_if::{Change, Property, WhatIf};
