//! Closure before any repair: every scene of the gallery, open and closed, and planes in which more lies than one surface.

use super::scenes::polygon;
use super::shadows::closed_cornell_box;
use etendue::assembly::{Exchange, Occlusion, System, assemble};
use etendue::basis::{Bundles, Resolution};
use etendue::gallery;
use etendue::geometry::Polygon;
use etendue::scattering::Lambert;
use etendue::scene::{Scene, SceneDescription, Surface};
use std::f64::consts::PI;
use std::sync::Arc;

/// The adaptive default, and what closed scenes promise for it.
const DEFAULT: (f64, f64) = (1e-7, 1e-6);
/// What is asked for where more digits are wanted, and what closed scenes promise for it.
const REQUEST: (f64, f64) = (1e-10, 1e-9);
/// After repair: some ulp for every sweep over a row.
const REPAIRED: f64 = 1e-13;

fn assembled(scene: &Scene, patch_size: f64, occlusion: Occlusion, repair: bool) -> System {
    let bundles = Bundles::new(scene, Resolution { patch_size, n_directions: 1 }).unwrap();
    assemble(scene, &bundles, Exchange { occlusion, repair, ..Exchange::default() }).unwrap()
}

fn is_large() -> bool {
    std::env::var_os("ETENDUE_LARGE").is_some()
}

/// Coarse meshes; with `ETENDUE_LARGE=1` those that the command line takes.
#[test]
fn every_scene_of_the_gallery_closes_before_any_repair() {
    for entry in gallery::list() {
        let patch_size = match entry.name {
            _ if is_large() => entry.patch_size,
            "cornell-box" => 1.0,
            // Of triangles that are never cut.
            "furnace-sphere" | "spherical-crater" => entry.patch_size,
            _ => 2.5 * entry.patch_size,
        };
        let scene = (entry.build)();
        let system = assembled(&scene, patch_size, Occlusion::Exact { tolerance: DEFAULT.0 }, false);
        let found = system.report().closure_before_repair;
        assert!(found < DEFAULT.1, "{}: {found:e}", entry.name);
        assert_eq!(system.sinks().max_abs() == 0.0, entry.closed, "{}", entry.name);
    }
}

#[test]
fn closed_scenes_with_obstacles_close_as_far_as_asked_and_to_rounding_once_repaired() {
    let scenes = [("corner-box", gallery::corner_box()), ("two-rooms", gallery::two_rooms())];
    let cornell = ("closed cornell-box", closed_cornell_box());
    for (name, scene) in scenes.into_iter().chain(is_large().then_some(cornell)) {
        for patch_size in [0.5, 0.25] {
            for (tolerance, allowed) in [DEFAULT, REQUEST] {
                let system = assembled(&scene, patch_size, Occlusion::Exact { tolerance }, true);
                let (before, after) = (system.report().closure_before_repair, system.laws().closure);
                assert!(before < allowed, "{name} in {patch_size} at {tolerance:e}: {before:e} before repair");
                assert!(after < REPAIRED, "{name} in {patch_size} at {tolerance:e}: {after:e} after repair");
            }
        }
    }
}

/// A rectangle at this height, facing up or down.
fn rectangle([x0, x1]: [f64; 2], [y0, y1]: [f64; 2], z: f64, faces_up: bool) -> Polygon {
    let mut corners = [[x0, y0, z], [x1, y0, z], [x1, y1, z], [x0, y1, z]];
    if !faces_up {
        corners.reverse();
    }
    polygon(&corners)
}

/// A scene of one-sided and two-sided rectangles, all of albedo ½ and emission 1.
fn scene_of_sides(parts: &[(Polygon, bool)]) -> Scene {
    let surface = |(k, (polygon, is_two_sided)): (usize, &(Polygon, bool))| Surface {
        name: format!("part-{k}"),
        polygons: vec![polygon.clone()],
        front: Arc::new(Lambert::grey(0.5, 1)),
        back: is_two_sided.then(|| Arc::new(Lambert::grey(0.5, 1)) as _),
        emission: vec![1.0],
        tessellation: None,
    };
    Scene::new(SceneDescription {
        name: "parts".to_string(),
        bands: vec!["grey".to_string()],
        surfaces: parts.iter().enumerate().map(surface).collect(),
        camera: None,
    })
    .unwrap()
}

/// Every order of so many things (Heap 1963).
fn permutations(n: usize) -> Vec<Vec<usize>> {
    fn visit(k: usize, order: &mut Vec<usize>, found: &mut Vec<Vec<usize>>) {
        if k <= 1 {
            found.push(order.clone());
            return;
        }
        for i in 0..k {
            visit(k - 1, order, found);
            order.swap(if k.is_multiple_of(2) { i } else { 0 }, k - 1);
        }
    }
    let mut found = Vec::new();
    visit(n, &mut (0..n).collect(), &mut found);
    found
}

/// Under an observer that looks down lie, all in one plane: two black backs that overlap, a front inside one of them, a two-sided sheet
/// across the border of both, and a black back hidden by the sheet altogether.
#[test]
fn at_every_point_of_a_plane_one_thing_is_seen() {
    let parts = [
        (rectangle([-0.4, 0.6], [-0.5, 0.5], 1.0, false), false),
        (rectangle([-1.0, 0.5], [-1.0, 1.0], 0.0, false), false),
        (rectangle([0.0, 1.5], [-0.7, 0.8], 0.0, false), false),
        (rectangle([-0.8, -0.3], [-0.6, 0.7], 0.0, true), false),
        (rectangle([0.2, 1.1], [0.3, 1.2], 0.0, false), true),
        (rectangle([0.4, 0.9], [0.4, 1.0], 0.0, false), false),
    ];
    // What the observer sees black: the union of the first two backs, 3 + 2.25 − 0.75, less 0.65 and the 0.49 that the sheet covers of it.
    let black = |system: &System, observer: usize| system.sinks().row(observer).nth(1).unwrap();
    let mut first: Option<[f64; 3]> = None;
    for order in permutations(parts.len()) {
        let ordered: Vec<(Polygon, bool)> = order.iter().map(|k| parts[*k].clone()).collect();
        let scene = scene_of_sides(&ordered);
        // A bundle for every front, and one for the back of what has two sides, after its front.
        let observer = ordered.iter().take_while(|(p, _)| *p != parts[0].0).map(|(_, two)| 1 + usize::from(*two)).sum();
        let system = assembled(&scene, 1e3, Occlusion::Exact { tolerance: 1e-10 }, false);
        // Nothing hides anything: only rounding is left.
        assert!(system.report().closure_before_repair < 1e-9, "{order:?}: {:e}", system.report().closure_before_repair);
        let mut seen = 0.0;
        system.exchange().for_each_in_row(observer, |_, t| seen += t);
        let shares = [seen, black(&system, observer), system.sinks().row(observer).next().unwrap()];
        let known = *first.get_or_insert(shares);
        assert!(shares.iter().zip(&known).all(|(a, b)| (a / b - 1.0).abs() < 1e-9), "{order:?}: {shares:?}, {known:?}");
    }

    // Rays agree, whichever facet they say they hit.
    let n_rays = 1 << 14;
    let by_rays = Occlusion::Sampled { rays: 64, sink_rays: n_rays };
    let [_, darkened, escaped] = first.unwrap();
    let mu = PI * parts[0].0.area();
    for rotation in 0..parts.len() {
        let ordered: Vec<(Polygon, bool)> =
            (0..parts.len()).map(|k| parts[(k + rotation) % parts.len()].clone()).collect();
        let observer = ordered.iter().take_while(|(p, _)| *p != parts[0].0).map(|(_, two)| 1 + usize::from(*two)).sum();
        let system = assembled(&scene_of_sides(&ordered), 1e3, by_rays, false);
        let found = [black(&system, observer), system.sinks().row(observer).next().unwrap()];
        for (found, share) in found.into_iter().zip([darkened / mu, escaped / mu]) {
            // Points spread evenly do better than the binomial's five standard errors, which chance exceeds once in 10⁶.
            let sigma = (share * (1.0 - share) / n_rays as f64).sqrt();
            assert!((found / mu - share).abs() < 5.0 * sigma, "{rotation}: {} for {share}", found / mu);
        }
    }
}
