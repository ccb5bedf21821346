//! The gallery: what its scenes promise, and whether their exact answers are consistent with themselves.

mod cornell;
mod crater;
mod plates;

use etendue::gallery::{self, Entry, Exact};
use etendue::geometry::{Polygon, Ray, Vec3};
use etendue::scene::{Scene, Side, Surface};
use std::collections::HashMap;
use std::f64::consts::PI;

/// A sum of some thousand terms of order one, each rounded: 1e3 × 2⁻⁵³ ≈ 1e-13, with room for atan2.
const SUM_ROUNDING: f64 = 1e-12;

/// Solid angle of a triangle seen from a point, positive where its front faces it (Van Oosterom and Strackee 1983).
fn solid_angle(eye: Vec3, triangle: [Vec3; 3]) -> f64 {
    let [a, b, c] = triangle.map(|v| v - eye);
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    -2.0 * a.dot(b.cross(c)).atan2(denominator)
}

/// Σ signed solid angles of all fronts of these surfaces.
fn seen_from(scene: &Scene, eye: Vec3, is_counted: impl Fn(&str) -> bool) -> f64 {
    let counted = scene.surfaces().iter().filter(|s| is_counted(&s.name));
    let outlines = counted.flat_map(|s| &s.polygons).map(|p| p.vertices());
    outlines.flat_map(|v| v[1..].windows(2).map(|edge| solid_angle(eye, [v[0], edge[0], edge[1]]))).sum()
}

/// Rooms that doors join are one cavity; a partition between them shows its front to one and its back to another, and is no part of
/// the hull.
fn is_hull(surface: &str) -> bool {
    !surface.starts_with("partition")
}

/// Points in the air of each closed scene, and points outside or inside of solids.
fn probes(name: &str) -> (Vec<Vec3>, Vec<Vec3>) {
    let points = |list: &[[f64; 3]]| list.iter().map(|p| Vec3::from_array(*p)).collect();
    match name {
        "furnace-cube" => (points(&[[0.5; 3], [0.01, 0.9, 0.3]]), points(&[[1.01, 0.5, 0.5], [0.5, -2.0, 0.5]])),
        "furnace-sphere" => (points(&[[0.0; 3], [0.5, -0.6, 0.3]]), points(&[[1.0, 0.2, 0.0], [-3.0, 0.1, 0.2]])),
        "corner-box" => (
            points(&[[0.1, 0.1, 0.1], [0.45, 0.46, 0.55], [0.7, 0.02, 0.4]]),
            points(&[[0.45, 0.2, 0.55], [0.6, 0.01, 0.6], [0.45, -0.1, 0.55], [0.5, 0.9, 0.5]]),
        ),
        "floating-block" => (
            points(&[[0.1, 0.1, 0.1], [0.45, 0.5, 0.02], [0.45, 0.5, 0.62], [0.95, 0.05, 0.8]]),
            points(&[[0.45, 0.5, 0.325], [0.55, 0.6, 0.06], [0.45, 0.5, -0.1], [1.2, 0.5, 0.5]]),
        ),
        "two-rooms" => (
            points(&[[1.5, 2.4, 1.5], [3.0, 0.6, 1.5], [6.0, 1.0, 2.0]]),
            points(&[[-0.1, 1.0, 1.0], [1.5, 2.6, 1.5], [7.1, 1.0, 1.0]]),
        ),
        "maze" => (
            points(&[[1.0, 1.9, 1.0], [2.0, 0.5, 0.5], [5.9, 0.1, 3.9], [0.1, 1.0, 2.1]]),
            points(&[[-0.1, 1.0, 1.0], [3.0, 2.1, 1.0], [6.1, 0.5, 3.0]]),
        ),
        other => panic!("no probes for the closed scene '{other}'"),
    }
}

fn closed() -> impl Iterator<Item = &'static Entry> {
    gallery::list().iter().filter(|entry| entry.closed)
}

/// Directed edges of all polygons that no polygon runs through the other way, compared bit for bit.
fn open_edges(scene: &Scene) -> Vec<(Vec3, Vec3)> {
    let bits = |v: Vec3| (v + Vec3::ZERO).to_array().map(f64::to_bits);
    let mut balance = HashMap::new();
    for p in scene.surfaces().iter().flat_map(|s| &s.polygons) {
        let n = p.vertices().len();
        for (a, b) in (0..n).map(|i| (p.vertices()[i], p.vertices()[(i + 1) % n])) {
            let (key, way) = if bits(a) < bits(b) { ((bits(a), bits(b)), 1) } else { ((bits(b), bits(a)), -1) };
            balance.entry(key).or_insert((0, a, b)).0 += way;
        }
    }
    balance.into_values().filter(|(count, ..)| *count != 0).map(|(_, a, b)| (a, b)).collect()
}

#[test]
fn names_are_unique_and_resolve() {
    for (i, entry) in gallery::list().iter().enumerate() {
        assert_eq!((entry.build)().name(), entry.name);
        assert_eq!(gallery::find(entry.name).map(|e| e.name), Some(entry.name));
        assert!(gallery::list()[..i].iter().all(|other| other.name != entry.name));
        assert!(!entry.summary.contains('\n') && entry.summary.len() <= 100, "{}", entry.summary);
    }
    assert!(gallery::find("cornell_box").is_none());
    assert_eq!(gallery::closest("cornel-bx").map(|e| e.name), Some("cornell-box"));
    assert_eq!(gallery::closest("two-romos").map(|e| e.name), Some("two-rooms"));
    assert!(gallery::closest("cornerbx--").is_none());
    assert!(gallery::closest("").is_none());
}

#[test]
fn every_scene_emits_reflects_and_shows_its_fronts() {
    for entry in gallery::list() {
        let scene = (entry.build)();
        assert!(gallery::emitted_power(&scene).iter().all(|power| *power > 0.0), "{}", entry.name);
        let albedos = scene.surfaces().iter().flat_map(|s| s.brdf(Side::Front)).flat_map(|b| b.lambertian().unwrap());
        assert!(albedos.clone().all(|a| (0.0..1.0).contains(a)) && albedos.clone().any(|a| *a > 0.0), "{}", entry.name);

        // Shoot a coarse grid of rays: most of the picture shows fronts, and none of it the black back of a wall.
        let camera = scene.camera().unwrap();
        let (width, height) = (camera.film.width as f64, camera.film.height as f64);
        let grid = (0..256).map(|k| ((k % 16) as f64 + 0.37, (k / 16) as f64 + 0.59));
        let seen: Vec<_> =
            grid.filter_map(|(x, y)| first_met(&scene, camera.ray(x * width / 16.0, y * height / 16.0))).collect();
        let n_fronts = seen.iter().filter(|side| **side == Side::Front).count();
        assert!(n_fronts > 128, "{}: {n_fronts} of 256", entry.name);
        assert!(entry.name == "spherical-crater" || n_fronts == seen.len(), "{}", entry.name);
        assert!(!entry.closed || n_fronts == 256, "{}: {n_fronts} of 256", entry.name);
    }
}

/// The side that a ray meets first; the back of the partition counts as a front, for it reflects.
fn first_met(scene: &Scene, ray: Ray) -> Option<Side> {
    let meet = |surface: &Surface, p: &Polygon| {
        let descent = p.normal().dot(ray.direction);
        let t = p.normal().dot(p.centroid() - ray.origin) / descent;
        let v = p.vertices();
        let is_left = |i: usize| (v[(i + 1) % v.len()] - v[i]).cross(ray.at(t) - v[i]).dot(p.normal()) > 0.0;
        let side = if descent < 0.0 || surface.back.is_some() { Side::Front } else { Side::Back };
        (t > 0.0 && (0..v.len()).all(is_left)).then_some((t, side))
    };
    let met = scene.surfaces().iter().flat_map(|s| s.polygons.iter().filter_map(move |p| meet(s, p)));
    met.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, side)| side)
}

#[test]
fn presets_are_a_few_hundred_to_two_thousand_patches() {
    for entry in gallery::list() {
        let scene = (entry.build)();
        let pieces = |a: Vec3, b: Vec3| (a.distance(b) / entry.patch_size - 1e-9).ceil().max(1.0);
        let patches = |v: &[Vec3]| match v.len() {
            3 => pieces(v[0], v[1]).max(pieces(v[1], v[2])).max(pieces(v[2], v[0])).powi(2),
            _ => pieces(v[0], v[1]).max(pieces(v[2], v[3])) * pieces(v[1], v[2]).max(pieces(v[3], v[0])),
        };
        let sides: f64 = scene
            .surfaces()
            .iter()
            .flat_map(|s| {
                s.polygons.iter().map(move |p| patches(p.vertices()) * if s.back.is_some() { 2.0 } else { 1.0 })
            })
            .sum();
        assert!((200.0..2500.0).contains(&sides), "{}: {sides}", entry.name);
    }
}

#[test]
fn closed_scenes_surround_the_air_and_nothing_else() {
    for entry in closed() {
        let scene = (entry.build)();
        let (air, elsewhere) = probes(entry.name);
        for eye in air {
            let seen = seen_from(&scene, eye, is_hull);
            assert!((seen - 4.0 * PI).abs() < SUM_ROUNDING * 4.0 * PI, "{} from {eye}: {seen}", entry.name);
        }
        for eye in elsewhere {
            let seen = seen_from(&scene, eye, is_hull);
            assert!(seen.abs() < SUM_ROUNDING * 4.0 * PI, "{} from {eye}: {seen}", entry.name);
        }
    }
    assert_eq!(closed().count(), 6);
}

#[test]
fn normals_of_closed_scenes_balance() {
    for entry in closed() {
        let scene = (entry.build)();
        let hull = || scene.surfaces().iter().filter(|s| is_hull(&s.name)).flat_map(|s| &s.polygons);
        let total: Vec3 = hull().map(|p| p.area() * p.normal()).sum();
        let area: f64 = hull().map(|p| p.area()).sum();
        assert!(total.length() < SUM_ROUNDING * area, "{}: {total}", entry.name);
    }
}

#[test]
fn polyhedra_share_their_edges_bit_for_bit() {
    for name in ["furnace-cube", "furnace-sphere", "corner-box", "floating-block"] {
        let scene = (gallery::find(name).unwrap().build)();
        assert_eq!(open_edges(&scene), [], "{name}");
    }
}

#[test]
fn furnace_answers_satisfy_their_equation() {
    for name in ["furnace-cube", "furnace-sphere"] {
        let entry = gallery::find(name).unwrap();
        let scene = (entry.build)();
        let Some(exact @ Exact::Uniform { .. }) = (entry.exact)() else { panic!("{name}") };
        assert!(exact.holds_on_any_mesh());
        let Exact::Uniform { radiance } = exact else { unreachable!() };
        for (surface, (band, l)) in
            scene.surfaces().iter().flat_map(|s| radiance.iter().enumerate().map(move |l| (s, l)))
        {
            let albedo = surface.front.lambertian().unwrap()[band];
            assert!((surface.emission[band] + albedo * l - l).abs() <= 2.0 * f64::EPSILON * l);
        }
        assert!(radiance.windows(2).any(|l| l[0] != l[1]));
    }
}

#[test]
fn furnaces_refuse_what_is_no_albedo() {
    assert!(gallery::furnace_cube(&[1.1], &[1.0]).is_err());
    assert!(gallery::furnace_cube(&[], &[]).is_err());
    assert!(gallery::furnace_cube(&[0.5, 0.5], &[1.0]).is_err());
    assert!(gallery::furnace_sphere(0, &[0.5], &[0.0]).is_err());
    assert!(gallery::furnace_sphere(0, &[f64::NAN], &[1.0]).is_err());
    assert!(gallery::spherical_crater(&[0.5], 0).is_err());
    assert!(gallery::spherical_crater(&[], 3).is_err());
}

#[test]
fn the_sphere_approaches_a_sphere() {
    // Area and deviation err by a term of the second order in the edge: a factor of four a subdivision, to 5 % once
    // edges are short.
    let errors = |n| {
        let scene = gallery::furnace_sphere(n, &[0.5], &[1.0]).unwrap();
        let sphere = &scene.surfaces()[0];
        let tessellation = sphere.tessellation.clone().unwrap();
        assert_eq!(tessellation.n_polygons, 20 << (2 * n));
        assert_eq!(tessellation.n_polygons, sphere.polygons.len());
        [1.0 - sphere.area() / (4.0 * PI), tessellation.deviation]
    };
    let (coarse, fine) = (errors(3), errors(4));
    for (c, f) in coarse.iter().zip(fine) {
        assert!((c / f - 4.0).abs() < 0.2, "{c} {f}");
    }
}

#[test]
fn energy_balances_name_the_emitted_power() {
    let power = |name: &str| match (gallery::find(name).unwrap().exact)() {
        Some(Exact::AbsorbedPower { power }) => power,
        other => panic!("{name}: {other:?}"),
    };
    // The corner box's ceiling is 1.0 × 1.2, the rooms' lamps 0.5 × 0.5.
    for (found, radiance) in power("corner-box").iter().zip([2.0, 1.5, 1.0]) {
        assert!((found - PI * 1.2 * radiance).abs() < 4.0 * f64::EPSILON * found);
    }
    for name in ["two-rooms", "maze"] {
        for (found, radiance) in power(name).iter().zip([50.0, 45.0, 40.0]) {
            assert!((found - PI * 0.25 * radiance).abs() < 4.0 * f64::EPSILON * found);
        }
    }
}

#[test]
fn the_block_stands_on_the_floor_and_is_turned() {
    let scene = gallery::corner_box();
    let surface = |name: &str| scene.surfaces().iter().find(|s| s.name == name).unwrap();
    let footprint = 0.34 * 0.44;
    assert!((surface("floor").area() - (1.2 - footprint)).abs() < SUM_ROUNDING);
    assert!((surface("block").area() - (footprint + 0.45 * 2.0 * (0.34 + 0.44))).abs() < SUM_ROUNDING);
    let axes = [Vec3::X, Vec3::Z];
    let sides = surface("block").polygons.iter().map(|p| p.normal()).filter(|n| n.y.abs() < 0.5);
    assert!(sides.clone().count() == 4 && sides.clone().all(|n| axes.iter().all(|a| n.dot(*a).abs() > 0.4)));
}

/// The race's numbers: facets, areas, and the same closed surface at any cut.
#[test]
fn the_floating_block_is_cut_without_a_seam() {
    for (n, n_facets) in [(1, 12), (4, 102), (10, 654), (16, 1_686)] {
        let scene = gallery::floating_block(n).unwrap();
        assert_eq!(scene.facets().len(), n_facets);
        assert_eq!(open_edges(&scene), [], "{n}");
        let block = scene.surfaces().iter().find(|s| s.name == "block").unwrap();
        assert!((block.area() - (2.0 * 0.09 + 4.0 * 0.3 * 0.55)).abs() < SUM_ROUNDING);
    }
    assert!(gallery::floating_block(0).is_err());
}

#[test]
fn the_partition_closes_all_but_the_door() {
    let scene = gallery::two_rooms();
    let partition = scene.surfaces().iter().find(|s| s.name == "partition").unwrap();
    assert!(partition.back.is_some());
    assert_eq!(partition.area(), 2.5 * 3.0 - 0.5 * 1.25);
    assert!(partition.polygons.iter().all(|p| p.normal() == -Vec3::X && p.vertices().iter().all(|v| v.x == 3.0)));

    let lit: f64 =
        scene.surfaces().iter().filter(|s| s.name.starts_with("lit") || s.name == "lamp").map(|s| s.area()).sum();
    let dim: f64 = scene.surfaces().iter().filter(|s| s.name.starts_with("dim")).map(|s| s.area()).sum();
    assert_eq!(lit, 2.0 * 9.0 + 3.0 * 7.5);
    assert_eq!(dim, 2.0 * 12.0 + 2.0 * 10.0 + 7.5);
}

#[test]
fn partitions_of_the_maze_leave_five_doors() {
    let scene = gallery::maze();
    let partitions = scene.surfaces().iter().find(|s| s.name == "partitions").unwrap();
    assert!(partitions.back.is_some());
    assert_eq!(partitions.area(), 7.0 * 4.0 - 5.0 * 0.5);
    let hull: f64 = scene.surfaces().iter().filter(|s| is_hull(&s.name)).map(Surface::area).sum();
    assert_eq!(hull, 2.0 * 24.0 + 2.0 * 12.0 + 2.0 * 8.0);
}
