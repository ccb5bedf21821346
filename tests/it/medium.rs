//! Every phase function × every law, and Beer's law.

use crate::sphere::{Cells, gauss, test_sampler};
use etendue::geometry::Vec3;
use etendue::medium::{HenyeyGreenstein, Homogeneous, Isotropic, MediumError, Phase};
use etendue::sampling::{Streams, warp};
use etendue::stats::{Moments, critical_z, sidak_level, z_score};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Family-wise significance of the random tests of this file.
const SIGNIFICANCE: f64 = 1e-6;

fn phases() -> Vec<Box<dyn Phase>> {
    let henyey_greenstein = |a| Box::new(HenyeyGreenstein::new(a).unwrap());
    let mut phases: Vec<Box<dyn Phase>> = vec![Box::new(Isotropic)];
    for asymmetry in [-0.9, -0.3, 0.0, 1e-9, 0.5, 0.85] {
        phases.push(henyey_greenstein(asymmetry));
    }
    phases
}

#[test]
fn phase_functions_are_positive_and_reciprocal_to_the_bit() {
    for phase in phases() {
        let mut stream = Streams::new(89, "pairs").stream(0, 0);
        for _ in 0..2000 {
            let [a, b] = [0, 1].map(|_| Vec3::from(warp::uniform_sphere(stream.uniform2())));
            let p = phase.eval(a, b);
            assert!(p > 0.0 && p.is_finite());
            assert_eq!(p.to_bits(), phase.eval(b, a).to_bits(), "{}", phase.description());
        }
    }
}

#[test]
fn phase_functions_are_normalised_with_the_mean_cosine_they_state() {
    // 16 panels of 32 nodes, graded towards both poles: exact to rounding for these asymmetries.
    let rule = gauss(32);
    for phase in phases() {
        let outgoing = Vec3::new(0.48, -0.6, 0.64);
        let side = outgoing.any_orthonormal_vector();
        let (mut total, mut mean) = (0.0, 0.0);
        for panel in 0..16 {
            for (u, weight) in &rule {
                let theta = std::f64::consts::PI * (f64::from(panel) + u) / 16.0;
                let (sin, cos) = theta.sin_cos();
                let p = phase.eval(-(cos * outgoing + sin * side), outgoing);
                let share = weight * std::f64::consts::PI / 16.0 * TAU * sin * p;
                total += share;
                mean += share * cos;
            }
        }
        assert!((total - 1.0).abs() < 1e-13, "{}: {total}", phase.description());
        assert!((mean - phase.mean_cosine()).abs() < 1e-13, "{}: {mean}", phase.description());
    }
}

#[test]
fn samplers_follow_their_densities() {
    let cells = Cells { low: -1.0, n_rings: 40, n_sectors: 20 };
    for phase in phases() {
        for outgoing in [Vec3::Z, Vec3::new(0.48, -0.6, 0.64)] {
            let test = test_sampler(
                cells,
                &phase.description(),
                100_000,
                |u| Some(phase.sample(outgoing, u)),
                |incident| phase.pdf(outgoing, incident),
            );
            let level = sidak_level(SIGNIFICANCE, 2 * phases().len());
            assert!(test.p_value > level, "{}: {test:?}", phase.description());
        }
    }
}

#[test]
fn samplers_have_the_mean_cosine_even_in_a_sharp_peak() {
    let asymmetries = [-0.999, -0.5, 1e-300, 1e-4, 0.97, 0.999_999];
    for asymmetry in asymmetries {
        let phase = HenyeyGreenstein::new(asymmetry).unwrap();
        let streams = Streams::new(97, "peak");
        let outgoing = Vec3::new(0.48, -0.6, 0.64);
        let m: Moments =
            (0..100_000).map(|k| -phase.sample(outgoing, streams.stream(0, k).uniform2()).dot(outgoing)).collect();
        let z = z_score(m.mean(), asymmetry, m.variance_of_mean());
        assert!(z.abs() < critical_z(SIGNIFICANCE, asymmetries.len()), "asymmetry {asymmetry}: z = {z}");
    }
}

#[test]
fn media_fade_light_by_beers_law() {
    let medium = Homogeneous::new(vec![0.0, 2.0, 1e-12], vec![0.0, 0.75, 1.0], Arc::new(Isotropic)).unwrap();
    assert_eq!(medium.n_bands(), 3);
    assert_eq!((medium.transmittance(0, 1e9), medium.opacity(0, 1e9)), (1.0, 0.0));
    assert_eq!(medium.optical_thickness(1, 1.5), 3.0);
    assert_eq!(medium.transmittance(1, 1.5), (-3.0f64).exp());
    // τ = 1e-12: opacity is τ − τ²/2 to every digit, where 1 − exp(−τ) keeps four.
    assert!((medium.opacity(2, 1.0) / (1e-12 - 0.5e-24) - 1.0).abs() < 2.0 * f64::EPSILON);
    // Beer: stretches multiply; three exponentials round.
    let product = medium.transmittance(1, 0.4) * medium.transmittance(1, 1.1);
    assert!((product / medium.transmittance(1, 1.5) - 1.0).abs() < 8.0 * f64::EPSILON);
    assert_eq!((medium.extinction(1), medium.single_scattering_albedo(1)), (2.0, 0.75));
    assert_eq!(medium.phase().mean_cosine(), 0.0);
}

#[test]
fn media_refuse_coefficients_no_medium_has() {
    let new = |extinction: &[f64], albedo: &[f64]| {
        Homogeneous::new(extinction.to_vec(), albedo.to_vec(), Arc::new(Isotropic)).map(|_| ())
    };
    assert_eq!(new(&[1.0], &[0.5, 0.5]), Err(MediumError::BandCount { n_extinction: 1, n_albedo: 2 }));
    assert!(matches!(
        new(&[1.0, -1.0], &[0.5, 0.5]),
        Err(MediumError::OutOfRange { quantity: "extinction", band: 1, .. })
    ));
    assert!(
        new(&[f64::INFINITY], &[0.5]).is_err() && new(&[1.0], &[f64::NAN]).is_err() && new(&[1.0], &[1.5]).is_err()
    );
    for asymmetry in [1.0, -1.0, 2.0, f64::NAN] {
        assert!(HenyeyGreenstein::new(asymmetry).is_err());
    }
}
