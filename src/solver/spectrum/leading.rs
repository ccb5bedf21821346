//! Leading eigenpairs and singular values of K, and what follows from them.

use super::super::SolveError;
use super::super::accelerated::self_adjoint_weights;
use super::krylov_schur::{self, Eigen, Eigenpair};
use crate::linalg::{
    Adjoint, Block, Dense, Equation, LinearOperator, SelfAdjoint, Unknown, singular_values as dense_singular_values,
};

/// Eigenpairs of every band, largest magnitude first.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    pub bands: Vec<Vec<Eigenpair>>,
    /// The weights in which K is self-adjoint and the vectors are orthonormal, n × bands; `None` if no such weights are known: then
    /// eigenvalues may be complex, and vectors have norm 1 with weights 1.
    pub weights: Option<Block>,
    /// Products with K, all bands at once.
    pub n_applies: usize,
}

/// The eigenvalues of K of largest magnitude, every band. For radiance with a self-adjoint form by Lanczos' method, real; else by
/// Krylov–Schur's.
///
/// # Errors
/// Products that are not finite.
pub fn leading_eigenpairs(equation: Equation<'_>, settings: Eigen) -> Result<Spectrum, SolveError> {
    let (n, n_bands) = (equation.n_unknowns(), equation.n_bands());
    let form = equation.self_adjoint.filter(|form| form.unknown == Unknown::Radiance);
    let weights = form.and_then(|form| self_adjoint_weights(form, n_bands));
    let ones = Block::from_fn(n, n_bands, |_, _| 1.0);
    let apply = |x: &Block, y: &mut Block| equation.transport.apply(x, y);
    let found =
        krylov_schur::leading("eigenpairs", weights.as_ref().unwrap_or(&ones), weights.is_some(), settings, apply)?;
    Ok(Spectrum { bands: found.bands, weights, n_applies: found.n_applies })
}

/// Singular values of every band, largest first.
#[derive(Clone, Debug, PartialEq)]
pub struct SingularValues {
    pub bands: Vec<Vec<f64>>,
    /// Products with K, and as many with K*, all bands at once.
    pub n_applies: usize,
}

/// The largest singular values of K in the norm ‖x‖² = Σ μᵢ xᵢ² of étendue (weights 1 where none is known): roots of the eigenvalues
/// of K* K, by Lanczos' method.
///
/// # Errors
/// Products that are not finite.
pub fn leading_singular_values(equation: Equation<'_>, settings: Eigen) -> Result<SingularValues, SolveError> {
    let (n, n_bands) = (equation.n_unknowns(), equation.n_bands());
    let etendue = etendue(equation.self_adjoint, n);
    let weights = Block::from_fn(n, n_bands, |i, _| etendue[i]);
    let adjoint = Adjoint::new(equation.transport, &etendue);
    let mut scratch = Block::zeros(n, n_bands);
    let apply = |x: &Block, y: &mut Block| {
        equation.transport.apply(x, &mut scratch);
        adjoint.apply(&scratch, y);
    };
    let found = krylov_schur::leading("singular values", &weights, true, settings, apply)?;
    let roots = |pairs: Vec<Eigenpair>| pairs.into_iter().map(|pair| pair.re.max(0.0).sqrt()).collect();
    Ok(SingularValues { bands: found.bands.into_iter().map(roots).collect(), n_applies: found.n_applies })
}

/// All singular values of one band of K and of I − K in the same norm, largest first each. Writes both out: for small n, cost some 20 n³.
///
/// # Errors
/// Entries that are not finite.
pub fn all_singular_values(equation: Equation<'_>, band: usize) -> Result<[Vec<f64>; 2], SolveError> {
    let mut weighed = weighed(equation, band);
    let failed = |source| SolveError::Factor { method: "singular values", band, source };
    let of_transport = dense_singular_values(&weighed).map_err(failed)?;
    for r in 0..equation.n_unknowns() {
        weighed.row_mut(r).iter_mut().for_each(|v| *v = -*v);
        weighed.row_mut(r)[r] += 1.0;
    }
    Ok([of_transport, dense_singular_values(&weighed).map_err(failed)?])
}

/// M^½ K M^−½ of one band, written out: its singular values are those of K in the norm of étendue.
pub(super) fn weighed(equation: Equation<'_>, band: usize) -> Dense {
    let etendue = etendue(equation.self_adjoint, equation.n_unknowns());
    let root: Vec<f64> = etendue.iter().map(|mu| mu.sqrt()).collect();
    let mut weighed = Dense::from_operator(equation.transport, band);
    for (r, left) in root.iter().enumerate() {
        weighed.row_mut(r).iter_mut().zip(&root).for_each(|(v, right)| *v *= left / right);
    }
    weighed
}

/// How many of these, largest first, exceed `tolerance` times the first: the rank that K has for whoever asks for no more.
pub fn effective_rank(singular_values: &[f64], tolerance: f64) -> usize {
    let largest = singular_values.first().copied().unwrap_or(0.0);
    singular_values.iter().take_while(|value| **value > tolerance * largest).count()
}

/// First over last: the condition number, of the singular values of I − K.
pub fn condition(singular_values: &[f64]) -> f64 {
    match (singular_values.first(), singular_values.last()) {
        (Some(first), Some(last)) => first / last,
        _ => 1.0,
    }
}

fn etendue(form: Option<SelfAdjoint<'_>>, n: usize) -> Vec<f64> {
    form.map_or_else(|| vec![1.0; n], |form| form.etendue.to_vec())
}
