//! Discrete sampling in constant time by Walker's alias method, tables built as Vose (1991) does.
//!
//! Building subtracts from large weights again and again; the remainders are carried in twice the precision, so that the
//! probabilities a table implies equal the weights to rounding, however many there are.

use rayon::prelude::*;
use thiserror::Error;

/// A row may exceed 1 by this much and is then taken as summing to 1: ten times what the assembly's laws leave (1e-12 relative).
pub const ROW_SUM_TOLERANCE: f64 = 1e-11;

/// Rows built together between two appends.
const ROWS_PER_BATCH: usize = 256;

/// The outcome "no column": what is missing from a row to 1.
const ABSORBED: u32 = u32::MAX;

/// Why weights are not a distribution.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum AliasError {
    #[error("row {row}, column {column}: the weight is {weight:e}, must be finite and not negative")]
    BadWeight { row: usize, column: usize, weight: f64 },
    #[error("row {row}: there is no weight above zero")]
    NoWeight { row: usize },
    #[error("row {row} sums to {sum:e}, which exceeds 1 by more than {ROW_SUM_TOLERANCE:e}")]
    SumAboveOne { row: usize, sum: f64 },
    #[error("a row of {found} columns is longer than the {} a table can number", u32::MAX - 1)]
    TooManyColumns { found: usize },
}

/// One slot: `here` below the threshold, `alias` above it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Slot {
    threshold: f64,
    here: u32,
    alias: u32,
}

/// A slot that was drawn, and where in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draw {
    slot: Slot,
    part: f64,
}

impl Draw {
    /// The column; `None` where the row absorbs.
    #[inline]
    pub fn column(self) -> Option<usize> {
        let outcome = self.outcome();
        (outcome != ABSORBED).then_some(outcome as usize)
    }

    #[inline]
    fn outcome(self) -> u32 {
        if self.part < self.slot.threshold { self.slot.here } else { self.slot.alias }
    }
}

/// One distribution over 0 … n − 1, proportional to its weights.
#[derive(Clone, Debug, PartialEq)]
pub struct AliasTable {
    n_outcomes: usize,
    slots: Vec<Slot>,
}

impl AliasTable {
    /// Cost O(n), 16 bytes a weight above zero.
    ///
    /// # Errors
    /// A weight that is negative or not finite, or none above zero.
    pub fn new(weights: &[f64]) -> Result<Self, AliasError> {
        check_length(weights.len())?;
        let outcomes = positive_outcomes(0, weights)?;
        let (sum, _) = exact_sum(&outcomes);
        if outcomes.is_empty() {
            return Err(AliasError::NoWeight { row: 0 });
        }
        Ok(Self { n_outcomes: weights.len(), slots: slots(&outcomes, sum) })
    }

    /// An outcome from one number uniform in [0, 1). Cost O(1).
    #[inline]
    pub fn sample(&self, uniform: f64) -> usize {
        draw(&self.slots, uniform) as usize
    }

    /// The probability of each outcome as the table has it, not as the weights had it.
    pub fn probabilities(&self) -> Vec<f64> {
        implied_probabilities(&self.slots, self.n_outcomes)
    }
}

/// A distribution for each row of a substochastic matrix: column j with probability p_ij, and none with 1 − Σⱼ p_ij.
///
/// Zeros take no memory, all rows lie in one allocation, and the bits do not depend on the number of threads.
#[derive(Clone, Debug, PartialEq)]
pub struct AliasRows {
    n_columns: usize,
    /// Row i owns slots `starts[i]..starts[i + 1]`.
    starts: Vec<usize>,
    slots: Vec<Slot>,
}

impl AliasRows {
    /// Builds all rows in parallel; `row(i, out)` writes row i into `out`, which comes filled with zeros.
    ///
    /// Cost O(n_rows · n_columns), 16 bytes an entry above zero.
    ///
    /// # Errors
    /// The first row (by number) with a weight that is negative or not finite, or with a sum above 1 by more than
    /// [`ROW_SUM_TOLERANCE`]; a sum above 1 by less is scaled to 1.
    pub fn new(n_rows: usize, n_columns: usize, row: impl Fn(usize, &mut [f64]) + Sync) -> Result<Self, AliasError> {
        check_length(n_columns)?;
        let mut starts = vec![0];
        let mut all = Vec::new();
        for first in (0..n_rows).step_by(ROWS_PER_BATCH) {
            let batch: Vec<Result<Vec<Slot>, AliasError>> = (first..n_rows.min(first + ROWS_PER_BATCH))
                .into_par_iter()
                .map_init(
                    || vec![0.0; n_columns],
                    |weights, i| {
                        weights.fill(0.0);
                        row(i, weights);
                        substochastic_slots(i, weights)
                    },
                )
                .collect();
            for slots in batch {
                all.extend_from_slice(&slots?);
                starts.push(all.len());
            }
        }
        Ok(Self { n_columns, starts, slots: all })
    }

    pub fn n_rows(&self) -> usize {
        self.starts.len() - 1
    }

    pub fn n_columns(&self) -> usize {
        self.n_columns
    }

    /// A column from one number uniform in [0, 1); `None` where the row absorbs. Cost O(1), one cache line.
    #[inline]
    pub fn sample(&self, row: usize, uniform: f64) -> Option<usize> {
        self.fetch(row, uniform).column()
    }

    /// The first half of [`AliasRows::sample`]: reads memory and decides nothing. A thread that fetches many draws before it looks at the first
    /// waits for memory once, not once for each.
    #[inline]
    pub fn fetch(&self, row: usize, uniform: f64) -> Draw {
        fetch(&self.slots[self.starts[row]..self.starts[row + 1]], uniform)
    }

    /// The probability of each column of a row as the table has it; the rest is absorbed.
    pub fn probabilities(&self, row: usize) -> Vec<f64> {
        implied_probabilities(&self.slots[self.starts[row]..self.starts[row + 1]], self.n_columns)
    }
}

#[inline]
fn fetch(slots: &[Slot], uniform: f64) -> Draw {
    let scaled = uniform * slots.len() as f64;
    let k = (scaled as usize).min(slots.len() - 1);
    Draw { slot: slots[k], part: scaled - k as f64 }
}

#[inline]
fn draw(slots: &[Slot], uniform: f64) -> u32 {
    fetch(slots, uniform).outcome()
}

/// Sums each outcome's shares of its slots, absorption left out.
fn implied_probabilities(slots: &[Slot], n_outcomes: usize) -> Vec<f64> {
    let mut sums = vec![Remainder { high: 0.0, low: 0.0 }; n_outcomes];
    let mut add = |outcome: u32, share: f64| {
        if let Some(sum) = sums.get_mut(outcome as usize) {
            sum.add(share);
        }
    };
    for slot in slots {
        add(slot.here, slot.threshold);
        add(slot.alias, 1.0 - slot.threshold);
    }
    sums.into_iter().map(|sum| sum.value() / slots.len() as f64).collect()
}

fn check_length(n_columns: usize) -> Result<(), AliasError> {
    if n_columns >= ABSORBED as usize { Err(AliasError::TooManyColumns { found: n_columns }) } else { Ok(()) }
}

/// The outcomes with a weight above zero.
fn positive_outcomes(row: usize, weights: &[f64]) -> Result<Vec<(u32, f64)>, AliasError> {
    if let Some((column, &weight)) = weights.iter().enumerate().find(|(_, w)| !(w.is_finite() && **w >= 0.0)) {
        return Err(AliasError::BadWeight { row, column, weight });
    }
    Ok(weights.iter().enumerate().filter(|(_, w)| **w > 0.0).map(|(k, w)| (k as u32, *w)).collect())
}

/// The slots of a row whose missing weight is absorption.
fn substochastic_slots(row: usize, weights: &[f64]) -> Result<Vec<Slot>, AliasError> {
    let mut outcomes = positive_outcomes(row, weights)?;
    let (sum, low) = exact_sum(&outcomes);
    if sum > 1.0 + ROW_SUM_TOLERANCE {
        return Err(AliasError::SumAboveOne { row, sum });
    }
    let absorbed = (1.0 - sum) - low;
    if absorbed > 0.0 {
        outcomes.push((ABSORBED, absorbed));
    }
    Ok(slots(&outcomes, sum.max(1.0)))
}

/// Σ of the weights as high part and correction.
fn exact_sum(outcomes: &[(u32, f64)]) -> (f64, f64) {
    let mut sum = Remainder { high: 0.0, low: 0.0 };
    for (_, weight) in outcomes {
        sum.add(*weight);
    }
    (sum.high, sum.low)
}

/// Vose's construction: fill each light slot up from a heavy one.
fn slots(outcomes: &[(u32, f64)], sum: f64) -> Vec<Slot> {
    let n = outcomes.len() as f64;
    let mut slots: Vec<Slot> =
        outcomes.iter().map(|(here, _)| Slot { threshold: 1.0, here: *here, alias: *here }).collect();
    let mut remainders: Vec<Remainder> =
        outcomes.iter().map(|(_, weight)| Remainder { high: weight / sum * n, low: 0.0 }).collect();
    let (mut light, mut heavy): (Vec<usize>, Vec<usize>) = (0..slots.len()).partition(|k| remainders[*k].high < 1.0);

    // Close a light slot with a heavy outcome, and move that one over once it has become light itself.
    while let (Some(&small), Some(&large)) = (light.last(), heavy.last()) {
        light.pop();
        let threshold = remainders[small].value();
        slots[small].threshold = threshold;
        slots[small].alias = outcomes[large].0;
        remainders[large].add(threshold);
        remainders[large].add(-1.0);
        if remainders[large].value() < 1.0 {
            heavy.pop();
            light.push(large);
        }
    }

    // What is left over differs from 1 by rounding only and keeps its whole slot.
    slots
}

/// An unevaluated sum of two numbers, twice the precision of one.
#[derive(Clone, Copy)]
struct Remainder {
    high: f64,
    low: f64,
}

impl Remainder {
    fn value(self) -> f64 {
        self.high + self.low
    }

    /// Adds without losing what does not fit into the high part (Knuth's two-sum).
    fn add(&mut self, term: f64) {
        let sum = self.high + term;
        let part = sum - self.high;
        self.low += (self.high - (sum - part)) + (term - part);
        self.high = sum;
    }
}
