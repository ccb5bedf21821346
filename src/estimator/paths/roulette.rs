//! Whether a path goes on.

use super::super::EstimatorError;

/// Ends paths at random without a bias: with a survival probability q, what survives is weighed up by 1/q.
///
/// Throughput is the product of f cosθ / density along the path, the largest over the bands; it is the product of albedos on diffuse
/// surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Roulette {
    /// q = min(1, throughput): no path carries more than one, so that all moments exist.
    #[default]
    Throughput,
    /// None before this many bounces, then as [`Roulette::Throughput`]: longer paths, of more even weight.
    After(usize),
    /// The same q in (0, 1] at every bounce. The variance exists where albedo² < q: the second moment of a path's weight grows by
    /// albedo² / q a bounce. Paths with q = 1 end only where light escapes or nothing is reflected, or after the last bounce asked for.
    Constant(f64),
}

impl Roulette {
    /// Refuses what is no probability, or lets no path go on.
    pub(super) fn checked(self) -> Result<Self, EstimatorError> {
        match self {
            Self::Constant(survival) if !(survival > 0.0 && survival <= 1.0) => {
                Err(EstimatorError::Survival { survival })
            }
            _ => Ok(self),
        }
    }

    /// q after this many bounces, the last included.
    #[inline]
    pub(super) fn survival(self, n_bounces: usize, throughput: f64) -> f64 {
        match self {
            _ if throughput <= 0.0 => 0.0,
            Self::Throughput => throughput.min(1.0),
            Self::After(first) if n_bounces <= first => 1.0,
            Self::After(_) => throughput.min(1.0),
            Self::Constant(survival) => survival,
        }
    }
}
