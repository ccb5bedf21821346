//! A rough conductor given back what it loses between facets.

use super::Brdf;
use super::choice::{Choice, choose};
use super::graded_table::GradedTable;

use super::metal::Metal;
use super::microfacet::Microfacets;
use super::parameter::{Examination, ParameterError};
use super::quadrature::{Quadrature, rule};
use super::rough_conductor::{RoughConductor, reflected_albedo};
use crate::geometry::Vec3;
use crate::sampling::warp;
use std::f64::consts::FRAC_1_PI;

/// Kulla & Conty's (2017) rough conductor: [`RoughConductor`] and a smooth lobe of the light that met several facets,
///
/// ```text
/// f = f₁ + κ (1 − E(i_z)) (1 − E(o_z)) / (π (1 − Ē)),      κ = F̄² Ē / (1 − F̄ (1 − Ē)),   F̄ = 2 ∫ F μ dμ
/// ```
///
/// E is the albedo of the facets were they perfect mirrors, Ē = 2 ∫ E μ dμ its mean. Of perfect mirrors (F = 1, κ = 1) it is white at every
/// angle: a rough furnace. Reciprocal; albedo E_F + κ (1 − E) ≤ 1. κ is Fdez-Agüera's (2019) sum over numbers of meetings.
///
/// E is tabulated when the surface is made (some 0.5 s). Samples the facets, or the cosine, by E and 1 − E.
#[derive(Clone, Debug, PartialEq)]
pub struct CompensatedConductor {
    once: RoughConductor,
    /// E
    kept: GradedTable,
    /// Ē
    mean: f64,
    /// κ of each band.
    regained: Vec<f64>,
}

/// Cosines below 2⁻³¹ are on a straight line.
const N_PANELS: usize = 30;
/// The cosine whose E stands for that of 0.
const GRAZING: f64 = 1e-12;

impl CompensatedConductor {
    /// These small mirrors of this metal.
    ///
    /// # Errors
    /// Roughness that differs between the axes.
    pub fn new(metal: Metal, facets: Microfacets) -> Result<Self, ParameterError> {
        let [along, across] = facets.alpha();
        Examination("compensated conductor").within("alpha_v", across, along..=along, "alpha_u")?;
        let albedo = |cosine: f64| reflected_albedo(&facets, warp::around_z(cosine, 0.0).into(), |_| 1.0).value;
        let kept = GradedTable::new(N_PANELS, albedo(GRAZING), albedo);
        let mean = kept.hemispherical_mean();
        let regained = (0..metal.n_bands()).map(|band| {
            let reflected: f64 = rule(2).iter().map(|(u, w)| 2.0 * u * w * metal.reflectance(band, *u)).sum();
            reflected * reflected * mean / (1.0 - reflected * (1.0 - mean))
        });
        let regained = regained.collect();
        Ok(Self { once: RoughConductor::new(metal, facets), kept, mean, regained })
    }

    fn lost(&self, cosine: f64) -> f64 {
        (1.0 - self.kept.at(cosine.min(1.0))).max(0.0)
    }

    /// The directional albedo with the error of its first part.
    pub fn albedo_with_error(&self, band: usize, outgoing: Vec3) -> Quadrature {
        let once = self.once.albedo_with_error(band, outgoing);
        let more = if outgoing.z > 0.0 { self.regained[band] * self.lost(outgoing.z) } else { 0.0 };
        Quadrature { value: once.value + more, error: once.error }
    }

    fn share(&self, outgoing: Vec3) -> f64 {
        self.kept.at(outgoing.z.min(1.0)).clamp(0.1, 0.9)
    }
}

impl Brdf for CompensatedConductor {
    fn n_bands(&self) -> usize {
        self.once.n_bands()
    }

    fn eval(&self, band: usize, incident: Vec3, outgoing: Vec3) -> f64 {
        if incident.z <= 0.0 || outgoing.z <= 0.0 {
            return 0.0;
        }
        let more = self.lost(incident.z) * self.lost(outgoing.z) * FRAC_1_PI / (1.0 - self.mean);
        self.once.eval(band, incident, outgoing) + self.regained[band] * more
    }

    fn sample(&self, outgoing: Vec3, [u, v]: [f64; 2]) -> Option<Vec3> {
        if outgoing.z <= 0.0 {
            return None;
        }
        match choose(self.share(outgoing), u) {
            Choice::First(u) => self.once.sample(outgoing, [u, v]),
            Choice::Second(u) => Some(warp::cosine_hemisphere([u, v]).into()),
        }
    }

    fn pdf(&self, outgoing: Vec3, incident: Vec3) -> f64 {
        if outgoing.z <= 0.0 {
            return 0.0;
        }
        let share = self.share(outgoing);
        let diffuse = warp::cosine_hemisphere_pdf(incident.to_array());
        share * self.once.pdf(outgoing, incident) + (1.0 - share) * diffuse
    }

    fn albedo(&self, band: usize, outgoing: Vec3) -> f64 {
        self.albedo_with_error(band, outgoing).value
    }

    fn lambertian(&self) -> Option<&[f64]> {
        None
    }

    fn description(&self) -> String {
        format!("compensated {}", self.once.description())
    }
}
