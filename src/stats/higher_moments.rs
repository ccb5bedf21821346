//! Running mean, variance, skewness and kurtosis, mergeable: what it takes to put an error bar on a variance.

use super::Moments;
use serde::Serialize;

/// Count and sums of the first four powers of deviations from a centre beside the mean (Pébay 2008), updated without cancellation.
///
/// The centre is the mean as far as an f64 can hold it; what is left over is kept, so that variance and kurtosis keep their digits
/// beside a mean of any size. Merging in a fixed order gives the same bits whoever computed the parts. 48 bytes, some 40
/// operations a number: where the mean's own error bar is enough, [`Moments`] is leaner.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct HigherMoments {
    n: u64,
    centre: f64,
    /// Σ (x − centre)^k for k = 1 … 4.
    sums: [f64; 4],
}

impl HigherMoments {
    pub fn push(&mut self, value: f64) {
        self.merge(&Self { n: 1, centre: value, sums: [0.0; 4] });
    }

    /// The moments of both samples together.
    pub fn merge(&mut self, other: &Self) {
        if self.n == 0 || other.n == 0 {
            if self.n == 0 {
                *self = *other;
            }
            return;
        }
        let n = self.n + other.n;
        let centre = self.mean() + (other.mean() - self.mean()) * (other.n as f64 / n as f64);
        let (mine, theirs) = (self.sums_about(centre), other.sums_about(centre));
        *self = Self { n, centre, sums: std::array::from_fn(|k| mine[k] + theirs[k]) };
    }

    /// Takes the sample as one of `n` numbers, those not pushed being zero: for scores that rarely hit.
    pub fn pad_with_zeros(&mut self, n: u64) {
        self.merge(&Self { n: n.saturating_sub(self.n), ..Self::default() });
    }

    /// How many numbers.
    pub fn n(&self) -> u64 {
        self.n
    }

    /// 0 if there are none.
    pub fn mean(&self) -> f64 {
        if self.n == 0 { 0.0 } else { self.centre + self.sums[0] / self.n as f64 }
    }

    /// Unbiased variance s² of one number. NaN below two numbers.
    pub fn variance(&self) -> f64 {
        self.moments().variance()
    }

    /// Count, mean and variance alone.
    pub fn moments(&self) -> Moments {
        Moments::from_sums(self.n, self.mean(), self.central()[0])
    }

    /// m₃/m₂^{3/2} of the central sample moments m_k = Σ (x − mean)^k / n; NaN where nothing varies. Bias of order 1/n.
    pub fn skewness(&self) -> f64 {
        let [second, third, _] = self.central().map(|sum| sum / self.n as f64);
        third / second.powf(1.5)
    }

    /// m₄/m₂²: 3 for normal numbers, at least 1 for any; NaN where nothing varies. Bias of order 1/n, downwards where tails are
    /// heavy, for it is at most n.
    pub fn kurtosis(&self) -> f64 {
        let [second, _, fourth] = self.central();
        self.n as f64 * (fourth / second) / second
    }

    /// Var(s²) = σ⁴ (κ − (n − 3)/(n − 1)) / n with the sample's own variance and kurtosis: 2σ⁴/(n − 1) for normal numbers. NaN
    /// below two numbers.
    ///
    /// The formula is exact for any distribution (Mood, Graybill & Boes 1974, VI.2); the sample's moments in place of the true
    /// ones are off by a relative order of 1/√n, and the worse the heavier the tails: κ settles no sooner than the eighth moment
    /// does.
    pub fn variance_of_variance(&self) -> f64 {
        let n = self.n as f64;
        self.variance().powi(2) * (self.kurtosis() - (n - 3.0) / (n - 1.0)) / n
    }

    /// √([`variance_of_variance`](Self::variance_of_variance)).
    pub fn standard_error_of_variance(&self) -> f64 {
        self.variance_of_variance().sqrt()
    }

    /// Σ (x − mean)^k for k = 2, 3, 4.
    fn central(&self) -> [f64; 3] {
        let [_, second, third, fourth] = self.shifted(-self.sums[0] / self.n as f64);
        [second, third, fourth]
    }

    /// Σ (x − c)^k about another centre c.
    fn sums_about(&self, centre: f64) -> [f64; 4] {
        self.shifted(self.centre - centre)
    }

    /// Σ (x − centre + s)^k by the binomial theorem.
    fn shifted(&self, s: f64) -> [f64; 4] {
        let [first, second, third, fourth] = self.sums;
        let zeroth = self.n as f64 * s;
        [
            first + zeroth,
            second + s * (2.0 * first + zeroth),
            third + s * (3.0 * second + s * (3.0 * first + zeroth)),
            fourth + s * (4.0 * third + s * (6.0 * second + s * (4.0 * first + zeroth))),
        ]
    }
}

impl FromIterator<f64> for HigherMoments {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        let mut moments = Self::default();
        values.into_iter().for_each(|v| moments.push(v));
        moments
    }
}
