//! A low-rank stand-in for K, inverted by Woodbury's formula and refined.
//!
//! ```text
//! K ≈ Q B,  B = Qᵀ K,      (I − Q B)⁻¹ = I + Q (I − B Q)⁻¹ B
//! ```
//!
//! Light that has bounced is smooth, so that few directions Q hold what K makes of anything: they are found from random vectors until what
//! is missing of K is about the rank tolerance. The stand-in then preconditions GMRES from the right, so that the residual is that of the
//! equation itself and the tolerance is met however coarse the stand-in; one step is the plain low-rank answer. Needs I − K to have an
//! inverse. Writes K out, 8 n² bytes a band; cost 2 n² (2 rank + 16) a band to find the range, and n rank² to keep it orthogonal; then one
//! product and one pass over Q, B and (I − B Q)⁻¹ an iteration. Products and passes are counted. The report's `n_fill` is the entries of Q, B
//! and (I − B Q)⁻¹: where that is not far below n², K has no low rank, and there are cheaper methods. Source: Halko, Martinsson and Tropp
//! (2011); Woodbury (1950).

use crate::linalg::{Block, Dense, Equation, LinearOperator, LuFactor, Range};
use crate::solver::krylov::{Preconditioner, Prepared, minimise};
use crate::solver::monitor::Monitor;
use crate::solver::report::Work;
use crate::solver::{Attempt, Observer, SolveError, Solver};

/// Iterations of GMRES between restarts.
const RESTART: usize = 30;

/// Woodbury, refined until the residual is below the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LowRank {
    /// On ‖E + K L − L‖∞ / ‖E‖∞.
    pub tolerance: f64,
    /// On ‖K − Q B‖ in the Frobenius norm, about: the rank follows from it.
    pub rank_tolerance: f64,
    pub seed: u64,
}

impl Solver for LowRank {
    fn name(&self) -> &'static str {
        "low-rank"
    }

    fn tolerance(&self) -> Option<f64> {
        Some(self.tolerance)
    }

    fn writes_out(&self) -> bool {
        true
    }

    fn attempt<'a>(&self, equation: Equation<'a>, observer: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        let monitor = Monitor::new(self.name(), equation, self.tolerance, observer);
        minimise(self.name(), equation, self.tolerance, RESTART, Some(self), monitor)
    }
}

impl Preconditioner for LowRank {
    fn prepare<'a>(
        &self,
        method: &'static str,
        equation: Equation<'a>,
        work: &mut Work,
    ) -> Result<Box<dyn Prepared + 'a>, SolveError> {
        let (mut bands, mut pass_work) = (Vec::new(), 0.0);
        for band in 0..equation.n_bands() {
            let factored = |source| SolveError::Factor { method, band, source };
            let transport = Dense::from_operator(equation.transport, band);
            transport.check_finite().map_err(factored)?;
            let range = Range::find(&transport, self.rank_tolerance, self.seed);
            let rank = range.rank();

            // I − B Q.
            let mut image = Block::zeros(rank, rank);
            range.coefficients.apply(&range.basis, &mut image);
            let core = Dense::from_fn(rank, rank, |r, c| f64::from(u8::from(r == c)) - image.get(r, c));
            let mut inverse = Block::from_fn(rank, rank, |r, c| f64::from(u8::from(r == c)));
            LuFactor::new(&core).map_err(factored)?.solve(&mut inverse);
            let core = Dense::from_fn(rank, rank, |r, c| inverse.get(r, c));
            let size = (equation.n_unknowns() as f64).powi(2) * equation.n_bands() as f64;
            pass_work += (rank * (2 * equation.n_unknowns() + rank)) as f64 / size;
            work.products += range.n_products as f64 / equation.n_bands() as f64;
            work.n_fill = work.n_fill.max(Some(rank * (2 * equation.n_unknowns() + rank)));
            let (within, solved) = (Block::zeros(rank, 1), Block::zeros(rank, 1));
            let column = Block::zeros(equation.n_unknowns(), 1);
            bands.push(StandIn { range, core, within, solved, column });
        }
        Ok(Box::new(StandIns { bands, pass_work }))
    }
}

/// (I − Q B)⁻¹ of every band.
struct StandIns {
    bands: Vec<StandIn>,
    /// Entries that are read each time, in products.
    pass_work: f64,
}

struct StandIn {
    range: Range,
    /// (I − B Q)⁻¹.
    core: Dense,
    within: Block,
    solved: Block,
    column: Block,
}

impl Prepared for StandIns {
    fn apply(&mut self, x: &Block, out: &mut Block, work: &mut Work) {
        work.products += self.pass_work;
        for (band, StandIn { range, core, within, solved, column }) in self.bands.iter_mut().enumerate() {
            column.column_mut(0).copy_from_slice(x.column(band));
            range.coefficients.apply(column, within);
            core.apply(within, solved);
            let out = out.column_mut(band);
            out.copy_from_slice(x.column(band));
            for (q, share) in range.basis.columns().zip(solved.column(0)) {
                out.iter_mut().zip(q).for_each(|(y, q)| *y += share * q);
            }
        }
    }
}
