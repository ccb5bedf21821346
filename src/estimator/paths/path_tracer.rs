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
//! f E cosθ′ / (p + q) ≤ (f cosθ′ / q) E under the balance heuristic and half of that at most under the power heuristic, with no trace of the
//! 1/r² of near emitters. f cosθ′ / q is the albedo of a diffuse surface and bounded for a Phong lobe, so one vertex adds 2 max E at most, the
//! length of paths falls off geometrically where light is absorbed or escapes, and all moments exist. With
//! [`Sampling::Emitters`] alone a point adds f E cosθ′ cosθ″ / (r² p), whose square cannot be integrated where an emitter touches a
//! surface that it lights: there the variance is infinite, the error falls off slower than n^(−1/2), and no error bar holds.
//!
//! Cost: a closest-hit ray and a shadow ray a vertex. Visibility leaves out the plane that a ray starts on by identity; there is no epsilon.
//! Paths of one bundle go abreast; each draws and finds what it would by itself, bit for bit.
//! Source: Kajiya 1986; Veach 1997, §9.2 (heuristics), §10.4 (roulette).

use super::super::bounces::Columns;
use super::super::{Bounces, Estimator, EstimatorError, Score, Truth};
use super::lanes;
use super::stage::Stage;
use super::wave::Wave;
use super::{Heuristic, Roulette};
use crate::basis::Bundles;
use crate::sampling::{Stream, Streams};
use crate::scene::Scene;
use std::ops::Range;

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

impl Sampling {
    /// The weight of what one of the two ways has found, with the densities of this one and of the other.
    #[inline]
    pub(super) fn weight(self, mine: f64, other: f64) -> f64 {
        match self {
            Self::Both(heuristic) => heuristic.weight(mine, other),
            Self::Directions | Self::Emitters => 1.0,
        }
    }
}

/// Paths whose mean is the continuous radiance of every bundle.
pub struct PathTracer<'a> {
    pub(super) stage: Stage<'a>,
    pub(super) sampling: Sampling,
    pub(super) roulette: Roulette,
    columns: Columns,
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
        let (streams, key, number, block) = stream.address();
        let mut wave = Wave::new(self, self.columns, streams, key);
        for found in wave.run(start, std::iter::once(number), block) {
            score.totals(start).iter_mut().zip(found).for_each(|(total, found)| *total += found);
        }
        stream.skip(wave.block.wrapping_sub(block));
        score.count_steps(wave.n_rays);
    }

    fn samples(&self, start: usize, numbers: Range<u64>, streams: &Streams, score: &mut Score) {
        let mut wave = Wave::new(self, self.columns, *streams, start as u32);
        let mut next = numbers.start;
        while next < numbers.end {
            let end = numbers.end.min(next.saturating_add(lanes::N as u64));
            for found in wave.run(start, next..end, 0) {
                score.totals(start).copy_from_slice(found);
                score.end_sample();
            }
            next = end;
        }
        score.count_steps(wave.n_rays);
    }
}
