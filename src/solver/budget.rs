//! How many products a solve may take.

use super::{Iteration, Observer};
use std::ops::ControlFlow;

/// Products after which a solve ends with [`super::Stop::Budget`] unless its observer says otherwise.
pub const BUDGET: f64 = 1e6;

/// Ends a solve when so many products are spent, at the end of that iteration; the observer inside it sees every iterate.
pub struct Budget<'a> {
    /// Products with K and K*.
    pub products: f64,
    pub observer: &'a mut dyn Observer,
}

impl Observer for Budget<'_> {
    fn observe(&mut self, iteration: Iteration<'_>) -> ControlFlow<()> {
        self.observer.observe(iteration)
    }

    fn budget(&self) -> f64 {
        self.products.min(self.observer.budget())
    }
}
