//! Lambert's law and Phong's lobe against exact values.

use super::{direction, direction_of_cosine};
use crate::sphere::gauss;
use etendue::scattering::{Brdf, Lambert, Phong, PhongError};

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

#[test]
fn phong_refuses_exponents_without_a_lobe() {
    assert_eq!(Phong::new(vec![1.0], -0.5), Err(PhongError::Exponent { exponent: -0.5 }));
    assert!(Phong::new(vec![1.0], f64::NAN).is_err());
    assert!(Phong::new(vec![1.0], f64::INFINITY).is_err());
}
