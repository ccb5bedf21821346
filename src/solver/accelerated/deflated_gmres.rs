//! Generalised minimal residuals on a coarse space, for equations without symmetry.
//!
//! ```text
//! M⁻¹ x = x + K P C⁻¹ Pᵀ W x,      I − (I − K) M⁻¹ = K Π
//! ```
//!
//! the two-grid method as a preconditioner from the right: what is left of K is K Π, the coarse space projected out. Needs a coarse
//! equation that is not singular. Every entry of K is read once to set up, then an application is one pass over the n × m matrix K P and
//! costs no product. Where nearly nothing is absorbed the constant in M⁻¹ x is large and takes digits with it: 1e-16 over the absorption
//! of the residual's own scale. Source: Atkinson (1976), §5.3; as a preconditioner, Saad (2003), §9.3.

use super::super::krylov::minimise;
use super::super::monitor::Monitor;
use super::super::report::Work;
use super::super::{Attempt, Observer, Preconditioner, Prepared, SolveError, Solver};
use super::coarse::{Coarse, Wanted};
use super::two_grid::{level, weights_or_ones};
use crate::linalg::{Block, Equation};

/// Iterations between restarts.
const RESTART: usize = 30;

/// I + K P C⁻¹ Pᵀ W, on the finest level of the hierarchy that has no more groups than wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoarseSpace {
    /// Most groups that the coarse equation may have; by default n^⅔, whose elimination costs a third of a product.
    pub n_groups: Option<usize>,
}

/// GMRES preconditioned by a [`CoarseSpace`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeflatedGmres {
    /// On ‖E + K L − L‖∞ / ‖E‖∞.
    pub tolerance: f64,
    /// As of [`CoarseSpace`].
    pub n_groups: Option<usize>,
}

impl Solver for DeflatedGmres {
    fn name(&self) -> &'static str {
        "deflated-gmres"
    }

    fn tolerance(&self) -> Option<f64> {
        Some(self.tolerance)
    }

    fn attempt<'a>(&self, equation: Equation<'a>, observer: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        let space = CoarseSpace { n_groups: self.n_groups };
        let monitor = Monitor::new(self.name(), equation, self.tolerance, observer);
        minimise(self.name(), equation, self.tolerance, RESTART, Some(&space), monitor)
    }
}

impl Preconditioner for CoarseSpace {
    fn prepare<'a>(
        &self,
        method: &'static str,
        equation: Equation<'a>,
        work: &mut Work,
    ) -> Result<Box<dyn Prepared + 'a>, SolveError> {
        let aggregation = level(equation, self.n_groups);
        let weights = weights_or_ones(equation);
        let coarse = Coarse::new(method, equation, aggregation, Wanted::Factor, weights, &[], &mut [])?;
        work.products += coarse.setup_work();
        let gathered = vec![0.0; coarse.n_groups()];
        Ok(Box::new(Ready { coarse, gathered }))
    }
}

/// A coarse space of one equation, and room for a coarse vector.
struct Ready {
    coarse: Coarse,
    gathered: Vec<f64>,
}

impl Prepared for Ready {
    fn apply(&mut self, x: &Block, out: &mut Block, work: &mut Work) {
        for band in 0..x.n_columns() {
            self.coarse.gather(band, x.column(band), &mut self.gathered);
            let constant = self.coarse.solve(band, &mut self.gathered);
            self.coarse.bounce(band, constant, &self.gathered, out.column_mut(band));
        }
        out.add_scaled(1.0, x);
        work.products += self.coarse.pass_work();
    }
}
