//! A coarse equation answered by a cycle over coarser ones.
//!
//! ```text
//! (I − Kₗ) x = ρ,      Kₗ = Dₗ⁻¹ Fₗ,      aₗ = Dₗ⁻¹ Σ w a,      Fₗ₊₁ = Pᵀ Fₗ P,      Dₗ = Pᵀ W P
//! x ← x + ρ,   ρ ← Kₗ ρ,      then so many times   x ← x + P (β 1 + d),   ρ ← ρ − β aₗ − P d + Kₗ P d
//! ```
//!
//! with (β, d) the answer of the next level to the ρ that is gathered there, and the last level eliminated without subtracting. Every Kₗ
//! is transport averaged over groups: not below zero, and what it loses known. Answers come as a constant and the rest, as in
//! [`LossFactor`], so that little absorption costs them no digits.

use crate::linalg::{Aggregation, Block, Dense, FactorError, LinearOperator, LossFactor};

/// The levels of one band, finest first.
pub(super) struct Levels {
    levels: Vec<Level>,
    last: LossFactor,
    /// q of the last level.
    last_values: Vec<f64>,
    n_visits: usize,
}

/// One level that is not the last.
struct Level {
    /// Kₗ.
    transport: Dense,
    /// aₗ.
    absorption: Vec<f64>,
    /// Dₗ.
    weight: Vec<f64>,
    /// Groups of the next level.
    onto: Aggregation,
    /// x without its constant.
    x: Block,
    /// ρ.
    residual: Block,
    step: Block,
    image: Block,
    /// What the next level is asked for, and its answer.
    gathered: Vec<f64>,
}

impl Levels {
    /// From F, losses and D of the finest level, and aggregations of its groups, finest first; the last of these is eliminated, or the
    /// finest level itself where there is none. Every level asks the next one `n_visits` times.
    ///
    /// # Errors
    /// As of [`LossFactor::new`].
    pub fn new(
        mut flows: Dense,
        mut losses: Vec<f64>,
        mut weight: Vec<f64>,
        onto: &[Aggregation],
        n_visits: usize,
    ) -> Result<Self, FactorError> {
        let mut levels = Vec::with_capacity(onto.len());
        for (k, aggregation) in onto.iter().enumerate() {
            // What is gathered of this level becomes the next.
            let next = match k {
                0 => aggregation.clone(),
                _ => onto[k - 1].onto(aggregation).unwrap_or_else(|| Aggregation::whole(weight.len())),
            };
            let (n, m) = (weight.len(), next.n_groups());
            let (mut coarser, mut coarser_losses, mut coarser_weight) =
                (Dense::zeros(m, m), vec![0.0; m], vec![0.0; m]);
            for (i, group) in next.groups().enumerate() {
                coarser_losses[group] += losses[i];
                coarser_weight[group] += weight[i];
                let row = coarser.row_mut(group);
                next.groups().zip(flows.row_slice(i)).for_each(|(j, flow)| row[j] += flow);
            }

            // Over what is gathered, flows are transport.
            for (i, weight) in weight.iter().enumerate().filter(|(_, weight)| **weight > 0.0) {
                flows.row_mut(i).iter_mut().for_each(|flow| *flow /= weight);
                losses[i] /= weight;
            }
            let zeros = || Block::zeros(n, 1);
            levels.push(Level {
                transport: std::mem::replace(&mut flows, coarser),
                absorption: std::mem::replace(&mut losses, coarser_losses),
                weight: std::mem::replace(&mut weight, coarser_weight),
                onto: next,
                x: zeros(),
                residual: zeros(),
                step: zeros(),
                image: zeros(),
                gathered: vec![0.0; m],
            });
        }
        let last_values = vec![0.0; losses.len()];
        Ok(Self { levels, last: LossFactor::new(flows, losses)?, last_values, n_visits })
    }

    /// q ← d of x = β 1 + d, and β, by one cycle from nothing: C x = D (I − K) x = q about.
    pub fn solve(&mut self, q: &mut [f64]) -> f64 {
        cycle(&mut self.levels, &self.last, self.n_visits, q)
    }

    /// The same, beginning on the coarsest level: every level starts from the answer of the next, and adds a cycle.
    pub fn solve_nested(&mut self, q: &mut [f64]) -> f64 {
        nested(&mut self.levels, &self.last, self.n_visits, q)
    }

    /// Entries that a cycle reads.
    pub fn n_read(&self) -> f64 {
        let last = (self.last_values.len() as f64).powi(2);
        let visits = self.n_visits as f64;
        self.levels.iter().rev().fold(last, |below, level| visits * (level.weight.len().pow(2) as f64 + below))
    }

    /// Entries that are read to start with a nested cycle.
    pub fn n_read_nested(&self) -> f64 {
        let last = (self.last_values.len() as f64).powi(2);
        let visits = self.n_visits as f64;
        let start = (last, last);
        let sums = self.levels.iter().rev().fold(start, |(cycle, nested), level| {
            let size = level.weight.len().pow(2) as f64;
            let cycle = visits * (size + cycle);
            (cycle, nested + size + cycle)
        });
        sums.1
    }

    /// Entries that are read to form the levels, and what the last elimination multiplies.
    pub fn n_formed(&self) -> f64 {
        let read: f64 = self.levels.iter().map(|level| level.weight.len().pow(2) as f64).sum();
        read + (self.last_values.len() as f64).powi(3) / 3.0
    }
}

fn cycle(levels: &mut [Level], last: &LossFactor, n_visits: usize, q: &mut [f64]) -> f64 {
    let Some((level, coarser)) = levels.split_first_mut() else { return last.solve(q) };
    level.receive(q);
    let constant = level.smooth_and_correct(0.0, n_visits, |q| cycle(coarser, last, n_visits, q));
    q.copy_from_slice(level.x.column(0));
    constant
}

fn nested(levels: &mut [Level], last: &LossFactor, n_visits: usize, q: &mut [f64]) -> f64 {
    let Some((level, coarser)) = levels.split_first_mut() else { return last.solve(q) };
    level.receive(q);
    level.gather();
    let constant = nested(coarser, last, n_visits, &mut level.gathered);
    level.prolong(constant, true);
    let constant = level.smooth_and_correct(constant, n_visits, |q| cycle(coarser, last, n_visits, q));
    q.copy_from_slice(level.x.column(0));
    constant
}

impl Level {
    /// ρ ← D⁻¹ q, x ← 0.
    fn receive(&mut self, q: &[f64]) {
        let rows = self.residual.column_mut(0).iter_mut().zip(q).zip(&self.weight);
        rows.for_each(|((r, q), weight)| *r = if *weight > 0.0 { q / weight } else { 0.0 });
        self.x.values_mut().fill(0.0);
    }

    /// One bounce, and corrections by the next level; β.
    fn smooth_and_correct(
        &mut self,
        mut constant: f64,
        n_visits: usize,
        mut answer: impl FnMut(&mut [f64]) -> f64,
    ) -> f64 {
        self.x.add_scaled(1.0, &self.residual);
        self.transport.apply(&self.residual, &mut self.image);
        std::mem::swap(&mut self.residual, &mut self.image);
        for visit in 1..=n_visits {
            self.gather();
            let added = answer(&mut self.gathered);
            constant += added;
            self.prolong(added, visit < n_visits);
        }
        constant
    }

    /// What the next level is asked for.
    fn gather(&mut self) {
        self.gathered.fill(0.0);
        for ((group, weight), r) in self.onto.groups().zip(&self.weight).zip(self.residual.column(0)) {
            self.gathered[group] += weight * r;
        }
    }

    /// x ← x + P d of what the next level answered; with it ρ, if that is still needed.
    fn prolong(&mut self, constant: f64, is_needed: bool) {
        for (group, step) in self.onto.groups().zip(self.step.column_mut(0)) {
            *step = self.gathered[group];
        }
        self.x.add_scaled(1.0, &self.step);
        if is_needed {
            self.transport.apply(&self.step, &mut self.image);
            let changes = self.absorption.iter().zip(self.step.values()).zip(self.image.values());
            let rows = self.residual.column_mut(0).iter_mut().zip(changes);
            rows.for_each(|(r, ((a, step), image))| *r += image - step - constant * a);
        }
    }
}
