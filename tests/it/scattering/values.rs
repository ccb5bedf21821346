//! Surfaces against values computed along independent routes (reference cases, named by their ids).

use super::{direction, direction_of_cosine};
use crate::sphere::gauss;
use etendue::geometry::Vec3;
use etendue::scattering::{
    Brdf, Chandrasekhar, CompensatedConductor, Distribution, LommelSeeliger, Masking, Metal, Microfacets, Phong,
    Plastic, RoughConductor, fresnel,
};
use etendue::stats::special::ln_beta;

/// Half a unit of the last digit given.
fn digits(n: i32) -> f64 {
    0.5 * 10.0_f64.powi(-n)
}

fn ideal(distribution: Distribution, masking: Masking, alpha: f64) -> RoughConductor {
    let facets = Microfacets::new(distribution, masking, [alpha; 2]).unwrap();
    RoughConductor::new(Metal::ideal(vec![1.0]).unwrap(), facets)
}

#[test]
fn ggx_albedos_match_independent_values() {
    // D-GGX-02, 04, 05 (correlated), 07, 09, 10 (separable): E at cosines 1, 0.8, 0.5, 0.2, 0.05, and the mean.
    let cosines = [1.0, 0.8, 0.5, 0.2, 0.05];
    let cases = [
        (
            0.25,
            Masking::Correlated,
            [0.915812430250, 0.897271774053, 0.857263435582, 0.848159951749, 0.933131742610],
            0.8823233826,
        ),
        (
            0.8,
            Masking::Correlated,
            [0.427002200171, 0.460283133188, 0.540134721410, 0.700399408306, 0.873999264876],
            0.5078663633,
        ),
        (
            1.0,
            Masking::Correlated,
            [0.306852819440, 0.351255827027, 0.450693855666, 0.641648106154, 0.847773878114],
            0.4091370926,
        ),
        (
            0.25,
            Masking::Separable,
            [0.915812430250, 0.897032048058, 0.855098534364, 0.831458194423, 0.874581645233],
            0.8794556695,
        ),
        (
            0.8,
            Masking::Separable,
            [0.427002200171, 0.453080122836, 0.509841887763, 0.600512085446, 0.666801502678],
            0.4837146121,
        ),
        (
            1.0,
            Masking::Separable,
            [0.306852819440, 0.340947577156, 0.409137092587, 0.511421365733, 0.584481560838],
            0.3766346112,
        ),
    ];
    for (alpha, masking, albedos, mean) in cases {
        let brdf = ideal(Distribution::Ggx, masking, alpha);
        for (cosine, exact) in cosines.into_iter().zip(albedos) {
            let albedo = brdf.albedo_with_error(0, direction_of_cosine(cosine));
            assert!(
                (albedo.value - exact).abs() < digits(12) + albedo.error,
                "{alpha} {masking:?} {cosine}: {albedo:?}"
            );
            assert!(albedo.error < 1e-10);
        }
        let average: f64 =
            gauss(40).iter().map(|(u, w)| w * 4.0 * u.powi(3) * brdf.albedo(0, direction_of_cosine(u * u))).sum();
        assert!((average - mean).abs() < digits(10) + 1e-11, "{alpha} {masking:?}: mean {average} against {mean}");
    }
    // The same integral at normal incidence by hand: 1 − ln 2 for α = 1.
    let normal = ideal(Distribution::Ggx, Masking::Correlated, 1.0).albedo(0, Vec3::Z);
    assert!((normal - (1.0 - 2.0_f64.ln())).abs() < 1e-14);
}

#[test]
fn brdfs_match_values_at_rational_directions() {
    // D-RECIP-1, 18 digits.
    let cases = [
        (
            [1, 2, 2],
            [-2, 1, 2],
            0.0193199314481651809,
            2.03562403349781414e-17,
            0.0789150435876827699,
            0.0788590126471924723,
        ),
        ([3, 0, 4], [-4, 0, 3], 0.908394166996492292, 1.07494223597517769, 1.21262735315453387, 1.21207211980089117),
        (
            [1, 1, 4],
            [2, -1, 1],
            0.00223339251617624094,
            8.67545625174758715e-27,
            0.0872848331276321456,
            0.0872622218477057755,
        ),
        (
            [0, 0, 1],
            [3, 4, 5],
            0.196944194159366953,
            2.46645720028238221e-7,
            0.198812386646128469,
            0.198812386646128469,
        ),
    ];
    // A cosine's rounding, to the fiftieth power.
    const ROUNDING: f64 = 50.0 * 8.0 * f64::EPSILON;
    let phong = |n| Phong::new(vec![1.0], n).unwrap();
    for (incident, outgoing, phong5, phong50, correlated, separable) in cases {
        let [a, b] = [incident, outgoing].map(|v: [i32; 3]| Vec3::from_array(v.map(f64::from)).normalize());
        let near = |brdf: &dyn Brdf, exact: f64| {
            let f = brdf.eval(0, a, b);
            // cosα = 1 of the mirror direction itself comes back from a subtraction.
            assert!((f / exact - 1.0).abs() < ROUNDING * 4.0, "{}: {f:e} against {exact:e}", brdf.description());
        };
        near(&phong(5.0), phong5);
        near(&phong(50.0), phong50);
        near(&ideal(Distribution::Ggx, Masking::Correlated, 0.3), correlated);
        near(&ideal(Distribution::Ggx, Masking::Separable, 0.3), separable);
    }
}

#[test]
fn clouds_match_independent_values() {
    // D-LS-2, 20 digits.
    let albedo = LommelSeeliger::new(vec![1.0]).unwrap().albedo(0, direction_of_cosine(0.5));
    assert!((albedo - 0.22534692783297257715).abs() < 1e-16);

    // D-HBRDF-2, 14 digits.
    let cloud = Chandrasekhar::new(vec![0.9, 1.0]).unwrap();
    for (cosine, exact) in [(1.0, 0.41494747913082), (0.5, 0.50793890694010), (0.1, 0.62933582073434)] {
        let albedo = cloud.albedo(0, direction_of_cosine(cosine));
        assert!((albedo - exact).abs() < digits(14) + 1e-14, "{cosine}: {albedo}");
    }

    // H satisfies its integral equation 1/H(μ) = √(1 − w) + w/2 ∫ x H(x)/(x + μ) dx; the integrand is smooth in √x.
    for (band, w) in [(0, 0.9_f64), (1, 1.0)] {
        for mu in [0.01, 0.3, 0.77, 1.0] {
            let integral: f64 = gauss(120)
                .iter()
                .map(|(u, weight)| (u.powi(4), weight * 4.0 * u.powi(3)))
                .map(|(x, weight)| weight * x * cloud.h(band, x) / (x + mu))
                .sum();
            let residual = cloud.h(band, mu) * ((1.0 - w).sqrt() + 0.5 * w * integral) - 1.0;
            assert!(residual.abs() < 1e-12, "w = {w}, μ = {mu}: {residual:e}");
        }
    }
}

#[test]
fn white_surfaces_are_furnaces_at_every_angle() {
    let facets = |distribution| Microfacets::new(distribution, Masking::Correlated, [0.5; 2]).unwrap();
    let metal = || Metal::ideal(vec![1.0]).unwrap();
    let white: Vec<Box<dyn Brdf>> = vec![
        Box::new(Chandrasekhar::new(vec![1.0]).unwrap()),
        Box::new(Plastic::new(base(vec![1.0]), vec![1.0]).unwrap()),
        Box::new(CompensatedConductor::new(metal(), facets(Distribution::Ggx)).unwrap()),
        Box::new(CompensatedConductor::new(metal(), facets(Distribution::Beckmann)).unwrap()),
    ];
    for brdf in white {
        for degrees in [0.0, 10.0, 37.0, 60.0, 80.0, 89.0, 89.9] {
            let albedo = brdf.albedo(0, direction(degrees, 0.3));
            // The error asked of the quadratures, of two albedos.
            assert!((albedo - 1.0).abs() < 2e-11, "{} at {degrees}°: {albedo}", brdf.description());
        }
    }
}

fn base(diffuse_reflectance: Vec<f64>) -> etendue::scattering::Base {
    etendue::scattering::Base::polypropylene(diffuse_reflectance).unwrap()
}

/// Walsh's (1926) closed form of the external diffuse reflectance, as Duntley (1942) prints it.
fn walsh(n: f64) -> f64 {
    let (n2, n4) = (n * n, n.powi(4));
    0.5 + (n - 1.0) * (3.0 * n + 1.0) / (6.0 * (n + 1.0).powi(2))
        + n2 * (n2 - 1.0).powi(2) / (n2 + 1.0).powi(3) * ((n - 1.0) / (n + 1.0)).ln()
        - 2.0 * n.powi(3) * (n2 + 2.0 * n - 1.0) / ((n2 + 1.0) * (n4 - 1.0))
        + 8.0 * n4 * (n4 + 1.0) / ((n2 + 1.0) * (n4 - 1.0).powi(2)) * n.ln()
}

#[test]
fn diffuse_fresnel_reflectances_match_the_closed_form() {
    // D-FRES-2, D-FRES-4, 20 digits: external, internal, at the normal.
    let cases = [
        (1.5, 0.091777959342351211664, 0.59634575970771164963, 0.04),
        (2.42, 0.21254079473884214512, 0.86553869181388602983, 0.17239492493416777812),
    ];
    for (n, external, internal, normal) in cases {
        assert!((fresnel::diffuse_reflectance(n) - external).abs() < 1e-14);
        assert!((fresnel::diffuse_reflectance(1.0 / n) - internal).abs() < 1e-14);
        assert!((fresnel::dielectric(1.0, n).reflectance - normal).abs() < 1e-16);
        assert!((fresnel::dielectric(1.0, 1.0 / n).reflectance - normal).abs() < 1e-15);
    }
    for n in [1.1, 1.333, 1.8, 4.0, 20.0, 100.0] {
        // The closed form cancels like (n − 1)⁻².
        let rounding = 1e-14 / (n - 1.0_f64).powi(2).min(1.0);
        let quadrature = fresnel::diffuse_reflectance(n);
        assert!((quadrature - walsh(n)).abs() < rounding, "{n}: {quadrature} against {}", walsh(n));
    }
    // To leading order 2 ∫ F μ dμ = (n − 1)/3.
    let barely = fresnel::diffuse_reflectance(1.0 + 1e-9);
    assert!((barely / 1e-9 * 3.0 - 1.0).abs() < 1e-6, "{barely:e}");
}

#[test]
fn logarithms_of_beta_functions_keep_their_digits() {
    // In 90-digit arithmetic.
    let cases = [
        (1.5, 2.25, -1.4827261013362656836),
        (3.0, 10.0, -6.4922398350204712289),
        (9.75, 1e5, -100.00924489275722727),
        (1.25, 1e30, -86.445212823698526312),
        (12.0, 12.0, -16.602059876016601892),
        (20.5, 4000.0, -129.24640232376213815),
        (9.999, 10.001, -13.736229121870218939),
        (1.0, 1.0, 0.0),
    ];
    for (a, b, exact) in cases {
        for value in [ln_beta(a, b), ln_beta(b, a)] {
            // Absolute in the logarithm is relative in B.
            assert!((value - exact).abs() < 1e-13, "B({a}, {b}): {value} against {exact}");
        }
    }
}

#[test]
fn metals_without_extinction_are_glass() {
    for cosine in [1.0, 0.9, 0.5, 0.1, 1e-3, 0.0] {
        for eta in [0.4, 0.9, 1.2, 1.5, 3.0] {
            let [glass, metal] = [fresnel::dielectric(cosine, eta).reflectance, fresnel::conductor(cosine, eta, 0.0)];
            assert!((glass - metal).abs() < 1e-14, "η = {eta}, cosine {cosine}: {glass} against {metal}");
        }
    }
    // ((η − 1)² + κ²)/((η + 1)² + κ²) at the normal.
    let normal = fresnel::conductor(1.0, 0.2, 3.9);
    assert!((normal - (0.64 + 15.21) / (1.44 + 15.21)).abs() < 1e-15);
}
