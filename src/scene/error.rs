//! What can be wrong with a scene, by name and number.

use crate::geometry::PolygonError;
use thiserror::Error;

/// A scene that cannot be used, with the thing and the number that is wrong.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SceneError {
    #[error("scene '{scene}' has no surfaces")]
    Empty { scene: String },
    #[error("scene '{scene}' has no emitter: no surface has an emission above zero")]
    NoEmitter { scene: String },
    #[error("scene '{scene}' has no colour bands")]
    NoBands { scene: String },
    #[error("surface '{surface}' has no polygons")]
    NoPolygons { surface: String },
    #[error("surface '{surface}', polygon {polygon}: {source}")]
    Polygon { surface: String, polygon: usize, source: PolygonError },
    #[error("surface '{surface}': {quantity} in band {band} is {value:e}, must be finite and within [{low}, {high}]")]
    OutOfRange { surface: String, quantity: &'static str, band: usize, value: f64, low: f64, high: f64 },
    #[error("surface '{surface}': {quantity} has {found} bands, the scene has {expected}")]
    BandCount { surface: String, quantity: &'static str, found: usize, expected: usize },
    #[error("two surfaces are named '{surface}'")]
    DuplicateName { surface: String },
    #[error("camera: {quantity} is {value:e}, must be {expected}")]
    Camera { quantity: &'static str, value: f64, expected: &'static str },
}
