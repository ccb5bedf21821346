//! What a measurement hangs on: its derivatives with respect to every albedo and every emission, from one adjoint solution.
//!
//! ```text
//! M = ⟨W, L⟩ = ⟨E, J⟩,      ∂M/∂Eᵢ = μᵢ Jᵢ,      ∂M/∂albedoᵢ = μᵢ Jᵢ (G L)ᵢ
//! ```
//!
//! band by band, for L = E + K L, J = W + K* J and ⟨a, b⟩ = Σ μᵢ aᵢ bᵢ. Both are exact for the discrete equation. Source: Marchuk (1995),
//! Adjoint Equations and Analysis of Complex Systems, ch. 1; for light, Christensen (2003).

use super::System;
use crate::linalg::{Block, LinearOperator};

/// The derivatives of one measurement, n × bands each; band b is that of the measurement in band b.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensitivity {
    /// ∂M/∂Eᵢ, in the unit of M a W m⁻² sr⁻¹.
    pub emission: Block,
    /// ∂M/∂albedoᵢ, in the unit of M.
    pub albedo: Block,
}

impl System {
    /// Derivatives of ⟨W, L⟩ from L and the importance J of W. One product with G.
    pub fn sensitivity(&self, radiance: &Block, importance: &Block) -> Sensitivity {
        let mut incident = Block::zeros(radiance.n_rows(), radiance.n_columns());
        self.transport().propagation().apply(radiance, &mut incident);
        let weighed = |i: usize, band: usize| self.etendue()[i] * importance.get(i, band);
        let (n, n_bands) = (importance.n_rows(), importance.n_columns());
        Sensitivity {
            emission: Block::from_fn(n, n_bands, weighed),
            albedo: Block::from_fn(n, n_bands, |i, band| weighed(i, band) * incident.get(i, band)),
        }
    }

    /// ⟨a, b⟩ = Σ μᵢ aᵢ bᵢ, a number a band.
    pub fn inner(&self, a: &Block, b: &Block) -> Vec<f64> {
        let bands = a.columns().zip(b.columns());
        bands.map(|(a, b)| self.etendue().iter().zip(a).zip(b).map(|((mu, a), b)| mu * a * b).sum()).collect()
    }
}
