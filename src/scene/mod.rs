//! What there is: surfaces, emitters, a camera. Validated once, then immutable.

mod camera;
mod error;
mod filter;
mod hash;
mod surface;
mod validate;

pub mod format;

pub use camera::{Camera, Film, PixelFilter};
pub use error::SceneError;
pub use filter::FilterTable;
pub use surface::{Side, Surface, Tessellation};

/// Everything a scene is made of, not yet checked. [`Scene::new`] turns it into a [`Scene`].
#[derive(Clone, Debug, Default)]
pub struct SceneDescription {
    pub name: String,
    /// Names of the colour bands, e.g. `["red", "green", "blue"]` for linear sRGB.
    pub bands: Vec<String>,
    pub surfaces: Vec<Surface>,
    pub camera: Option<Camera>,
}

/// A validated, immutable scene.
///
/// Open scenes are surrounded by a black environment: what leaves, never comes back.
#[derive(Clone, Debug)]
pub struct Scene {
    description: SceneDescription,
    facets: Vec<Facet>,
}

/// One polygon of one surface, by position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Facet {
    /// Index into [`Scene::surfaces`].
    pub surface: usize,
    /// Index into [`Surface::polygons`].
    pub polygon: usize,
}

/// The names of the three default bands, linear sRGB.
pub fn rgb_bands() -> Vec<String> {
    ["red", "green", "blue"].map(String::from).to_vec()
}
