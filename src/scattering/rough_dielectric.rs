//! Ground glass: small facets that reflect and refract.

use super::Brdf;
use super::choice::{Choice, choose};
use super::fresnel;
use super::glass::Glass;

use super::microfacet::Microfacets;
use super::parameter::{Examination, ParameterError};
use super::quadrature::Quadrature;
use super::refracting_facets::{RefractingFacet, integrate};
use super::rough_conductor::{glossy, glossy_pdf, sample_glossy};
use crate::geometry::Vec3;

/// Walter et al.'s surface of small dielectric facets, Mitsuba 3's `roughdielectric` (there: `distribution` beckmann, `alpha` 0.1, masking
/// separable). In basic radiance, with v = n(i) i + n(o) o and m = ±v/|v| above the horizon,
///
/// ```text
/// same side   f = F D(h) G₂ / (4 |i_z o_z|)
/// crossing    f = n(i)² |i·m| |o·m| (1 − F) D(m) G₂ / (|i_z o_z| |v|²)
/// ```
///
/// What meets a second facet is absorbed. Samples visible normals, and before them whether to reflect, by F of the flat surface kept
/// within [0.1, 0.9]; a facet that reflects totally ends what was to be refracted. Source: Walter et al. 2007, eqs. 19–21.
#[derive(Clone, Debug, PartialEq)]
pub struct RoughDielectric {
    glass: Glass,
    facets: Microfacets,
}

impl RoughDielectric {
    /// Small facets of this glass.
    ///
    /// # Errors
    /// Indices so near one another that nothing is bent.
    pub fn new(glass: Glass, facets: Microfacets) -> Result<Self, ParameterError> {
        let contrast = (glass.relative_index() - 1.0).abs();
        Examination("roughdielectric").within("|int_ior/ext_ior - 1|", contrast, 1e-6..=1e3, "within [1e-6, 1000]")?;
        Ok(Self { glass, facets })
    }

    /// The directional albedo with its error, by quadrature over slopes: some 10 ms, tenfold where the axes' roughness differs.
    pub fn albedo_with_error(&self, band: usize, outgoing: Vec3) -> Quadrature {
        if outgoing.z == 0.0 {
            return Quadrature::ZERO;
        }
        let eta = self.glass.relative_index_from(outgoing);
        let outgoing = lifted(outgoing);
        let masked = self.facets.lambda(outgoing);
        integrate(outgoing, self.facets.lobe(), eta, |facet: &RefractingFacet| {
            let reflectance = facet.interface.reflectance;
            let mut sum = 0.0;
            if facet.reflected.z > 0.0 {
                let visible = self.facets.joint(self.facets.lambda(facet.reflected), masked, true);
                sum += self.glass.reflected(band) * reflectance * visible;
            }
            if reflectance < 1.0 && facet.refracted.z < 0.0 {
                let visible = self.facets.joint(self.facets.lambda(facet.refracted), masked, false);
                sum += self.glass.transmitted(band) * (1.0 - reflectance) * visible;
            }
            self.facets.slope_density(facet.r_squared) * sum * facet.facing / (facet.cosine * outgoing.z)
        })
    }

    /// Chance that a sample is reflected.
    fn share(&self, outgoing: Vec3) -> f64 {
        let eta = self.glass.relative_index_from(outgoing);
        fresnel::dielectric(outgoing.z.abs().min(1.0), eta).reflectance.clamp(0.1, 0.9)
    }

    fn reflected(&self, band: usize, incident: Vec3, outgoing: Vec3) -> f64 {
        let eta = self.glass.relative_index_from(outgoing);
        let fresnel = |cosine| self.glass.reflected(band) * fresnel::dielectric(cosine, eta).reflectance;
        glossy(&self.facets, lifted(incident), lifted(outgoing), fresnel)
    }

    /// f/n(i)², symmetric to the bit: Fresnel's share is that of the upper direction.
    fn crossing(&self, band: usize, incident: Vec3, outgoing: Vec3) -> f64 {
        let Some(bent) = self.bent(incident, outgoing) else { return 0.0 };
        let upper = if outgoing.z > 0.0 { bent.facing_outgoing } else { bent.facing_incident };
        let passed = 1.0 - fresnel::dielectric(upper.min(1.0), self.glass.relative_index()).reflectance;
        let facing = bent.facing_incident * bent.facing_outgoing / (incident.z * outgoing.z).abs();
        let visible = self.facets.density(bent.normal) * self.facets.shadowing(incident, outgoing);
        self.glass.transmitted(band) * passed * facing * visible / bent.length_squared
    }

    /// The facet that bends one direction into the other, if there is one.
    fn bent(&self, incident: Vec3, outgoing: Vec3) -> Option<Bent> {
        let sum = self.index_at(incident) * incident + self.index_at(outgoing) * outgoing;
        let length_squared = sum.length_squared();
        let normal = sum / length_squared.sqrt().copysign(sum.z);
        let facing = |direction: Vec3| direction.dot(normal) * direction.z.signum();
        let (facing_incident, facing_outgoing) = (facing(incident), facing(outgoing));
        (facing_incident > 0.0 && facing_outgoing > 0.0).then_some(Bent {
            normal,
            length_squared,
            facing_incident,
            facing_outgoing,
        })
    }

    /// Refractive index where this direction lies, in units of the index above.
    fn index_at(&self, direction: Vec3) -> f64 {
        if direction.z > 0.0 { 1.0 } else { self.glass.relative_index() }
    }
}

/// The facet between an incident and an outgoing direction on opposite sides.
struct Bent {
    /// Above the horizon.
    normal: Vec3,
    /// |n(i) i + n(o) o|²
    length_squared: f64,
    /// |i·m|
    facing_incident: f64,
    /// |o·m|
    facing_outgoing: f64,
}

impl Brdf for RoughDielectric {
    fn n_bands(&self) -> usize {
        self.glass.n_bands()
    }

    fn eval(&self, band: usize, incident: Vec3, outgoing: Vec3) -> f64 {
        let product = incident.z * outgoing.z;
        if product > 0.0 {
            self.reflected(band, incident, outgoing)
        } else if product < 0.0 {
            let index = self.index_at(incident);
            index * index * self.crossing(band, incident, outgoing)
        } else {
            0.0
        }
    }

    fn sample(&self, outgoing: Vec3, [u, v]: [f64; 2]) -> Option<Vec3> {
        if outgoing.z == 0.0 {
            return None;
        }
        let above = lifted(outgoing);
        let back = |direction: Vec3| if outgoing.z > 0.0 { direction } else { flipped(direction) };
        let normal = match choose(self.share(outgoing), u) {
            Choice::First(u) => return sample_glossy(&self.facets, above, [u, v]).map(back),
            Choice::Second(u) => self.facets.sample_visible(above, [u, v]),
        };
        let facet = RefractingFacet::new(above, normal, 0.0, self.glass.relative_index_from(outgoing));
        let passes = facet.interface.reflectance < 1.0 && facet.refracted.z < 0.0;
        passes.then(|| back(facet.refracted.normalize()))
    }

    fn pdf(&self, outgoing: Vec3, incident: Vec3) -> f64 {
        let product = incident.z * outgoing.z;
        if product > 0.0 {
            self.share(outgoing) * glossy_pdf(&self.facets, lifted(outgoing), lifted(incident))
        } else if product < 0.0 {
            // Density of the normal, times dω_m/dωᵢ = n(i)² |i·m|/|v|².
            let Some(bent) = self.bent(incident, outgoing) else { return 0.0 };
            let index = self.index_at(incident);
            let normal = self.facets.masking(outgoing) * bent.facing_outgoing * self.facets.density(bent.normal);
            let stretch = index * index * bent.facing_incident / bent.length_squared;
            (1.0 - self.share(outgoing)) * normal / outgoing.z.abs() * stretch
        } else {
            0.0
        }
    }

    fn albedo(&self, band: usize, outgoing: Vec3) -> f64 {
        self.albedo_with_error(band, outgoing).value
    }

    fn is_transmissive(&self) -> bool {
        true
    }

    fn relative_index(&self) -> f64 {
        self.glass.relative_index()
    }

    fn lambertian(&self) -> Option<&[f64]> {
        None
    }

    fn description(&self) -> String {
        format!("roughdielectric {} {}", self.glass.description(), self.facets.description())
    }
}

/// The direction itself above the surface, its image in the surface below: the facets are alike from both sides.
fn lifted(direction: Vec3) -> Vec3 {
    if direction.z < 0.0 { flipped(direction) } else { direction }
}

fn flipped(direction: Vec3) -> Vec3 {
    Vec3::new(direction.x, direction.y, -direction.z)
}
