//! Rough metal and rough glass against another program and across the interface.

use super::direction_of_cosine;
use crate::sphere::gauss;
use etendue::geometry::Vec3;
use etendue::scattering::{
    Brdf, Distribution, Glass, Masking, Metal, Microfacets, ParameterError, RoughConductor, RoughDielectric,
};

fn unit([x, y, z]: [i32; 3]) -> Vec3 {
    Vec3::new(f64::from(x), f64::from(y), f64::from(z)).normalize()
}

#[test]
fn anisotropic_facets_match_mitsuba() {
    // Mitsuba 3.9.1, `scalar_rgb`: eval over |cosθᵢ|, times n(i)²/n(o)² where light crosses, for basic radiance.
    // Some sixteen roundings of single precision, in which it computes.
    const SINGLE: f64 = 16.0 * f32::EPSILON as f64;
    let facets = Microfacets::new(Distribution::Ggx, Masking::Separable, [0.3, 0.15]).unwrap();
    let metal = RoughConductor::new(Metal::new(vec![0.2], vec![3.9], vec![1.0]).unwrap(), facets);
    let glass = RoughDielectric::new(Glass::clear(1.5, 1.0, 1).unwrap(), facets).unwrap();
    let cases: [(&dyn Brdf, [i32; 3], [i32; 3], f64); 7] = [
        (&metal, [1, 2, 2], [-2, 1, 2], 0.013557996600866318),
        (&metal, [1, 2, 2], [-2, -6, 9], 1.5760246647728813),
        (&glass, [1, 2, 2], [-2, 1, 2], 0.000598147715209052),
        (&glass, [1, 2, 2], [-2, -6, 9], 0.07770612835884094),
        (&glass, [2, 1, 2], [-2, -1, -2], 1.2326340302824974),
        (&glass, [2, -1, -2], [-3, 2, 6], 0.08257992620821353),
        (&glass, [1, 2, -2], [-1, -4, -8], 0.08969645574688911),
    ];
    for (brdf, outgoing, incident, theirs) in cases {
        let ours = brdf.eval(0, unit(incident), unit(outgoing));
        assert!((ours / theirs - 1.0).abs() < SINGLE, "{outgoing:?} {incident:?}: {ours} against {theirs}");
    }
}

/// Étendue that passes from above to below is that which passes from below to above: n² 2 ∫ T μ dμ of both sides. Two quadratures over
/// different facets, one of them with total reflection, that share nothing but the surface.
#[test]
fn as_much_etendue_passes_either_way() {
    // What four times 12 Gauss nodes leave at the bend of T about the critical angle.
    const BEND: f64 = 1e-9;
    let facets = Microfacets::new(Distribution::Beckmann, Masking::Separable, [0.2; 2]).unwrap();
    let glass = Glass::new(1.49, 1.0, vec![0.0], vec![1.0]).unwrap();
    let brdf = RoughDielectric::new(glass, facets).unwrap();
    let [down, up] = [1.0, -1.0].map(|side| {
        let passed = |mu: f64| brdf.albedo(0, direction_of_cosine(side * mu));
        let panel = |k: i32| {
            let nodes = gauss(12).into_iter().map(move |(u, weight)| (0.25 * (f64::from(k) + u), 0.25 * weight));
            nodes.map(|(mu, weight)| 2.0 * weight * mu * passed(mu)).sum::<f64>()
        };
        (0..4).map(panel).sum::<f64>()
    });
    assert!((down / (1.49 * 1.49) / up - 1.0).abs() < BEND, "{down} above, {up} below");
}

#[test]
fn parameters_out_of_range_are_named() {
    let rough = |alpha| Microfacets::new(Distribution::Ggx, Masking::Correlated, alpha);
    let expected = "within [1e-4, 10]";
    let error = ParameterError { brdf: "microfacets", parameter: "alpha_v", value: 0.0, expected };
    assert_eq!(rough([0.1, 0.0]), Err(error.clone()));
    assert_eq!(error.to_string(), "microfacets: alpha_v is 0e0, must be within [1e-4, 10]");
    assert!(rough([f64::NAN, 0.1]).is_err());
    assert!(Metal::new(vec![1.0, 1.0], vec![1.0], vec![1.0, 1.0]).is_err());
    assert!(Metal::new(vec![1.0], vec![-1.0], vec![1.0]).is_err());
    assert!(Metal::ideal(vec![1.5]).is_err());
    assert!(Glass::clear(f64::INFINITY, 1.0, 1).is_err() && Glass::clear(1.5, 0.0, 1).is_err());
    assert!(RoughDielectric::new(Glass::clear(1.2, 1.2, 1).unwrap(), rough([0.1, 0.1]).unwrap()).is_err());
}
