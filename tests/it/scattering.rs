//! Every BRDF × every law.

use crate::sphere::{Cells, gauss, test_sampler};
use etendue::geometry::Vec3;
use etendue::sampling::{Streams, warp};
use etendue::scattering::{Brdf, Lambert, Phong, PhongError};
use etendue::stats::sidak_level;
use std::f64::consts::TAU;

/// Family-wise significance of the random tests of this file.
const SIGNIFICANCE: f64 = 1e-6;

fn brdfs() -> Vec<Box<dyn Brdf>> {
    let phong = |exponent| Box::new(Phong::new(vec![1.0, 0.25], exponent).unwrap());
    vec![
        Box::new(Lambert::new(vec![1.0, 0.3])),
        Box::new(Lambert::black(2)),
        phong(0.0),
        phong(1.0),
        phong(5.0),
        phong(17.5),
        phong(100.0),
    ]
}

fn direction(degrees: f64, turn: f64) -> Vec3 {
    warp::around_z(degrees.to_radians().cos(), turn).into()
}

fn outgoing_directions() -> Vec<Vec3> {
    [0.0, 20.0, 45.0, 70.0, 85.0, 89.5].iter().enumerate().map(|(k, t)| direction(*t, 0.05 + 0.17 * k as f64)).collect()
}

/// ∫ f cosθ dω over the hemisphere in coordinates about the mirror direction, split where the lobe meets the horizon.
fn quadrature_of_albedo(brdf: &dyn Brdf, band: usize, outgoing: Vec3) -> f64 {
    let axis = Vec3::new(-outgoing.x, -outgoing.y, outgoing.z);
    let across = if axis.z > 1.0 - 1e-12 { Vec3::X } else { (Vec3::Z - axis.z * axis).normalize() };
    let side = axis.cross(across);
    let (cosine, sine) = (axis.z, (1.0 - axis.z * axis.z).max(0.0).sqrt());
    let rule = gauss(64);

    // The polar angle about the mirror direction: full circles first, then arcs; x = (3 − 2u)u² smooths the arc's root at both ends.
    let tilt = cosine.acos();
    let right = std::f64::consts::FRAC_PI_2;
    let mut sum = 0.0;
    for (low, high) in [(0.0, right - tilt), (right - tilt, right), (right, right + tilt)] {
        for panel in 0..8 {
            for (u, weight) in &rule {
                let u = (f64::from(panel) + u) / 8.0;
                let alpha = low + (high - low) * (3.0 - 2.0 * u) * u * u;
                let stretch = (high - low) * 6.0 * u * (1.0 - u) / 8.0;
                let (sin_alpha, cos_alpha) = alpha.sin_cos();
                let reach = -cos_alpha * cosine / (sin_alpha * sine);
                let half_arc = if reach <= -1.0 || sine == 0.0 { 0.5 * TAU } else { reach.min(1.0).acos() };
                for (v, weight_v) in &rule {
                    let (sin, cos) = (half_arc * v).sin_cos();
                    let incident = cos_alpha * axis + sin_alpha * (cos * across + sin * side);
                    if incident.z > 0.0 {
                        let f = brdf.eval(band, incident.normalize(), outgoing);
                        sum += weight * stretch * weight_v * 2.0 * half_arc * sin_alpha * f * incident.z;
                    }
                }
            }
        }
    }
    sum
}

#[test]
fn brdfs_are_positive_and_reciprocal_to_the_bit() {
    for brdf in brdfs() {
        let mut stream = Streams::new(79, "pairs").stream(0, 0);
        for _ in 0..2000 {
            let [a, b] = [0, 1].map(|_| Vec3::from(warp::uniform_sphere(stream.uniform2())));
            for band in 0..brdf.n_bands() {
                let f = brdf.eval(band, a, b);
                assert!(f >= 0.0 && f.is_finite());
                assert_eq!(f.to_bits(), brdf.eval(band, b, a).to_bits(), "{}", brdf.description());
                if a.z <= 0.0 || b.z <= 0.0 {
                    assert_eq!(f, 0.0, "{} below the surface", brdf.description());
                }
            }
        }
    }
}

#[test]
fn albedo_is_the_integral_of_the_brdf() {
    // What 64 × 512 nodes of the test's own rule leave.
    const QUADRATURE: f64 = 1e-11;
    for brdf in brdfs() {
        for outgoing in outgoing_directions() {
            for band in 0..brdf.n_bands() {
                let albedo = brdf.albedo(band, outgoing);
                let integral = quadrature_of_albedo(&*brdf, band, outgoing);
                assert!((0.0..=1.0 + 4.0 * f64::EPSILON).contains(&albedo), "{}: {albedo}", brdf.description());
                assert!(
                    (albedo - integral).abs() < QUADRATURE,
                    "{} at cosine {}: {albedo} against {integral}",
                    brdf.description(),
                    outgoing.z
                );
            }
        }
    }
}

#[test]
fn samplers_follow_their_densities() {
    let cells = Cells { low: -1.0, n_rings: 40, n_sectors: 24 };
    let n = brdfs().len() * outgoing_directions().len();
    for brdf in brdfs() {
        for outgoing in outgoing_directions() {
            let name = brdf.description();
            let pdf = |incident| brdf.pdf(outgoing, incident);
            let total: f64 = cells.integrate(24, pdf).iter().sum();
            assert!(total <= 1.0 + 1e-9, "{name}: the density integrates to {total}");
            let test = test_sampler(cells, &name, 50_000, |u| brdf.sample(outgoing, u), pdf);
            assert!(test.p_value > sidak_level(SIGNIFICANCE, n), "{name} at cosine {}: {test:?}", outgoing.z);
        }
    }
}

/// A density must be above zero wherever light is reflected, and its samples above the surface.
#[test]
fn samplers_reach_all_that_is_reflected() {
    for brdf in brdfs() {
        let mut stream = Streams::new(83, "reach").stream(0, 0);
        for _ in 0..2000 {
            let [a, b] = [0, 1].map(|_| Vec3::from(warp::uniform_sphere(stream.uniform2())));
            assert!(brdf.eval(0, a, b) == 0.0 || brdf.pdf(b, a) > 0.0, "{}", brdf.description());
            match brdf.sample(b, stream.uniform2()) {
                Some(incident) => {
                    assert!(b.z > 0.0 && incident.z >= 0.0 && (incident.length() - 1.0).abs() < 1e-15);
                }
                None => assert!(brdf.lambertian().is_none() || b.z <= 0.0),
            }
        }
    }
}

#[test]
fn lambert_alone_is_lambertian() {
    assert_eq!(Lambert::new(vec![0.1, 0.2]).lambertian(), Some(&[0.1, 0.2][..]));
    assert_eq!(Lambert::grey(0.4, 3).lambertian(), Some(&[0.4; 3][..]));
    assert!(Phong::new(vec![0.5], 0.0).unwrap().lambertian().is_none());
}

#[test]
fn phong_albedo_matches_independent_values() {
    // Directional albedo of Lafortune & Willems' lobe at 0°, 30°, 60°, 80°, 89°, computed along two routes in high-precision quadrature
    // (reference cases D-PHONG-2 and D-PHONG-4, 13 digits), and the mean over the hemisphere 2 ∫ albedo c dc (10 digits).
    let cases = [
        (
            5.0,
            [1.0, 0.866_253_576_462_17, 0.519_406_835_538_19, 0.269_290_802_609_92, 0.178_620_736_528_26],
            0.682_834_787_9,
        ),
        (
            100.0,
            [1.0, 0.866_025_403_784_44, 0.500_000_000_612_32, 0.175_232_623_516_45, 0.049_125_363_960_452],
            0.666_926_762_2,
        ),
    ];
    for (exponent, albedos, mean) in cases {
        let phong = Phong::new(vec![1.0], exponent).unwrap();
        for (degrees, exact) in [0.0, 30.0, 60.0, 80.0, 89.0].into_iter().zip(albedos) {
            let albedo = phong.albedo(0, direction(degrees, 0.3));
            assert!(
                (albedo - exact).abs() < 6e-15 + 5e-14 * exact,
                "n = {exponent}, {degrees}°: {albedo} against {exact}"
            );
        }
        // Substitute c = u², as the albedo has a square root's slope nowhere but a kink's curvature at grazing.
        let integral: f64 =
            gauss(64).iter().map(|(u, w)| w * 4.0 * u.powi(3) * phong.albedo(0, direction_of_cosine(u * u))).sum();
        assert!((integral - mean).abs() < 1e-10, "n = {exponent}: mean albedo {integral} against {mean}");
    }
    // The same closed form in 30-digit arithmetic.
    for (exponent, cosine, exact) in [
        (0.0, 0.5, 0.75),
        (2.5, 0.3, 0.404_473_192_906_113_76),
        (1000.0, 0.5, 0.5),
        (1000.0, 0.05, 0.050_765_129_688_415_85),
    ] {
        let albedo = Phong::new(vec![1.0], exponent).unwrap().albedo(0, direction_of_cosine(cosine));
        assert!((albedo / exact - 1.0).abs() < 1e-12, "n = {exponent}: {albedo} against {exact}");
    }
}

fn direction_of_cosine(cosine: f64) -> Vec3 {
    warp::around_z(cosine, 0.1).into()
}

#[test]
fn phong_refuses_exponents_without_a_lobe() {
    assert_eq!(Phong::new(vec![1.0], -0.5), Err(PhongError::Exponent { exponent: -0.5 }));
    assert!(Phong::new(vec![1.0], f64::NAN).is_err());
    assert!(Phong::new(vec![1.0], f64::INFINITY).is_err());
}
