//! The rough conductor: small mirrors of metal.

use super::Brdf;
use super::half_vectors::{Rim, integrate};
use super::metal::Metal;
use super::microfacet::Microfacets;
use super::quadrature::Quadrature;
use crate::geometry::Vec3;

/// Torrance & Sparrow's surface of metal,
///
/// ```text
/// f = F(o·h) D(h) G₂(i, o) / (4 i_z o_z),      h = (i + o)/|i + o|
/// ```
///
/// Mitsuba 3's `roughconductor` (there: `distribution` beckmann, `alpha` 0.1, masking separable). Samples visible normals and mirrors at
/// them. What meets a second facet is absorbed. Source: Walter et al. 2007, eq. 20.
#[derive(Clone, Debug, PartialEq)]
pub struct RoughConductor {
    metal: Metal,
    facets: Microfacets,
}

impl RoughConductor {
    /// These small mirrors of this metal.
    pub fn new(metal: Metal, facets: Microfacets) -> Self {
        Self { metal, facets }
    }

    /// The directional albedo with its error, by quadrature over slopes (some 100 µs).
    pub fn albedo_with_error(&self, band: usize, outgoing: Vec3) -> Quadrature {
        if outgoing.z <= 0.0 {
            return Quadrature::ZERO;
        }
        reflected_albedo(&self.facets, outgoing, |cosine| self.metal.reflectance(band, cosine))
    }
}

impl Brdf for RoughConductor {
    fn n_bands(&self) -> usize {
        self.metal.n_bands()
    }

    fn eval(&self, band: usize, incident: Vec3, outgoing: Vec3) -> f64 {
        glossy(&self.facets, incident, outgoing, |cosine| self.metal.reflectance(band, cosine))
    }

    fn sample(&self, outgoing: Vec3, uniform: [f64; 2]) -> Option<Vec3> {
        sample_glossy(&self.facets, outgoing, uniform)
    }

    fn pdf(&self, outgoing: Vec3, incident: Vec3) -> f64 {
        glossy_pdf(&self.facets, outgoing, incident)
    }

    fn albedo(&self, band: usize, outgoing: Vec3) -> f64 {
        self.albedo_with_error(band, outgoing).value
    }

    fn lambertian(&self) -> Option<&[f64]> {
        None
    }

    fn description(&self) -> String {
        format!("roughconductor {} {}", self.metal.description(), self.facets.description())
    }
}

/// F D G₂/(4 i_z o_z) above the horizon, symmetric to the bit: o·h is half the length of i + o.
pub(super) fn glossy(facets: &Microfacets, incident: Vec3, outgoing: Vec3, fresnel: impl Fn(f64) -> f64) -> f64 {
    if incident.z <= 0.0 || outgoing.z <= 0.0 {
        return 0.0;
    }
    let sum = incident + outgoing;
    let length = sum.length();
    let density = facets.density(sum / length);
    if density == 0.0 {
        return 0.0;
    }
    fresnel((0.5 * length).min(1.0)) * density * facets.shadowing(incident, outgoing)
        / (4.0 * (incident.z * outgoing.z))
}

/// Mirrors at a visible normal.
pub(super) fn sample_glossy(facets: &Microfacets, outgoing: Vec3, uniform: [f64; 2]) -> Option<Vec3> {
    if outgoing.z <= 0.0 {
        return None;
    }
    let normal = facets.sample_visible(outgoing, uniform);
    let incident = (2.0 * outgoing.dot(normal) * normal - outgoing).normalize();
    (incident.z > 0.0).then_some(incident)
}

/// Density of [`sample_glossy`]: that of the normals over 4 (o·h).
pub(super) fn glossy_pdf(facets: &Microfacets, outgoing: Vec3, incident: Vec3) -> f64 {
    if incident.z <= 0.0 || outgoing.z <= 0.0 {
        return 0.0;
    }
    let sum = incident + outgoing;
    let normal = sum / sum.length();
    facets.masking(outgoing) * facets.density(normal) / (4.0 * outgoing.z)
}

/// ∫ F D G₂/(4 i_z o_z) i_z dωᵢ = ∫ P(p) F G₂ (o_z − o_xy·p)/o_z dp.
pub(super) fn reflected_albedo(facets: &Microfacets, outgoing: Vec3, fresnel: impl Fn(f64) -> f64) -> Quadrature {
    let masked = facets.lambda(outgoing);
    integrate(outgoing, facets.lobe(), Rim::Mirrored, |facet| {
        let visible = facets.joint(facets.lambda(facet.incident), masked, true);
        let facing = facet.facing / (facet.cosine * outgoing.z);
        facets.slope_density(facet.r_squared) * fresnel(facet.facing.min(1.0)) * visible * facing
    })
}
