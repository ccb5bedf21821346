//! Is G self-adjoint in the étendue inner product, as the methods that rest on it need?

use super::SolveError;
use crate::linalg::{Block, Equation, SelfAdjoint};

/// |⟨x, G y⟩ − ⟨G x, y⟩| relative to ‖x‖ ‖G y‖: rounding leaves some n^½ ulp, a wrong μ or a lost symmetry leaves far more.
const SELF_ADJOINT: f64 = 1e-10;

/// Products that [`checked_form`] takes.
pub(super) const CHECK: usize = 2;

/// The self-adjoint form of an equation, looked at. [`CHECK`] products.
///
/// # Errors
/// An equation without it, or one whose G is not what it says.
pub(super) fn checked_form<'a>(method: &'static str, equation: Equation<'a>) -> Result<SelfAdjoint<'a>, SolveError> {
    let form = equation.self_adjoint.ok_or(SolveError::NoSelfAdjointForm { method })?;
    check_self_adjoint(method, form)?;
    Ok(form)
}

/// Frequencies of the two vectors without structure that symmetry is probed with.
pub(super) const PROBES: [f64; 2] = [1.618_033_988_749_895, 2.414_213_562_373_095];

/// Entry i of a probe.
pub(super) fn probe(frequency: f64, i: usize) -> f64 {
    (frequency * (i as f64 + 1.0)).sin()
}

/// Probes ⟨x, G y⟩ = ⟨G x, y⟩ with two vectors without structure.
fn check_self_adjoint(method: &'static str, form: SelfAdjoint<'_>) -> Result<(), SolveError> {
    let n = form.etendue.len();
    let [x, y] = PROBES.map(|frequency| Block::from_fn(n, 1, |i, _| probe(frequency, i)));
    let (mut gx, mut gy) = (Block::zeros(n, 1), Block::zeros(n, 1));
    form.propagation.apply(&x, &mut gx);
    form.propagation.apply(&y, &mut gy);
    let product = |a: &[f64], b: &[f64]| form.inner(a, b);
    check_probes(method, product, [x.column(0), gx.column(0)], [y.column(0), gy.column(0)])
}

/// ⟨x, A y⟩ = ⟨A x, y⟩ of two probes and their images.
///
/// # Errors
/// An A that is not self-adjoint in this inner product.
pub(super) fn check_probes(
    method: &'static str,
    product: impl Fn(&[f64], &[f64]) -> f64,
    [x, ax]: [&[f64]; 2],
    [y, ay]: [&[f64]; 2],
) -> Result<(), SolveError> {
    let scale = (product(x, x) * product(ay, ay)).sqrt() + (product(ax, ax) * product(y, y)).sqrt();
    let violation = (product(x, ay) - product(ax, y)).abs() / scale.max(f64::MIN_POSITIVE);
    if violation > SELF_ADJOINT {
        return Err(SolveError::NotSelfAdjoint { method, violation, allowed: SELF_ADJOINT });
    }
    Ok(())
}
