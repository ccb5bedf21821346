//! Partly visible pairs, integrated: against reference form factors and rays, closure of whole scenes before any repair, and whether
//! the estimate is honest.

use super::form_factors::OCCLUDED;
use super::scenes::{polygon, scene_of};
use etendue::assembly::{Exchange, Occlusion, System, assemble};
use etendue::basis::{Bundles, Resolution};
use etendue::gallery;
use etendue::geometry::{Mat3, Polygon, Tracer, Vec3};
use etendue::linalg::LinearOperator;
use etendue::sampling::Stream;
use etendue::scene::{Scene, SceneDescription};
use std::f64::consts::PI;

/// Asked of Tᵢⱼ / min(μᵢ, μⱼ).
const TOLERANCE: f64 = 1e-7;

/// No edge is longer: every polygon is one patch.
const WHOLE: f64 = 1e12;

/// So many trials where nobody asks for all of them with `ETENDUE_LARGE=1`.
pub fn n_trials(few: usize, many: usize) -> usize {
    if std::env::var("ETENDUE_LARGE").is_ok_and(|v| v == "1") { many } else { few }
}

fn exchange(scene: &Scene, patch_size: f64, tolerance: f64) -> System {
    let bundles = Bundles::new(scene, Resolution { patch_size, n_directions: 1 }).unwrap();
    let occlusion = Occlusion::Exact { tolerance };
    let settings = Exchange { occlusion, repair: false, ..Exchange::default() };
    assemble(scene, &bundles, settings).unwrap()
}

/// The error that a system states for the pair i, j.
fn estimate(system: &System, i: usize, j: usize) -> f64 {
    let mut row = vec![0.0; system.n_bundles()];
    system.exchange_error().row(0, i, &mut row);
    row[j]
}

fn entry(system: &System, i: usize, j: usize) -> f64 {
    let mut row = vec![0.0; system.n_bundles()];
    system.exchange().row(0, i, &mut row);
    row[j]
}

#[test]
fn integrated_pairs_match_the_reference_to_the_tolerance() {
    for pair in OCCLUDED {
        let polygons: Vec<_> = [pair.first, pair.second].iter().chain(pair.occluders).map(|v| polygon(v)).collect();
        let scene = scene_of(&polygons, true);
        let system = exchange(&scene, WHOLE, TOLERANCE);

        // Every polygon has a bundle on either side, front first: the fronts of the pair are 0 and 2.
        let found = entry(&system, 0, 2) / (PI * polygons[0].area());
        // The tolerance is on the smaller of the two étendues.
        let smaller = polygons[0].area().min(polygons[1].area()) / polygons[0].area();
        let error = (found - pair.form_factor).abs();
        assert!(error <= TOLERANCE * smaller, "{}: {found} for {}, off by {error:e}", pair.id, pair.form_factor);
        assert_eq!(system.report().n_sampled, 0, "{}", pair.id);
    }
}

/// The Cornell box with a front wall. Both its boxes end on the floor, which closes them, and what is inside them and above the lamp takes
/// part too: no light is lost, and closure needs no samples.
pub fn closed_cornell_box() -> Scene {
    let mut description: SceneDescription = gallery::cornell_box().description().clone();
    description.camera = None;
    let mut front = description.surfaces[2].clone();
    front.name = "front".to_string();
    let mirrored = front.polygons[0].vertices().iter().rev().map(|v| Vec3::new(v.x, v.y, -v.z));
    front.polygons = vec![Polygon::new(mirrored.collect()).unwrap()];
    description.surfaces.push(front);
    for surface in &mut description.surfaces {
        if surface.name.ends_with("box") {
            surface.polygons.retain(|p| p.normal().y > -0.5);
            for p in &mut surface.polygons {
                let raised = p.vertices().iter().map(|v| Vec3::new(v.x, v.y.max(-1.0), v.z));
                *p = Polygon::new(raised.collect()).unwrap();
            }
        }
        if surface.name.ends_with("box") || surface.name == "light" {
            surface.back = Some(surface.front.clone());
        }
    }
    Scene::new(description).unwrap()
}

/// What closed scenes with obstacles promise at the default tolerance and on request.
#[test]
fn closed_scenes_close_before_any_repair() {
    let scenes = [
        (gallery::corner_box(), 0.5, 1e-7, 1e-6),
        (gallery::corner_box(), 0.5, 1e-10, 1e-9),
        (gallery::corner_box(), 0.25, 1e-7, 1e-6),
        (gallery::corner_box(), 0.25, 1e-11, 1e-9),
        (gallery::two_rooms(), 1.0, 1e-7, 1e-6),
        (gallery::two_rooms(), 1.0, 1e-10, 1e-9),
        (gallery::floating_block(1).unwrap(), 0.25, 1e-7, 1e-6),
        (gallery::floating_block(1).unwrap(), 0.25, 1e-10, 1e-9),
        (closed_cornell_box(), 0.5, 1e-7, 1e-6),
        (closed_cornell_box(), 0.5, 1e-10, 1e-9),
    ];
    for (scene, patch_size, tolerance, allowed) in scenes {
        let system = exchange(&scene, patch_size, tolerance);
        let found = system.report().closure_before_repair;
        assert!(found < allowed, "{} at {tolerance:e}: {found:e}", scene.name());
        assert_eq!(system.sinks().max_abs(), 0.0, "{}", scene.name());
    }
}

/// Two patches that face each other across a gap of about one, and what stands in it.
fn across(stream: &mut Stream) -> [Polygon; 2] {
    let mut around = |centre: Vec3, size: f64| {
        let mut point = || Vec3::from_array(std::array::from_fn(|_| size * (stream.uniform() - 0.5)));
        let (u, v) = (Vec3::X * size + 0.3 * point(), Vec3::Y * size + 0.3 * point());
        [centre - u - v, centre + u - v, centre + u + v, centre - u + v].to_vec()
    };
    let low = Polygon::new(around(Vec3::ZERO, 0.5)).unwrap();
    let high = Polygon::new(around(Vec3::Z, 0.4)).unwrap().flipped();
    [low, high]
}

fn turned(points: &[[f64; 3]], faces: &[&[usize]], size: f64, centre: Vec3, stream: &mut Stream) -> Vec<Polygon> {
    let axis = Vec3::from_array(std::array::from_fn(|_| stream.uniform() - 0.5)).normalize();
    let turn = Mat3::from_axis_angle(axis, 6.0 * stream.uniform());
    let points: Vec<Vec3> = points.iter().map(|p| centre + size * (turn * Vec3::from_array(*p))).collect();
    faces.iter().map(|face| Polygon::new(face.iter().map(|k| points[*k]).collect()).unwrap()).collect()
}

const CUBE: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];
const CUBE_FACES: [&[usize]; 6] =
    [&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]];

/// An L of two unit squares and a half, extruded: its inner edge bends towards the fronts.
const CORNER: [[f64; 3]; 12] = [
    [-1.0, -1.0, -0.5],
    [1.0, -1.0, -0.5],
    [1.0, 0.0, -0.5],
    [0.0, 0.0, -0.5],
    [0.0, 1.0, -0.5],
    [-1.0, 1.0, -0.5],
    [-1.0, -1.0, 0.5],
    [1.0, -1.0, 0.5],
    [1.0, 0.0, 0.5],
    [0.0, 0.0, 0.5],
    [0.0, 1.0, 0.5],
    [-1.0, 1.0, 0.5],
];
const CORNER_FACES: [&[usize]; 10] = [
    &[3, 2, 1, 0],
    &[5, 4, 3, 0],
    &[6, 7, 8, 9],
    &[6, 9, 10, 11],
    &[0, 1, 7, 6],
    &[1, 2, 8, 7],
    &[2, 3, 9, 8],
    &[3, 4, 10, 9],
    &[4, 5, 11, 10],
    &[5, 0, 6, 11],
];

/// Obstacles of a kind, in the middle of the gap.
fn obstacles(kind: usize, stream: &mut Stream) -> Vec<Polygon> {
    let centre = |stream: &mut Stream| {
        Vec3::new(0.5 * stream.uniform() - 0.25, 0.5 * stream.uniform() - 0.25, 0.4 + 0.2 * stream.uniform())
    };
    match kind {
        0 => turned(&CUBE[..4], &[&[0, 1, 2, 3]], 0.2, centre(stream), stream),
        1 => turned(&CUBE, &CUBE_FACES, 0.15, centre(stream), stream),
        2 => turned(&CORNER, &CORNER_FACES, 0.2, centre(stream), stream),
        // A cube open at one side, and two that may overlap.
        3 => turned(&CUBE, &CUBE_FACES[1..], 0.15, centre(stream), stream),
        4 => [1, 1].iter().flat_map(|kind| obstacles(*kind, stream)).collect(),
        5 => (0..3).flat_map(|_| obstacles(0, stream)).collect(),
        // Two bricks side by side or one behind the other: edges of both in one plane.
        6 => (0..2).flat_map(|_| brick(stream)).collect(),
        _ => ball(10, 0.1 + 0.1 * stream.uniform(), centre(stream)),
    }
}

/// A cube along the axes, its corners on a grid.
fn brick(stream: &mut Stream) -> Vec<Polygon> {
    let mut grid = |n: f64| (n * stream.uniform()).floor() * 0.125;
    let centre = Vec3::new(grid(5.0) - 0.25, grid(5.0) - 0.25, 0.375 + grid(3.0));
    let corner = |k: usize| centre + 0.0625 * Vec3::from_array(CUBE[k]);
    CUBE_FACES.iter().map(|face| Polygon::new(face.iter().map(|k| corner(*k)).collect()).unwrap()).collect()
}

/// A sphere in n sectors and n/2 rings.
fn ball(n: usize, radius: f64, centre: Vec3) -> Vec<Polygon> {
    let n_rings = n / 2;
    let at = |ring: usize, sector: usize| {
        let (polar, azimuth) = (PI * ring as f64 / n_rings as f64, 2.0 * PI * (sector % n) as f64 / n as f64);
        // Poles lie on the axis exactly.
        let sine = if ring == 0 || ring == n_rings { 0.0 } else { polar.sin() };
        centre + radius * Vec3::new(sine * azimuth.cos(), sine * azimuth.sin(), polar.cos())
    };
    let facet = |ring: usize, sector: usize| {
        let [a, b] = [sector, sector + 1].map(|sector| at(ring + 1, sector));
        let [d, c] = [sector, sector + 1].map(|sector| at(ring, sector));
        let corners = if ring == 0 { vec![a, b, c] } else { vec![a, b, c, d] };
        Polygon::new(if ring + 1 == n_rings { vec![b, c, d] } else { corners }).unwrap()
    };
    (0..n_rings).flat_map(|ring| (0..n).map(move |sector| facet(ring, sector))).collect()
}

const N_KINDS: usize = 8;

/// Whether a kind is one convex body, so that nothing is left to refinement and any tolerance is reached.
const IS_ALONE: [bool; N_KINDS] = [true, true, false, true, false, false, false, true];

/// Σ cosθ cosθ' / r² V over random segments, as T and its standard error.
fn by_rays(pair: &[Polygon; 2], all: &[Polygon], n: usize, stream: &mut Stream) -> (f64, f64) {
    let tracer = Tracer::new(&all.iter().collect::<Vec<_>>());
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..n {
        let (x, y) = (pair[0].sample(stream.uniform2()), pair[1].sample(stream.uniform2()));
        let d = y - x;
        let cosines = pair[0].normal().dot(d).max(0.0) * (-pair[1].normal().dot(d)).max(0.0);
        let seen = cosines > 0.0 && !tracer.occluded(x, y, [0, 1]);
        let value = if seen { cosines / d.length_squared().powi(2) } else { 0.0 };
        sum += value;
        squares += value * value;
    }
    let areas = pair[0].area() * pair[1].area();
    let mean = sum / n as f64;
    let variance = (squares / n as f64 - mean * mean) / n as f64;
    (areas * mean, areas * variance.sqrt())
}

#[test]
fn shadows_are_those_that_rays_find() {
    // At most 320 comparisons at a total significance of 1e-6: 3e-9 each, 6.0 standard errors of a normal mean.
    const LIMIT: f64 = 6.0;
    let mut stream = Stream::new(0x7368_6164, 0, 0);
    let (mut n_partial, n_trials) = (0, n_trials(8, 40));
    for kind in 0..N_KINDS {
        for trial in 0..n_trials {
            let pair = across(&mut stream);
            let mut all = pair.to_vec();
            all.extend(obstacles(kind, &mut stream));
            let system = exchange(&scene_of(&all, false), WHOLE, 1e-5);
            let found = entry(&system, 0, 1);
            let (expected, error) = by_rays(&pair, &all, 20_000, &mut stream);
            n_partial += usize::from(system.report().n_integrated > 0);
            // What the tolerance leaves open is on top.
            let allowed = LIMIT * error + estimate(&system, 0, 1) + 1e-5 * PI * pair[0].area().min(pair[1].area());
            assert!((found - expected).abs() <= allowed, "kind {kind}, {trial}: {found} for {expected} ± {error}");
        }
    }
    assert!(n_partial > N_KINDS * n_trials * 3 / 4, "{n_partial}");
}

/// The estimate contains what a far smaller tolerance finds, and is within the tolerance where one body hides.
#[test]
fn estimates_contain_the_truth() {
    let mut stream = Stream::new(0x686f_6e65, 0, 0);
    let mut n_pairs = 0;
    for (kind, is_alone) in IS_ALONE.into_iter().enumerate() {
        for trial in 0..n_trials(10, 40) {
            let pair = across(&mut stream);
            let mut all = pair.to_vec();
            all.extend(obstacles(kind, &mut stream));
            let scene = scene_of(&all, false);
            let finer = if is_alone { 1e-9 } else { 1e-6 };
            let (rough, fine) = (exchange(&scene, WHOLE, 1e-4), exchange(&scene, WHOLE, finer));
            if rough.report().n_integrated != 1 {
                continue;
            }
            let mu = PI * pair[0].area().min(pair[1].area());
            assert!(
                !is_alone || estimate(&rough, 0, 1) <= 1e-4 * mu,
                "kind {kind}, {trial}: {}",
                estimate(&rough, 0, 1) / mu
            );
            let change = (entry(&rough, 0, 1) - entry(&fine, 0, 1)).abs();
            let estimates = estimate(&rough, 0, 1) + estimate(&fine, 0, 1) + 1e-12 * mu;
            n_pairs += 1;
            assert!(change <= estimates, "kind {kind}, {trial}: {change:e} for {estimates:e}");
        }
    }
    assert!(n_pairs > 5 * N_KINDS, "{n_pairs}");
}

/// Turned, scaled and numbered anew: the same exchange to the tolerance, or to what the estimates say where it is not reached.
#[test]
fn shadows_do_not_depend_on_where_and_in_which_order() {
    let turn = Mat3::from_axis_angle(Vec3::new(0.36, 0.48, 0.8), 1.2);
    let mut stream = Stream::new(0x7475_726e, 0, 0);
    for (kind, is_alone) in IS_ALONE.into_iter().enumerate() {
        for trial in 0..n_trials(2, 10) {
            let pair = across(&mut stream);
            let mut all = pair.to_vec();
            all.extend(obstacles(kind, &mut stream));
            let tolerance = if is_alone { 1e-9 } else { 1e-5 };
            let system = exchange(&scene_of(&all, false), WHOLE, tolerance);
            let (reference, stated) = (entry(&system, 0, 1), estimate(&system, 0, 1));
            let map = |p: &Polygon| {
                let moved = p.vertices().iter().map(|v| turn * (3.0 * *v) + Vec3::new(5.0, -7.0, 2.0));
                Polygon::new(moved.collect()).unwrap()
            };
            let mut moved: Vec<Polygon> = all.iter().map(map).collect();
            moved.reverse();
            let n = moved.len();
            let system = exchange(&scene_of(&moved, false), WHOLE, tolerance);
            let found = entry(&system, n - 2, n - 1) / 9.0;
            let asked = tolerance * PI * pair[0].area().min(pair[1].area());
            let allowed = stated.max(asked) + (estimate(&system, n - 2, n - 1) / 9.0).max(asked);
            assert!((found - reference).abs() <= allowed, "kind {kind}, {trial}: {found} for {reference}");
        }
    }
}

/// The exchange of the parts of a patch is that of the whole.
#[test]
fn shadows_add_up_over_the_parts_of_a_patch() {
    let mut stream = Stream::new(0x7061_7274, 0, 0);
    for (kind, is_alone) in IS_ALONE.into_iter().enumerate() {
        let tolerance = if is_alone { 1e-9 } else { 1e-5 };
        let pair = across(&mut stream);
        let mut all = pair.to_vec();
        all.extend(obstacles(kind, &mut stream));
        let whole = entry(&exchange(&scene_of(&all, false), WHOLE, tolerance), 0, 1);
        let scene = scene_of(&all, false);
        let bundles = Bundles::new(&scene, Resolution { patch_size: 0.3, n_directions: 1 }).unwrap();
        let parts = exchange(&scene, 0.3, tolerance);
        let of = |facet: usize| {
            let bundles = &bundles;
            (0..bundles.elements().len()).filter(move |e| bundles.patch(*e).unwrap().facet == facet)
        };
        let sum: f64 = of(0).map(|i| of(1).map(|j| entry(&parts, i, j)).sum::<f64>()).sum();
        // Every pair of parts may be off by its own tolerance.
        let mu: f64 = of(0).map(|i| parts.etendue()[i]).sum();
        let allowed = tolerance * mu * of(1).count() as f64;
        assert!(of(0).count() > 4 && (sum - whole).abs() <= allowed, "kind {kind}: {sum} for {whole}");
    }
}
