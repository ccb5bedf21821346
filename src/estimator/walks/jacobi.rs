//! Stochastic Jacobi: all power that is not yet shot, shot at once by particles in proportion.
//!
//! ```text
//! P₀ = M E,      Pₖ₊₁ = S Gᵀ Pₖ      Pₖ = M KᵏE, one iteration a bounce
//! ```
//!
//! An iteration sends Pₖ/quantum particles from every bundle, rounded up or down by one random offset for all of them (systematic
//! sampling), spreads the destinations of a bundle's particles evenly over its row of G, and adds up what arrives before the next: a particle
//! carries the quantum of its bundle's brightest band and the other bands in proportion. The number of particles falls with the power,
//! and a run ends when none is left; since rounding has the right mean at every iteration, the mean of a run is L without bias.
//!
//! A sample is one run of about `n_particles` / (1 − albedo) particles; the error of a run falls faster than that of as many independent
//! particles. Its variance has no linear system here: counts of different bundles depend on one another.
//!
//! Cost: one random number and one alias slot a particle, O(n) a bounce. Source: Neumann 1995 (stochastic Jacobi); Bekaert 1999, §6.

use super::super::bounces::Columns;
use super::super::{Bounces, Estimator, EstimatorError, Score, Truth};
use super::MatrixWalk;
use super::chain::Chain;
use crate::linalg::Block;
use crate::sampling::Stream;
use std::ops::Range;
use std::sync::Arc;

/// First particles that one thread shoots, in whole runs.
const PARTICLES_A_TASK: u64 = 1 << 16;

/// Runs of stochastic Jacobi, whose mean is (I − K)⁻¹E in every band. One start, which scores every bundle.
#[derive(Clone, Debug)]
pub struct StochasticJacobi {
    columns: Columns,
    chain: Arc<Chain>,
    /// Power of a particle in its brightest band, W.
    quantum: f64,
    known: Block,
    samples_a_task: u64,
}

impl MatrixWalk {
    /// Runs that begin with so many particles, on the same tables.
    ///
    /// # Errors
    /// No particles, or exchange that is not symmetric.
    pub fn stochastic_jacobi(&self, n_particles: u64) -> Result<StochasticJacobi, EstimatorError> {
        let chain = self.chain.clone();
        if !chain.is_reciprocal {
            return Err(EstimatorError::NotReciprocal);
        }
        if n_particles == 0 {
            return Err(EstimatorError::NoParticles);
        }
        let brightest = |i: usize| chain.emission.row(i).fold(0.0, f64::max);
        let power: f64 = chain.etendue.iter().enumerate().map(|(i, mu)| mu * brightest(i)).sum();
        let columns = Columns { n_bands: chain.n_bands, bounces: Bounces::All };
        let known = chain.emission.clone();
        Ok(StochasticJacobi {
            columns,
            chain,
            quantum: power / n_particles as f64,
            known,
            samples_a_task: PARTICLES_A_TASK / n_particles,
        })
    }
}

impl StochasticJacobi {
    /// The same runs, scored for these bounces.
    pub fn with_bounces(self, bounces: Bounces) -> Self {
        let columns = Columns { bounces, ..self.columns };
        let known = columns.first(&self.chain.emission);
        Self { columns, known, ..self }
    }
}

impl Estimator for StochasticJacobi {
    fn name(&self) -> &'static str {
        "stochastic-jacobi"
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
        self.samples_a_task
    }

    fn sample(&self, _: usize, stream: &mut Stream, score: &mut Score) {
        let (chain, n, n_bands) = (&self.chain, self.n_bundles(), self.chain.n_bands);
        let etendue = |i: usize| chain.etendue[i];
        let mut unshot: Vec<f64> = (0..n).flat_map(|i| chain.emission.row(i).map(move |e| e * etendue(i))).collect();
        let mut received = vec![0.0; n * n_bands];
        for bounce in 1.. {
            let Some(here) = self.columns.of(bounce) else { return };
            let n_particles = self.shoot(&unshot, &mut received, stream);
            if n_particles == 0 {
                return;
            }
            score.count_steps(n_particles);

            // Reflect what has arrived, and score it.
            for (i, power) in received.chunks_exact_mut(n_bands).enumerate() {
                if power.iter().all(|power| *power == 0.0) {
                    continue;
                }
                let totals = &mut score.totals(i)[here.clone()];
                for ((power, albedo), total) in power.iter_mut().zip(chain.albedo.row(i)).zip(totals) {
                    *power *= albedo;
                    *total += *power / chain.etendue[i];
                }
            }
            std::mem::swap(&mut unshot, &mut received);
            received.fill(0.0);
        }
    }
}

impl StochasticJacobi {
    /// Sends the particles of one iteration and counts them; `received` ← what arrives, n × bands row by row.
    fn shoot(&self, unshot: &[f64], received: &mut [f64], stream: &mut Stream) -> u64 {
        let n_bands = self.chain.n_bands;
        let (mut level, mut n_all) = (stream.uniform(), 0);
        for (i, power) in unshot.chunks_exact(n_bands).enumerate() {
            // Round the bundle's share to whole particles, the rest left for the next.
            let brightest = power.iter().copied().fold(0.0, f64::max);
            level += brightest / self.quantum;
            let n_here = level.floor();
            level -= n_here;
            for k in 0..n_here as u64 {
                let uniform = ((k as f64 + stream.uniform()) / n_here).min(1.0 - f64::EPSILON / 2.0);
                if let Some(j) = self.chain.steps.sample(i, uniform) {
                    let arrived = &mut received[j * n_bands..][..n_bands];
                    arrived.iter_mut().zip(power).for_each(|(sum, power)| *sum += power * (self.quantum / brightest));
                }
            }
            n_all += n_here as u64;
        }
        n_all
    }
}
