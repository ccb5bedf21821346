//! The residual of an answer, without the digits that a nearly constant answer would cost.
//!
//! ```text
//! rᵢ = Eᵢ − aᵢ Lᵢ − Σⱼ Kᵢⱼ (Lᵢ − Lⱼ)      by      r = E − a c + K d − d,      L = c 1 + d,      a = (I − K) 1
//! ```
//!
//! Where little is absorbed L is nearly a constant c, some 1/a times brighter than E; E + K L − L then keeps the digits that E has of L.
//! With the absorption a known, c has no part in the sums, and r is right to some ulp of E and of d. The diagonal of I − K is
//! thereby what is lost and what goes elsewhere, as elimination without subtraction has it. Where a is not known c = 0.

use super::{Block, Equation, max_abs};

/// Evaluates residuals of one equation; allocates once.
pub struct Residual<'a> {
    equation: Equation<'a>,
    /// d.
    rest: Block,
    /// c of every band.
    constants: Vec<f64>,
}

impl<'a> Residual<'a> {
    pub fn new(equation: Equation<'a>) -> Self {
        let rest = Block::zeros(equation.n_unknowns(), equation.n_bands());
        Self { equation, rest, constants: vec![0.0; equation.n_bands()] }
    }

    /// out ← E + K L − L of L = high + low, low being what rounding took from high, if that is known. One product with K.
    pub fn evaluate(&mut self, high: &Block, low: Option<&Block>, out: &mut Block) {
        // Split L.
        self.rest.copy_from(high);
        for (band, constant) in self.constants.iter_mut().enumerate() {
            let rest = self.rest.column_mut(band);
            *constant = self.equation.absorption.map_or(0.0, |absorption| middle(rest, absorption.column(band)));
            rest.iter_mut().for_each(|d| *d -= *constant);
            if let Some(low) = low {
                rest.iter_mut().zip(low.column(band)).for_each(|(d, low)| *d += low);
            }
        }

        // A row that keeps most of its light for itself has little to do with c: (1 − a) c is the smaller part.
        self.equation.transport.apply(&self.rest, out);
        for (band, constant) in self.constants.iter().enumerate() {
            let (e, d) = (self.equation.emission.column(band), self.rest.column(band));
            let rows = out.column_mut(band).iter_mut().zip(e).zip(d);
            match self.equation.absorption {
                None => rows.for_each(|((r, e), d)| *r += e - d),
                Some(absorption) => rows.zip(absorption.column(band)).zip(high.column(band)).enumerate().for_each(
                    |(i, ((((r, e), d), a), l))| {
                        *r += if *a < 0.5 {
                            (e - a * constant) - d
                        } else {
                            (e - (l - (1.0 - a) * constant)) - low.map_or(0.0, |low| low.get(i, band))
                        };
                    },
                ),
            }
        }
    }

    /// The sum of the magnitudes that the residual of row i was last summed from: an ulp of it is what rounding takes at a time. For rows
    /// that gain no more than 1, with `residual` as it came out.
    pub fn magnitudes(&self, band: usize, high: &Block, residual: &Block, out: &mut [f64]) {
        let (e, d, r) = (self.equation.emission.column(band), self.rest.column(band), residual.column(band));
        let constant = self.constants[band];
        let largest = max_abs(d);
        // K ≥ 0, so that where d ≥ 0 the magnitudes that K d sums are what it sums.
        let is_positive = constant == 0.0 && d.iter().all(|d| *d >= 0.0);
        for (i, out) in out.iter_mut().enumerate() {
            let a = self.equation.absorption.map_or(0.0, |absorption| absorption.get(i, band));
            let gathered = if is_positive { (r[i] + d[i] - e[i]).abs() } else { (1.0 - a) * largest };
            let own = if a < 0.5 {
                a * constant.abs() + d[i].abs()
            } else {
                high.get(i, band).abs() + (1.0 - a) * constant.abs()
            };
            *out = e[i].abs() + own + gathered;
        }
    }
}

/// What the rows that give light on hold on average.
fn middle(values: &[f64], absorption: &[f64]) -> f64 {
    let (sum, weight) = values.iter().zip(absorption).fold((0.0, 0.0), |(sum, weight), (l, a)| {
        let gain = 1.0 - a;
        (sum + gain * l, weight + gain)
    });
    if weight > 0.0 { sum / weight } else { 0.0 }
}
