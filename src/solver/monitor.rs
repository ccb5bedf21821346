//! What every iteration is asked: converged, diverged, out of budget, told to stop?

use super::report::Work;
use super::{Iteration, Observer, RowGain, SolveError, Stop};
use crate::linalg::{Block, Equation};
use std::ops::ControlFlow;

/// A residual this much above the best so far is divergence, not a hump.
const DIVERGENCE: f64 = 1e8;

/// This many iterations in which the residual did not fall by even [`PROGRESS`] in all end with [`Stop::Stagnated`]: rounding, or a scene
/// that loses nothing.
const PATIENCE: usize = 1000;

/// Least relative fall of the residual that counts.
const PROGRESS: f64 = 1e-7;

/// Iterations that a history has room for from the start.
const HISTORY: usize = 1024;

/// Keeps the history of one solve and decides when it ends.
pub(super) struct Monitor<'a> {
    method: &'static str,
    equation: Equation<'a>,
    tolerance: f64,
    budget: f64,
    observer: &'a mut dyn Observer,
    best: f64,
    /// Residual and iteration that last made progress.
    progress: (f64, usize),
    pub work: Work,
    pub history: Vec<f64>,
}

impl<'a> Monitor<'a> {
    pub fn new(method: &'static str, equation: Equation<'a>, tolerance: f64, observer: &'a mut dyn Observer) -> Self {
        Self {
            method,
            equation,
            tolerance,
            budget: observer.budget(),
            observer,
            best: f64::INFINITY,
            progress: (f64::INFINITY, 0),
            work: Work::default(),
            history: Vec::with_capacity(HISTORY),
        }
    }

    /// Records an iterate and its residual; `Some` ends the solve.
    pub fn check(&mut self, residual: f64, iterate: &Block) -> Result<Option<Stop>, SolveError> {
        let index = self.history.len();
        self.work.n_iterations = index;
        self.history.push(residual);
        if residual.is_nan() {
            return Err(SolveError::NotFinite { method: self.method, iteration: index });
        }
        if residual < self.progress.0 * (1.0 - PROGRESS) {
            self.progress = (residual, index);
        }
        self.best = self.best.min(residual);
        if residual > DIVERGENCE * self.best.max(f64::MIN_POSITIVE) && residual > 1.0 {
            let gain = RowGain::of(self.equation);
            return Err(SolveError::Diverged {
                method: self.method,
                iteration: index,
                residual,
                best: self.best,
                gain,
            });
        }
        let iteration = Iteration { index, products: self.work.products, residual, iterate };
        let told = self.observer.observe(iteration);
        Ok(if residual <= self.tolerance {
            Some(Stop::Converged)
        } else if told == ControlFlow::Break(()) {
            Some(Stop::Observer)
        } else if self.work.products >= self.budget {
            Some(Stop::Budget)
        } else if index - self.progress.1 >= PATIENCE {
            Some(Stop::Stagnated)
        } else {
            None
        })
    }

    /// Counts whole products with K.
    pub fn count_applies(&mut self, n: usize) {
        self.work.count_applies(n);
    }

    /// Counts whole products with K*.
    pub fn count_adjoint_applies(&mut self, n: usize) {
        self.work.count_adjoint_applies(n);
    }
}
