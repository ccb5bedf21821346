//! A field near a constant, as the constant and the rest: L = α P 1 + v.
//!
//! Where little is absorbed L is nearly the same everywhere and 1/(1 − a) times brighter than what is emitted; kept apart, the constant
//! costs the rest no digits, and the residual of both, r = E − α a + K v − v, none either.

use super::coarse::Coarse;
use crate::linalg::{Block, Doubled};

/// α of every band and v.
pub(super) struct Shifted {
    pub constants: Vec<f64>,
    pub rest: Block,
}

impl Shifted {
    /// v = E, α = 0.
    pub fn at(emission: &Block) -> Self {
        Self { constants: vec![0.0; emission.n_columns()], rest: emission.clone() }
    }

    /// out ← α P 1 + v + more.
    pub fn write(&self, coarse: &Coarse, more: Option<&Block>, out: &mut Block) {
        out.copy_from(&self.rest);
        more.iter().for_each(|more| out.add_scaled(1.0, more));
        for (band, constant) in self.constants.iter().enumerate() {
            coarse.prolong_constant(band, *constant, out.column_mut(band));
        }
    }

    /// The same, with what rounding takes from it.
    pub fn doubled(mut self, coarse: &Coarse, more: Option<&Block>) -> Doubled {
        more.iter().for_each(|more| self.rest.add_scaled(1.0, more));
        let mut constant = vec![0.0; self.rest.n_rows()];
        let mut sum = Doubled::from(self.rest);
        for (band, alpha) in self.constants.iter().enumerate() {
            constant.fill(0.0);
            coarse.prolong_constant(band, *alpha, &mut constant);
            sum.add_scaled(band, 1.0, &constant);
        }
        sum
    }
}
