//! Patches: they partition their polygon, share corners, and are found again from points.

use super::scenes::{polygon, scene_of};
use etendue::basis::{BasisError, Bundles, Resolution};
use etendue::geometry::{Polygon, Vec3};
use etendue::sampling::Stream;
use etendue::scene::Side;
use std::collections::HashMap;
use std::f64::consts::PI;

/// Areas are sums of some hundred pieces, each rounded.
const AREA: f64 = 1e-12;
/// Points are located by a quotient of rounded coordinates of order one.
const ON_BORDER: f64 = 1e-10;

/// One of each kind of grid, and awkward ones: a thin trapezoid, a quadrilateral with a corner on an edge.
fn outlines() -> Vec<(&'static str, Polygon)> {
    let regular = |n: usize| -> Polygon {
        let corner = |k: usize| {
            let angle = std::f64::consts::TAU * k as f64 / n as f64;
            Vec3::new(angle.cos(), angle.sin(), 0.3 * angle.cos() - 0.2 * angle.sin())
        };
        Polygon::new((0..n).map(corner).collect()).unwrap()
    };
    vec![
        ("triangle", polygon(&[[0.0, 0.0, 0.0], [1.3, 0.1, 0.2], [0.2, 0.9, -0.4]])),
        ("sliver", polygon(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.01, 0.0]])),
        ("rectangle", polygon(&[[0.0, 0.0, 1.0], [2.0, 0.0, 1.0], [2.0, 0.7, 1.0], [0.0, 0.7, 1.0]])),
        ("parallelogram", polygon(&[[0.0, 0.0, 0.0], [1.0, 0.5, 0.25], [1.5, 2.0, 0.75], [0.5, 1.5, 0.5]])),
        ("quadrilateral", polygon(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.8, 0.6, 0.0], [0.1, 0.9, 0.0]])),
        ("trapezoid", polygon(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.52, 1.0, 0.0], [0.48, 1.0, 0.0]])),
        ("triangle of four", polygon(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.0, 1.0, 0.0]])),
        ("pentagon", regular(5)),
        ("heptagon", regular(7)),
    ]
}

fn bundles_of(outline: &Polygon, patch_size: f64, are_two_sided: bool) -> Bundles {
    let scene = scene_of(std::slice::from_ref(outline), are_two_sided);
    let resolution = Resolution { patch_size, n_directions: 1 };
    let bundles = Bundles::new(&scene, resolution).unwrap();
    assert_eq!(Bundles::count(&scene, resolution), Ok(bundles.n_bundles()));
    bundles
}

fn patches(bundles: &Bundles) -> Vec<&Polygon> {
    (0..bundles.elements().len()).map(|e| &bundles.patch(e).unwrap().polygon).collect()
}

/// How deep inside of its nearest edge a point of the plane lies; negative outside.
fn depth(polygon: &Polygon, point: Vec3) -> f64 {
    let v = polygon.vertices();
    let edges = (0..v.len()).map(|k| (v[k], v[(k + 1) % v.len()])).filter(|(a, b)| a.distance(*b) > 1e-12);
    edges.map(|(a, b)| polygon.normal().cross(b - a).dot(point - a) / a.distance(b)).fold(f64::INFINITY, f64::min)
}

fn perimeter(polygon: &Polygon) -> f64 {
    let v = polygon.vertices();
    (0..v.len()).map(|k| v[k].distance(v[(k + 1) % v.len()])).sum()
}

#[test]
fn patches_partition_area_and_etendue() {
    for (name, outline) in outlines() {
        for patch_size in [10.0, 0.3, 0.11] {
            let bundles = bundles_of(&outline, patch_size, false);
            let area: f64 = patches(&bundles).iter().map(|p| p.area()).sum();
            assert!((area / outline.area() - 1.0).abs() < AREA, "{name} at {patch_size}: {area}");
            let etendue: f64 = bundles.etendue().iter().sum();
            assert!((etendue / (PI * outline.area()) - 1.0).abs() < AREA, "{name} at {patch_size}: {etendue}");
            for patch in patches(&bundles) {
                assert!(patch.normal().distance(outline.normal()) < 1e-9, "{name} at {patch_size}");
                assert!(depth(&outline, patch.centroid()) > 0.0, "{name} at {patch_size}");
                let v = patch.vertices();
                let longest = (0..v.len()).map(|k| v[k].distance(v[(k + 1) % v.len()])).fold(0.0, f64::max);
                assert!(longest <= patch_size * (1.0 + 1e-8), "{name} at {patch_size}: {longest}");
            }
        }
    }
}

#[test]
fn two_sides_have_twice_the_etendue_and_opposite_normals() {
    for (name, outline) in outlines() {
        let bundles = bundles_of(&outline, 0.3, true);
        let n = bundles.n_bundles() / 2;
        let etendue: f64 = bundles.etendue().iter().sum();
        assert!((etendue / (2.0 * PI * outline.area()) - 1.0).abs() < AREA, "{name}");
        for k in 0..n {
            let [front, back] = [k, n + k].map(|e| bundles.patch(e).unwrap());
            assert_eq!((front.side, back.side), (Side::Front, Side::Back));
            assert_eq!(front.polygon.normal(), -back.polygon.normal());
            assert_eq!(front.polygon.centroid(), back.polygon.centroid());
            let point = front.polygon.centroid();
            assert_eq!(bundles.locate(0, Side::Front, point, Vec3::Z), Some(k), "{name}");
            assert_eq!(bundles.locate(0, Side::Back, point, Vec3::Z), Some(n + k), "{name}");
        }
    }
    // A black back is no element.
    let bundles = bundles_of(&outlines()[0].1, 0.3, false);
    assert_eq!(bundles.locate(0, Side::Back, Vec3::ZERO, Vec3::Z), None);
}

#[test]
fn centroids_and_random_points_are_found_in_their_patch() {
    let mut stream = Stream::new(0x6c6f_6361, 0, 0);
    for (name, outline) in outlines() {
        for patch_size in [10.0, 0.3, 0.0631] {
            let bundles = bundles_of(&outline, patch_size, false);
            let patches = patches(&bundles);
            for (k, patch) in patches.iter().enumerate() {
                let found = bundles.locate(0, Side::Front, patch.centroid(), Vec3::Z);
                assert_eq!(found, Some(k), "{name} at {patch_size}");
            }
            for _ in 0..2_000 {
                let point = outline.sample(stream.uniform2());
                let k = bundles.locate(0, Side::Front, point, Vec3::Z).unwrap();
                let depth = depth(patches[k], point);
                assert!(depth > -ON_BORDER, "{name} at {patch_size}: {point} is {depth:e} outside of patch {k}");
            }
            // Corners and points off the polygon by rounding are in some patch all the same.
            for v in outline.vertices() {
                let off = *v + (*v - outline.centroid()) * 1e-13;
                for point in [*v, off] {
                    let k = bundles.locate(0, Side::Front, point, Vec3::Z).unwrap();
                    assert!(depth(patches[k], point) > -1e-7, "{name} at {patch_size}: corner {v}");
                }
            }
        }
    }
}

#[test]
fn random_quadrilaterals_find_their_patches() {
    let mut stream = Stream::new(0x7175_6164, 0, 0);
    let mut n_convex = 0;
    while n_convex < 300 {
        let mut angles: [f64; 4] = std::array::from_fn(|_| stream.uniform() * std::f64::consts::TAU);
        angles.sort_by(f64::total_cmp);
        let corner = |angle: f64| Vec3::new(angle.cos(), 0.7 * angle.sin(), 0.2 * angle.cos());
        let Ok(outline) = Polygon::new(angles.map(corner).to_vec()) else { continue };
        if outline.area() < 1e-2 {
            continue;
        }
        n_convex += 1;
        let bundles = bundles_of(&outline, 0.17, false);
        let patches = patches(&bundles);
        for (k, patch) in patches.iter().enumerate() {
            assert_eq!(bundles.locate(0, Side::Front, patch.centroid(), Vec3::Z), Some(k), "{angles:?}");
        }
        for _ in 0..50 {
            let point = outline.sample(stream.uniform2());
            let k = bundles.locate(0, Side::Front, point, Vec3::Z).unwrap();
            assert!(depth(patches[k], point) > -ON_BORDER, "{angles:?}: {point}");
        }
    }
}

/// Every edge inside is run through once each way, by corners alike to the bit; what is left over is the outline.
#[test]
fn neighbours_share_their_corners_bit_for_bit() {
    for (name, outline) in outlines().iter().filter(|(_, outline)| outline.vertices().len() < 5) {
        let bundles = bundles_of(outline, 0.0931, false);
        let bits = |v: Vec3| (v + Vec3::ZERO).to_array().map(f64::to_bits);
        let mut open: HashMap<_, f64> = HashMap::new();
        for patch in patches(&bundles) {
            let v = patch.vertices();
            for (a, b) in (0..v.len()).map(|k| (v[k], v[(k + 1) % v.len()])) {
                if open.remove(&(bits(b), bits(a))).is_none() {
                    open.insert((bits(a), bits(b)), a.distance(b));
                }
            }
        }
        let left: f64 = open.values().sum();
        assert!((left / perimeter(outline) - 1.0).abs() < AREA, "{name}: {left}");
    }
}

#[test]
fn resolutions_that_make_no_sense_are_refused() {
    let scene = scene_of(&[outlines()[2].1.clone()], false);
    let new = |patch_size, n_directions| Bundles::new(&scene, Resolution { patch_size, n_directions }).map(|_| ());
    for value in [0.0, -1.0, f64::INFINITY] {
        assert_eq!(new(value, 1), Err(BasisError::PatchSize { value }));
    }
    assert!(matches!(new(f64::NAN, 1), Err(BasisError::PatchSize { value }) if value.is_nan()));
    assert_eq!(new(0.1, 0), Err(BasisError::Directions { found: 0 }));
    assert_eq!(new(0.1, 2), Err(BasisError::Directions { found: 2 }));
    // Refused before anything is allocated, however absurd.
    assert!(matches!(new(1e-5, 1), Err(BasisError::TooMany { limit: Bundles::LIMIT, .. })));
    assert!(matches!(new(1e-300, 1), Err(BasisError::TooMany { .. })));
}
