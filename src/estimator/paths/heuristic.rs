//! How strategies that find the same path share it.

/// Weighs a path that several strategies could have found (multiple importance sampling, Veach 1997, §9.2). With the density pᵢ of the
/// path under strategy i, the weights sum to one over the strategies in use, whatever the densities.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Heuristic {
    /// pᵢ / Σ pⱼ: no other weights have a variance lower by more than a bounded amount.
    #[default]
    Balance,
    /// pᵢ² / Σ pⱼ²: better where one strategy is nearly perfect.
    Power,
}

impl Heuristic {
    /// What a density counts, relative to that of the strategy that is weighed: x or x².
    #[inline]
    pub(super) fn power(self, ratio: f64) -> f64 {
        match self {
            Self::Balance => ratio,
            Self::Power => ratio * ratio,
        }
    }

    /// The weight of the first of two strategies with densities `mine` > 0 and `other`.
    #[inline]
    pub(super) fn weight(self, mine: f64, other: f64) -> f64 {
        1.0 / (1.0 + self.power(other / mine))
    }
}
