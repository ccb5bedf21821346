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

/// Probes ⟨x, G y⟩ = ⟨G x, y⟩ with two vectors without structure.
fn check_self_adjoint(method: &'static str, form: SelfAdjoint<'_>) -> Result<(), SolveError> {
    let n = form.etendue.len();
    let wave = |frequency: f64| Block::from_fn(n, 1, |i, _| (frequency * (i as f64 + 1.0)).sin());
    let (x, y) = (wave(1.618_033_988_749_895), wave(2.414_213_562_373_095));
    let (mut gx, mut gy) = (Block::zeros(n, 1), Block::zeros(n, 1));
    form.propagation.apply(&x, &mut gx);
    form.propagation.apply(&y, &mut gy);
    let product = |a: &Block, b: &Block| form.inner(a.column(0), b.column(0));
    let scale = (product(&x, &x) * product(&gy, &gy)).sqrt() + (product(&gx, &gx) * product(&y, &y)).sqrt();
    let violation = (product(&x, &gy) - product(&gx, &y)).abs() / scale.max(f64::MIN_POSITIVE);
    if violation > SELF_ADJOINT {
        return Err(SolveError::NotSelfAdjoint { method, violation, allowed: SELF_ADJOINT });
    }
    Ok(())
}
