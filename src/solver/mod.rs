//! Deterministic answers to L = E + K L, one file a method: direct, stationary and Krylov. Knows operators and vectors, never a scene.
//!
//! Every method is a struct of its parameters and a [`Solver`]. Iterative ones stop when ‖E + K L − L‖∞ ≤ tolerance · ‖E‖∞ in every
//! band; running out of budget is a status, divergence and singularity are errors. What a method answers is looked at by a residual that
//! keeps its digits however little is absorbed, and corrected until it stands that: see [`SolveReport::n_refinements`].

mod accelerated;
mod attempt;
mod bracket;
mod budget;
mod direct;
mod error;
mod krylov;
mod monitor;
mod refine;
mod report;
mod self_adjoint;
pub mod spectrum;
mod stationary;

pub use accelerated::{CoarseSpace, DeflatedCg, DeflatedGmres, Multigrid, Perron, TwoGrid};
pub use attempt::Attempt;
pub use bracket::Bracket;
pub use budget::{BUDGET, Budget};
pub use direct::{Cholesky, Factored, Gth, LowRank, Lu, LuNalgebra, RowChange, SingleLu, SparseCholesky, SparseLu};
pub use error::{RowGain, SolveError};
pub use krylov::{
    Anderson, BiCg, BiCgStab, Cg, FlexibleGmres, Gmres, MinimalResidual, Minres, OwnGain, Preconditioner, Prepared,
};
pub use report::{Solution, SolveReport, Stop, Work};
pub use stationary::{
    Chebyshev, GaussSeidel, Jacobi, Neumann, Overshooting, Progressive, Richardson, Sor, Southwell,
    SymmetricGaussSeidel,
};

use crate::linalg::{Block, Equation};
use std::ops::ControlFlow;

/// A method that answers L = E + K L.
pub trait Solver {
    /// Name on the command line and in reports.
    fn name(&self) -> &'static str;

    /// True if the answer comes without iterating.
    fn is_direct(&self) -> bool {
        false
    }

    /// True if it writes K out in full, and something of its size beside it.
    fn writes_out(&self) -> bool {
        self.is_direct()
    }

    /// On ‖E + K L − L‖∞ / ‖E‖∞; `None` for a method that does not iterate.
    fn tolerance(&self) -> Option<f64> {
        None
    }

    /// What the method alone makes of the equation, every band: an answer that nobody has verified. [`Solver::solve`] is what is called.
    ///
    /// # Errors
    /// As of [`Solver::solve`].
    fn attempt<'a>(&self, equation: Equation<'a>, observer: &mut dyn Observer) -> Result<Attempt<'a>, SolveError>;

    /// Answers the equation, every band; `observer` sees every iterate and may stop it. What the method's own arithmetic loses where little
    /// is absorbed is won back by correcting its answer, if that is needed.
    ///
    /// # Errors
    /// A singular or diverging equation, numbers that are not finite, or a property the method needs and the equation lacks.
    fn solve(&self, equation: Equation<'_>, observer: &mut dyn Observer) -> Result<Solution, SolveError> {
        refine::solve(self, equation, observer)
    }
}

/// One iterate on its way to an observer.
#[derive(Clone, Copy)]
pub struct Iteration<'a> {
    /// 0 is the first iterate that the method has a residual for: its starting guess, or for methods that sweep the first sweep.
    pub index: usize,
    /// Work so far in products with K: entries touched / entries of K.
    pub products: f64,
    /// ‖E + K L − L‖∞ / ‖E‖∞, the worst band, as the method knows it without further work.
    pub residual: f64,
    /// L as it stands, n × bands.
    pub iterate: &'a Block,
}

/// Watches a solver. `()` watches nothing.
pub trait Observer {
    /// Called after every iteration; `Break` ends the solve with [`Stop::Observer`].
    fn observe(&mut self, iteration: Iteration<'_>) -> ControlFlow<()>;

    /// Products after which the solve ends with [`Stop::Budget`]. See [`Budget`].
    fn budget(&self) -> f64 {
        BUDGET
    }
}

impl Observer for () {
    fn observe(&mut self, _: Iteration<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

impl<F: FnMut(Iteration<'_>) -> ControlFlow<()>> Observer for F {
    fn observe(&mut self, iteration: Iteration<'_>) -> ControlFlow<()> {
        self(iteration)
    }
}

/// Every method there is at one tolerance, in the order of reports; those on coarse spaces take the equation's hierarchy, or the constants
/// alone where it has none. One more method is one more line.
pub fn all(tolerance: f64) -> Vec<Box<dyn Solver>> {
    vec![
        Box::new(Lu),
        Box::new(Gth),
        Box::new(Cholesky),
        Box::new(SparseLu),
        Box::new(SparseCholesky),
        Box::new(SingleLu { tolerance }),
        Box::new(LowRank { tolerance, rank_tolerance: 0.5, seed: 0 }),
        Box::new(LuNalgebra),
        Box::new(Neumann { tolerance }),
        Box::new(Jacobi { tolerance }),
        Box::new(Richardson { tolerance, damping: None }),
        Box::new(GaussSeidel { tolerance }),
        Box::new(SymmetricGaussSeidel { tolerance }),
        Box::new(Sor { tolerance, relaxation: None }),
        Box::new(Southwell { tolerance }),
        Box::new(Progressive { tolerance }),
        Box::new(Overshooting { tolerance }),
        Box::new(Chebyshev { tolerance }),
        Box::new(Cg { tolerance }),
        Box::new(Minres { tolerance }),
        Box::new(BiCg { tolerance }),
        Box::new(BiCgStab { tolerance, preconditioner: None }),
        Box::new(Gmres { tolerance, restart: 30, preconditioner: None }),
        Box::new(FlexibleGmres { tolerance, restart: 30, preconditioner: &MinimalResidual { n_steps: 2 } }),
        Box::new(Anderson { tolerance, depth: 5 }),
        Box::new(DeflatedCg { tolerance, n_groups: None }),
        Box::new(DeflatedGmres { tolerance, n_groups: None }),
        Box::new(TwoGrid { tolerance, n_groups: None }),
        Box::new(Multigrid { tolerance, n_visits: 2 }),
        Box::new(Perron { tolerance }),
    ]
}

/// The method of this name, as reports and the command line give it.
pub fn named(name: &str, tolerance: f64) -> Option<Box<dyn Solver>> {
    all(tolerance).into_iter().find(|method| method.name() == name)
}
