//! Random walks on the assembled matrix: shooting, one particle a sample, scored in every bundle it comes by.
//!
//! ```text
//! μᵢ Lᵢ = μᵢ Eᵢ + aᵢ Σⱼ Gⱼᵢ μⱼ Lⱼ        power, and T = M G symmetric
//! ```
//!
//! A particle is born on bundle i with probability qᵢ ∝ μᵢ max over bands Eᵢ and power w = μᵢ Eᵢ / qᵢ. It steps to bundle j with probability
//! Gᵢⱼ, is absorbed there with probability 1 − pⱼ, and goes on with power w aⱼ / pⱼ. Where it arrives, it scores w αⱼ / μⱼ if it is absorbed
//! and w βⱼ / μⱼ if not, with (1 − p) α + p β = a: every arrival with what is reflected on average (*continuous* shooting, the collision
//! scoring), or only where whole particles end or go on (*discrete* shooting, absorption and survival; see [`Scoring`]). E itself is added
//! unsampled. Expected values score as collision does: the reflected power is the expectation already.
//!
//! The mean of every bundle is L without bias. All moments exist where those of [`MatrixWalk`](super::MatrixWalk) do. Errors of different
//! bundles are not independent.
//!
//! Cost: one random number and one alias slot a step. Source: Pattanaik & Mudur 1992; Bekaert 1999, §4.3; Sbert 1997 (variances).

use super::super::bands::Bands;
use super::super::bounces::Columns;
use super::super::{Bounces, Estimator, EstimatorError, Score, Truth};
use super::chain::Chain;
use super::gathering::{N_ABREAST, add};
use super::measuring::Starts;
use super::oracle::Law;
use super::{MatrixWalk, Scoring};
use crate::linalg::Block;
use crate::sampling::{Stream, Streams};
use std::ops::Range;
use std::sync::Arc;

/// Particles on K whose mean is (I − K)⁻¹E, in every band. One start, which scores every bundle.
#[derive(Clone, Debug)]
pub struct ShootingWalk {
    scoring: Scoring,
    columns: Columns,
    pub(super) chain: Arc<Chain>,
    pub(super) births: Arc<Starts>,
    /// n × (1 + 3 bands), row by row: p, then a / p, α / μ and β / μ of every band.
    bundles: Vec<f64>,
    pub(super) known: Block,
}

/// A particle on its way.
struct Particle {
    bundle: usize,
    is_alive: bool,
    /// Steps taken.
    n_steps: usize,
    /// Chooses the next step.
    uniform: f64,
    power: Bands,
    stream: Stream,
    /// Where it arrived, whether it survived there, and with what power it came.
    visits: Vec<(usize, bool, Bands)>,
}

impl MatrixWalk {
    /// Particles on the same tables, shot from the system's emission.
    ///
    /// # Errors
    /// No emission, or exchange that is not symmetric.
    pub fn shooting(&self, scoring: Scoring) -> Result<ShootingWalk, EstimatorError> {
        let chain = self.chain.clone();
        if !chain.is_reciprocal {
            return Err(EstimatorError::NotReciprocal);
        }
        let births = Starts::new(&chain.emission, &chain.etendue).map_err(EstimatorError::Emission)?;
        let mut bundles = Vec::with_capacity(chain.n_bundles() * (1 + 3 * chain.n_bands));
        for (i, (survival, mu)) in chain.survival.iter().zip(chain.etendue.iter()).enumerate() {
            let (last, other) = scoring.shares(*survival);
            bundles.push(*survival);
            bundles.extend(chain.gain(i));
            bundles.extend(chain.albedo.row(i).map(|a| last * a / mu));
            bundles.extend(chain.albedo.row(i).map(|a| other * a / mu));
        }
        let columns = Columns { n_bands: chain.n_bands, bounces: Bounces::All };
        let known = chain.emission.clone();
        Ok(ShootingWalk { scoring, columns, chain, births: Arc::new(births), bundles, known })
    }
}

impl ShootingWalk {
    /// The same particles, scored for these bounces.
    pub fn with_bounces(self, bounces: Bounces) -> Self {
        let columns = Columns { bounces, ..self.columns };
        let known = columns.first(&self.chain.emission);
        Self { columns, known, ..self }
    }

    pub fn scoring(&self) -> Scoring {
        self.scoring
    }

    pub(super) fn bounces(&self) -> Bounces {
        self.columns.bounces
    }

    /// What a particle of unit power does where it has arrived.
    pub(super) fn law(&self) -> Law<'_> {
        let (n, n_bands) = (self.chain.n_bundles(), self.chain.n_bands);
        let at =
            |first: usize| Block::from_fn(n, n_bands, |i, band| self.bundles[i * (1 + 3 * n_bands) + first + band]);
        Law::of_chain(&self.chain, [at(1 + n_bands), at(1 + 2 * n_bands)])
    }
}

impl Estimator for ShootingWalk {
    fn name(&self) -> &'static str {
        match self.scoring {
            Scoring::Collision => "collision-shooting",
            Scoring::Absorption => "absorption-shooting",
            Scoring::Survival => "survival-shooting",
            Scoring::ExpectedValue => "expected-value-shooting",
        }
    }

    fn truth(&self) -> Truth {
        Truth::Discrete
    }

    fn n_bundles(&self) -> usize {
        self.chain.n_bundles()
    }

    fn n_columns(&self) -> usize {
        self.columns.count()
    }

    fn n_starts(&self) -> usize {
        1
    }

    fn reach(&self, _: usize) -> Range<usize> {
        0..self.n_bundles()
    }

    fn known(&self) -> Option<&Block> {
        Some(&self.known)
    }

    fn samples_a_task(&self) -> u64 {
        4 * self.n_bundles().max(256) as u64
    }

    fn sample(&self, _: usize, stream: &mut Stream, score: &mut Score) {
        let mut particle = self.birth(stream.clone(), Vec::new());
        while particle.is_alive {
            let next = self.chain.steps.sample(particle.bundle, particle.uniform);
            self.arrive(&mut particle, next);
        }
        self.score(&particle, score);
        *stream = particle.stream;
    }

    fn samples(&self, _: usize, numbers: Range<u64>, streams: &Streams, score: &mut Score) {
        let mut waiting = numbers.map(|number| streams.stream(0, number));
        let birth = |stream| self.birth(stream, Vec::new());
        let mut particles: Vec<Particle> = waiting.by_ref().take(N_ABREAST).map(birth).collect();
        let mut draws = Vec::with_capacity(N_ABREAST);
        while !particles.is_empty() {
            // Move them all: first nothing but reads, so that memory delivers many slots at a time.
            draws.clear();
            draws.extend(particles.iter().map(|particle| self.chain.steps.fetch(particle.bundle, particle.uniform)));
            particles.iter_mut().zip(&draws).for_each(|(particle, draw)| self.arrive(particle, draw.column()));

            // Score those that have ended, and put a new one in the place of each.
            let mut k = 0;
            while k < particles.len() {
                if particles[k].is_alive {
                    k += 1;
                    continue;
                }
                self.score(&particles[k], score);
                score.end_sample();
                match waiting.next() {
                    Some(stream) => particles[k] = self.birth(stream, std::mem::take(&mut particles[k].visits)),
                    None => drop(particles.swap_remove(k)),
                }
            }
        }
    }
}

impl ShootingWalk {
    /// A particle where it is born, with the power it carries. Takes another's room for visits.
    fn birth(&self, mut stream: Stream, mut visits: Vec<(usize, bool, Bands)>) -> Particle {
        visits.clear();
        let bundle = self.births.draw(&mut stream);
        let mut power = Bands::all(0.0, self.chain.n_bands);
        power.iter_mut().zip(self.births.weights(bundle)).for_each(|(power, w)| *power = w);
        let uniform = stream.uniform();
        let is_alive = !self.columns.ends_before(1);
        Particle { bundle, is_alive, n_steps: 0, uniform, power, stream, visits }
    }

    /// Lets a particle arrive on its next bundle, maybe out of the scene, and be absorbed or go on.
    #[inline]
    fn arrive(&self, particle: &mut Particle, next: Option<usize>) {
        particle.n_steps += 1;
        let Some(bundle) = next else {
            particle.is_alive = false;
            return;
        };
        let n_bands = self.chain.n_bands;
        let (survival, gain) = self.row(bundle)[..1 + n_bands].split_at(1);

        // Absorb it with probability 1 − p; below p, the number over p is uniform again.
        let uniform = particle.stream.uniform();
        let survives = uniform < survival[0];
        particle.visits.push((bundle, survives, particle.power.clone()));
        particle.bundle = bundle;
        particle.is_alive = survives && !self.columns.ends_before(particle.n_steps + 1);
        particle.uniform = uniform / survival[0];
        particle.power.iter_mut().zip(gain).for_each(|(power, gain)| *power *= gain);
    }

    /// Adds what a particle has left on its way to the sample.
    fn score(&self, particle: &Particle, score: &mut Score) {
        let n_bands = self.chain.n_bands;
        score.count_steps(particle.n_steps as u64);
        for (bounce, (bundle, survives, power)) in (1..).zip(&particle.visits) {
            let Some(here) = self.columns.of(bounce) else { return };
            let first = 1 + if *survives { 2 * n_bands } else { n_bands };
            add(&mut score.totals(*bundle)[here], power, &self.row(*bundle)[first..][..n_bands]);
        }
    }

    #[inline]
    fn row(&self, bundle: usize) -> &[f64] {
        let width = 1 + 3 * self.chain.n_bands;
        &self.bundles[bundle * width..][..width]
    }
}
