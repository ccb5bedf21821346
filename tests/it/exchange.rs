//! Exchange of single pairs: against reference form factors, and under moves that must not change it.

use super::form_factors::{CLEAR, OCCLUDED, Pair};
use super::scenes::{Case, polygon, scene_of};
use etendue::assembly::{Exchange, Occlusion, System, assemble};
use etendue::basis::{Bundles, Resolution};
use etendue::geometry::{Mat3, Polygon, Vec3};
use etendue::linalg::LinearOperator;
use etendue::sampling::Stream;
use etendue::scene::Scene;
use std::f64::consts::PI;

/// Asked of the quadrature.
const TOLERANCE: f64 = 1e-13;
/// What moves leave of it: they round the corners.
const REACHED: f64 = 1e-12;
/// Rounding of a reference and of the division by the étendue.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Standard errors: with seven pairs in the family, 4.5 is a false alarm in 20 000 runs; seeds are fixed.
const STANDARD_ERRORS: f64 = 4.5;

/// Every polygon one patch.
fn assembled(polygons: &[Polygon], are_two_sided: bool, visibility_rays: usize) -> System {
    let scene = scene_of(polygons, are_two_sided);
    let bundles = Bundles::new(&scene, Resolution { patch_size: 1e12, n_directions: 1 }).unwrap();
    let settings = Exchange {
        tolerance: TOLERANCE,
        occlusion: Occlusion::Sampled { rays: visibility_rays, sink_rays: 1 },
        repair: false,
        ..Exchange::default()
    };
    assemble(&scene, &bundles, settings).unwrap()
}

fn entry(system: &System, i: usize, j: usize) -> f64 {
    let mut row = vec![0.0; system.n_bundles()];
    system.exchange().row(0, i, &mut row);
    row[j]
}

fn error_of_entry(system: &System, i: usize, j: usize) -> f64 {
    let mut row = vec![0.0; system.n_bundles()];
    system.exchange_error().row(0, i, &mut row);
    row[j]
}

fn polygons_of(pair: &Pair) -> Vec<Polygon> {
    [pair.first, pair.second].iter().chain(pair.occluders).map(|v| polygon(v)).collect()
}

#[test]
fn unoccluded_pairs_match_the_reference() {
    for pair in CLEAR {
        let polygons = polygons_of(pair);
        let system = assembled(&polygons, false, 1);
        let found = entry(&system, 0, 1) / (PI * polygons[0].area());
        let error = (found / pair.form_factor - 1.0).abs();
        let allowed = 10f64.powi(-pair.digits);
        assert!(error <= allowed, "{}: {found} for {}, off by {error:e}", pair.id, pair.form_factor);
        let report = system.report();
        assert_eq!((report.n_pairs, report.n_clear, report.n_sampled), (1, 1, 0), "{}", pair.id);
        assert_eq!(error_of_entry(&system, 0, 1), 0.0, "{}", pair.id);
    }
}

#[test]
fn error_estimates_of_the_quadrature_are_honest() {
    for pair in CLEAR {
        let polygons = polygons_of(pair);
        let system = assembled(&polygons, false, 1);
        let found = entry(&system, 0, 1) / (PI * polygons[0].area());
        let error = (found / pair.form_factor - 1.0).abs();
        let estimate = system.report().quadrature_error;
        let certain = if pair.digits < 13 { 10f64.powi(-pair.digits) } else { 0.0 };
        assert!(error <= estimate + ROUNDING + certain, "{}: off by {error:e}, estimated {estimate:e}", pair.id);
        assert!(estimate <= TOLERANCE, "{}: estimated {estimate:e}", pair.id);
    }
}

#[test]
fn occluded_pairs_match_the_reference_within_their_error_estimate() {
    for pair in OCCLUDED {
        let polygons = polygons_of(pair);
        let system = assembled(&polygons, true, 4096);
        // Every polygon has a bundle on either side, front first: the fronts of the pair are 0 and 2.
        let found = entry(&system, 0, 2);
        let mu = PI * polygons[0].area();
        let standard_error = error_of_entry(&system, 0, 2);
        let difference = (found - pair.form_factor * mu).abs();
        let bound = STANDARD_ERRORS * standard_error + REACHED * found;
        assert!(difference <= bound, "{}: {} for {}, {bound:e}", pair.id, found / mu, pair.form_factor);
        // And the estimate means something: some per mille, not the whole.
        assert!(standard_error <= 0.05 * mu, "{}: {standard_error:e}", pair.id);
    }
}

#[test]
fn what_geometry_can_settle_is_not_sampled() {
    let settled = |id: &str| {
        let pair = OCCLUDED.iter().find(|pair| pair.id == id).unwrap();
        let polygons = polygons_of(pair);
        // One-sided, so that the pair itself is the only one that could be sampled; occluders face the first.
        let system = assembled(&polygons, false, 1);
        (entry(&system, 0, 1) / (PI * polygons[0].area()), pair.form_factor)
    };
    // An occluder that covers everything, and an opening that covers nothing: one ray would be luck.
    let (found, expected) = settled("B-BLK-05");
    assert_eq!((found, expected), (0.0, 0.0));
    let (found, expected) = settled("B-APE-05");
    assert!((found / expected - 1.0).abs() <= REACHED, "{found} {expected}");
}

/// Pairs that see each other: apart, sharing a corner, sharing an edge.
fn random_pairs(n: usize) -> Vec<[Polygon; 2]> {
    let mut stream = Stream::new(0x7061_6972, 0, 0);
    let mut point = move |half: f64| Vec3::from_array(std::array::from_fn(|_| half * (2.0 * stream.uniform() - 1.0)));
    let mut pairs = Vec::new();
    while pairs.len() < n {
        let shared = [point(1.0), point(1.0)];
        let first = [shared[0], shared[1], point(1.0)];
        let second = match pairs.len() % 3 {
            0 => [point(1.0) + Vec3::X * 2.5, point(1.0) + Vec3::X * 2.5, point(1.0) + Vec3::X * 2.5],
            1 => [shared[0], point(1.0), point(1.0)],
            _ => [shared[1], shared[0], point(1.0)],
        };
        let polygons = [first, second].map(|v| Polygon::new(v.to_vec()));
        let [Ok(first), Ok(second)] = polygons else { continue };
        let pair = [first, second];
        // Slivers, and pairs that hardly face each other, have a condition of their own.
        let well_shaped = pair.iter().all(|p| {
            let v = p.vertices();
            let longest = v[0].distance(v[1]).max(v[1].distance(v[2])).max(v[2].distance(v[0]));
            p.area() > 0.05 * longest * longest
        });
        let facing = entry(&assembled(&pair, false, 1), 0, 1) > 1e-3 * PI * pair[0].area().min(pair[1].area());
        if well_shaped && facing {
            pairs.push(pair);
        }
    }
    pairs
}

/// A name, a map of points, and what it does to areas.
type Move<'a> = (&'a str, &'a dyn Fn(Vec3) -> Vec3, f64);

#[test]
fn moves_turns_and_scales_do_not_change_form_factors() {
    let turn = Mat3::from_axis_angle(Vec3::new(0.36, 0.48, 0.8), 1.234_5);
    let moves: [Move; 5] = [
        ("turned", &|v| turn * v, 1.0),
        ("shifted", &|v| v + Vec3::new(3.0, -7.0, 11.0), 1.0),
        ("tiny", &|v| v * 1e-6, 1e-12),
        ("huge", &|v| v * 1e6, 1e12),
        ("all at once", &|v| turn * (v * 0.37) + Vec3::new(1.0, 2.0, 3.0), 0.37 * 0.37),
    ];
    for (k, pair) in random_pairs(45).iter().enumerate() {
        let reference = entry(&assembled(pair, false, 1), 0, 1);
        for (name, map, scale) in &moves {
            let moved = pair.clone().map(|p| Polygon::new(p.vertices().iter().map(|v| map(*v)).collect()).unwrap());
            let found = entry(&assembled(&moved, false, 1), 0, 1) / scale;
            let error = (found / reference - 1.0).abs();
            assert!(error <= REACHED, "pair {k} {name}: {found} for {reference}, off by {error:e}");
        }
    }
}

#[test]
fn numbering_does_not_change_exchange() {
    for (k, [first, second]) in random_pairs(45).iter().enumerate() {
        let reference = entry(&assembled(&[first.clone(), second.clone()], false, 1), 0, 1);
        // The other order of surfaces, and other corners first.
        let begun_later = |p: &Polygon| {
            let mut v = p.vertices().to_vec();
            v.rotate_left(1);
            Polygon::new(v).unwrap()
        };
        let found = entry(&assembled(&[begun_later(second), begun_later(first)], false, 1), 1, 0);
        assert!((found / reference - 1.0).abs() <= REACHED, "pair {k}: {found} for {reference}");
    }
}

/// A whole scene under a map of its points, its patches scaled along, without its camera.
fn mapped(case: &Case, map: impl Fn(Vec3) -> Vec3, scale: f64) -> System {
    let mut description = case.scene.description().clone();
    description.camera = None;
    for polygon in description.surfaces.iter_mut().flat_map(|surface| &mut surface.polygons) {
        *polygon = Polygon::new(polygon.vertices().iter().map(|v| map(*v)).collect()).unwrap();
    }
    let scene = Scene::new(description).unwrap();
    let patch_size = scale * case.bundles.resolution().patch_size;
    let bundles = Bundles::new(&scene, Resolution { patch_size, n_directions: 1 }).unwrap();
    assemble(&scene, &bundles, case.settings).unwrap()
}

fn all_entries(system: &System) -> Vec<f64> {
    let mut row = vec![0.0; system.n_bundles()];
    let rows = (0..system.n_bundles()).flat_map(|i| {
        system.exchange().row(0, i, &mut row);
        row.clone()
    });
    rows.collect()
}

/// Doubling rounds nothing: any difference would be an absolute length hidden in the code.
#[test]
fn doubling_a_scene_quadruples_its_exchange_to_the_bit() {
    for name in ["cornell-box", "two-rooms"] {
        let case = super::scenes::find(name);
        let reference = all_entries(&case.system);
        for exponent in [-40, -20, 1, 20, 40] {
            let scale = f64::powi(2.0, exponent);
            let scaled = mapped(case, |v| v * scale, scale);
            assert_eq!(scaled.report(), case.system.report(), "{name} × 2^{exponent}");
            for (k, (found, expected)) in all_entries(&scaled).iter().zip(&reference).enumerate() {
                assert_eq!(found.to_bits(), (expected * scale * scale).to_bits(), "{name} × 2^{exponent}: entry {k}");
            }
        }
    }
}

/// Turned, and carried up to ten thousand sizes away: the same pairs, the same zeros, no ray lost, and in closed scenes (whose sinks are
/// no samples of turned directions) the same exchange within its own error estimate.
#[test]
fn moved_scenes_keep_their_exchange() {
    let turn = Mat3::from_axis_angle(Vec3::new(0.36, 0.48, 0.8), 0.7);
    for name in ["cornell-box", "corner-box", "two-rooms"] {
        let case = super::scenes::find(name);
        let reference = all_entries(&case.system);
        for shift in [Vec3::ZERO, Vec3::new(10.0, -20.0, 30.0), Vec3::splat(1e4)] {
            let moved = mapped(case, |v| turn * v + shift, 1.0);
            assert_eq!(moved.report().n_pairs, case.system.report().n_pairs, "{name} by {shift}");
            assert!(moved.laws().closure < 1e-12 && moved.laws().reciprocity == 0.0, "{name} by {shift}");
            let estimate = moved.report().quadrature_error + case.system.report().quadrature_error;
            for (k, (found, expected)) in all_entries(&moved).iter().zip(&reference).enumerate() {
                assert_eq!(*found == 0.0, *expected == 0.0, "{name} by {shift}: entry {k}");
                // What little of a patch rises above another's plane is as uncertain as the plane: some ulp of all its étendue.
                let etendue = case.system.etendue()[k / moved.n_bundles()];
                // Far away an ulp of the coordinates is so much of the length of an edge; T has four lengths.
                let rounding = 4.0 * f64::EPSILON * shift.length() / (etendue / PI).sqrt();
                let allowed = (estimate + rounding) * expected + 1e-12 * etendue;
                assert!(!case.entry.closed || (found - expected).abs() <= allowed, "{name} by {shift}: entry {k}");
            }
            assert_eq!(moved.sinks().max_abs() == 0.0, case.entry.closed, "{name} by {shift}");
        }
    }
}
