//! The equation L = E + K L, as solvers and matrix estimators see it: operators and vectors, no scene.

use super::{Block, Hierarchy, LinearOperator};

/// L = E + K L, one column a band.
///
/// The adjoint equation, J = W + K* J, is of the same form: importance is what its solvers answer.
#[derive(Clone, Copy)]
pub struct Equation<'a> {
    /// K = S G, n × n.
    pub transport: &'a dyn LinearOperator,
    /// E, n × bands.
    pub emission: &'a Block,
    /// 1 − Σⱼ Kᵢⱼ, n × bands, where it is known without subtracting: what a nearly white row loses has digits of its own.
    pub absorption: Option<&'a Block>,
    /// The self-adjoint form, where there is one.
    pub self_adjoint: Option<SelfAdjoint<'a>>,
    /// Groups of unknowns that are near each other, where there are any.
    pub hierarchy: Option<&'a Hierarchy>,
}

/// The same equation in the étendue inner product ⟨a, b⟩ = Σ μᵢ aᵢ bᵢ, with A = S^½ G S^½ and S^½ the positive semidefinite root of S:
///
/// ```text
/// L = E + S G L:      (I − A) u = S^½ G E,      L = E + S^½ u
/// J = W + G S J:      (I − A) u = S^½ W,        J = W + G S^½ u
/// ```
///
/// A is self-adjoint because M G and M S^½ are symmetric.
#[derive(Clone, Copy)]
pub struct SelfAdjoint<'a> {
    /// μ, n.
    pub etendue: &'a [f64],
    /// G, n × n, M G symmetric.
    pub propagation: &'a dyn LinearOperator,
    /// S^½, n × n, M S^½ symmetric.
    pub scattering_root: &'a dyn LinearOperator,
    /// Which of the two equations it is.
    pub unknown: Unknown,
}

/// What L stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unknown {
    /// Outgoing radiance, L = E + S G L.
    Radiance,
    /// Importance, J = W + G S J.
    Importance,
}

impl<'a> Equation<'a> {
    /// Of which no more is known than K and E.
    pub fn plain(transport: &'a dyn LinearOperator, emission: &'a Block) -> Self {
        Self { transport, emission, absorption: None, self_adjoint: None, hierarchy: None }
    }

    /// n.
    pub fn n_unknowns(&self) -> usize {
        self.emission.n_rows()
    }

    /// Number of right-hand sides: the bands.
    pub fn n_bands(&self) -> usize {
        self.emission.n_columns()
    }
}

impl SelfAdjoint<'_> {
    /// out ← A u, and `direction` ← where u moves the answer: S^½ u for radiance, G S^½ u for importance. One product; `scratch` is room to
    /// work in.
    pub fn apply(&self, u: &Block, scratch: &mut Block, direction: &mut Block, out: &mut Block) {
        match self.unknown {
            Unknown::Radiance => {
                self.scattering_root.apply(u, direction);
                self.propagation.apply(direction, scratch);
                self.scattering_root.apply(scratch, out);
            }
            Unknown::Importance => {
                self.scattering_root.apply(u, scratch);
                self.propagation.apply(scratch, direction);
                self.scattering_root.apply(direction, out);
            }
        }
    }

    /// out ← the right-hand side for this E or W, and the products it took: one for radiance, none for importance.
    pub fn right_side(&self, emission: &Block, scratch: &mut Block, out: &mut Block) -> usize {
        match self.unknown {
            Unknown::Radiance => {
                self.propagation.apply(emission, scratch);
                self.scattering_root.apply(scratch, out);
                1
            }
            Unknown::Importance => {
                self.scattering_root.apply(emission, out);
                0
            }
        }
    }

    /// out ← L or J of this u, and the products it took: none for radiance, one for importance.
    pub fn answer(&self, emission: &Block, u: &Block, scratch: &mut Block, out: &mut Block) -> usize {
        let n_products = match self.unknown {
            Unknown::Radiance => {
                self.scattering_root.apply(u, out);
                0
            }
            Unknown::Importance => {
                self.scattering_root.apply(u, scratch);
                self.propagation.apply(scratch, out);
                1
            }
        };
        out.add_scaled(1.0, emission);
        n_products
    }

    /// out ← S^½ r of the residual r of u: the residual of L, and of J a bound on the magnitude of its residual G S^½ r, G being an
    /// average.
    pub fn residual(&self, r: &Block, out: &mut Block) {
        self.scattering_root.apply(r, out);
    }

    /// ⟨a, b⟩ = Σ μᵢ aᵢ bᵢ.
    pub fn inner(&self, a: &[f64], b: &[f64]) -> f64 {
        self.etendue.iter().zip(a).zip(b).map(|((mu, a), b)| mu * a * b).sum()
    }
}
