//! The matrices of a system, written out to leave the program.

use super::System;
use crate::linalg::{Dense, LinearOperator, Matrix, Sparse};
use std::fmt;
use std::str::FromStr;

/// A matrix by its letter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Letter {
    /// K = S G, one bounce.
    K,
    /// T = M G, exchange, m² sr.
    T,
    /// G, which on patches with one bin are form factors.
    F,
    /// S, local scattering.
    S,
    /// E, emission, n × bands, W m⁻² sr⁻¹.
    E,
}

impl Letter {
    pub const ALL: [Self; 5] = [Self::K, Self::T, Self::F, Self::S, Self::E];

    /// True for what differs from band to band.
    pub fn has_bands(self) -> bool {
        matches!(self, Self::K | Self::S)
    }
}

impl fmt::Display for Letter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self, f)
    }
}

impl FromStr for Letter {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let letter = Self::ALL.into_iter().find(|letter| letter.to_string() == text);
        letter.ok_or_else(|| "expected some of K, T, F, S and E".to_string())
    }
}

impl System {
    /// The matrix of one band, in full or sparse as T is. Cost O(entries).
    pub fn written_out(&self, letter: Letter, band: usize) -> Matrix {
        let like_exchange = |operator: &dyn LinearOperator| match self.exchange() {
            Matrix::Dense(_) => Matrix::Dense(Dense::from_operator(operator, band.min(operator.n_bands() - 1))),
            Matrix::Sparse(_) => Matrix::Sparse(Sparse::from_operator(operator, band.min(operator.n_bands() - 1))),
        };
        match letter {
            Letter::K => like_exchange(self.transport()),
            Letter::T => self.exchange().clone(),
            Letter::F => like_exchange(self.transport().propagation()),
            Letter::S => Matrix::Sparse(Sparse::from_operator(self.transport().scattering(), band)),
            Letter::E => {
                let emission = self.emission();
                Matrix::Dense(Dense::from_fn(emission.n_rows(), emission.n_columns(), |i, c| emission.get(i, c)))
            }
        }
    }
}
