//! Photon density: unbiased where radiance is uniform, biased by the kernel elsewhere, and by as much as it says.

use super::*;
use etendue::estimator::{EstimatorError, Kernel, PhotonDensity, Truth, estimate};
use etendue::gallery;
use etendue::stats::fit_power_law;

/// Where the radiance is the same everywhere, a disk of one radius sees just that, at edges and corners too; and both histogram and
/// density are right, bounce by bounce.
#[test]
fn a_uniform_radiance_is_seen_without_bias() {
    let (albedo, emission) = ([0.5, 0.8], [1.0, 0.25]);
    let mut verdict = Verdict::default();
    for scene in
        [gallery::furnace_cube(&albedo, &emission).unwrap(), gallery::furnace_sphere(0, &albedo, &emission).unwrap()]
    {
        let bundles = bundles(&scene, 0.5);
        let means = SurfaceMeans::new(&scene, &bundles);
        for radius in [0.1, 0.3, 3.0] {
            let density = || PhotonDensity::new(&scene, &bundles, 100, Kernel::Radius(radius)).unwrap();
            assert_eq!((density().truth(), density().kernel()), (Truth::Smoothed, Kernel::Radius(radius)));
            let each = density().with_bounces(Bounces::Each(3)).with_roulette(Roulette::After(3)).unwrap();
            for (k, drawn) in batches(&each, 20, |radiance| means.of(radiance)).iter().enumerate() {
                let (bounce, band) = ((k % 8) / 2, k % 2);
                let exact = emission[band] * albedo[band].powi(bounce as i32);
                verdict.compare(format!("{}, radius {radius}, bounce {bounce}", scene.name()), drawn, &certain(exact));
            }
            // Held against one, as what rounding leaves is small beside the radiance and not beside zero.
            let one_more = |radiance: &Block| means.of(radiance).iter().map(|bias| 1.0 + bias).collect();
            for drawn in batches(&density().bias(), 20, one_more) {
                verdict.compare(format!("{}, bias at radius {radius}", scene.name()), &drawn, &certain(1.0));
            }
        }
    }
    verdict.assert_agreement();
}

/// Between the plates radiance is not uniform. The density estimate less the light tracer is the bias that the estimator of the bias
/// gives, and both are seen to differ from zero; and the bias falls with the radius, in the second order of it.
#[test]
fn the_bias_is_what_it_is_said_to_be() {
    let scene = gallery::parallel_plates();
    let bundles = bundles(&scene, 0.125);
    // The centre of the plate that emits nothing: radiance is largest there, and smoothing darkens it.
    let central = |radiance: &Block| {
        let is_central = |k: &usize| {
            let patch = bundles.patch(*k).unwrap();
            patch.facet == 1 && (patch.polygon.centroid() - Vec3::new(0.5, 0.5, 0.5)).abs().max_element() < 0.1
        };
        let chosen: Vec<usize> = (0..bundles.n_bundles()).filter(is_central).collect();
        assert_eq!(chosen.len(), 4);
        vec![chosen.iter().map(|k| radiance.get(*k, 0)).sum::<f64>() / chosen.len() as f64]
    };
    let density = |radius| PhotonDensity::new(&scene, &bundles, 500, Kernel::Radius(radius)).unwrap();
    let radii = [0.15, 0.3, 0.45];
    let biases = radii.map(|radius| batches(&density(radius).bias(), 40, central).remove(0));
    let light = batches(&LightTracer::new(&scene, &bundles).unwrap(), 20_000, central).remove(0);
    let mut verdict = Verdict::default();
    for (radius, bias) in radii.into_iter().zip(&biases) {
        let seen = batches(&density(radius), 40, central).remove(0);
        let expected = Moments::from_iter([0.0, 0.0]);
        if radius > 0.2 {
            assert!(p_value(bias, &expected) < ALPHA, "no bias seen at radius {radius}: {bias:?}");
        }
        // seen − light against the bias, as seen against light + bias.
        let variance = seen.variance_of_mean() + light.variance_of_mean() + bias.variance_of_mean();
        let z = (seen.mean() - light.mean() - bias.mean()) / variance.sqrt();
        let p = etendue::stats::two_sided_p(z);
        verdict.comparisons.push((format!("radius {radius}: {seen:?} against {light:?} and {bias:?}"), p));
    }
    verdict.assert_agreement();
    let sizes: Vec<f64> = biases.iter().map(|bias| -bias.mean()).collect();
    let line = fit_power_law(&radii, &sizes).unwrap();
    assert!((1.5..2.5).contains(&line.slope), "bias {sizes:?} of order {}", line.slope);
}

/// The k nearest photons lie closer as there are more of them: the bias vanishes while k grows.
#[test]
fn the_nearest_photons_are_consistent() {
    let scene = gallery::parallel_plates();
    let bundles = bundles(&scene, 0.25);
    let means = SurfaceMeans::new(&scene, &bundles);
    let bias = |n_photons, k, n_samples| {
        let density = PhotonDensity::new(&scene, &bundles, n_photons, Kernel::Nearest(k)).unwrap().bias();
        batches(&density, n_samples, |radiance| means.of(radiance)).remove(1)
    };
    let (few, many) = (bias(200, 40, 20), bias(6_400, 160, 2));
    assert!(few.mean().abs() > 20.0 * few.standard_error(), "{few:?}");
    assert!(many.mean().abs() + 5.0 * many.standard_error() < 0.5 * few.mean().abs(), "{few:?}, then {many:?}");
}

#[test]
fn kernels_that_hold_nothing_are_refused() {
    let scene = gallery::parallel_plates();
    let bundles = bundles(&scene, 1.0);
    let refused =
        [(0, Kernel::Radius(1.0)), (10, Kernel::Radius(0.0)), (10, Kernel::Radius(f64::NAN)), (10, Kernel::Nearest(2))];
    for (n_photons, kernel) in refused {
        let density = PhotonDensity::new(&scene, &bundles, n_photons, kernel).map(|_| ());
        assert!(matches!(density, Err(EstimatorError::Kernel { .. })), "{n_photons} photons, {kernel:?}");
    }
}

#[test]
fn threads_change_no_bit_of_a_density() {
    let scene = gallery::corner_box();
    let bundles = bundles(&scene, 0.5);
    for kernel in [Kernel::Radius(0.2), Kernel::Nearest(8)] {
        let density = PhotonDensity::new(&scene, &bundles, 60, kernel).unwrap();
        let on = |n_threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
            pool.install(|| estimate(&density, 100, SEED))
        };
        let alone = on(1);
        for n_threads in [2, 3, 8] {
            assert_eq!(alone, on(n_threads), "{kernel:?} on {n_threads} threads");
        }
    }
}
