//! The two-grid method: a bounce on the fine grid, and what it leaves of the coarse space removed.
//!
//! ```text
//! z = r + N r + N² r + N³ r,      L ← L + z + P C⁻¹ Pᵀ W (r − (I − K) z),      r ← Π (r − (I − K) z)
//! ```
//!
//! which is Atkinson's and Brakhage's iteration with a Galerkin coarse equation C = Pᵀ W (I − K) P, solved directly, and with
//! N, the strong entries of K, smoothed first. With z = r what converges is the Neumann series of K with the coarse space projected
//! out: its factor is the spectral radius of Π K, which for smooth kernels falls
//! with the size of the groups and knows nothing of the albedo. With one group only the leading mode is taken out: Perron deflation.
//!
//! Needs a coarse equation that is not singular, as that of K ≥ 0 with some absorption; takes any K. Every entry of K is read once to set
//! up, which also gives the first bounce; then one product an iteration, and a pass over the n × m matrix K P. Source: Brakhage
//! (1960); Atkinson (1976), §5.3; as an iterated Galerkin correction, Hackbusch (1985), §16.

use super::super::monitor::Monitor;
use super::super::report::relative_residual;
use super::super::{Attempt, Observer, SolveError, Solver};
use super::coarse::{self, Coarse, Wanted};
use super::shifted::Shifted;
use crate::linalg::{Aggregation, Block, Equation, max_abs};

/// Bounces and coarse corrections until the residual is below the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoGrid {
    /// On ‖E + K L − L‖∞ / ‖E‖∞.
    pub tolerance: f64,
    /// Most groups that the coarse equation may have; by default n^⅔, whose elimination costs a third of a product.
    pub n_groups: Option<usize>,
}

/// [`TwoGrid`] with a single group: the Neumann series without its slowest mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Perron {
    /// On ‖E + K L − L‖∞ / ‖E‖∞.
    pub tolerance: f64,
}

impl TwoGrid {
    /// What an iteration takes off the residual in the long run, of every band: the spectral radius of Π K by that many products, as the
    /// mean over their second half.
    ///
    /// # Errors
    /// As of solving.
    pub fn factor(&self, equation: Equation<'_>, n_products: usize) -> Result<Vec<f64>, SolveError> {
        let (n, n_bands) = (equation.n_unknowns(), equation.n_bands());
        let (aggregation, weights) = (level(equation, self.n_groups), weights_or_ones(equation));
        let mut coarse = Coarse::new(self.name(), equation, aggregation, Wanted::Factor, weights, &[], &mut [])?;
        let mut residual = Block::from_fn(n, n_bands, |i, _| (1.618_033_988_749_895 * (i as f64 + 1.0)).sin());
        let (mut step, mut next) = (Block::zeros(n, n_bands), Block::zeros(n, n_bands));
        let mut gathered = vec![0.0; coarse.n_groups()];
        let mut logarithms = vec![0.0; n_bands];
        for k in 0..n_products {
            smooth(equation, &coarse, Smoother::Near, &mut residual, &mut step, &mut next);
            for (band, logarithm) in logarithms.iter_mut().enumerate() {
                coarse.gather(band, residual.column(band), &mut gathered);
                let constant = coarse.solve(band, &mut gathered);
                coarse.correct(band, constant, &gathered, residual.column_mut(band));
                // What is left becomes 1 again.
                let left = max_abs(residual.column(band));
                if left > 0.0 {
                    residual.column_mut(band).iter_mut().for_each(|r| *r /= left);
                }
                if k >= n_products / 2 {
                    *logarithm += left.ln();
                }
            }
        }
        let n_counted = (n_products - n_products / 2) as f64;
        Ok(logarithms.into_iter().map(|sum| (sum / n_counted).exp()).collect())
    }
}

impl Solver for TwoGrid {
    fn name(&self) -> &'static str {
        "two-grid"
    }

    fn tolerance(&self) -> Option<f64> {
        Some(self.tolerance)
    }

    fn attempt<'a>(&self, equation: Equation<'a>, observer: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        iterate(
            Monitor::new(self.name(), equation, self.tolerance, observer),
            self.name(),
            equation,
            level(equation, self.n_groups),
            Wanted::Factor,
            Smoother::Near,
        )
    }
}

impl Solver for Perron {
    fn name(&self) -> &'static str {
        "perron"
    }

    fn tolerance(&self) -> Option<f64> {
        Some(self.tolerance)
    }

    fn attempt<'a>(&self, equation: Equation<'a>, observer: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        iterate(
            Monitor::new(self.name(), equation, self.tolerance, observer),
            self.name(),
            equation,
            level(equation, Some(1)),
            Wanted::Factor,
            Smoother::Bounce,
        )
    }
}

/// n^⅔ groups, whose elimination costs a third of a product.
pub(super) fn cheap_to_eliminate(n: usize) -> usize {
    (n as f64).powf(2.0 / 3.0) as usize
}

/// The finest level of the hierarchy with no more groups than wanted; everything in one group where there is none.
pub(super) fn level(equation: Equation<'_>, n_groups: Option<usize>) -> Aggregation {
    let n = equation.n_unknowns();
    let most = n_groups.unwrap_or(cheap_to_eliminate(n)).max(1);
    let found = equation.hierarchy.and_then(|hierarchy| hierarchy.finest_within(most));
    found.cloned().unwrap_or_else(|| Aggregation::whole(n))
}

/// Weights that make K self-adjoint, or ones.
pub(super) fn weights_or_ones(equation: Equation<'_>) -> Block {
    let n_bands = equation.n_bands();
    let weights = equation.self_adjoint.and_then(|form| coarse::weights(form, n_bands));
    weights.unwrap_or_else(|| Block::from_fn(equation.n_unknowns(), n_bands, |_, _| 1.0))
}

/// What a residual is turned into before it bounces.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Smoother {
    /// Itself.
    Bounce,
    /// r + N r + N² r + N³ r.
    Near,
}

/// step ← the smoothed residual r, r ← r − (I − K) step, and the work beside that one product.
fn smooth(
    equation: Equation<'_>,
    coarse: &Coarse,
    smoother: Smoother,
    residual: &mut Block,
    step: &mut Block,
    next: &mut Block,
) -> f64 {
    step.copy_from(residual);
    if smoother == Smoother::Near {
        for band in 0..residual.n_columns() {
            coarse.near(band).apply(residual.column(band), next.column_mut(band), step.column_mut(band));
        }
    }
    equation.transport.apply(step, next);
    residual.add_scaled(-1.0, step);
    residual.add_scaled(1.0, next);
    if smoother == Smoother::Near { coarse.near_work() } else { 0.0 }
}

/// The iteration of this family, whatever answers its coarse equation.
pub(super) fn iterate<'a>(
    mut monitor: Monitor<'_>,
    method: &'static str,
    equation: Equation<'a>,
    aggregation: Aggregation,
    wanted: Wanted<'_>,
    smoother: Smoother,
) -> Result<Attempt<'a>, SolveError> {
    // Read K once: the coarse equation, and the first bounce.
    let (n, n_bands) = (equation.n_unknowns(), equation.n_bands());
    let mut first = [Block::zeros(n, n_bands)];
    let weights = weights_or_ones(equation);
    let mut coarse = Coarse::new(method, equation, aggregation, wanted, weights, &[equation.emission], &mut first)?;
    monitor.work.products += coarse.setup_work();
    let [mut residual] = first;

    let mut field = Shifted::at(equation.emission);
    let (mut radiance, mut next) = (equation.emission.clone(), Block::zeros(n, n_bands));
    let mut step = Block::zeros(n, n_bands);
    let mut gathered = vec![0.0; coarse.n_groups()];
    let mut is_first = true;
    let stop = loop {
        // Take what is left of the coarse space out of the residual.
        for band in 0..n_bands {
            coarse.gather(band, residual.column(band), &mut gathered);
            let constant =
                if is_first { coarse.solve_first(band, &mut gathered) } else { coarse.solve(band, &mut gathered) };
            field.constants[band] += constant;
            coarse.prolong(band, &gathered, field.rest.column_mut(band));
            coarse.correct(band, constant, &gathered, residual.column_mut(band));
        }
        monitor.work.products += if is_first { coarse.first_pass_work() } else { coarse.pass_work() };
        is_first = false;

        // Show one bounce more, which the residual is: what that leaves is no larger where no row gains.
        field.write(&coarse, Some(&residual), &mut radiance);
        if let Some(stop) = monitor.check(relative_residual(equation.emission, &residual), &radiance)? {
            break stop;
        }

        // Step along what the strong entries make of the residual, and see what is left after its bounce.
        monitor.work.products += smooth(equation, &coarse, smoother, &mut residual, &mut step, &mut next);
        monitor.count_applies(1);
        field.rest.add_scaled(1.0, &step);
    };
    Ok(Attempt::ended(field.doubled(&coarse, Some(&residual)), stop, monitor))
}
