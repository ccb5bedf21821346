//! One random number for two decisions.

/// The largest number below 1.
const BELOW_ONE: f64 = 1.0 - 0.5 * f64::EPSILON;

/// Which of two parts a uniform number falls to, and what is left of it, uniform in [0, 1) again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Choice {
    First(f64),
    Second(f64),
}

/// The first part with probability `share`, which may be 0 or 1.
pub(super) fn choose(share: f64, uniform: f64) -> Choice {
    if uniform < share {
        Choice::First((uniform / share).min(BELOW_ONE))
    } else {
        Choice::Second(((uniform - share) / (1.0 - share)).min(BELOW_ONE))
    }
}
