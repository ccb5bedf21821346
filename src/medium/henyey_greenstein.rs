//! The one-parameter phase function of haze, tissue and interstellar dust.

use super::Phase;
use crate::geometry::Vec3;
use crate::sampling::warp;
use std::f64::consts::PI;
use thiserror::Error;

/// Henyey & Greenstein (1941), with asymmetry a in (−1, 1):
///
/// ```text
/// p(θ) = (1 − a²) / (4π (1 + a² − 2 a cosθ)^{3/2})
/// ```
///
/// The asymmetry is the mean cosine: positive scatters forward, negative back, 0 is isotropic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HenyeyGreenstein {
    asymmetry: f64,
}

/// An asymmetry that makes no density.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum HenyeyGreensteinError {
    #[error("the asymmetry is {asymmetry:e}, must lie strictly between -1 and 1")]
    Asymmetry { asymmetry: f64 },
}

impl HenyeyGreenstein {
    /// # Errors
    /// An asymmetry that is not strictly between −1 and 1.
    pub fn new(asymmetry: f64) -> Result<Self, HenyeyGreensteinError> {
        if asymmetry.abs() < 1.0 { Ok(Self { asymmetry }) } else { Err(HenyeyGreensteinError::Asymmetry { asymmetry }) }
    }
}

impl Phase for HenyeyGreenstein {
    /// Takes 1 − |cosθ| from the chord between the directions, which keeps its digits in the peak: for a ≥ 0,
    /// 1 + a² − 2a cosθ = (1 − a)² + a |incident + outgoing|².
    fn eval(&self, incident: Vec3, outgoing: Vec3) -> f64 {
        let a = self.asymmetry.abs();
        let chord = if self.asymmetry >= 0.0 { incident + outgoing } else { incident - outgoing };
        let denominator = (1.0 - a) * (1.0 - a) + a * chord.length_squared();
        (1.0 - a) * (1.0 + a) / (4.0 * PI * denominator * denominator.sqrt())
    }

    /// Inverts the distribution of cosθ, which in t = 1 − 2u is a ratio of polynomials in a and t, without the usual division by a.
    fn sample(&self, outgoing: Vec3, uniform: [f64; 2]) -> Vec3 {
        let a = self.asymmetry;
        let t = 1.0 - 2.0 * uniform[0];
        let cosine =
            (t * (2.0 + 2.0 * a * a) + a * (3.0 + t * t) - a * a * a * (1.0 - t * t)) / (2.0 * (1.0 + a * t).powi(2));
        let [x, y, z] = warp::around_z(cosine.clamp(-1.0, 1.0), uniform[1]);

        // Turn the pole onto the direction of light that goes straight on.
        let axis = -outgoing;
        let (right, up) = axis.any_orthonormal_pair();
        (x * right + y * up + z * axis).normalize()
    }

    fn pdf(&self, outgoing: Vec3, incident: Vec3) -> f64 {
        self.eval(incident, outgoing)
    }

    fn mean_cosine(&self) -> f64 {
        self.asymmetry
    }

    fn description(&self) -> String {
        format!("henyey-greenstein asymmetry={:?}", self.asymmetry)
    }
}
