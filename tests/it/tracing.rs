//! Rays and shafts: nothing escapes through an edge, nothing is met that is not there.

use super::scenes::polygon;
use etendue::gallery;
use etendue::geometry::{Frame, Mat3, Polygon, Ray, Shaft, Tracer, Vec3};
use etendue::sampling::{Stream, warp};

/// Brute force decides by plain f64 products of coordinates of order one: what it finds within this of an edge, it leaves open.
const MARGIN: f64 = 1e-9;

fn polygons_of(name: &str) -> Vec<Polygon> {
    let scene = (gallery::find(name).unwrap().build)();
    (0..scene.facets().len()).map(|facet| scene.polygon(facet).clone()).collect()
}

fn mapped(polygons: &[Polygon], map: impl Fn(Vec3) -> Vec3) -> Vec<Polygon> {
    polygons.iter().map(|p| Polygon::new(p.vertices().iter().map(|v| map(*v)).collect()).unwrap()).collect()
}

fn tracer_of(polygons: &[Polygon]) -> Tracer {
    Tracer::new(&polygons.iter().collect::<Vec<_>>())
}

fn point(stream: &mut Stream, half: f64) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| half * (2.0 * stream.uniform() - 1.0)))
}

/// An index below n.
fn pick(stream: &mut Stream, n: usize) -> usize {
    ((stream.uniform() * n as f64) as usize).min(n - 1)
}

/// Closed meshes as they are, tiny, huge, turned, and a hundred thousand sizes away from the origin. Every ray from inside is aimed
/// at a point of an edge or at a corner; 2·10⁵ in all, and none escapes.
#[test]
fn no_ray_escapes_through_an_edge_of_a_closed_mesh() {
    const RAYS: usize = 20_000;
    let turn = Mat3::from_axis_angle(Vec3::new(0.36, 0.48, 0.8), 0.7);
    let far = Vec3::new(1e5, -1e5, 0.7e5);
    let maps: [(&str, &dyn Fn(Vec3) -> Vec3); 5] = [
        ("as it is", &|v| v),
        ("tiny", &|v| turn * v * 1e-6),
        ("huge", &|v| turn * v * 1e6),
        ("far", &|v| v + far),
        ("turned and far", &|v| turn * v + far),
    ];
    for (mesh, (name, centre)) in
        [("furnace-cube", Vec3::splat(0.5)), ("furnace-sphere", Vec3::ZERO)].iter().enumerate()
    {
        let polygons = polygons_of(name);
        for (m, (how, map)) in maps.iter().enumerate() {
            let moved = mapped(&polygons, map);
            let tracer = tracer_of(&moved);
            let mut stream = Stream::new(0x6564_6765, mesh as u32, m as u64);
            for k in 0..RAYS {
                let origin = map(*centre + point(&mut stream, 0.3));
                let v = moved[pick(&mut stream, moved.len())].vertices();
                let corner = pick(&mut stream, v.len());
                let (a, b) = (v[corner], v[(corner + 1) % v.len()]);
                let target = if k % 4 == 0 { a } else { a + stream.uniform() * (b - a) };
                let ray = Ray { origin, direction: target - origin };
                let Some(hit) = tracer.closest(&ray, None) else { panic!("{name} {how}: {ray:?} escapes at {target}") };
                // At 1e5 sizes the coordinates have eleven digits behind the point: 1e-11, over a cosine of 0.1.
                assert!(hit.front && (hit.t - 1.0).abs() < 1e-8, "{name} {how}: {hit:?}");
                // The unnormalised direction is no accident: a unit one must do as well.
                let unit = Ray { origin, direction: ray.direction.normalize() };
                assert!(tracer.closest(&unit, None).is_some(), "{name} {how}: {unit:?} escapes");
            }
        }
    }
}

/// From the faces inwards, leaving out the polygon where the ray starts: also closed, T-junctions of the rooms included.
#[test]
fn no_ray_that_starts_on_a_closed_scene_escapes() {
    for (s, name) in ["furnace-cube", "furnace-sphere", "corner-box", "floating-block", "two-rooms"].iter().enumerate()
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
fn random_polygon(stream: &mut Stream, half: f64, size: f64) -> Polygon {
    let corners = 3 + pick(stream, 4);
    let centre = point(stream, half);
    let [a, b] = [point(stream, size), point(stream, size)];
    let mut angles: Vec<f64> = (0..corners).map(|_| stream.uniform() * std::f64::consts::TAU).collect();
    angles.sort_by(f64::total_cmp);
    let vertices = angles.iter().map(|angle| centre + angle.cos() * a + angle.sin() * b).collect();
    match Polygon::new(vertices) {
        Ok(polygon) if polygon.area() > 1e-3 * size * size => polygon,
        _ => random_polygon(stream, half, size),
    }
}

/// Where the line of a ray meets a polygon's plane, and how far inside of the nearest edge: negative outside.
fn meeting(ray: &Ray, polygon: &Polygon) -> (f64, f64) {
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

/// Whether something crosses the segment; `None` where f64 cannot tell.
fn is_crossed(soup: &[Polygon], ends: [usize; 2], from: Vec3, to: Vec3) -> Option<bool> {
    let ray = Ray { origin: from, direction: to - from };
    let mut doubtful = false;
    for (k, polygon) in soup.iter().enumerate().filter(|(k, _)| !ends.contains(k)) {
        let (t, depth) = meeting(&ray, polygon);
        if depth > MARGIN && t > MARGIN && t < 1.0 - MARGIN {
            return Some(true);
        }
        doubtful |= depth > -MARGIN && t > -MARGIN && t < 1.0 + MARGIN;
        assert!(k < soup.len());
    }
    (!doubtful).then_some(false)
}

/// Light goes from the front of one to the front of the other.
fn exchanges(a: &Polygon, b: &Polygon, x: Vec3, y: Vec3) -> bool {
    a.normal().dot(y - x) > 0.0 && b.normal().dot(x - y) > 0.0
}

#[test]
fn shafts_are_never_wrong() {
    let mut stream = Stream::new(0x7368_6166, 0, 0);
    let (mut clear, mut blocked, mut undecided, mut crossed) = (0, 0, 0, 0);
    for round in 0..1_500 {
        // Two patches and a few occluders: small ones, and in every third round one as large as a wall.
        let mut soup: Vec<Polygon> = (0..2).map(|_| random_polygon(&mut stream, 1.0, 0.3)).collect();
        soup.extend((0..round % 4).map(|_| random_polygon(&mut stream, 1.0, 0.4)));
        if round % 3 == 0 {
            soup.push(random_polygon(&mut stream, 0.2, 4.0));
        }
        let all: Vec<&Polygon> = soup.iter().collect();
        let (tracer, occluders) = (Tracer::new(&all), Tracer::occluders(&all));
        let (a, b) = (&soup[0], &soup[1]);
        let shaft = Shaft::between(&occluders, (a, 0), (b, 1));
        for _ in 0..24 {
            let (x, y) = (a.sample(stream.uniform2()), b.sample(stream.uniform2()));
            if !exchanges(a, b, x, y) {
                continue;
            }
            let Some(truth) = is_crossed(&soup, [0, 1], x, y) else { continue };
            crossed += usize::from(truth);
            assert_eq!(tracer.occluded(x, y, [0, 1]), truth, "round {round}");
            assert_eq!(occluders.occluded(x, y, [0, 1]), truth, "round {round}: an occluder was left out");
            match &shaft {
                Shaft::Clear => assert!(!truth, "round {round}: called clear, {x} to {y} is blocked"),
                Shaft::Blocked => assert!(truth, "round {round}: called blocked, {x} sees {y}"),
                Shaft::Undecided(handles) => assert_eq!(occluders.blocked_by(handles, x, y), truth, "round {round}"),
            }
        }
        match shaft {
            Shaft::Clear => clear += 1,
            Shaft::Blocked => blocked += 1,
            Shaft::Undecided(_) => undecided += 1,
        }
    }
    // Every answer was put to the test, and often.
    assert!(clear > 100 && blocked > 50 && undecided > 100 && crossed > 500, "{clear} {blocked} {undecided} {crossed}");
}

/// Pieces of the scene's own polygons, as exchange asks about them: nothing that a shaft calls clear or blocked is the other.
#[test]
fn shafts_are_never_wrong_in_the_gallery() {
    for (s, name) in ["cornell-box", "corner-box", "two-rooms", "spherical-crater"].iter().enumerate() {
        let polygons = polygons_of(name);
        let all: Vec<&Polygon> = polygons.iter().collect();
        let (tracer, occluders) = (Tracer::new(&all), Tracer::occluders(&all));
        let mut stream = Stream::new(0x6761_6c6c, s as u32, 0);
        let mut decided = 0;
        for _ in 0..1_500 {
            let ids = [pick(&mut stream, polygons.len()), pick(&mut stream, polygons.len())];
            if tracer.coplanar(ids[0], ids[1]) {
                continue;
            }
            let piece = ids.map(|id| shrunk(&polygons[id], &mut stream));
            let shaft = Shaft::between(&occluders, (&piece[0], ids[0]), (&piece[1], ids[1]));
            decided += usize::from(!matches!(shaft, Shaft::Undecided(_)));
            for _ in 0..12 {
                let (x, y) = (piece[0].sample(stream.uniform2()), piece[1].sample(stream.uniform2()));
                if !exchanges(&piece[0], &piece[1], x, y) {
                    continue;
                }
                let truth = tracer.occluded(x, y, ids);
                match &shaft {
                    Shaft::Clear => assert!(!truth, "{name}: called clear, {x} to {y} is blocked"),
                    Shaft::Blocked => assert!(truth, "{name}: called blocked, {x} sees {y}"),
                    Shaft::Undecided(handles) => assert_eq!(occluders.blocked_by(handles, x, y), truth, "{name}"),
                }
            }
        }
        assert!(decided > 100, "{name}: {decided}");
    }
}

/// The polygon shrunk towards one of its points.
fn shrunk(whole: &Polygon, stream: &mut Stream) -> Polygon {
    let (towards, factor) = (whole.sample(stream.uniform2()), 0.1 + 0.4 * stream.uniform());
    Polygon::new(whole.vertices().iter().map(|v| towards + factor * (*v - towards)).collect()).unwrap()
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
