//! Is the spectral radius of a moment's matrix below 1?
//!
//! ```text
//! min (H x)ᵢ / xᵢ  ≤  ρ(H)  ≤  max (H x)ᵢ / xᵢ      for H ≥ 0 and any x > 0
//! ```
//!
//! Powers of H + θ, which keep x positive, close in from both sides; the answer stands as soon as one bound is on its side of 1. Both are
//! widened by a bound on their rounding. Cost: a product an iteration, mostly one. Source: Collatz 1942; Wielandt 1950.

use super::OracleError;
use super::kernel::Kernel;
use crate::linalg::{Block, LinearOperator, max_abs};

/// Products after which the question stays open.
const N_PRODUCTS: usize = 500;

/// θ, in units of the upper bound.
const SHIFT: f64 = 0.25;

/// # Errors
/// A radius of 1 or more, or one too close to tell.
pub fn check<E>(kernel: &Kernel<'_>, order: usize) -> Result<(), OracleError<E>> {
    let (n, n_bands) = (kernel.n_rows(), kernel.n_bands());
    // A sum of n products is off by at most (n + 2) ulp of itself, and the quotient by one.
    let rounding = (n as f64 + 4.0) * f64::EPSILON;
    let mut x = Block::from_fn(n, n_bands, |_, _| 1.0);
    let mut image = Block::zeros(n, n_bands);
    let mut bounds = vec![(0.0_f64, f64::INFINITY); n_bands];
    for _ in 0..N_PRODUCTS {
        kernel.apply(&x, &mut image);
        for (band, (low, high)) in bounds.iter_mut().enumerate() {
            // Tighten both bounds.
            let quotients = x.column(band).iter().zip(image.column(band)).map(|(x, y)| y / x);
            let (least, most) =
                quotients.fold((f64::INFINITY, 0.0_f64), |(least, most), q| (least.min(q), most.max(q)));
            *low = low.max(least * (1.0 - rounding));
            *high = high.min(most * (1.0 + rounding));
            if *low >= 1.0 {
                return Err(OracleError::Infinite { order, radius: *low });
            }

            // Take one step, and keep x from running out of range.
            let shift = SHIFT * most + f64::MIN_POSITIVE;
            let column = x.column_mut(band);
            column.iter_mut().zip(image.column(band)).for_each(|(x, y)| *x = y + shift * *x);
            let largest = max_abs(column);
            column.iter_mut().for_each(|x| *x = (*x / largest).max(f64::MIN_POSITIVE));
        }
        if bounds.iter().all(|(_, high)| *high < 1.0) {
            return Ok(());
        }
    }
    let widest = bounds
        .into_iter()
        .filter(|(_, high)| *high >= 1.0)
        .fold((0.0, 0.0), |a: (f64, f64), b| if b.1 > a.1 { b } else { a });
    Err(OracleError::Undecided { order, low: widest.0, high: widest.1 })
}
