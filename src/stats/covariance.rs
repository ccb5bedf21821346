//! Running covariance of two streams, and the mean of one of them with the other as its control variate.

use super::Moments;
use serde::Serialize;

/// Count and sums of the powers uⁱ vʲ of pairs' deviations from a centre beside their means, for i, j up to 2 and i = 3 (Pébay
/// 2008), updated without cancellation.
///
/// Merging in a fixed order gives the same bits whoever computed the parts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Covariance {
    n: u64,
    /// The means as far as an f64 can hold them; what is left over is in the first sums.
    centre: [f64; 2],
    sums: CoMoments,
}

/// Σ uⁱ vʲ of the deviations u, v from some centre.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
struct CoMoments {
    u: f64,
    v: f64,
    uu: f64,
    uv: f64,
    vv: f64,
    uuu: f64,
    uuv: f64,
    uvv: f64,
    uuvv: f64,
}

/// A mean with its control variate taken out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ControlledMean {
    /// mean y − c (mean x − E x).
    pub mean: f64,
    pub variance_of_mean: f64,
    /// c.
    pub coefficient: f64,
    /// The bias that fitting c to the same sample leaves, to leading order 1/n, as the sample estimates it; 0 for a given c.
    pub leading_bias: f64,
}

impl Covariance {
    /// Adds a pair.
    pub fn push(&mut self, x: f64, y: f64) {
        self.merge(&Self { n: 1, centre: [x, y], sums: CoMoments::default() });
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
        let share = other.n as f64 / n as f64;
        let (mine, theirs) = (self.means(), other.means());
        let centre = [0, 1].map(|k| mine[k] + (theirs[k] - mine[k]) * share);
        *self = Self { n, centre, sums: self.sums_about(centre).plus(&other.sums_about(centre)) };
    }

    /// Takes the sample as one of `n` pairs, those not pushed being (0, 0).
    pub fn pad_with_zeros(&mut self, n: u64) {
        self.merge(&Self { n: n.saturating_sub(self.n), ..Self::default() });
    }

    /// How many pairs.
    pub fn n(&self) -> u64 {
        self.n
    }

    /// The first numbers' moments.
    pub fn x(&self) -> Moments {
        Moments::from_sums(self.n, self.means()[0], self.central().uu)
    }

    /// The second numbers' moments.
    pub fn y(&self) -> Moments {
        Moments::from_sums(self.n, self.means()[1], self.central().vv)
    }

    /// Unbiased covariance, Σ (x − mean x)(y − mean y) / (n − 1). NaN below two pairs.
    pub fn covariance(&self) -> f64 {
        if self.n < 2 { f64::NAN } else { self.central().uv / (self.n - 1) as f64 }
    }

    /// Pearson's correlation coefficient; NaN where either does not vary. Bias of order 1/n.
    pub fn correlation(&self) -> f64 {
        let CoMoments { uu, uv, vv, .. } = self.central();
        (uv / uu.sqrt() / vv.sqrt()).clamp(-1.0, 1.0)
    }

    /// Variance of [`covariance`](Self::covariance): (μ₂₂ − μ₁₁²)/n + (μ₂₀μ₀₂ + μ₁₁²)/(n (n − 1)), with the sample's own moments
    /// for the true ones. NaN below two pairs. The formula is exact for any distribution (Kendall & Stuart, 13.2), the plug-in to
    /// a relative order of 1/√n.
    pub fn variance_of_covariance(&self) -> f64 {
        if self.n < 2 {
            return f64::NAN;
        }
        let n = self.n as f64;
        let CoMoments { uu, uv, vv, uuvv, .. } = self.central();
        let [product, square] = [uu * vv, uv * uv].map(|sum| sum / (n * n));
        (uuvv / n - square) / n + (product + square) / (n * (n - 1.0))
    }

    /// cov(x, y)/var(x), the coefficient that takes most variance out of y − c x; 0 where x does not vary.
    pub fn control_coefficient(&self) -> f64 {
        let CoMoments { uu, uv, .. } = self.central();
        if uu == 0.0 { 0.0 } else { uv / uu }
    }

    /// Mean of y with x as control variate, whose expectation is known, and a coefficient that this sample had no part in: from a
    /// pilot, or from theory.
    ///
    /// Unbiased for every coefficient, and so is its variance, which is known down to 1e-16 of that of y.
    pub fn controlled_mean(&self, expectation_of_x: f64, coefficient: f64) -> ControlledMean {
        let c = coefficient;
        let n = self.n as f64;
        let CoMoments { uu, uv, vv, .. } = self.central();
        let squares = (vv - c * (2.0 * uv - c * uu)).max(0.0);
        let [mean_x, mean_y] = self.means();
        let variance_of_mean = if self.n < 2 { f64::NAN } else { squares / (n - 1.0) / n };
        ControlledMean {
            mean: mean_y - c * (mean_x - expectation_of_x),
            variance_of_mean,
            coefficient,
            leading_bias: 0.0,
        }
    }

    /// The same with the [coefficient](Self::control_coefficient) of this very sample: the regression of y on x, read off at E x.
    ///
    /// The coefficient knows the sample, which costs a bias of −E[(x − E x)² ε] / (n var x) to leading order, ε being what x does
    /// not explain of y (Lavenberg & Welch 1981): none where y is linear in x but for independent noise, and next to nothing at
    /// large n, for the error bar falls as 1/√n only. The variance is that of regression,
    /// Σ ε²/(n − 2) · (1/n + (mean x − E x)²/Σ (x − mean x)²): exact for normal pairs, elsewhere to a relative order of 1/n. NaN
    /// below three pairs.
    pub fn self_controlled_mean(&self, expectation_of_x: f64) -> ControlledMean {
        let c = self.control_coefficient();
        let n = self.n as f64;
        let plain = self.controlled_mean(expectation_of_x, c);
        if self.n < 3 {
            return ControlledMean { variance_of_mean: f64::NAN, leading_bias: f64::NAN, ..plain };
        }
        let CoMoments { uu, uuu, uuv, .. } = self.central();
        if uu == 0.0 {
            return plain;
        }
        let squares = plain.variance_of_mean * n * (n - 1.0);
        let off = self.means()[0] - expectation_of_x;
        ControlledMean {
            variance_of_mean: squares / (n - 2.0) * (1.0 / n + off * off / uu),
            leading_bias: -(uuv - c * uuu) / uu / n,
            ..plain
        }
    }

    fn means(&self) -> [f64; 2] {
        let n = self.n.max(1) as f64;
        [self.centre[0] + self.sums.u / n, self.centre[1] + self.sums.v / n]
    }

    /// The sums about the means.
    fn central(&self) -> CoMoments {
        let n = self.n as f64;
        self.sums.shifted(n, [-self.sums.u / n, -self.sums.v / n])
    }

    fn sums_about(&self, centre: [f64; 2]) -> CoMoments {
        self.sums.shifted(self.n as f64, [self.centre[0] - centre[0], self.centre[1] - centre[1]])
    }
}

impl CoMoments {
    /// Σ (u + s)ⁱ (v + t)ʲ over n pairs, by the binomial theorem.
    fn shifted(&self, n: f64, [s, t]: [f64; 2]) -> Self {
        let Self { u, v, uu, uv, vv, uuu, uuv, uvv, uuvv } = *self;
        Self {
            u: u + n * s,
            v: v + n * t,
            uu: uu + s * (2.0 * u + n * s),
            uv: uv + s * v + t * u + n * s * t,
            vv: vv + t * (2.0 * v + n * t),
            uuu: uuu + s * (3.0 * uu + s * (3.0 * u + n * s)),
            uuv: uuv + t * uu + s * (2.0 * uv + s * v + t * (2.0 * u + n * s)),
            uvv: uvv + s * vv + t * (2.0 * uv + t * u + s * (2.0 * v + n * t)),
            uuvv: uuvv
                + 2.0 * (t * uuv + s * uvv + s * t * (s * v + t * u))
                + t * t * uu
                + 4.0 * s * t * uv
                + s * s * (vv + n * t * t),
        }
    }

    fn plus(&self, other: &Self) -> Self {
        Self {
            u: self.u + other.u,
            v: self.v + other.v,
            uu: self.uu + other.uu,
            uv: self.uv + other.uv,
            vv: self.vv + other.vv,
            uuu: self.uuu + other.uuu,
            uuv: self.uuv + other.uuv,
            uvv: self.uvv + other.uvv,
            uuvv: self.uuvv + other.uuvv,
        }
    }
}

impl FromIterator<(f64, f64)> for Covariance {
    fn from_iter<I: IntoIterator<Item = (f64, f64)>>(pairs: I) -> Self {
        let mut covariance = Self::default();
        pairs.into_iter().for_each(|(x, y)| covariance.push(x, y));
        covariance
    }
}
