//! Every estimator × every scene of the gallery, and bounce by bounce where the bounces are known.

use super::*;
use crate::sphere::gauss;
use etendue::gallery::{self, Exact};
use etendue::scattering::Phong;
use std::f64::consts::PI;

/// Bundles × samples in a batch, in the gallery.
const WORK: u64 = 400;

/// Each estimator against the exact answer where one is known of surface means, against the energy balance where that is, and everywhere
/// against path tracing.
#[test]
fn every_estimator_in_every_scene_of_the_gallery() {
    let mut verdict = Verdict::default();
    for entry in gallery::list() {
        let scene = (entry.build)();
        let bundles = bundles(&scene, 100.0);
        let means = SurfaceMeans::new(&scene, &bundles);
        let exact = (entry.exact)();
        // Lamps touch nothing that they light in these.
        let has_apart_emitters =
            ["cornell-box", "parallel-plates", "two-rooms", "maze", "spherical-crater"].contains(&entry.name);
        // Far rooms are lit by few paths: no normal mean of theirs, but one of the whole scene.
        let is_lit_by_few = ["two-rooms", "maze"].contains(&entry.name);
        let total: f64 = bundles.etendue().iter().sum();
        let whole = |radiance: &Block| -> Vec<f64> {
            let mean = |column: &[f64]| column.iter().zip(bundles.etendue()).map(|(l, mu)| l * mu / total).sum();
            radiance.columns().map(mean).collect()
        };
        let of = |radiance: &Block| {
            let mut values = if is_lit_by_few { whole(radiance) } else { means.of(radiance) };
            values.extend(absorbed_power(&scene, &bundles, radiance));
            values
        };
        let samples = |contestant: &Contestant| {
            // A start of its own for every bundle, or one for all.
            (WORK / contestant.estimator.n_starts() as u64).max(4)
        };
        let all = contestants(&scene, &bundles, Bounces::All);
        let reference = batches(&*all[0].estimator, 4 * samples(&all[0]), of);
        for contestant in &all[1..] {
            // The sun of the crater is met by one ray in 10⁵, the lamps of the rooms by one in some hundred.
            let has_small_emitters = is_lit_by_few || entry.name == "spherical-crater";
            let is_judged = (contestant.has_variance_near_emitters || has_apart_emitters)
                && (contestant.finds_small_emitters || !has_small_emitters);
            if !is_judged {
                continue;
            }
            let drawn = batches(&*contestant.estimator, samples(contestant), of);
            for (k, (drawn, reference)) in drawn.iter().zip(&reference).enumerate() {
                verdict.compare(format!("{}: {}, value {k}", entry.name, contestant.label), drawn, reference);
            }
            compare_with_exact(entry.name, contestant.label, &exact, &scene, &means, &drawn, &mut verdict);
        }
        compare_with_exact(entry.name, all[0].label, &exact, &scene, &means, &reference, &mut verdict);
    }
    assert!(verdict.comparisons.len() > 1000, "{} comparisons", verdict.comparisons.len());
    verdict.assert_agreement();
}

/// Σ (1 − a) H A = Σ μ (L − E) (1 − a) / a over all bundles, W in each band; zero where some side reflects nothing.
fn absorbed_power(scene: &Scene, bundles: &Bundles, radiance: &Block) -> Vec<f64> {
    let absorbed = |band: usize| {
        let of_bundle = |bundle: usize| {
            let patch = bundles.patch(bundle).unwrap();
            let surface = scene.surface_of(patch.facet);
            let albedo = surface.brdf(patch.side).unwrap().lambertian().unwrap()[band];
            let reflected = radiance.get(bundle, band) - surface.emitted(patch.side, band);
            (albedo > 0.0).then(|| bundles.etendue()[bundle] * reflected * (1.0 - albedo) / albedo)
        };
        (0..bundles.n_bundles()).map(of_bundle).sum::<Option<f64>>().unwrap_or(0.0)
    };
    (0..scene.n_bands()).map(absorbed).collect()
}

/// Holds the values of [`SurfaceMeans`] and the absorbed power against what is known.
fn compare_with_exact(
    name: &str,
    label: &str,
    exact: &Option<Exact>,
    scene: &Scene,
    means: &SurfaceMeans,
    drawn: &[Moments],
    verdict: &mut Verdict,
) {
    let n_bands = scene.n_bands();
    let (of_surfaces, absorbed) = drawn.split_at(drawn.len() - n_bands);
    let mut compare = |what: &str, drawn: &Moments, known: f64| {
        verdict.compare(format!("{name}: {label}, {what}"), drawn, &certain(known));
    };
    match exact {
        Some(Exact::Uniform { radiance }) => {
            for (k, drawn) in of_surfaces.iter().enumerate() {
                compare("uniform radiance", drawn, radiance[k % n_bands]);
            }
        }
        Some(Exact::AbsorbedPower { power }) => {
            absorbed.iter().zip(power).for_each(|(drawn, power)| compare("absorbed power", drawn, *power));
        }
        // Of polygons that stand for a curved shape, only the shape's means are known.
        Some(Exact::Continuous(known)) if known.tessellation_error == 0.0 => {
            for known in &known.means {
                let k = means.means.iter().position(|(name, _)| name == known.surface).unwrap();
                let drawn = &of_surfaces[k * n_bands..];
                drawn.iter().zip(&known.radiance).for_each(|(drawn, known)| compare("surface mean", drawn, *known));
            }
        }
        Some(Exact::Continuous(_)) | None => {}
    }
}

/// Bounce k of a furnace is albedoᵏ times what it emits.
#[test]
fn bounces_of_the_furnaces() {
    let (albedo, emission) = ([0.5, 0.9], [1.0, 0.25]);
    let mut verdict = Verdict::default();
    for scene in
        [gallery::furnace_cube(&albedo, &emission).unwrap(), gallery::furnace_sphere(1, &albedo, &emission).unwrap()]
    {
        let bundles = bundles(&scene, 100.0);
        let means = SurfaceMeans::new(&scene, &bundles);
        for contestant in contestants(&scene, &bundles, Bounces::Each(8)) {
            if !contestant.has_variance_near_emitters {
                continue;
            }
            let samples = (4_000 / contestant.estimator.n_starts() as u64).max(40);
            let drawn = batches(&*contestant.estimator, samples, |radiance| means.of(radiance));
            for (k, drawn) in drawn.iter().enumerate() {
                let (bounce, band) = ((k % 18) / 2, k % 2);
                let exact = emission[band] * albedo[band].powi(bounce as i32);
                let what = format!("{}: {}, bounce {bounce}", scene.name(), contestant.label);
                verdict.compare(what, drawn, &certain(exact));
            }
        }
    }
    verdict.assert_agreement();
}

/// Means of KᵏE over the two parallel plates, k = 0 … last, by products with the kernel at 16 × 16 Gauss points: the kernel is analytic, so
/// that the rule has converged to far more digits than are compared.
pub(super) fn bounces_of_plates(last: usize) -> Vec<[f64; 2]> {
    let (gap, albedo, emission) = (0.5, 0.8, 1.0 / PI);
    let rule = gauss(16);
    let points: Vec<(f64, f64, f64)> =
        rule.iter().flat_map(|(x, wx)| rule.iter().map(move |(y, wy)| (*x, *y, wx * wy))).collect();
    let kernel = |(ax, ay, _): &(f64, f64, f64), (bx, by, _): &(f64, f64, f64)| {
        let distance_squared = (ax - bx).powi(2) + (ay - by).powi(2) + gap * gap;
        gap * gap / (PI * distance_squared * distance_squared)
    };
    let reflect = |other: &[f64]| -> Vec<f64> {
        let arriving = |a| points.iter().zip(other).map(|(b, radiance)| b.2 * kernel(a, b) * radiance).sum::<f64>();
        points.iter().map(|a| albedo * arriving(a)).collect()
    };
    let mean = |field: &[f64]| points.iter().zip(field).map(|(p, value)| p.2 * value).sum::<f64>();
    let mut fields = [vec![emission; points.len()], vec![0.0; points.len()]];
    (0..=last)
        .map(|_| {
            let means = [mean(&fields[0]), mean(&fields[1])];
            fields = [reflect(&fields[1]), reflect(&fields[0])];
            means
        })
        .collect()
}

#[test]
fn bounces_between_the_plates() {
    // Added up, they are the gallery's answer.
    let sum = |plate: usize| bounces_of_plates(150).iter().map(|means| means[plate]).sum::<f64>();
    let Exact::Continuous(known) = gallery::parallel_plates_exact() else { panic!("the plates' truth is continuous") };
    for (plate, known) in known.means.iter().enumerate() {
        assert!((sum(plate) / known.radiance[0] - 1.0).abs() < 1e-10, "plate {plate}: {}", sum(plate));
    }

    let scene = gallery::parallel_plates();
    let bundles = bundles(&scene, 0.5);
    let means = SurfaceMeans::new(&scene, &bundles);
    let exact = bounces_of_plates(8);
    let mut verdict = Verdict::default();
    for contestant in contestants(&scene, &bundles, Bounces::Each(8)) {
        let samples = 12_000 / contestant.estimator.n_starts() as u64;
        let drawn = batches(&*contestant.estimator, samples, |radiance| means.of(radiance));
        for (k, drawn) in drawn.iter().enumerate() {
            let (plate, bounce) = (k / 9, k % 9);
            // Late bounces rest on too few scores for a normal mean.
            if bounce <= 5 {
                let what = format!("plate {plate}: {}, bounce {bounce}", contestant.label);
                verdict.compare(what, drawn, &certain(exact[bounce][plate]));
            }
        }
    }
    verdict.assert_agreement();
}

/// A glossy floor under five black walls that all emit 1 sees nothing but 1: it sends out its directional albedo, on average
/// ∫ albedo(θ) 2 cosθ d(cosθ).
#[test]
fn glossy_surfaces_send_out_their_albedo() {
    let mut verdict = Verdict::default();
    for exponent in [0.0, 4.0, 50.0] {
        let gloss = Phong::new(vec![0.9, 0.4], exponent).unwrap();
        let albedo = |band| {
            let at =
                |cosine: f64| gloss.albedo(band, Vec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine)) * 2.0 * cosine;
            gauss(64).iter().map(|(cosine, weight)| weight * at(*cosine)).sum::<f64>()
        };
        let [floor, walls @ ..] = cube();
        let mut surfaces = vec![surface("floor", floor, gloss.clone(), &[0.0; 2])];
        let walls = walls.into_iter().enumerate();
        surfaces.extend(walls.map(|(k, wall)| matte(&format!("wall-{k}"), wall, &[0.0; 2], &[1.0; 2])));
        let scene = scene(surfaces);
        let bundles = bundles(&scene, 100.0);
        let means = SurfaceMeans::new(&scene, &bundles);
        for contestant in contestants(&scene, &bundles, Bounces::All).iter().filter(|c| c.has_variance_near_emitters) {
            let samples = 6_000 / contestant.estimator.n_starts() as u64;
            let drawn = batches(&*contestant.estimator, samples, |radiance| means.of(radiance));
            for (k, drawn) in drawn.iter().enumerate() {
                let exact = if k < 2 { albedo(k) } else { 1.0 };
                verdict.compare(format!("exponent {exponent}: {}", contestant.label), drawn, &certain(exact));
            }
        }
    }
    verdict.assert_agreement();
}
