//! What a method makes of an equation, before anyone has looked at it.

use super::Stop;
use super::monitor::Monitor;
use super::report::Work;
use crate::linalg::{Block, Doubled};

/// d ← (I − K)⁻¹ r with what is at hand, and what that costs.
pub(super) type Again<'a> = Box<dyn FnMut(&Block, &mut Block, &mut Work) + 'a>;

/// A method's own answer, and what it thinks of it.
pub struct Attempt<'a> {
    /// L, and what rounding took from it where the method knows.
    pub radiance: Doubled,
    pub stop: Stop,
    pub work: Work,
    /// Residual by iteration, as the method knew it.
    pub history: Vec<f64>,
    /// Factors that were kept because they may be needed again.
    pub(super) again: Option<Again<'a>>,
}

impl Attempt<'_> {
    /// Of an iteration that ended.
    pub(super) fn ended(radiance: impl Into<Doubled>, stop: Stop, monitor: Monitor<'_>) -> Self {
        let (work, history) = (monitor.work, monitor.history);
        Self { radiance: radiance.into(), stop, work, history, again: None }
    }
}

impl<'a> Attempt<'a> {
    /// Of a factorization.
    pub(super) fn direct(radiance: Block, work: Work, again: Option<Again<'a>>) -> Self {
        Self { radiance: radiance.into(), stop: Stop::Direct, work, history: Vec::new(), again }
    }
}
