//! From a description to a scene: every check, once.

use super::{Facet, Scene, SceneDescription, SceneError, Surface};
use crate::geometry::Polygon;
use std::collections::HashSet;

impl Scene {
    /// Checks the description and makes it immutable.
    ///
    /// # Errors
    /// The first thing found wrong, by name and number: nothing there, nothing that emits, an albedo outside [0, 1], a
    /// negative or infinite emission, a band count that differs, a name used twice, a camera that cannot see.
    pub fn new(description: SceneDescription) -> Result<Self, SceneError> {
        let scene = || description.name.clone();
        if description.surfaces.is_empty() {
            return Err(SceneError::Empty { scene: scene() });
        }
        if description.bands.is_empty() {
            return Err(SceneError::NoBands { scene: scene() });
        }
        let mut names = HashSet::new();
        for surface in &description.surfaces {
            if !names.insert(surface.name.as_str()) {
                return Err(SceneError::DuplicateName { surface: surface.name.clone() });
            }
            check_surface(surface, description.bands.len())?;
        }
        if description.surfaces.iter().all(|s| s.emission.iter().all(|e| *e == 0.0)) {
            return Err(SceneError::NoEmitter { scene: scene() });
        }
        if let Some(camera) = &description.camera {
            camera.check()?;
        }

        let facets = description
            .surfaces
            .iter()
            .enumerate()
            .flat_map(|(surface, s)| (0..s.polygons.len()).map(move |polygon| Facet { surface, polygon }))
            .collect();
        Ok(Self { description, facets })
    }

    pub fn name(&self) -> &str {
        &self.description.name
    }

    /// Names of the colour bands.
    pub fn bands(&self) -> &[String] {
        &self.description.bands
    }

    pub fn n_bands(&self) -> usize {
        self.description.bands.len()
    }

    pub fn surfaces(&self) -> &[Surface] {
        &self.description.surfaces
    }

    pub fn camera(&self) -> Option<&super::Camera> {
        self.description.camera.as_ref()
    }

    /// Every polygon of every surface, in order; a facet's position here is its number everywhere.
    pub fn facets(&self) -> &[Facet] {
        &self.facets
    }

    /// The polygon of a facet.
    pub fn polygon(&self, facet: usize) -> &Polygon {
        let Facet { surface, polygon } = self.facets[facet];
        &self.description.surfaces[surface].polygons[polygon]
    }

    /// The surface of a facet.
    pub fn surface_of(&self, facet: usize) -> &Surface {
        &self.description.surfaces[self.facets[facet].surface]
    }

    /// What the scene was made from.
    pub fn description(&self) -> &SceneDescription {
        &self.description
    }
}

fn check_surface(surface: &Surface, n_bands: usize) -> Result<(), SceneError> {
    let name = || surface.name.clone();
    if surface.polygons.is_empty() {
        return Err(SceneError::NoPolygons { surface: name() });
    }
    let counts = [
        ("albedo", surface.front.n_bands()),
        ("albedo of the back", surface.back.as_ref().map_or(n_bands, |b| b.n_bands())),
        ("emission", surface.emission.len()),
    ];
    for (quantity, found) in counts {
        if found != n_bands {
            return Err(SceneError::BandCount { surface: name(), quantity, found, expected: n_bands });
        }
    }

    // Hold albedos to [0, 1] at normal incidence, and emissions to what is finite and not negative.
    let in_range = |quantity, band, value: f64, high: f64| {
        if value.is_finite() && (0.0..=high).contains(&value) {
            return Ok(());
        }
        Err(SceneError::OutOfRange { surface: name(), quantity, band, value, low: 0.0, high })
    };
    for band in 0..n_bands {
        in_range("albedo", band, surface.front.albedo(band, crate::geometry::Vec3::Z), 1.0)?;
        if let Some(back) = &surface.back {
            in_range("albedo of the back", band, back.albedo(band, crate::geometry::Vec3::Z), 1.0)?;
        }
        in_range("emission", band, surface.emission[band], f64::MAX)?;
    }
    Ok(())
}
