//! Elimination without subtraction, after Grassmann, Taksar and Heyman.
//!
//! ```text
//! 1 − Kₚₚ = aₚ + Σ_{j≠p} Kₚⱼ,      so that every pivot of I − K is a sum of what is lost and of what goes elsewhere
//! ```
//!
//! Needs K ≥ 0 and rows that gain no more than 1, and refuses by the entry that breaks either. Where the equation knows its absorption a,
//! every component of L is right to some n ulp of itself, for absorption down to 1e-15 and below, where elimination with subtraction has
//! lost every digit; E of either sign is solved by parts. Where it does not, a = 1 − Σⱼ Kᵢⱼ is computed, and digits are lost there as they
//! are in LU. Cost ⅔ n³ a band. Source: Grassmann, Taksar and Heyman (1985); O'Cinneide (1993).

use super::factored::{Band, Factored, eliminate};
use crate::linalg::{Dense, Equation, FactorError, GthFactor};
use crate::solver::{Attempt, Observer, SolveError, Solver};

/// Elimination from absorption.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gth;

impl Gth {
    /// The factors of every band: 8 n² bytes each.
    ///
    /// # Errors
    /// A matrix that is singular or not finite, an entry of K below zero, a row that gains more than 1.
    pub fn factor(&self, equation: Equation<'_>) -> Result<Factored, SolveError> {
        Factored::new(self.name(), equation, factor)
    }
}

impl Solver for Gth {
    fn name(&self) -> &'static str {
        "gth"
    }

    fn is_direct(&self) -> bool {
        true
    }

    fn attempt<'a>(&self, equation: Equation<'a>, _: &mut dyn Observer) -> Result<Attempt<'a>, SolveError> {
        eliminate(self.name(), equation, factor)
    }
}

fn factor(equation: Equation<'_>, band: usize) -> Result<Band, FactorError> {
    let transport = Dense::from_operator(equation.transport, band);
    let losses = match equation.absorption {
        Some(absorption) => absorption.column(band).to_vec(),
        None => (0..equation.n_unknowns()).map(|i| loss(transport.row_slice(i))).collect(),
    };
    Ok((Box::new(GthFactor::new(transport, &losses)?), None))
}

/// 1 − Σⱼ Kᵢⱼ of a row, its rounding carried along (Neumaier 1974); what is below zero by no more than that of its entries is zero.
fn loss(row: &[f64]) -> f64 {
    let (mut sum, mut carried) = (1.0, 0.0);
    for k in row {
        let next: f64 = sum - k;
        carried += if f64::abs(sum) >= *k { (sum - next) - k } else { (-k - next) + sum };
        sum = next;
    }
    let loss = sum + carried;
    if (-f64::EPSILON..0.0).contains(&loss) { 0.0 } else { loss }
}
