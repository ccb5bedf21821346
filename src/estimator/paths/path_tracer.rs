//! Path tracing in the scene itself, scored into the bundles: gathering, one path a sample.
//!
//! ```text
//! L(x, ω) = E(x, ω) + ∫ f(ω′, ω) L(y, −ω′) cosθ′ dω′       y the point that x sees towards ω′
//! ```
//!
//! The expectation of a sample is L averaged over the étendue of a bundle: x uniform on its patch, ω with density cosθ/π. At every
//! vertex, emitters are met in one or both of two ways: by the direction drawn from the BRDF that also carries the path on, and by a
//! point drawn on them. With densities q and p by solid angle, both together weigh what they find by a [`Heuristic`], e.g. with
//! q/(p + q) and p/(p + q). Before each ray, a [`Roulette`] decides whether the path goes on.
//!
//! Variance, with paths weighed by their throughput: a ray adds no more than its throughput times E. A point on an emitter adds
//! f E cosθ′ / (p + q) ≤ (f cosθ′ / q) E under the balance heuristic, with no trace of the 1/r² of near emitters, and no more than
//! 1.21 times that under the power heuristic. f cosθ′ / q is the albedo of a diffuse surface and bounded for a Phong lobe, so one vertex
//! adds 2.21 max E at most, the length of paths falls off geometrically where light is absorbed or escapes, and all moments exist. With
//! [`Sampling::Emitters`] alone a point adds f E cosθ′ cosθ″ / (r² p), whose square cannot be integrated where an emitter touches a
//! surface that it lights: there the variance is infinite, the error falls off slower than n^(−1/2), and no error bar holds.
//!
//! Cost: a closest-hit ray and a shadow ray a vertex. Visibility leaves out the plane that a ray starts on by identity; there is no epsilon.
//! Source: Kajiya 1986; Veach 1997, §9.2 (heuristics), §10.4 (roulette).

use super::super::bands::Bands;
use super::super::bounces::Columns;
use super::super::{Bounces, Estimator, EstimatorError, Score, Truth};
use super::stage::{Arrival, Stage, Vertex};
use super::{Heuristic, Roulette};
use crate::basis::Bundles;
use crate::sampling::Stream;
use crate::scene::{Scene, Side};

/// How paths find emitters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Sampling {
    /// By the rays that carry them on (unidirectional path tracing).
    Directions,
    /// By points drawn on the emitters (next-event estimation).
    Emitters,
    /// By both, weighed.
    Both(Heuristic),
}

/// Paths whose mean is the continuous radiance of every bundle.
pub struct PathTracer<'a> {
    stage: Stage<'a>,
    sampling: Sampling,
    roulette: Roulette,
    columns: Columns,
}

/// A point on an emitter as a vertex sees it.
struct Sight {
    /// f E cosθ′ over the density, a band each.
    light: Bands,
    is_free: bool,
}

impl<'a> PathTracer<'a> {
    /// Paths that find emitters in both ways, weighed by the balance heuristic. Cost O(facets log facets + bundles).
    ///
    /// # Errors
    /// Bundles that are not all on patches of this scene, emission beyond what can be summed, or a closed part of the scene that absorbs
    /// nothing in some band.
    pub fn new(scene: &'a Scene, bundles: &'a Bundles) -> Result<Self, EstimatorError> {
        let columns = Columns { n_bands: scene.n_bands(), bounces: Bounces::All };
        let sampling = Sampling::Both(Heuristic::Balance);
        Ok(Self { stage: Stage::new(scene, bundles)?, sampling, roulette: Roulette::default(), columns })
    }

    /// The same paths, finding emitters so.
    pub fn with_sampling(self, sampling: Sampling) -> Self {
        Self { sampling, ..self }
    }

    /// The same paths, ended so.
    ///
    /// # Errors
    /// A survival probability outside (0, 1].
    pub fn with_roulette(self, roulette: Roulette) -> Result<Self, EstimatorError> {
        roulette.checked().map(|roulette| Self { roulette, ..self })
    }

    /// The same paths, scored for these bounces.
    pub fn with_bounces(self, bounces: Bounces) -> Self {
        Self { columns: Columns { bounces, ..self.columns }, ..self }
    }

    /// Adds one path to the score. Returns how many rays it cast.
    #[inline]
    fn trace(&self, start: usize, stream: &mut Stream, score: &mut Score) -> u64 {
        // Leave the bundle with what it emits.
        let (stage, columns) = (&self.stage, self.columns);
        let patch = stage.patches[start];
        let Some(emitted) = columns.of(0) else { return 0 };
        add(&mut score.totals(start)[emitted], stage.emission(patch.facet, patch.side), 1.0);
        let Some(mut vertex) = stage.leave(patch, stream) else { return 0 };
        let mut throughput = Bands::all(1.0, columns.n_bands);
        let mut n_rays = 0;
        for bounce in 1.. {
            let Some(here) = columns.of(bounce) else { return n_rays };
            let totals = &mut score.totals(start)[here];
            if let Some(sight) = self.draw_emitter(&vertex, &throughput, stream) {
                n_rays += 1;
                if sight.is_free {
                    add(totals, &sight.light, 1.0);
                }
            }
            if self.sampling == Sampling::Emitters && columns.ends_before(bounce + 1) {
                return n_rays;
            }

            // Draw a direction that light may come from, and let the path survive or not.
            let Some(turn) = vertex.reflection.turn(vertex.given, stream.uniform2(), &mut throughput) else {
                return n_rays;
            };
            let survival = self.roulette.survival(bounce, throughput.max());
            if survival < 1.0 {
                if stream.uniform() >= survival {
                    return n_rays;
                }
                throughput.iter_mut().for_each(|throughput| *throughput /= survival);
            }

            // Go and see where it came from.
            n_rays += 1;
            let direction = vertex.frame.to_world(turn.direction);
            let Some(arrival) = stage.follow(vertex.facet, vertex.position, direction) else { return n_rays };
            let density = stage.emitters.density(arrival.facet);
            if density > 0.0 && arrival.side == Side::Front && self.sampling != Sampling::Emitters {
                let weight = self.weight_of_ray(turn.density, density, &arrival);
                let emission = &stage.scene.surface_of(arrival.facet).emission;
                for ((total, throughput), emission) in totals.iter_mut().zip(throughput.iter()).zip(emission) {
                    *total += throughput * weight * emission;
                }
            }
            let Some(next) = stage.vertex(&arrival) else { return n_rays };
            vertex = next;
        }
        n_rays
    }

    /// What a point drawn on the emitters sends to the vertex and on along the path, weighed against finding it by a ray; `None` where the
    /// two do not face each other, or emitters are not drawn.
    #[inline]
    fn draw_emitter(&self, vertex: &Vertex<'_>, throughput: &Bands, stream: &mut Stream) -> Option<Sight> {
        if self.sampling == Sampling::Directions {
            return None;
        }
        let stage = &self.stage;
        let (emitter, point) = stage.emitters.point(stream);
        if stage.tracer.coplanar(emitter.facet, vertex.facet) {
            return None;
        }
        let offset = point - vertex.position;
        let distance_squared = offset.length_squared();
        let direction = offset / distance_squared.sqrt();
        let incident = vertex.frame.to_local(direction);
        let emitter_cosine = -direction.dot(emitter.polygon.normal());
        if !(incident.z > 0.0 && emitter_cosine > 0.0) {
            return None;
        }

        // f E cosθ′ / p, times the weight.
        let by_point = emitter.density * distance_squared / emitter_cosine;
        let weight = match self.sampling {
            Sampling::Both(heuristic) => heuristic.weight(by_point, vertex.reflection.density(vertex.given, incident)),
            _ => 1.0,
        };
        let mut light = throughput.clone();
        light.iter_mut().zip(emitter.emission).for_each(|(light, emission)| *light *= emission);
        vertex.reflection.scale(vertex.given, incident, incident.z / by_point * weight, &mut light);
        if light.max() <= 0.0 {
            return None;
        }
        let is_free = !stage.tracer.occluded(vertex.position, point, [vertex.facet, emitter.facet]);
        Some(Sight { light, is_free })
    }

    /// The weight of an emitter that a ray of this density has found, against drawing that point.
    #[inline]
    fn weight_of_ray(&self, by_ray: f64, density: f64, arrival: &Arrival) -> f64 {
        match self.sampling {
            Sampling::Both(heuristic) => {
                let by_point = density * arrival.distance * arrival.distance / arrival.given.z;
                heuristic.weight(by_ray, by_point)
            }
            _ => 1.0,
        }
    }
}

/// totals ← totals + scale · values.
#[inline]
fn add(totals: &mut [f64], values: &[f64], scale: f64) {
    totals.iter_mut().zip(values).for_each(|(total, value)| *total += scale * value);
}

impl Estimator for PathTracer<'_> {
    fn name(&self) -> &'static str {
        match self.sampling {
            Sampling::Directions => "path-tracer-directions",
            Sampling::Emitters => "path-tracer-emitters",
            Sampling::Both(Heuristic::Balance) => "path-tracer",
            Sampling::Both(Heuristic::Power) => "path-tracer-power",
        }
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
        let n_rays = self.trace(start, stream, score);
        score.count_steps(n_rays);
    }
}
