//! Rays: closest and any-hit against `obvhs`' compressed eight-wide tree with a plain f64 triangle test in its leaves, on the Cornell
//! box and on a mesh of 81 204 triangles. One core; contestants take turns in one process, so that their ratio means something on
//! a machine that is busy with other things.

use etendue::gallery;
use etendue::geometry::{Polygon, Ray, Tracer, Vec3};
use etendue::sampling::Stream;
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh_from_tris};
use obvhs::ray::{Ray as BoxRay, RayHit};
use obvhs::{BvhBuildParams, triangle::Triangle};
use std::f64::consts::{PI, TAU};
use std::hint::black_box;
use std::time::{Duration, Instant};

const N_RAYS: usize = 1 << 17;
const N_TURNS: usize = 15;

fn main() {
    let scene = gallery::cornell_box();
    let cornell: Vec<Polygon> = (0..scene.facets().len()).map(|facet| scene.polygon(facet).clone()).collect();
    println!(
        "{:12} {:8} {:>9} {:>9} {:>7}   Mrays/s, best of {N_TURNS}; median ratio",
        "scene", "query", "tracer", "CwBvh", "ratio"
    );
    for (name, polygons) in [("cornell-box", cornell), ("81k bumps", bumpy_sphere(202))] {
        let yardstick = Yardstick::new(&polygons);
        let tracer = Tracer::new(&polygons.iter().collect::<Vec<_>>());
        let segments = segments(&polygons, &tracer);
        race(name, "any-hit", &segments, |s| tracer.occluded(s.from, s.to, s.ends), |s| yardstick.occluded(s));
        let first =
            |s: &Segment| tracer.closest(&Ray { origin: s.from, direction: s.to - s.from }, Some(s.ends[0])).is_some();
        race(name, "closest", &segments, first, |s| yardstick.closest(s).is_finite());
    }
}

/// Lets both answer all segments in turns, and prints their rates.
fn race(
    scene: &str,
    query: &str,
    segments: &[Segment],
    ours: impl Fn(&Segment) -> bool,
    theirs: impl Fn(&Segment) -> bool,
) {
    let n_rounds = if scene == "cornell-box" { 8 } else { 1 };
    let (mut best, mut ratios) = ([0.0_f64; 2], Vec::new());
    for _ in 0..N_TURNS {
        let rate = |answer: &dyn Fn() -> usize| {
            let start = Instant::now();
            black_box(answer());
            (n_rounds * segments.len()) as f64 / start.elapsed().as_secs_f64()
        };
        let count = |answer: &dyn Fn() -> usize| (0..n_rounds).map(|_| answer()).sum();
        let rates = [
            rate(&|| count(&|| segments.iter().filter(|s| ours(black_box(s))).count())),
            rate(&|| count(&|| segments.iter().filter(|s| theirs(black_box(s))).count())),
        ];
        best = [best[0].max(rates[0]), best[1].max(rates[1])];
        ratios.push(rates[0] / rates[1]);
    }
    ratios.sort_by(f64::total_cmp);
    let ratio = ratios[ratios.len() / 2];
    println!("{scene:12} {query:8} {:9.2} {:9.2} {ratio:7.2}", best[0] / 1e6, best[1] / 1e6);
}

/// Two points of the scene, and the polygons they are on.
struct Segment {
    from: Vec3,
    to: Vec3,
    ends: [usize; 2],
}

/// Segments between points uniform by area, on polygons of different planes.
fn segments(polygons: &[Polygon], tracer: &Tracer) -> Vec<Segment> {
    let mut stream = Stream::new(0x7261_7973, 0, 0);
    let areas: Vec<f64> = polygons
        .iter()
        .scan(0.0, |sum, polygon| {
            *sum += polygon.area();
            Some(*sum)
        })
        .collect();
    let mut place = || {
        let area = stream.uniform() * areas[areas.len() - 1];
        let id = areas.partition_point(|sum| *sum <= area).min(areas.len() - 1);
        (id, polygons[id].sample(stream.uniform2()))
    };
    let pairs = std::iter::repeat_with(|| (place(), place()));
    let apart = pairs.filter(|(a, b)| !tracer.coplanar(a.0, b.0));
    apart.map(|(a, b)| Segment { from: a.1, to: b.1, ends: [a.0, b.0] }).take(N_RAYS).collect()
}

/// `obvhs`' compressed tree over triangles, each with the number of its polygon, in the order of the leaves.
struct Yardstick {
    tree: CwBvh,
    triangles: Vec<([Vec3; 3], usize)>,
}

impl Yardstick {
    fn new(polygons: &[Polygon]) -> Self {
        let fan = |(id, polygon): (usize, &Polygon)| {
            let v = polygon.vertices().to_vec();
            (2..v.len()).map(move |k| ([v[0], v[k - 1], v[k]], id)).collect::<Vec<_>>()
        };
        let triangles: Vec<([Vec3; 3], usize)> = polygons.iter().enumerate().flat_map(fan).collect();
        let corners = |([a, b, c], _): &([Vec3; 3], usize)| {
            let [v0, v1, v2] = [a, b, c].map(|v| v.as_vec3a());
            Triangle { v0, v1, v2 }
        };
        let boxes: Vec<Triangle> = triangles.iter().map(corners).collect();
        let parameters = BvhBuildParams { pre_split: false, ..BvhBuildParams::medium_build() };
        let tree = build_cwbvh_from_tris(&boxes, parameters, &mut Duration::default());
        let triangles = tree.primitive_indices.iter().map(|&k| triangles[k as usize]).collect();
        Self { tree, triangles }
    }

    fn occluded(&self, s: &Segment) -> bool {
        let direction = s.to - s.from;
        let ray = BoxRay::new(s.from.as_vec3a(), direction.as_vec3a(), 0.0, 1.0);
        !self.tree.ray_traverse_miss(ray, |_, k| {
            let (triangle, id) = &self.triangles[k];
            let t = if s.ends.contains(id) { f64::INFINITY } else { meet(triangle, s.from, direction) };
            if t < 1.0 { t as f32 } else { f32::INFINITY }
        })
    }

    fn closest(&self, s: &Segment) -> f32 {
        let direction = s.to - s.from;
        let ray = BoxRay::new(s.from.as_vec3a(), direction.as_vec3a(), 0.0, f32::INFINITY);
        let mut hit = RayHit::none();
        self.tree.ray_traverse(ray, &mut hit, |_, k| {
            let (triangle, id) = &self.triangles[k];
            if *id == s.ends[0] { f32::INFINITY } else { meet(triangle, s.from, direction) as f32 }
        });
        hit.t
    }
}

/// Where a ray meets a triangle (Möller and Trumbore 1997).
fn meet([a, b, c]: &[Vec3; 3], origin: Vec3, direction: Vec3) -> f64 {
    let (ab, ac) = (*b - *a, *c - *a);
    let p = direction.cross(ac);
    let inverse = 1.0 / ab.dot(p);
    let offset = origin - *a;
    let u = offset.dot(p) * inverse;
    let q = offset.cross(ab);
    let v = direction.dot(q) * inverse;
    let t = ac.dot(q) * inverse;
    if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0 { t } else { f64::INFINITY }
}

/// A closed mesh of 2 n (n − 1) triangles with bumps of two sizes.
fn bumpy_sphere(n: usize) -> Vec<Polygon> {
    let point = |i: usize, j: usize| {
        let (polar, around) = (i as f64 / n as f64 * PI, (j % n) as f64 / n as f64 * TAU);
        let bumps =
            0.1 * (9.0 * polar).sin() * (7.0 * around).cos() + 0.03 * (31.0 * polar).cos() * (29.0 * around).sin();
        let radius = 1.0 + polar.sin() * bumps;
        radius * Vec3::new(polar.sin() * around.cos(), polar.sin() * around.sin(), polar.cos())
    };
    let cells = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let outlines = cells.flat_map(|(i, j)| {
        let [a, b, c, d] = [point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)];
        [(i > 0).then_some([a, d, c]), (i + 1 < n).then_some([a, c, b])]
    });
    outlines.flatten().map(|outline| Polygon::new(outline.to_vec()).expect("a triangle")).collect()
}
