//! Surfaces of small mirrors: how their normals are distributed, and how they hide each other.
//!
//! ```text
//! p = (−m_x/m_z, −m_y/m_z),   r² = (p_x/α_x)² + (p_y/α_y)²          slope of the small normal m
//! GGX        P(p) = 1/(π α_x α_y (1 + r²)²)      Λ = (√(1 + 1/a²) − 1)/2
//! Beckmann   P(p) = exp(−r²)/(π α_x α_y)         Λ = (erf a − 1)/2 + exp(−a²)/(2a√π)
//! D(m) = P/m_z⁴,   a = z/√(α_x² x² + α_y² y²),   G₁ = 1/(1 + Λ),   ∫ D G₁ (o·m)₊ dω = o_z
//! ```
//!
//! Smith's masking, for heights that are correlated (of light that leaves on the side it came from, 1/(1 + Λᵢ + Λₒ); of light that crosses,
//! B(1 + Λᵢ, 1 + Λₒ)) or not (G₁G₁). Light that meets a second facet is counted as lost: it is absorbed, never given back.
//!
//! Sources: Walter et al. 2007; Heitz 2014 (eqs. 72, 80, 98, 99); Heitz et al. 2016 (eq. 5 of the crossing heights); Dupuy & Benyoub 2023
//! (sampling GGX by spherical caps); Heitz & d'Eon 2014 (sampling Beckmann by slopes).

use super::graded_table::GradedTable;
use super::half_vectors::{Lobe, Tail};
use super::parameter::{Examination, ParameterError};
use crate::geometry::Vec3;
use crate::stats::special::{complementary_error_function, ln_beta};
use std::f64::consts::{PI, TAU};
use std::sync::LazyLock;

/// The distribution of normals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distribution {
    /// Gaussian slopes.
    Beckmann,
    /// Trowbridge & Reitz: the normals of an ellipsoid, with longer tails.
    Ggx,
}

/// How masking and shadowing go together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Masking {
    /// By the height of the facet, which both depend on: what the distribution implies.
    Correlated,
    /// As if independent, G₁G₁: Mitsuba's, somewhat darker.
    Separable,
}

/// A distribution of small mirrors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Microfacets {
    distribution: Distribution,
    masking: Masking,
    alpha: [f64; 2],
}

/// The least roughness; what is smoother is a mirror.
const MIN_ALPHA: f64 = 1e-4;
/// Slopes beyond this many α have probability exp(−6.5²) < 1e-18 under Gaussian slopes.
pub(super) const GAUSSIAN_REACH: f64 = 6.5;

/// Beyond this a, Beckmann's Λ is below the rounding of the 1 it is added to.
const SHALLOW: f64 = 6.0;
/// exp(a²) erfc(a) at a/6.
static SCALED_COMPLEMENT: LazyLock<GradedTable> = LazyLock::new(|| {
    GradedTable::new(30, 1.0, |x| {
        let a = SHALLOW * x;
        (a * a).exp() * complementary_error_function(a)
    })
});

/// erfc(a), a ≥ 0, to 1e-16.
fn complement(a: f64) -> f64 {
    if a < SHALLOW { (-a * a).exp() * SCALED_COMPLEMENT.at(a / SHALLOW) } else { 0.0 }
}

impl Microfacets {
    /// Roughness α along the local x and y axes.
    ///
    /// # Errors
    /// A roughness outside [1e-4, 10].
    pub fn new(distribution: Distribution, masking: Masking, alpha: [f64; 2]) -> Result<Self, ParameterError> {
        for (name, value) in ["alpha_u", "alpha_v"].into_iter().zip(alpha) {
            Examination("microfacets").within(name, value, MIN_ALPHA..=10.0, "within [1e-4, 10]")?;
        }
        Ok(Self { distribution, masking, alpha })
    }

    /// The same roughness along both axes, masking as in Mitsuba.
    ///
    /// # Errors
    /// A roughness outside [1e-4, 10].
    pub fn isotropic(distribution: Distribution, alpha: f64) -> Result<Self, ParameterError> {
        Self::new(distribution, Masking::Separable, [alpha; 2])
    }

    /// Roughness along x and y.
    pub fn alpha(&self) -> [f64; 2] {
        self.alpha
    }

    /// Whether turning the surface about its normal changes nothing.
    pub fn is_isotropic(&self) -> bool {
        self.alpha[0] == self.alpha[1]
    }

    /// D(m), sr⁻¹; zero for normals below the horizon.
    pub fn density(&self, normal: Vec3) -> f64 {
        if normal.z <= 0.0 {
            return 0.0;
        }
        let [ax, ay] = self.alpha;
        let (x, y) = (normal.x / ax, normal.y / ay);
        let (across, along) = (x * x + y * y, normal.z * normal.z);
        match self.distribution {
            Distribution::Ggx => 1.0 / (PI * ax * ay * (along + across) * (along + across)),
            Distribution::Beckmann => (-across / along).exp() / (PI * ax * ay * along * along),
        }
    }

    /// P of a slope by its r².
    pub(super) fn slope_density(&self, r_squared: f64) -> f64 {
        let fall = match self.distribution {
            Distribution::Ggx => 1.0 / ((1.0 + r_squared) * (1.0 + r_squared)),
            Distribution::Beckmann => (-r_squared).exp(),
        };
        fall / (PI * self.alpha[0] * self.alpha[1])
    }

    /// The lobe of half vectors, for its quadrature.
    pub(super) fn lobe(&self) -> Lobe {
        let tail = match self.distribution {
            Distribution::Ggx => Tail::Algebraic,
            Distribution::Beckmann => Tail::Gaussian,
        };
        (self.alpha, tail)
    }

    /// Smith's Λ of a direction on either side: hidden over visible area of the facets that face it.
    pub fn lambda(&self, direction: Vec3) -> f64 {
        let z = direction.z.abs();
        let across = (self.alpha[0] * direction.x).hypot(self.alpha[1] * direction.y);
        match self.distribution {
            Distribution::Ggx if across == 0.0 => 0.0,
            Distribution::Ggx => 0.5 * across / z * (across / (z + z.hypot(across))),
            Distribution::Beckmann => {
                let a = z / across;
                if a >= SHALLOW {
                    return 0.0;
                }
                let scaled = SCALED_COMPLEMENT.at(a / SHALLOW);
                0.5 * (-a * a).exp() * (1.0 / (a * PI.sqrt()) - scaled).max(0.0)
            }
        }
    }

    /// G₁: the visible share of the facets that face a direction.
    pub fn masking(&self, direction: Vec3) -> f64 {
        1.0 / (1.0 + self.lambda(direction))
    }

    /// G₂: the share of facets that both directions see, where each is on the facet's proper side. Symmetric to the bit.
    pub fn shadowing(&self, incident: Vec3, outgoing: Vec3) -> f64 {
        self.joint(self.lambda(incident), self.lambda(outgoing), (incident.z > 0.0) == (outgoing.z > 0.0))
    }

    /// G₂ from both Λ.
    pub(super) fn joint(&self, first: f64, second: f64, same_side: bool) -> f64 {
        match self.masking {
            Masking::Separable => 1.0 / ((1.0 + first) * (1.0 + second)),
            Masking::Correlated if same_side => 1.0 / (1.0 + (first + second)),
            Masking::Correlated if first + second < f64::MAX => ln_beta(1.0 + first, 1.0 + second).exp(),
            Masking::Correlated => 0.0,
        }
    }

    /// Density of the normals a direction above the horizon sees, D G₁ (o·m)₊/o_z, sr⁻¹: that of [`Microfacets::sample_visible`].
    pub fn visible_density(&self, direction: Vec3, normal: Vec3) -> f64 {
        let facing = direction.dot(normal);
        if facing <= 0.0 || direction.z <= 0.0 {
            return 0.0;
        }
        self.masking(direction) * facing * self.density(normal) / direction.z
    }

    /// A normal as this direction (above the horizon) sees them, from two numbers uniform in [0, 1).
    pub fn sample_visible(&self, direction: Vec3, uniform: [f64; 2]) -> Vec3 {
        let [ax, ay] = self.alpha;
        let stretched = Vec3::new(ax * direction.x, ay * direction.y, direction.z).normalize();
        let seen = match self.distribution {
            Distribution::Ggx => {
                // A point of the spherical cap that the unit hemisphere's mirror images of the direction fill.
                let [u, v] = uniform;
                let z = (1.0 - v) * (1.0 + stretched.z) - stretched.z;
                let sine = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
                let (sin, cos) = (TAU * u).sin_cos();
                Vec3::new(sine * cos, sine * sin, z) + stretched
            }
            Distribution::Beckmann => {
                // A slope along the direction's azimuth, weighed by how it faces it, and one across it.
                let sine = stretched.x.hypot(stretched.y);
                let (cos, sin) = if sine > 0.0 { (stretched.x / sine, stretched.y / sine) } else { (1.0, 0.0) };
                let along = visible_slope(stretched.z, sine, uniform[0]);
                let across = visible_slope(1.0, 0.0, uniform[1]);
                Vec3::new(-(cos * along - sin * across), -(sin * along + cos * across), 1.0)
            }
        };
        Vec3::new(ax * seen.x, ay * seen.y, seen.z.max(0.0)).normalize()
    }

    /// What it is, for a BRDF's description.
    pub(super) fn description(&self) -> String {
        let Self { distribution, masking, alpha } = self;
        format!("distribution={distribution:?} masking={masking:?} alpha={alpha:?}")
    }
}

/// A slope p with density ∝ (c − s p)₊ exp(−p²), by inverting its distribution function
///
/// ```text
/// N(p) = c √π/2 (1 + erf p) + s/2 exp(−p²)
/// ```
///
/// with Newton's method, kept within a bracket. Some ten error functions.
fn visible_slope(cosine: f64, sine: f64, uniform: f64) -> f64 {
    let distribution = |p: f64| {
        let below = if p < 0.0 { complement(-p) } else { 2.0 - complement(p) };
        0.5 * (cosine * PI.sqrt() * below + sine * (-p * p).exp())
    };
    let mut low = -GAUSSIAN_REACH;
    let mut high = if sine > 0.0 { (cosine / sine).min(GAUSSIAN_REACH) } else { GAUSSIAN_REACH };
    let target = uniform * distribution(high);
    let mut slope = (0.5 * (low + high)).max(high - 1.5).min(high);
    for _ in 0..60 {
        let excess = distribution(slope) - target;
        if excess > 0.0 {
            high = slope;
        } else {
            low = slope;
        }
        let step = excess / ((cosine - sine * slope) * (-slope * slope).exp());
        let next = slope - step;
        slope = if (low..=high).contains(&next) { next } else { 0.5 * (low + high) };
        if (high - low).min(step.abs()) < 1e-12 {
            break;
        }
    }
    slope
}
