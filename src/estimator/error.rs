//! Why an equation or a scene cannot be sampled.

use super::{Kernel, NestingError};
use crate::sampling::AliasError;
use thiserror::Error;

/// What stands in the way of an unbiased sample.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum EstimatorError {
    #[error("the propagation is no table of probabilities: {0}")]
    Propagation(#[source] AliasError),
    #[error("a walk from bundle {bundle} never ends: nothing it can reach absorbs in every band, or lets light out")]
    NeverEnds { bundle: usize },
    #[error("measurement {measurement} cannot be drawn from: {source}")]
    Measurement { measurement: usize, source: AliasError },
    #[error("light cannot be shot: exchange is not symmetric, its closure was repaired by rows")]
    NotReciprocal,
    #[error("light cannot be shot: no emission to draw from: {0}")]
    Emission(#[source] AliasError),
    #[error("bundle {bundle}, band {band}: the guide or its source is {value:e}, must be finite and not negative")]
    Guide { bundle: usize, band: usize, value: f64 },
    #[error("bundle {bundle}, band {band}: the guide is zero where there is something to find")]
    GuideMisses { bundle: usize, band: usize },
    #[error("there is no level to walk on")]
    NoLevels,
    #[error("level {level} is no refinement of the one before: {source}")]
    Nesting { level: usize, source: NestingError },
    #[error("a run needs at least one particle")]
    NoParticles,
    #[error("emitters cannot be chosen by their power: {0}")]
    Emitters(#[source] AliasError),
    #[error("element {element} is not a patch: paths start on surfaces")]
    NotAPatch { element: usize },
    #[error("element {element} lies on facet {facet}, but the scene has {n_facets}: the bundles are another scene's")]
    ForeignBundles { element: usize, facet: usize, n_facets: usize },
    #[error("strategy ({n_light}, 0) has no vertex on the bundle: that is light tracing")]
    NoEyeVertex { n_light: usize },
    #[error(
        "{n_photons} photons through {kernel:?}: there must be some, within a radius above zero or at least the 3 nearest"
    )]
    Kernel { n_photons: usize, kernel: Kernel },
    #[error("the probability that paths go on is {survival:e}, must be above 0 and at most 1")]
    Survival { survival: f64 },
}
