//! Iterative refinement: what every method's answer goes through before it is believed.
//!
//! ```text
//! rᵢ = Eᵢ − aᵢ Lᵢ − Σⱼ Kᵢⱼ (Lᵢ − Lⱼ),      (I − K) d = r  by the same method,      L ← L + d  in twice the digits
//! ```
//!
//! A method that sums E + K L − L, or that writes out I − K, loses 1/a of its digits where a is what is absorbed; the residual above, see
//! [`Residual`], loses none, so that every correction wins back as many digits as the method has left. An iteration is refined where
//! that residual is above the tolerance it was asked for, an elimination where the error that it allows, r over a, is above [`DIRECT`];
//! where neither is so, and where a is not known, nothing is done and nothing spent. Corrections that do not halve what they were made
//! for end in [`Stop::Stagnated`].
//!
//! Cost: for an elimination one product and its substitutions a time; for an iteration one product, and what the method takes to bring
//! the residual down to the tolerance again. Source: Wilkinson (1963); Higham (2002), chapter 12.

use super::attempt::Again;
use super::bracket::rounding;
use super::report::{Work, conclude};
use super::{Iteration, Observer, Solution, SolveError, Solver, Stop};
use crate::linalg::{Block, Doubled, Equation, Residual, max_abs};
use std::ops::ControlFlow;

/// How far a true residual may be above the tolerance where the one that was kept up to date is below it.
const DRIFT: f64 = 2.0;

/// The error, relative to the largest radiance, that an elimination's residual may allow.
const DIRECT: f64 = 1e-12;

/// A residual of so many parts of what it was summed from is rounding.
const NOISE: f64 = 8.0 * f64::EPSILON;

/// Corrections after which an answer is taken as it is.
const MOST: usize = 8;

/// True if an elimination may lose so many digits that its factors are worth keeping.
pub(super) fn may_be_needed(equation: Equation<'_>) -> bool {
    let absorption = equation.absorption.into_iter().flat_map(Block::columns);
    absorption.into_iter().any(|a| NOISE > DIRECT * smallest(a))
}

/// Answers the equation by a method, refines the answer and verifies it.
pub(super) fn solve<S: Solver + ?Sized>(
    solver: &S,
    equation: Equation<'_>,
    observer: &mut dyn Observer,
) -> Result<Solution, SolveError> {
    let attempt = solver.attempt(equation, observer)?;
    let (mut work, mut history, mut stop) = (attempt.work, attempt.history, attempt.stop);
    let (mut radiance, mut again) = (attempt.radiance, attempt.again);
    let zeros = || Block::zeros(equation.n_unknowns(), equation.n_bands());
    let mut residual = Residual::new(equation);
    let mut r = zeros();
    residual.evaluate(&radiance.high, Some(&radiance.low), &mut r);

    let tolerance = solver.tolerance();
    let mut excess = Excess::of(equation, tolerance, NOISE, &residual, &radiance, &r);
    let mut n_refinements = 0;
    while matches!(stop, Stop::Converged | Stop::Direct) && excess.worst() > 1.0 && n_refinements < MOST {
        n_refinements += 1;
        // Leave alone what is good enough.
        for (band, excess) in excess.bands.iter().enumerate().filter(|(_, excess)| **excess <= 1.0) {
            debug_assert!(*excess <= 1.0);
            r.column_mut(band).fill(0.0);
        }
        let correction = match &mut again {
            Some(again) => Some(by_factors(again, &r, &mut work)),
            None => {
                let mut watch = Watch::new(equation, &radiance.high, &r, tolerance, &work, &mut history, observer);
                let found = solver.attempt(Equation { emission: &r, ..equation }, &mut watch);
                let is_met = watch.is_met;
                found.ok().map(|found| {
                    work.add(&found.work);
                    work.n_iterations = history.len() - 1;
                    stop = if is_met { stop } else { found.stop };
                    found.radiance.high
                })
            }
        };

        // Take what is better, and see that it is.
        let mut corrected = radiance.clone();
        correction.iter().for_each(|correction| corrected.add(correction));
        residual.evaluate(&corrected.high, Some(&corrected.low), &mut r);
        work.count_applies(1);
        let left = Excess::of(equation, tolerance, NOISE, &residual, &corrected, &r);
        let is_halved = left.worst() <= 0.5 * excess.worst();
        if left.worst() < excess.worst() {
            (radiance, excess) = (corrected, left);
        } else {
            residual.evaluate(&radiance.high, Some(&radiance.low), &mut r);
        }
        if !is_halved {
            break;
        }
    }

    // What is left is rounding, or more than the method can mend.
    if matches!(stop, Stop::Converged | Stop::Direct) && excess.worst() > 1.0 {
        let bound = 2.0 * rounding(equation);
        if Excess::of(equation, tolerance, bound, &residual, &radiance, &r).worst() > 1.0 {
            stop = Stop::Stagnated;
        }
    }
    conclude(solver.name(), equation, radiance, (&residual, &r), stop, work, history, n_refinements)
}

fn by_factors(again: &mut Again<'_>, r: &Block, work: &mut Work) -> Block {
    let mut correction = Block::zeros(r.n_rows(), r.n_columns());
    again(r, &mut correction, work);
    correction
}

/// How many times too large a residual is, in every band where it is worst; 0 where nothing is known of the absorption.
struct Excess {
    bands: Vec<f64>,
}

impl Excess {
    /// Without a tolerance by the error it allows; what is below `noise` times what it was summed from is never too large.
    fn of(
        equation: Equation<'_>,
        tolerance: Option<f64>,
        noise: f64,
        residual: &Residual<'_>,
        radiance: &Doubled,
        r: &Block,
    ) -> Self {
        let Some(absorption) = equation.absorption else { return Self { bands: vec![0.0; equation.n_bands()] } };
        let mut magnitudes = vec![0.0; equation.n_unknowns()];
        let band_excess = |band: usize| {
            residual.magnitudes(band, &radiance.high, r, &mut magnitudes);
            let (brightest, a) = (max_abs(radiance.high.column(band)), absorption.column(band));
            let (least, emitted) = (smallest(a), max_abs(equation.emission.column(band)));
            let rows = r.column(band).iter().zip(a).zip(&magnitudes);
            let ratios = rows.map(|((r, a), magnitude)| {
                let allowed = match tolerance {
                    Some(tolerance) => DRIFT * tolerance * emitted,
                    None => DIRECT * brightest * a.max(least),
                };
                if *r == 0.0 { 0.0 } else { r.abs() / allowed.max(noise * magnitude) }
            });
            ratios.fold(0.0, f64::max)
        };
        Self { bands: (0..equation.n_bands()).map(band_excess).collect() }
    }

    fn worst(&self) -> f64 {
        self.bands.iter().copied().fold(0.0, f64::max)
    }
}

/// The smallest of these that is above zero.
fn smallest(absorption: &[f64]) -> f64 {
    absorption.iter().copied().filter(|a| *a > 0.0).fold(f64::INFINITY, f64::min)
}

/// Shows an observer a correction as iterates of the whole, and ends it when it is good enough.
struct Watch<'a> {
    observer: &'a mut dyn Observer,
    history: &'a mut Vec<f64>,
    base: &'a Block,
    shown: Block,
    /// Products before this correction.
    spent: f64,
    /// ‖r‖∞ / ‖E‖∞ that the correction begins with, worst band: its own residuals are relative to that.
    scale: f64,
    tolerance: f64,
    is_met: bool,
}

impl<'a> Watch<'a> {
    fn new(
        equation: Equation<'_>,
        base: &'a Block,
        r: &Block,
        tolerance: Option<f64>,
        work: &Work,
        history: &'a mut Vec<f64>,
        observer: &'a mut dyn Observer,
    ) -> Self {
        let scale = super::report::relative_residual(equation.emission, r);
        let (spent, tolerance) = (work.products, tolerance.unwrap_or(0.0));
        Self { observer, history, base, shown: base.clone(), spent, scale, tolerance, is_met: false }
    }
}

impl Observer for Watch<'_> {
    fn observe(&mut self, iteration: Iteration<'_>) -> ControlFlow<()> {
        self.shown.copy_from(self.base);
        self.shown.add_scaled(1.0, iteration.iterate);
        let residual = self.scale * iteration.residual;
        let (index, products) = (self.history.len(), self.spent + iteration.products);
        self.history.push(residual);
        let told = self.observer.observe(Iteration { index, products, residual, iterate: &self.shown });
        self.is_met = told == ControlFlow::Continue(()) && residual <= self.tolerance;
        if self.is_met { ControlFlow::Break(()) } else { told }
    }

    fn budget(&self) -> f64 {
        self.observer.budget() - self.spent
    }
}
