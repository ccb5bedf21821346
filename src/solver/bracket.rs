//! Bounds around the discrete answer that trust no solver.
//!
//! Where K ≥ 0, every L₊ with L₊ ≥ E + K L₊ lies above (I − K)⁻¹E, and every L₋ with L₋ ≤ E + K L₋ below it. For any L̃ with residual
//! r = E + K L̃ − L̃ and any w > 0 with b = (I − K) w > 0,
//!
//! ```text
//! L₊ = L̃ + s w,      s = max (rᵢ / bᵢ)⁺,      and, one step closer,      E + K L₊ = L̃ + r + s (w − b)
//! ```
//!
//! and likewise below. With w = 1 the loss b is the absorption, known without subtracting; where some rows lose nothing, w counts the
//! bounces until they do, w = Σₘ Kᵐ 1, b = 1 − Kᵐ⁺¹ 1. Residual and losses are widened by a bound on their own rounding.
//!
//! Cost: no product where the absorption is given and nowhere zero, one where it is not given, one a bounce of w. Source: Collatz
//! (1952), "Aufgaben monotoner Art"; Varga (2000), §3.5.

use crate::linalg::{Block, Doubled, Equation, Residual, max_abs};

/// Bounces after which rows that lose nothing are given up.
const BOUNCES: usize = 64;

/// low ≤ (I − K)⁻¹E ≤ high, bundle by bundle, n × bands.
#[derive(Clone, Debug, PartialEq)]
pub struct Bracket {
    pub low: Block,
    pub high: Block,
}

impl Bracket {
    /// Half its width where it is widest, relative to the largest radiance of that band.
    pub fn relative_width(&self) -> f64 {
        let bands = self.low.columns().zip(self.high.columns()).map(|(low, high)| {
            let widest = low.iter().zip(high).fold(0.0, |widest: f64, (low, high)| widest.max(0.5 * (high - low)));
            let scale = max_abs(high).max(max_abs(low));
            if scale > 0.0 { widest / scale } else { 0.0 }
        });
        bands.fold(0.0, f64::max)
    }
}

/// What rounding takes from a row's sum at most, relative to the magnitudes that are summed: a sum of n products is off by at most
/// (n + 2) ulp of them.
pub(super) fn rounding(equation: Equation<'_>) -> f64 {
    (equation.n_unknowns() as f64 + 8.0) * f64::EPSILON
}

/// The bracket around `radiance` with the residual `r`; `None` where K has entries below zero, or loses nothing in many bounces.
pub(super) fn around(
    equation: Equation<'_>,
    radiance: &Doubled,
    residual: &Residual<'_>,
    r: &Block,
) -> Option<Bracket> {
    if !equation.transport.is_nonnegative() {
        return None;
    }
    let (n, n_bands) = (r.n_rows(), r.n_columns());
    let rounding = rounding(equation);
    let (weight, loss) = weight(equation, rounding)?;

    let (mut low, mut high) = (Block::zeros(n, n_bands), Block::zeros(n, n_bands));
    let mut slack = vec![0.0; n];
    for band in 0..n_bands {
        let e = equation.emission.column(band);
        let (l, rest) = (radiance.high.column(band), radiance.low.column(band));
        let (w, b) = (weight.column(band), loss.column(band));
        residual.magnitudes(band, &radiance.high, r, &mut slack);
        let r = r.column(band);
        slack.iter_mut().for_each(|magnitude| *magnitude *= 2.0 * rounding);
        let side = |sign: f64, out: &mut Block| {
            let scale = (0..n).fold(0.0, |worst: f64, i| worst.max((sign * r[i] + slack[i]) / b[i]));
            let bounds = out.column_mut(band).iter_mut().enumerate();
            bounds.for_each(|(i, bound)| {
                let whole = scale * w[i];
                let closer = sign * r[i] + slack[i] + scale * (w[i] - b[i]).max(0.0);
                // Every step away from L.
                let away = whole.min(closer) * (1.0 + 8.0 * f64::EPSILON) + sign * rest[i];
                *bound = l[i] + sign * away;
                *bound = if sign > 0.0 { bound.next_up() } else { bound.next_down() };
            });
        };
        side(-1.0, &mut low);
        side(1.0, &mut high);
        // Where nothing takes light away there is at least what is emitted.
        if e.iter().all(|e| *e >= 0.0) {
            low.column_mut(band).iter_mut().zip(e).for_each(|(low, e)| *low = low.max(*e));
        }
    }
    Some(Bracket { low, high })
}

/// w > 0 and a lower bound b > 0 of (I − K) w, n × bands each.
fn weight(equation: Equation<'_>, rounding: f64) -> Option<(Block, Block)> {
    let (n, n_bands) = (equation.n_unknowns(), equation.n_bands());
    let mut weight = Block::from_fn(n, n_bands, |_, _| 1.0);
    let absorption = match equation.absorption {
        Some(absorption) => Block::from_fn(n, n_bands, |i, band| absorption.get(i, band) * (1.0 - 8.0 * f64::EPSILON)),
        None => {
            let mut gain = Block::zeros(n, n_bands);
            equation.transport.apply(&weight, &mut gain);
            Block::from_fn(n, n_bands, |i, band| 1.0 - gain.get(i, band) * (1.0 + rounding))
        }
    };
    let mut loss = absorption.clone();
    let mut scratch = Block::zeros(n, n_bands);
    for _ in 0..BOUNCES {
        if loss.values().iter().all(|b| *b > 0.0) {
            return Some((weight, loss));
        }
        // What is left after m bounces joins the weight; what is lost in m + 1 is lost in one, or in m after it.
        for (w, b) in weight.values_mut().iter_mut().zip(loss.values()) {
            *w += 1.0 - b;
        }
        equation.transport.apply(&loss, &mut scratch);
        for ((b, carried), a) in loss.values_mut().iter_mut().zip(scratch.values()).zip(absorption.values()) {
            *b = a + carried - rounding * carried.abs();
        }
    }
    None
}
