//! Which bounces of light are scored, and where.

use crate::linalg::Block;
use std::ops::Range;

/// Bounce k is KᵏE: light that was scattered k times since it was emitted, the last time into the bundle that is scored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Bounces {
    /// All of them, added up: one column a band.
    #[default]
    All,
    /// Bounces 0 … k, added up: one column a band. Paths end after the last.
    UpTo(usize),
    /// Bounces 0 … k, each alone: one column for every bounce and band, a bounce's bands together. Paths end after the last.
    Each(usize),
}

/// The columns that an estimator scores.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Columns {
    pub n_bands: usize,
    pub bounces: Bounces,
}

impl Bounces {
    /// The last bounce that counts, if there is one.
    pub fn last(self) -> Option<usize> {
        match self {
            Self::All => None,
            Self::UpTo(last) | Self::Each(last) => Some(last),
        }
    }
}

impl Columns {
    /// How many there are.
    pub fn count(self) -> usize {
        match self.bounces {
            Bounces::All | Bounces::UpTo(_) => self.n_bands,
            Bounces::Each(last) => self.n_bands * (last + 1),
        }
    }

    /// Where a bounce is scored, one column a band; `None` for one that does not count.
    #[inline]
    pub fn of(self, bounce: usize) -> Option<Range<usize>> {
        if self.ends_before(bounce) {
            return None;
        }
        let first = if matches!(self.bounces, Bounces::Each(_)) { bounce * self.n_bands } else { 0 };
        Some(first..first + self.n_bands)
    }

    /// What bounce 0 alone comes to, n × columns.
    pub fn first(self, emission: &Block) -> Block {
        let value = |i, c| if c < self.n_bands { emission.get(i, c) } else { 0.0 };
        Block::from_fn(emission.n_rows(), self.count(), value)
    }

    /// True if neither this bounce nor a later one counts.
    #[inline]
    pub fn ends_before(self, bounce: usize) -> bool {
        self.bounces.last().is_some_and(|last| bounce > last)
    }
}
