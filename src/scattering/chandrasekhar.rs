//! The exact reflection of a deep cloud that scatters alike in all directions.

use super::Brdf;
use super::graded_table::GradedTable;
use super::parameter::{Examination, ParameterError};
use super::quadrature::{Rule, gauss_legendre};
use crate::geometry::Vec3;
use crate::sampling::warp;
use std::f64::consts::{FRAC_PI_2, PI};

/// The BRDF of a semi-infinite medium of isotropic scattering with single-scattering albedo w,
///
/// ```text
/// f = w/(4π) H(i_z) H(o_z)/(i_z + o_z),      directional albedo 1 − H(o_z) √(1 − w)
/// ```
///
/// with Chandrasekhar's H function. For w = 1 it is not Lambertian and yet white at every angle: the glossy furnace. Reciprocal.
///
/// H is tabulated when the surface is made (some 30 ms a band) from its explicit form
///
/// ```text
/// ln H(μ) = −(μ/π) ∫₀^{π/2} ln(1 − w θ cotθ) / (cos²θ + μ² sin²θ) dθ
/// ```
///
/// with sinh-graded Gauss nodes, to a relative error below 1e-13. Samples the cosine. Sources: Chandrasekhar 1960, §§33–34 and 47;
/// Stibbs & Weir 1959.
#[derive(Clone, Debug, PartialEq)]
pub struct Chandrasekhar {
    single_scattering_albedo: Vec<f64>,
    h: Vec<GradedTable>,
}

/// Cosines below 2⁻⁵⁰ are as good as 0: H − 1 is linear there to rounding.
const N_PANELS: usize = 50;

impl Chandrasekhar {
    /// One single-scattering albedo a band.
    ///
    /// # Errors
    /// An albedo outside [0, 1].
    pub fn new(single_scattering_albedo: Vec<f64>) -> Result<Self, ParameterError> {
        Examination("chandrasekhar").fractions("single_scattering_albedo", &single_scattering_albedo)?;
        let rule = gauss_legendre(40);
        let table = |w: &f64| GradedTable::new(N_PANELS, 1.0, |cosine| h_function(*w, cosine, &rule));
        let h = single_scattering_albedo.iter().map(table).collect();
        Ok(Self { single_scattering_albedo, h })
    }

    /// H(μ) in a band, for μ in [0, 1].
    pub fn h(&self, band: usize, cosine: f64) -> f64 {
        self.h[band].at(cosine)
    }
}

/// H by quadrature. The integrand peaks at π/2 with width μ and, for w → 1, has a logarithm at 0; panels shrink towards both.
fn h_function(w: f64, cosine: f64, rule: &Rule) -> f64 {
    // 1 − w θ cotθ without cancellation at small θ, where θ cotθ = 1 − θ²/3 − θ⁴/45 − 2θ⁶/945 − θ⁸/4725 − ….
    let loss = |theta: f64| {
        let square = theta * theta;
        let bent = if theta < 0.05 {
            square * (1.0 / 3.0 + square * (1.0 / 45.0 + square * (2.0 / 945.0 + square / 4725.0)))
        } else {
            1.0 - theta / theta.tan()
        };
        (1.0 - w) + w * bent
    };
    // From π/4 down to 0, halving; from π/4 up to π/2 in φ = π/2 − θ, where tanφ = μ sinh-like: φ halves as far down as μ.
    let panels = |smallest: f64| {
        let mut edges = vec![0.5 * FRAC_PI_2];
        while edges[edges.len() - 1] > smallest {
            edges.push(0.5 * edges[edges.len() - 1]);
        }
        edges.push(0.0);
        edges
    };
    let integrate = |edges: &[f64], f: &dyn Fn(f64) -> f64| -> f64 {
        let pairs = edges.windows(2).map(|pair| (pair[1], pair[0]));
        pairs.map(|(a, b)| rule.iter().map(|(u, weight)| (b - a) * weight * f(a + (b - a) * u)).sum::<f64>()).sum()
    };
    let low = integrate(&panels(1e-9), &|theta: f64| {
        let (sin, cos) = theta.sin_cos();
        loss(theta).ln() / (cos * cos + cosine * cosine * sin * sin)
    });
    let high = integrate(&panels(0.25 * cosine), &|angle: f64| {
        let (sin, cos) = angle.sin_cos();
        let lost = 1.0 - w * (FRAC_PI_2 - angle) * sin / cos;
        lost.ln() / (sin * sin + cosine * cosine * cos * cos)
    });
    (-cosine / PI * (low + high)).exp()
}

impl Brdf for Chandrasekhar {
    fn n_bands(&self) -> usize {
        self.single_scattering_albedo.len()
    }

    fn eval(&self, band: usize, incident: Vec3, outgoing: Vec3) -> f64 {
        if incident.z <= 0.0 || outgoing.z <= 0.0 {
            return 0.0;
        }
        let [first, second] = [incident.z, outgoing.z].map(|cosine| self.h(band, cosine.min(1.0)));
        self.single_scattering_albedo[band] / (4.0 * PI) * (first * second) / (incident.z + outgoing.z)
    }

    fn sample(&self, outgoing: Vec3, uniform: [f64; 2]) -> Option<Vec3> {
        (outgoing.z > 0.0).then(|| warp::cosine_hemisphere(uniform).into())
    }

    fn pdf(&self, outgoing: Vec3, incident: Vec3) -> f64 {
        if outgoing.z > 0.0 { warp::cosine_hemisphere_pdf(incident.to_array()) } else { 0.0 }
    }

    fn albedo(&self, band: usize, outgoing: Vec3) -> f64 {
        if outgoing.z <= 0.0 {
            return 0.0;
        }
        let w = self.single_scattering_albedo[band];
        (1.0 - self.h(band, outgoing.z.min(1.0)) * (1.0 - w).sqrt()).max(0.0)
    }

    fn lambertian(&self) -> Option<&[f64]> {
        None
    }

    fn description(&self) -> String {
        format!("chandrasekhar single_scattering_albedo={:?}", self.single_scattering_albedo)
    }
}
