//! The inner product of a Krylov method, and updates of single columns.

use crate::linalg::{Block, Equation};

/// ⟨a, b⟩ = Σ μᵢ aᵢ bᵢ, with the étendue of the self-adjoint form, or 1 where there is none.
#[derive(Clone, Copy)]
pub(super) struct Inner<'a>(Option<&'a [f64]>);

impl<'a> Inner<'a> {
    pub fn of(equation: Equation<'a>) -> Self {
        Self(equation.self_adjoint.map(|form| form.etendue))
    }

    pub fn dot(&self, a: &[f64], b: &[f64]) -> f64 {
        match self.0 {
            Some(mu) => mu.iter().zip(a).zip(b).map(|((mu, a), b)| mu * a * b).sum(),
            None => a.iter().zip(b).map(|(a, b)| a * b).sum(),
        }
    }

    pub fn norm(&self, a: &[f64]) -> f64 {
        self.dot(a, a).sqrt()
    }

    /// x ← M x.
    pub fn weigh(&self, x: &mut [f64]) {
        if let Some(mu) = self.0 {
            x.iter_mut().zip(mu).for_each(|(x, mu)| *x *= mu);
        }
    }
}

/// x ← x + factor y.
pub(super) fn add_scaled(x: &mut [f64], factor: f64, y: &[f64]) {
    x.iter_mut().zip(y).for_each(|(x, y)| *x += factor * y);
}

/// x ← factor y.
pub(super) fn set_scaled(x: &mut [f64], factor: f64, y: &[f64]) {
    x.iter_mut().zip(y).for_each(|(x, y)| *x = factor * y);
}

/// out ← (I − K) x. One product.
pub(super) fn one_minus_transport(equation: Equation<'_>, x: &Block, out: &mut Block) {
    equation.transport.apply(x, out);
    out.values_mut().iter_mut().zip(x.values()).for_each(|(y, x)| *y = x - *y);
}
