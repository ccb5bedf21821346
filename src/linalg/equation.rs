//! The equation L = E + K L, as solvers and matrix estimators see it: operators and vectors, no scene.

use super::{Block, LinearOperator};

/// L = E + K L, one column a band.
#[derive(Clone, Copy)]
pub struct Equation<'a> {
    /// K = S G, n × n.
    pub transport: &'a dyn LinearOperator,
    /// E, n × bands.
    pub emission: &'a Block,
    /// The self-adjoint form, where there is one.
    pub self_adjoint: Option<SelfAdjoint<'a>>,
}

/// The same equation in the étendue inner product ⟨a, b⟩ = Σ μᵢ aᵢ bᵢ:
///
/// ```text
/// (I − S^½ G S^½) u = S^½ G E,      L = E + S^½ u
/// ```
///
/// with S^½ the positive semidefinite root of S. S^½ G S^½ is self-adjoint because M G and M S^½ are symmetric.
#[derive(Clone, Copy)]
pub struct SelfAdjoint<'a> {
    /// μ, n.
    pub etendue: &'a [f64],
    /// G, n × n, M G symmetric.
    pub propagation: &'a dyn LinearOperator,
    /// S^½, n × n, M S^½ symmetric.
    pub scattering_root: &'a dyn LinearOperator,
}

impl Equation<'_> {
    /// n.
    pub fn n_unknowns(&self) -> usize {
        self.emission.n_rows()
    }

    /// Number of right-hand sides: the bands.
    pub fn n_bands(&self) -> usize {
        self.emission.n_columns()
    }

    /// out ← E + K x − x, the residual of x. One product with K.
    pub fn residual(&self, x: &Block, out: &mut Block) {
        self.transport.apply(x, out);
        for ((r, e), l) in out.values_mut().iter_mut().zip(self.emission.values()).zip(x.values()) {
            *r += e - l;
        }
    }
}
