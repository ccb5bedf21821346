//! Rough plastic: paint under a clear coat of small facets.

use super::Brdf;
use super::choice::{Choice, choose};
use super::fresnel;
use super::graded_table::GradedTable;
use super::half_vectors::{Rim, integrate};
use super::microfacet::Microfacets;
use super::parameter::{Examination, ParameterError};
use super::plastic::Base;
use super::quadrature::gauss_legendre;
use super::refracting_facets::{self, RefractingFacet};
use super::rough_conductor::{glossy, glossy_pdf, reflected_albedo, sample_glossy};
use crate::geometry::Vec3;
use crate::sampling::warp;
use std::f64::consts::FRAC_1_PI;

/// Facets of a clear coat over a diffuse base of albedo d, Mitsuba 3's `roughplastic`,
///
/// ```text
/// f = F D G₂/(4 i_z o_z) + T(i_z) T(o_z) d / (π η² (1 − d' R))
/// ```
///
/// T(μ) is what the facets let through from outside and R, the mean over the hemisphere, what they reflect from inside, both once and without
/// a second meeting; d' = d where colours saturate (`nonlinear`), else 1. Reciprocal whatever T is. With E what the facets reflect from
/// outside, and 2 ∫ T μ dμ/η² ≤ 1 − R what they let out (étendue is the same both ways),
///
/// ```text
/// albedo = E(o_z) + T(o_z) d (2 ∫ T μ dμ/η²)/(1 − d' R) ≤ E + T ≤ 1
/// ```
///
/// What is lost between facets is absorbed, on the way in, under the coat and on the way out. T is tabulated when the surface is made (up to a
/// second, with R), and the table is the surface. Samples either part by its approximate share.
#[derive(Clone, Debug, PartialEq)]
pub struct RoughPlastic {
    base: Base,
    facets: Microfacets,
    specular_reflectance: Vec<f64>,
    passed: GradedTable,
    /// R
    internal: f64,
    /// 2 ∫ T μ dμ/η²
    let_out: f64,
}

/// Cosines below 2⁻¹² are on a straight line.
const N_PANELS: usize = 12;
/// Nodes of the mean over the hemisphere that is R, which has a bend at the critical angle: right to 1e-5.
const N_INTERNAL: usize = 12;
/// The cosine whose T stands for that of 0.
const GRAZING: f64 = 1e-6;

impl RoughPlastic {
    /// A coat of these facets over this base, and a share (1 where physics is meant) of what they mirror, a value a band.
    ///
    /// # Errors
    /// Roughness that differs between the axes, a share outside [0, 1], different numbers of bands, a coat of relative index 1.
    pub fn new(base: Base, facets: Microfacets, specular_reflectance: Vec<f64>) -> Result<Self, ParameterError> {
        let examine = Examination("roughplastic");
        examine.bands("number of specular_reflectance", specular_reflectance.len(), base.diffuse_reflectance.len())?;
        examine.fractions("specular_reflectance", &specular_reflectance)?;
        examine.within("int_ior/ext_ior", base.relative_index, 1.0 + 1e-6..=1e3, "above 1")?;
        let [along, across] = facets.alpha();
        examine.within("alpha_v", across, along..=along, "alpha_u")?;

        let passed = GradedTable::new(N_PANELS, passed(&facets, base.relative_index, GRAZING), |cosine| {
            passed(&facets, base.relative_index, cosine)
        });
        let let_out = passed.hemispherical_mean() / (base.relative_index * base.relative_index);
        let rule = gauss_legendre(N_INTERNAL);
        let inside = |cosine: f64| returned(&facets, base.relative_index.recip(), cosine);
        let internal: f64 = rule.iter().map(|(u, weight)| weight * 2.0 * u * inside(*u)).sum();
        let internal = internal.min(1.0 - let_out);
        Ok(Self { base, facets, specular_reflectance, passed, internal, let_out })
    }

    fn coat(&self, cosine: f64) -> f64 {
        fresnel::dielectric(cosine.min(1.0), self.base.relative_index).reflectance
    }

    /// Chance that a sample is mirrored.
    fn share(&self, outgoing: Vec3) -> f64 {
        self.base.mirror_share(self.coat(outgoing.z))
    }
}

/// T: the share of light from this cosine that facets of relative index η let through.
fn passed(facets: &Microfacets, eta: f64, cosine: f64) -> f64 {
    let outgoing = Vec3::from(warp::around_z(cosine, 0.0));
    let masked = facets.lambda(outgoing);
    integrate(outgoing, facets.lobe(), Rim::Facing, |facet| {
        let bent = RefractingFacet::new(outgoing, facet.normal, facet.r_squared, eta);
        let visible = facets.joint(facets.lambda(bent.refracted), masked, false);
        let facing = facet.facing / (facet.cosine * outgoing.z);
        facets.slope_density(facet.r_squared) * (1.0 - bent.interface.reflectance) * visible * facing
    })
    .value
}

/// The share of light from this cosine that facets of relative index η reflect to where it came from.
fn returned(facets: &Microfacets, eta: f64, cosine: f64) -> f64 {
    let outgoing = Vec3::from(warp::around_z(cosine, 0.0));
    let masked = facets.lambda(outgoing);
    refracting_facets::integrate(outgoing, facets.lobe(), eta, |facet: &RefractingFacet| {
        if facet.reflected.z <= 0.0 {
            return 0.0;
        }
        let visible = facets.joint(facets.lambda(facet.reflected), masked, true);
        let facing = facet.facing / (facet.cosine * outgoing.z);
        facets.slope_density(facet.r_squared) * facet.interface.reflectance * visible * facing
    })
    .value
}

impl Brdf for RoughPlastic {
    fn n_bands(&self) -> usize {
        self.specular_reflectance.len()
    }

    fn eval(&self, band: usize, incident: Vec3, outgoing: Vec3) -> f64 {
        if incident.z <= 0.0 || outgoing.z <= 0.0 {
            return 0.0;
        }
        let mirrored = glossy(&self.facets, incident, outgoing, |cosine| self.coat(cosine));
        let through = self.passed.at(incident.z.min(1.0)) * self.passed.at(outgoing.z.min(1.0));
        let eta = self.base.relative_index;
        let diffuse = through * self.base.gain(band, self.internal) * FRAC_1_PI / (eta * eta);
        self.specular_reflectance[band] * mirrored + diffuse
    }

    fn sample(&self, outgoing: Vec3, [u, v]: [f64; 2]) -> Option<Vec3> {
        if outgoing.z <= 0.0 {
            return None;
        }
        match choose(self.share(outgoing), u) {
            Choice::First(u) => sample_glossy(&self.facets, outgoing, [u, v]),
            Choice::Second(u) => Some(warp::cosine_hemisphere([u, v]).into()),
        }
    }

    fn pdf(&self, outgoing: Vec3, incident: Vec3) -> f64 {
        if outgoing.z <= 0.0 {
            return 0.0;
        }
        let share = self.share(outgoing);
        let diffuse = warp::cosine_hemisphere_pdf(incident.to_array());
        share * glossy_pdf(&self.facets, outgoing, incident) + (1.0 - share) * diffuse
    }

    fn albedo(&self, band: usize, outgoing: Vec3) -> f64 {
        if outgoing.z <= 0.0 {
            return 0.0;
        }
        let mirrored = reflected_albedo(&self.facets, outgoing, |cosine| self.coat(cosine)).value;
        let base = self.passed.at(outgoing.z.min(1.0)) * self.let_out * self.base.gain(band, self.internal);
        self.specular_reflectance[band] * mirrored + base
    }

    fn lambertian(&self) -> Option<&[f64]> {
        None
    }

    fn description(&self) -> String {
        let (base, facets) = (self.base.description(), self.facets.description());
        format!("roughplastic {base} {facets} specular_reflectance={:?}", self.specular_reflectance)
    }
}
