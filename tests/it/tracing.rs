//! Rays: nothing escapes through an edge, nothing is met that is not there.

use super::scenes::polygon;
use etendue::gallery;
use etendue::geometry::{Frame, Mat3, Polygon, Ray, Tracer, Vec3};
use etendue::sampling::{Stream, warp};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Brute force decides by plain f64 products of coordinates of order one: what it finds within this of an edge, it leaves open.
pub const MARGIN: f64 = 1e-9;

pub fn polygons_of(name: &str) -> Vec<Polygon> {
    let scene = (gallery::find(name).unwrap().build)();
    (0..scene.facets().len()).map(|facet| scene.polygon(facet).clone()).collect()
}

pub fn mapped(polygons: &[Polygon], map: impl Fn(Vec3) -> Vec3) -> Vec<Polygon> {
    polygons.iter().map(|p| Polygon::new(p.vertices().iter().map(|v| map(*v)).collect()).unwrap()).collect()
}

fn tracer_of(polygons: &[Polygon]) -> Tracer {
    Tracer::new(&polygons.iter().collect::<Vec<_>>())
}

pub fn point(stream: &mut Stream, half: f64) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| half * (2.0 * stream.uniform() - 1.0)))
}

/// An index below n.
pub fn pick(stream: &mut Stream, n: usize) -> usize {
    ((stream.uniform() * n as f64) as usize).min(n - 1)
}

/// A closed mesh of triangles with bumps: adjacent ones meet at all angles, and twenty-four in each of two corners.
fn bumpy_sphere() -> Vec<Polygon> {
    const N: usize = 24;
    let point = |i: usize, j: usize| {
        let (polar, around) = (i as f64 / N as f64 * PI, (j % N) as f64 / N as f64 * TAU);
        let ring = if i.is_multiple_of(N) { 0.0 } else { polar.sin() };
        let radius = 1.0 + 0.1 * ring * (9.0 * polar).sin() * (7.0 * around).cos();
        radius * Vec3::new(ring * around.cos(), ring * around.sin(), polar.cos())
    };
    let cells = (0..N).flat_map(|i| (0..N).map(move |j| (i, j)));
    let outlines = cells.flat_map(|(i, j)| {
        let [a, b, c, d] = [point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)];
        [(i > 0).then_some([a, d, c]), (i + 1 < N).then_some([a, c, b])]
    });
    outlines.flatten().map(|outline| Polygon::new(outline.to_vec()).unwrap()).collect()
}

/// Closed meshes tiny, huge, turned, and a hundred thousand sizes away from the origin, and rays from inside at points of their
/// edges and at their corners: none escapes. 2·10⁵ rays, or 10⁷ with `ETENDUE_LARGE=1`.
#[test]
fn no_ray_escapes_through_an_edge_of_a_closed_mesh() {
    let n_rays = if std::env::var_os("ETENDUE_LARGE").is_some() { 500_000 } else { 10_000 };
    let turn = Mat3::from_axis_angle(Vec3::new(0.36, 0.48, 0.8), 0.7);
    let far = Vec3::new(1e5, -1e5, 0.7e5);
    type Map<'a> = &'a (dyn Fn(Vec3) -> Vec3 + Sync);
    let maps: [(&str, f64, Map); 7] = [
        ("as it is", 1.0, &|v| v),
        ("tiny", 1e-6, &|v| turn * v * 1e-6),
        ("huge", 1e6, &|v| turn * v * 1e6),
        ("far", 1.0, &|v| v + far),
        ("turned and far", 1.0, &|v| turn * v + far),
        ("tiny and far", 1e-6, &|v| (turn * v + far) * 1e-6),
        ("huge and far", 1e6, &|v| (turn * v + far) * 1e6),
    ];
    let meshes = [
        ("cube", polygons_of("furnace-cube"), Vec3::splat(0.5), true),
        ("sphere", polygons_of("furnace-sphere"), Vec3::ZERO, true),
        ("bumpy sphere", bumpy_sphere(), Vec3::ZERO, false),
    ];
    for (mesh, (name, polygons, centre, convex)) in meshes.iter().enumerate() {
        maps.par_iter().enumerate().for_each(|(m, (how, size, map))| {
            let moved = mapped(polygons, map);
            let tracer = tracer_of(&moved);
            // Which side is inside, and how many ulp a coordinate may be off.
            let inward = (map(*centre) - moved[0].centroid()).dot(moved[0].normal()).signum();
            let ulp = f64::EPSILON * moved[0].centroid().abs().max_element();
            let mut stream = Stream::new(0x6564_6765, mesh as u32, m as u64);
            for k in 0..n_rays {
                let target = edge_point(&mut stream, &moved, k % 4 == 0);
                // From well inside, where the mesh is convex, the point aimed at is the first met.
                if k % 2 == 0 {
                    let origin = map(*centre + point(&mut stream, 0.3));
                    let ray = Ray { origin, direction: target - origin };
                    let hit = tracer.closest(&ray, None);
                    let Some(hit) = hit else { panic!("{name} {how}: {ray:?} escapes at {target}") };
                    // At 1e5 sizes the coordinates have eleven digits behind the point: 1e-11, over a cosine of 0.1.
                    assert!(!convex || (hit.t - 1.0).abs() < 1e-8, "{name} {how}: {hit:?}");
                    // The unnormalised direction is no accident: a unit one must do as well.
                    let unit = Ray { origin, direction: ray.direction.normalize() };
                    assert!(tracer.closest(&unit, None).is_some(), "{name} {how}: {unit:?} escapes");
                    continue;
                }
                // From next to a face, as low as a billionth of the size and a thousand ulp: along it, among other ways.
                let face = &moved[pick(&mut stream, moved.len())];
                let low = (size * f64::powf(10.0, -9.0 * stream.uniform()) * 0.05).max(1e3 * ulp);
                let within = face.centroid() + 0.9 * (face.sample(stream.uniform2()) - face.centroid());
                let origin = within + low * inward * face.normal();
                let ray = Ray { origin, direction: target - origin };
                assert!(tracer.closest(&ray, None).is_some(), "{name} {how}: {ray:?} escapes at {target}, from {low}");
            }
        });
    }
}

/// A corner of the mesh, or a point of an edge.
fn edge_point(stream: &mut Stream, mesh: &[Polygon], at_corner: bool) -> Vec3 {
    let v = mesh[pick(stream, mesh.len())].vertices();
    let corner = pick(stream, v.len());
    let (a, b) = (v[corner], v[(corner + 1) % v.len()]);
    if at_corner { a } else { a + stream.uniform() * (b - a) }
}

/// From the faces inwards, leaving out the polygon where the ray starts: also closed, T-junctions of the rooms included.
#[test]
fn no_ray_that_starts_on_a_closed_scene_escapes() {
    for (s, name) in
        ["furnace-cube", "furnace-sphere", "corner-box", "floating-block", "two-rooms", "maze"].iter().enumerate()
    {
        let polygons = polygons_of(name);
        let tracer = tracer_of(&polygons);
        let mut stream = Stream::new(0x7374_6172, s as u32, 0);
        for _ in 0..20_000 {
            let start = pick(&mut stream, polygons.len());
            let origin = polygons[start].sample(stream.uniform2());
            let local = Vec3::from(warp::cosine_hemisphere(stream.uniform2()));
            let direction = Frame::about(polygons[start].normal()).to_world(local);
            let hit = tracer.closest(&Ray { origin, direction }, Some(start));
            assert!(hit.is_some(), "{name}: from {origin} of polygon {start} along {direction}");
        }
    }
}

/// Along axes, from the centre and off it, in scenes whose walls are axis-aligned: zeros in the direction.
#[test]
fn rays_along_axes_arrive() {
    let cube = polygons_of("furnace-cube");
    let tracer = tracer_of(&cube);
    for origin in [Vec3::splat(0.5), Vec3::new(0.0, 0.5, 0.25), Vec3::new(1.0, 1.0, 0.5), Vec3::splat(0.125)] {
        for direction in [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|d| [d, -d]) {
            let leaves = (0..3).any(|axis| {
                let (o, d) = (origin[axis], direction[axis]);
                (o == 0.0 && d < 0.0) || (o == 1.0 && d > 0.0)
            });
            let within = (0..3).all(|axis| direction[axis] != 0.0 || (origin[axis] > 0.0 && origin[axis] < 1.0));
            let hit = tracer.closest(&Ray { origin, direction }, None);
            if leaves {
                assert_eq!(hit, None);
            } else if within {
                let distance =
                    if direction.element_sum() > 0.0 { 1.0 - origin.dot(direction) } else { origin.dot(-direction) };
                assert_eq!(hit.unwrap().t, distance, "{origin} {direction}");
            }
        }
    }
}

/// A convex polygon with corners on an ellipse, somewhere, turned anyhow.
pub fn random_polygon(stream: &mut Stream, half: f64, size: f64) -> Polygon {
    let corners = 3 + pick(stream, 4);
    let centre = point(stream, half);
    let [a, b] = [point(stream, size), point(stream, size)];
    let mut angles: Vec<f64> = (0..corners).map(|_| stream.uniform() * TAU).collect();
    angles.sort_by(f64::total_cmp);
    let vertices = angles.iter().map(|angle| centre + angle.cos() * a + angle.sin() * b).collect();
    match Polygon::new(vertices) {
        Ok(polygon) if polygon.area() > 1e-3 * size * size => polygon,
        _ => random_polygon(stream, half, size),
    }
}

/// Where the line of a ray meets a polygon's plane, and how far inside of the nearest edge: negative outside.
pub fn meeting(ray: &Ray, polygon: &Polygon) -> (f64, f64) {
    let t = polygon.normal().dot(polygon.centroid() - ray.origin) / polygon.normal().dot(ray.direction);
    let v = polygon.vertices();
    let depth = |k: usize| {
        let edge = v[(k + 1) % v.len()] - v[k];
        polygon.normal().cross(edge).dot(ray.at(t) - v[k]) / edge.length()
    };
    (t, (0..v.len()).map(depth).fold(f64::INFINITY, f64::min))
}

#[test]
fn closest_is_what_brute_force_finds() {
    let mut stream = Stream::new(0x736f_7570, 0, 0);
    let mut hits = 0;
    for _ in 0..40 {
        let soup: Vec<Polygon> = (0..60).map(|_| random_polygon(&mut stream, 1.0, 0.4)).collect();
        let tracer = tracer_of(&soup);
        assert_eq!(tracer.n_polygons(), soup.len());
        for k in 0..500 {
            let origin = point(&mut stream, if k % 5 == 0 { 30.0 } else { 1.2 });
            let ray = Ray { origin, direction: point(&mut stream, 1.0) - origin };
            let met: Vec<(f64, f64)> = soup.iter().map(|p| meeting(&ray, p)).collect();
            // Surely met: well inside and well ahead. Possibly met: not well outside.
            let first_sure = met
                .iter()
                .filter(|(t, depth)| *t > MARGIN && *depth > MARGIN)
                .map(|m| m.0)
                .fold(f64::INFINITY, f64::min);
            match tracer.closest(&ray, None) {
                None => assert_eq!(first_sure, f64::INFINITY, "{ray:?}"),
                Some(hit) => {
                    let (t, depth) = met[hit.polygon];
                    assert!(
                        depth > -MARGIN && (hit.t - t).abs() < MARGIN && t > -MARGIN,
                        "{ray:?}: {hit:?} {t} {depth}"
                    );
                    assert!(hit.t <= first_sure + MARGIN, "{ray:?}: {hit:?}, but {first_sure} comes first");
                    assert_eq!(hit.front, soup[hit.polygon].normal().dot(ray.direction) < 0.0);
                    hits += 1;
                }
            }
        }
    }
    assert!(hits > 5_000, "{hits}");
}

#[test]
fn a_box_on_the_floor_is_in_the_planes_it_stands_on() {
    // Coplanar either way round, far apart or overlapping; a ray that starts on one leaves out all.
    let floor = polygon(&[[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 4.0, 0.0], [0.0, 4.0, 0.0]]);
    let bottom = polygon(&[[1.0, 1.0, 0.0], [1.0, 2.0, 0.0], [2.0, 2.0, 0.0], [2.0, 1.0, 0.0]]);
    let lid = polygon(&[[1.0, 1.0, 1e-9], [2.0, 1.0, 1e-9], [2.0, 2.0, 1e-9], [1.0, 2.0, 1e-9]]);
    let tracer = tracer_of(&[floor, bottom, lid]);
    assert!(tracer.coplanar(0, 1) && !tracer.coplanar(0, 2) && !tracer.coplanar(1, 2));
    let ray = Ray { origin: Vec3::new(1.5, 1.5, 0.0), direction: Vec3::Z };
    assert_eq!(tracer.closest(&ray, Some(0)).map(|hit| (hit.polygon, hit.front)), Some((2, false)));
    let above = Vec3::new(1.5, 1.5, 1.0);
    assert!(tracer.occluded(ray.origin, above, [0, 0]) && !tracer.occluded(ray.origin, above, [1, 2]));
}

/// A point of every direction's own length: results depend on the line, not on how long its direction is written.
#[test]
fn the_length_of_a_direction_does_not_matter() {
    let mut stream = Stream::new(0x6c65_6e67, 0, 0);
    let soup: Vec<Polygon> = (0..60).map(|_| random_polygon(&mut stream, 1.0, 0.4)).collect();
    for size in [1e-6, 1.0, 1e9] {
        let scaled = mapped(&soup, |v| v * size);
        let tracer = tracer_of(&scaled);
        for _ in 0..2_000 {
            let origin = size * point(&mut stream, 1.2);
            let direction = point(&mut stream, 1.0);
            // Powers of two: the very same line.
            let hits = [-100, -30, 0, 30, 100].map(|exponent| {
                let stretch = f64::powi(2.0, exponent);
                let hit = tracer.closest(&Ray { origin, direction: direction * stretch }, None);
                hit.map(|hit| (hit.polygon, hit.front, (hit.t * stretch).to_bits()))
            });
            assert!(hits.iter().all(|hit| *hit == hits[0]), "{origin} {direction}: {hits:?}");
        }
    }
}
