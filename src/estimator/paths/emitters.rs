//! Points on what emits, chosen by power.

use super::super::EstimatorError;
use crate::geometry::Vec3;
use crate::sampling::{AliasTable, Stream};
use crate::scene::Scene;

/// Samples points of the emitting fronts with a density by area in proportion to the largest band's emission.
#[derive(Clone, Debug)]
pub(super) struct Emitters {
    facets: Vec<usize>,
    choice: AliasTable,
    /// Density of [`Emitters::sample`] on each facet of the scene, m⁻²; 0 where nothing is emitted.
    density: Vec<f64>,
}

impl Emitters {
    /// Cost O(facets).
    pub fn new(scene: &Scene) -> Result<Self, EstimatorError> {
        let strength = |facet: usize| scene.surface_of(facet).emission.iter().copied().fold(0.0, f64::max);
        let facets: Vec<usize> = (0..scene.facets().len()).filter(|facet| strength(*facet) > 0.0).collect();
        let power: Vec<f64> = facets.iter().map(|facet| strength(*facet) * scene.polygon(*facet).area()).collect();
        let choice = AliasTable::new(&power).map_err(EstimatorError::Emitters)?;
        let total: f64 = power.iter().sum();
        let density = (0..scene.facets().len()).map(|facet| strength(facet) / total).collect();
        Ok(Self { facets, choice, density })
    }

    /// A facet and a point of it. Draws three numbers.
    pub fn sample(&self, scene: &Scene, stream: &mut Stream) -> (usize, Vec3) {
        let facet = self.facets[self.choice.sample(stream.uniform())];
        (facet, scene.polygon(facet).sample(stream.uniform2()))
    }

    /// Density of [`Emitters::sample`] by area, m⁻², at any point of a facet.
    pub fn density(&self, facet: usize) -> f64 {
        self.density[facet]
    }
}
