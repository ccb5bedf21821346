//! The crater's answer, held against brute force: its shadow ray by ray, its energy by quadrature over the sphere.

use super::{open_edges, solid_angle};
use etendue::gallery::{self, Continuous, Exact, PointRadiance};
use etendue::geometry::{Polygon, Vec3};
use etendue::scene::Scene;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const HALF_ANGLE: f64 = PI / 3.0;
const RIM_HEIGHT: f64 = -0.5;

fn exact(albedo: &[f64], n_rings: usize) -> Continuous {
    match gallery::spherical_crater_exact(albedo, n_rings) {
        Exact::Continuous(exact) => exact,
        other => panic!("{other:?}"),
    }
}

/// The sun as the scene has it, as the nine points of the 3 × 3 Gauss rule: position and radiance × share of the area.
fn sun(scene: &Scene) -> Vec<(Vec3, f64)> {
    let sun = scene.surfaces().iter().find(|s| s.name == "sun").unwrap();
    let (centre, area, half_side) = (sun.polygons[0].centroid(), sun.area(), 0.5 * sun.area().sqrt());
    let rule = [(-0.6_f64.sqrt(), 5.0 / 18.0), (0.0, 8.0 / 18.0), (0.6_f64.sqrt(), 5.0 / 18.0)];
    let node = |(x, wx): (f64, f64), (z, wz): (f64, f64)| {
        (centre + half_side * Vec3::new(x, 0.0, z), sun.emission[0] * area * wx * wz)
    };
    rule.iter().flat_map(|x| rule.iter().map(move |z| node(*x, *z))).collect()
}

/// Irradiance at p with normal n from a point of the sun, unhindered.
fn unshadowed(p: Vec3, n: Vec3, (sun, strength): (Vec3, f64)) -> f64 {
    let to_sun = sun - p;
    strength * n.dot(to_sun).max(0.0) * to_sun.y / to_sun.length_squared().powi(2)
}

/// Irradiance at a point of the sphere from a point of the sun, zero where the sphere's cap hides it: by
/// intersecting the ray with the sphere.
fn irradiance(p: Vec3, sun: (Vec3, f64)) -> f64 {
    let to_sun = sun.0 - p;
    let other_end = p - to_sun * (2.0 * p.dot(to_sun) / to_sun.length_squared());
    if other_end.y <= RIM_HEIGHT { 0.0 } else { unshadowed(p, -p, sun) }
}

fn on_bowl(angle: f64, azimuth: f64) -> Vec3 {
    Vec3::new(angle.sin() * azimuth.cos(), -angle.cos(), angle.sin() * azimuth.sin())
}

/// ∫ f over [a, b] by the double-exponential rule: takes endpoints where f has a root's infinite slope.
fn tanh_sinh(a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
    let step = 1.0 / 16.0;
    let half = 0.5 * (b - a);
    (-48..=48)
        .map(|k| {
            let t = k as f64 * step;
            let inner = FRAC_PI_2 * t.sinh();
            let weight = step * FRAC_PI_2 * t.cosh() / inner.cosh().powi(2);
            half * weight * f(0.5 * (a + b) + half * inner.tanh())
        })
        .sum()
}

/// Where a predicate turns from false at a to true at b.
fn bisect(mut a: f64, mut b: f64, is_past: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (a + b);
        if is_past(middle) { b = middle } else { a = middle }
    }
    0.5 * (a + b)
}

/// ∫ H dA over the bowl from a point of the sun, ring by ring; on each ring, counted from the azimuth of the sun, the
/// light begins at an azimuth found by bisection.
fn direct_flux(sun: (Vec3, f64)) -> f64 {
    let towards = sun.0.z.atan2(sun.0.x);
    let at = |angle: f64, azimuth: f64| irradiance(on_bowl(angle, azimuth + towards), sun);
    let is_lit = |angle: f64, azimuth: f64| at(angle, azimuth) > 0.0;
    let ring = |angle: f64| {
        let dawn = match (is_lit(angle, 0.0), is_lit(angle, PI)) {
            (true, true) => 0.0,
            (false, false) => return 0.0,
            _ => bisect(0.0, PI, |azimuth| is_lit(angle, azimuth)),
        };
        2.0 * tanh_sinh(dawn, PI, |azimuth| at(angle, azimuth)) * angle.sin()
    };

    // The shadow's edge crosses the plane of symmetry once; rings inside that angle are wholly lit or wholly dark.
    let crossing = bisect(0.0, HALF_ANGLE, |angle| is_lit(angle, PI) != is_lit(angle, 0.0));
    tanh_sinh(0.0, crossing, ring) + tanh_sinh(crossing, HALF_ANGLE, ring)
}

#[test]
fn the_energy_balances_on_the_sphere() {
    let albedo = [0.8, 0.5, 0.2];
    let exact = exact(&albedo, 8);
    let direct: f64 = sun(&gallery::spherical_crater(&albedo, 8).unwrap()).into_iter().map(direct_flux).sum();
    let bowl_area = TAU * (1.0 + RIM_HEIGHT);
    let in_shadow = exact.points.iter().min_by(|a, b| a.radiance[0].total_cmp(&b.radiance[0])).unwrap();
    for (band, albedo) in albedo.into_iter().enumerate() {
        // What the bowl reflects reaches each place of the whole sphere alike.
        let indirect = PI * in_shadow.radiance[band] / albedo;
        let reflected = albedo * (direct + indirect * bowl_area);
        let error = indirect * 4.0 * PI / reflected - 1.0;
        assert!(error.abs() < exact.relative_uncertainty, "{error:e}");
        let error = exact.means[0].radiance[band] * PI * bowl_area / reflected - 1.0;
        assert!(error.abs() < exact.relative_uncertainty, "{error:e}");
    }
}

#[test]
fn light_and_shadow_are_where_rays_say() {
    let exact = exact(&[0.5], 16);
    let sun = sun(&gallery::spherical_crater(&[0.5], 16).unwrap());
    let dark = exact.points.iter().map(|p| p.radiance[0]).fold(f64::MAX, f64::min);
    let (mut n_lit, mut n_shadowed) = (0, 0);
    for point in &exact.points {
        let p = Vec3::from_array(point.position).normalize();
        let direct = 0.5 / PI * sun.iter().map(|node| irradiance(p, *node)).sum::<f64>();
        let error = point.radiance[0] / (dark + direct) - 1.0;
        assert!(error.abs() < exact.relative_uncertainty, "{point:?}: {error:e}");
        if direct > 0.0 { n_lit += 1 } else { n_shadowed += 1 }
    }
    // Both kinds are there in numbers, and only a band along the shadow's edge is left out.
    assert!(n_lit > 300 && n_shadowed > 300 && n_lit + n_shadowed > 6 * 16 * 16 * 3 / 4, "{n_lit} {n_shadowed}");
}

#[test]
fn the_far_limit_is_the_textbook_formula() {
    // At a distance of ten radii, Φ differs from S sin(elevation) π r² by a term of the second order in r/d: 0.75 /
    // 100 × a few.
    let exact = exact(&[0.5], 4);
    let dark = exact.points.iter().map(|p| p.radiance[0]).fold(f64::MAX, f64::min);
    let flux = 25_f64.to_radians().sin() * PI * 0.75;
    let expected = 0.5 / PI * 0.5 * flux / (4.0 * PI) / (1.0 - 0.5 * 0.25);
    assert!((dark / expected - 1.0).abs() < 0.02);
}

#[test]
fn the_bowl_has_no_cracks_and_its_rim_is_a_ring() {
    let n_rings = 5;
    let scene = gallery::spherical_crater(&[0.5], n_rings).unwrap();
    let bowl = &scene.surfaces()[0];
    assert_eq!(bowl.polygons.len(), 6 * n_rings * n_rings);
    let rim: Vec<_> = open_edges(&scene).into_iter().filter(|(a, b)| a.y < 0.0 && b.y < 0.0).collect();
    assert_eq!(rim.len(), 6 * n_rings);
    assert!(rim.iter().all(|(a, b)| (a.y - RIM_HEIGHT).abs() < 1e-15 && (b.y - RIM_HEIGHT).abs() < 1e-15));
    let corners = bowl.polygons.iter().flat_map(|p| p.vertices());
    assert!(corners.clone().all(|v| (v.length() - 1.0).abs() < 1e-15 && v.y < RIM_HEIGHT + 1e-15));

    // Bowl and a lid of triangles over the rim surround a point inside.
    let eye = Vec3::new(0.1, -0.7, 0.2);
    let lid: f64 = rim.iter().map(|(a, b)| solid_angle(eye, [Vec3::Y * RIM_HEIGHT, *a, *b]).abs()).sum();
    let fan = |v: &[Vec3]| solid_angle(eye, [v[0], v[1], v[2]]);
    let seen: f64 = bowl.polygons.iter().map(|p| fan(p.vertices())).sum();
    assert!((seen + lid - 4.0 * PI).abs() < 1e-12 * 4.0 * PI, "{seen} {lid}");
}

/// Form factor from a point with normal n to a triangle wholly above its horizon, by Lambert's sum over the edges.
fn form_factor(p: Vec3, n: Vec3, v: &[Vec3]) -> f64 {
    let edge = |i: usize| {
        let (a, b) = (v[i] - p, v[(i + 1) % 3] - p);
        let across = a.cross(b);
        -n.dot(across) / across.length() * across.length().atan2(a.dot(b))
    };
    (0..3).map(edge).sum::<f64>() / TAU
}

/// Relative differences between the sphere and the scene's own triangles.
#[derive(Debug)]
struct Differences {
    n_rings: usize,
    /// Largest over the exact points.
    points: f64,
    /// Of the bowl's mean.
    mean: f64,
    /// What the gallery says about it.
    estimate: f64,
}

/// Solves the scene's own triangles as a radiosity problem (one unknown a triangle, exact form factors from its
/// centroid: the polyhedron is convex, nothing is hidden), and gathers at the exact points.
fn differences_from_triangles(n_rings: usize) -> Differences {
    let albedo = 0.8;
    let scene = gallery::spherical_crater(&[albedo], n_rings).unwrap();
    let sun = sun(&scene);
    let triangles = &scene.surfaces()[0].polygons;

    // Average the direct light over each triangle: a ray is free if it passes the rim's polygon.
    let apothem = HALF_ANGLE.sin() * (PI / (6 * n_rings) as f64).cos();
    let sector = TAU / (6 * n_rings) as f64;
    let passes = |p: Vec3, sun: Vec3| {
        let exit = p + (sun - p) * ((RIM_HEIGHT - p.y) / (sun.y - p.y));
        let azimuth = (exit.z.atan2(exit.x)).rem_euclid(sector) - 0.5 * sector;
        exit.x.hypot(exit.z) * azimuth.cos() < apothem
    };
    let n = 16;
    let thirds = |i: usize, j: usize, of: f64| ((i as f64 + of) / n as f64, (j as f64 + of) / n as f64);
    let upright = (0..n).flat_map(|i| (0..n - i).map(move |j| thirds(i, j, 1.0 / 3.0)));
    let inverted = (0..n).flat_map(|i| (0..n - i - 1).map(move |j| thirds(i, j, 2.0 / 3.0)));
    let samples: Vec<(f64, f64)> = upright.chain(inverted).collect();
    let direct = |x: Vec3, normal: Vec3| -> f64 {
        sun.iter().filter(|sun| passes(x, sun.0)).map(|sun| unshadowed(x, normal, *sun)).sum()
    };
    let average = |p: &Polygon| {
        let v = p.vertices();
        let at = |(s, t): &(f64, f64)| direct(v[0] + (v[1] - v[0]) * *s + (v[2] - v[0]) * *t, p.normal());
        samples.iter().map(at).sum::<f64>() / samples.len() as f64
    };
    let averages: Vec<f64> = triangles.iter().map(average).collect();

    // Bounce until nothing is left: the bowl sees a quarter of itself, so a bounce keeps a fifth.
    let row = |x: Vec3, p: &Polygon| -> Vec<f64> {
        triangles.iter().map(|q| if p == q { 0.0 } else { form_factor(x, p.normal(), q.vertices()) }).collect()
    };
    let gather = |row: &[f64], field: &[f64]| row.iter().zip(field).map(|(f, b)| f * b).sum::<f64>();
    let rows: Vec<Vec<f64>> = triangles.iter().map(|p| row(p.centroid(), p)).collect();
    let mut radiosity = vec![0.0; triangles.len()];
    for _ in 0..12 {
        radiosity =
            rows.iter().zip(&averages).map(|(row, direct)| albedo * (direct + gather(row, &radiosity))).collect();
    }

    // Gather at the exact points: no point is nearer to the plane of another triangle, for the polyhedron is convex.
    let exact = exact(&[albedo], n_rings);
    let relative = |point: &PointRadiance| {
        let x = Vec3::from_array(point.position);
        let height = |p: &Polygon| (x - p.centroid()).dot(p.normal());
        let p = triangles.iter().min_by(|p, q| height(p).total_cmp(&height(q))).expect("there are triangles");
        let found = albedo * (direct(x, p.normal()) + gather(&row(x, p), &radiosity)) / PI;
        (found / point.radiance[0] - 1.0).abs()
    };
    let points = exact.points.iter().map(relative).fold(0.0, f64::max);
    let power: f64 = triangles.iter().zip(&radiosity).map(|(p, b)| p.area() * b).sum();
    let mean = power / triangles.iter().map(Polygon::area).sum::<f64>() / PI;
    Differences {
        n_rings,
        points,
        mean: (mean / exact.means[0].radiance[0] - 1.0).abs(),
        estimate: exact.tessellation_error,
    }
}

#[test]
fn triangles_approach_the_sphere_in_second_order() {
    let all = [4, 8, 16].map(differences_from_triangles);
    for d in &all {
        assert!(d.points < d.estimate && d.mean < 0.1 * d.estimate, "{d:?}");
    }

    // Measured: 1.0e-2, 2.7e-3, 8.5e-4. The largest of a thousand differences scatters by where the shadow cuts, so
    // ask for 3/2.
    let order = (all[0].points / all[2].points).ln() / (all[2].n_rings as f64 / all[0].n_rings as f64).ln();
    assert!(order > 1.5, "{order}: {all:?}");
}
