//! Diffuse surfaces, the scene around them, and the film they are seen on.

use super::shape::Outline;
use crate::geometry::Polygon;
use crate::scattering::Lambert;
use crate::scene::{Camera, Film, PixelFilter, Scene, SceneDescription, SceneError, Surface, rgb_bands};
use std::sync::Arc;

/// A one-sided diffuse surface. Errors name the polygon that is none.
pub(super) fn matte(
    name: &str,
    outlines: impl IntoIterator<Item = Outline>,
    albedo: &[f64],
    emission: &[f64],
) -> Result<Surface, SceneError> {
    let polygons = outlines
        .into_iter()
        .enumerate()
        .map(|(polygon, outline)| {
            let named = |source| SceneError::Polygon { surface: name.to_string(), polygon, source };
            Polygon::new(outline).map_err(named)
        })
        .collect::<Result<_, _>>()?;
    Ok(Surface {
        name: name.to_string(),
        polygons,
        front: Arc::new(Lambert::new(albedo.to_vec())),
        back: None,
        emission: emission.to_vec(),
        tessellation: None,
    })
}

/// The scene of these surfaces, its bands named by their number: one is grey, three are linear sRGB.
pub(super) fn scene(name: &str, n_bands: usize, surfaces: Vec<Surface>, camera: Camera) -> Result<Scene, SceneError> {
    let bands = match n_bands {
        1 => vec!["grey".to_string()],
        3 => rgb_bands(),
        n => (1..=n).map(|band| format!("band-{band}")).collect(),
    };
    Scene::new(SceneDescription { name: name.to_string(), bands, surfaces, camera: Some(camera) })
}

/// The film of every gallery camera: 256 × 256 pixels under a Gaussian of standard deviation 0.5 pixel.
pub(super) fn film() -> Film {
    Film { width: 256, height: 256, filter: PixelFilter::Gaussian { standard_deviation: 0.5 } }
}
