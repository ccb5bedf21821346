//! Path tracing in the scene itself, scored into the bundles: gathering, one path a sample.
//!
//! ```text
//! L(x, ω) = E(x, ω) + ∫ f(ω′, ω) L(y, −ω′) cosθ′ dω′       y the point that x sees towards ω′
//! ```
//!
//! The expectation of a sample is L averaged over the étendue of a bundle: x uniform on its patch, ω with density cosθ/π. At every
//! vertex, emitters are met in two ways: by a point drawn on them, and by the direction drawn from the BRDF that also carries
//! the path on. With densities p and q by solid angle, the balance heuristic weighs what they find with p/(p + q) and q/(p + q).
//! Before each ray, the path survives with probability min(1, largest throughput over the bands), and is weighed up for it.
//!
//! Variance: a point on an emitter adds f E cosθ′ / (p + q) ≤ (f cosθ′ / q) E, with no trace of the 1/r² of near emitters; a ray adds no more
//! than its throughput times E. f cosθ′ / q is the albedo of a diffuse surface and bounded for a Phong lobe, so one vertex adds
//! 2 max E at most, the length of paths falls off geometrically where light is absorbed or escapes, and all moments exist. In a
//! closed scene that absorbs nothing there is no steady state, and a path never ends.
//!
//! Cost: a closest-hit ray and a shadow ray a vertex. Visibility leaves out the plane that a ray starts on by identity; there is no epsilon.
//! Source: Kajiya 1986; Veach 1997, §9.2 (balance heuristic), §10.4 (roulette).

use super::super::bands::Bands;
use super::super::bounces::Columns;
use super::super::{Bounces, Estimator, EstimatorError, Score, Truth};
use super::stage::{Stage, Vertex};
use crate::basis::Bundles;
use crate::geometry::Ray;
use crate::sampling::Stream;
use crate::scene::{Scene, Side};

/// Paths whose mean is the continuous radiance of every bundle.
pub struct PathTracer<'a> {
    stage: Stage<'a>,
    columns: Columns,
}

impl<'a> PathTracer<'a> {
    /// Cost O(facets log facets + bundles).
    ///
    /// # Errors
    /// Bundles that are not all on patches of this scene, or emission beyond what can be summed.
    pub fn new(scene: &'a Scene, bundles: &'a Bundles) -> Result<Self, EstimatorError> {
        let columns = Columns { n_bands: scene.n_bands(), bounces: Bounces::All };
        Ok(Self { stage: Stage::new(scene, bundles)?, columns })
    }

    /// The same paths, scored for these bounces.
    pub fn with_bounces(self, bounces: Bounces) -> Self {
        Self { columns: Columns { bounces, ..self.columns }, ..self }
    }

    /// Adds what a point drawn on the emitters sends to the vertex and on along the path, weighed against finding it by a ray.
    fn add_direct(&self, vertex: &Vertex<'_>, throughput: &[f64], stream: &mut Stream, totals: &mut [f64]) {
        let stage = &self.stage;
        let (facet, point) = stage.emitters.sample(stage.scene, stream);
        if stage.tracer.coplanar(facet, vertex.facet) {
            return;
        }

        // Both must face each other.
        let offset = point - vertex.position;
        let distance = offset.length();
        let direction = offset / distance;
        let incident = vertex.frame.to_local(direction);
        let emitter_cosine = -direction.dot(stage.scene.polygon(facet).normal());
        if !(incident.z > 0.0 && emitter_cosine > 0.0) {
            return;
        }

        // f E cosθ′ / p, times p / (p + q).
        let by_point = stage.emitters.density(facet) * distance * distance / emitter_cosine;
        let by_ray = vertex.brdf.pdf(vertex.outgoing, incident);
        let scale = incident.z / (by_point + by_ray);
        if !stage.tracer.occluded(vertex.position, point, [vertex.facet, facet]) {
            let emission = &stage.scene.surface_of(facet).emission;
            for (band, total) in totals.iter_mut().enumerate() {
                let reflected = vertex.brdf.eval(band, incident, vertex.outgoing) * scale;
                *total += throughput[band] * reflected * emission[band];
            }
        }
    }
}

impl Estimator for PathTracer<'_> {
    fn name(&self) -> &'static str {
        "path-tracer"
    }

    fn truth(&self) -> Truth {
        Truth::Continuous
    }

    fn n_bundles(&self) -> usize {
        self.stage.patches.len()
    }

    fn n_columns(&self) -> usize {
        self.columns.count()
    }

    fn sample(&self, start: usize, stream: &mut Stream, score: &mut Score) {
        // Leave the bundle with what it emits.
        let (stage, columns) = (&self.stage, self.columns);
        let patch = stage.patches[start];
        let surface = stage.scene.surface_of(patch.facet);
        let Some(emitted) = columns.of(0) else { return };
        for (band, total) in score.totals(start)[emitted].iter_mut().enumerate() {
            *total += surface.emitted(patch.side, band);
        }
        let Some(mut vertex) = stage.leave(patch, stream) else { return };
        let mut throughput = Bands::all(1.0, columns.n_bands);
        for bounce in 1.. {
            let Some(here) = columns.of(bounce) else { return };
            let totals = &mut score.totals(start)[here];
            self.add_direct(&vertex, &throughput, stream, totals);

            // Draw a direction that light may come from.
            let Some(incident) = vertex.brdf.sample(vertex.outgoing, stream.uniform2()) else { return };
            let by_ray = vertex.brdf.pdf(vertex.outgoing, incident);
            let scale = incident.z / by_ray;
            if !scale.is_finite() {
                return;
            }
            for (band, throughput) in throughput.iter_mut().enumerate() {
                *throughput *= vertex.brdf.eval(band, incident, vertex.outgoing) * scale;
            }

            // Let the path survive with the probability that it still carries.
            let survival = throughput.max();
            if survival < 1.0 {
                if stream.uniform() >= survival {
                    return;
                }
                throughput.iter_mut().for_each(|throughput| *throughput /= survival);
            }

            // Go and see where it came from.
            let ray = Ray { origin: vertex.position, direction: vertex.frame.to_world(incident) };
            let Some(hit) = stage.tracer.closest(&ray, Some(vertex.facet)) else { return };
            let side = if hit.front { Side::Front } else { Side::Back };
            let outgoing = stage.frame(hit.polygon, side).to_local(-ray.direction);

            // Add what is emitted there, weighed against drawing that point.
            let density = stage.emitters.density(hit.polygon);
            if hit.front && density > 0.0 {
                let by_point = density * hit.t * hit.t / outgoing.z;
                let share = by_ray / (by_ray + by_point);
                let emission = &stage.scene.surface_of(hit.polygon).emission;
                for (band, total) in totals.iter_mut().enumerate() {
                    *total += throughput[band] * share * emission[band];
                }
            }
            let Some(next) = stage.vertex(hit.polygon, side, ray.at(hit.t), outgoing) else { return };
            vertex = next;
        }
    }
}
