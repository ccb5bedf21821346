//! The tree answers as f64 tests of every polygon do, bit for bit, with and without vector instructions.

use super::eight::Kernel;
use super::local::Reach;
use super::walk::{Any, Closest};
use super::{Hit, Tracer};
use crate::geometry::{Mat3, Polygon, Ray, Vec3};
use crate::sampling::Stream;
use pulp::Scalar256b;

fn point(stream: &mut Stream, half: f64) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| half * (2.0 * stream.uniform() - 1.0)))
}

fn pick<'a, T>(stream: &mut Stream, of: &'a [T]) -> &'a T {
    &of[((stream.uniform() * of.len() as f64) as usize).min(of.len() - 1)]
}

/// A lattice of triangles, squares, trapezoids and pentagons that share edges and corners, three layers deep, every second one
/// turned over; and slivers among them.
fn lattice(n: usize) -> Vec<Vec<Vec3>> {
    let mut outlines = Vec::new();
    for layer in 0..3 {
        for i in 0..n {
            for j in 0..n {
                let at = |u: f64, v: f64| {
                    let (x, y) = ((i as f64 + u) / n as f64, (j as f64 + v) / n as f64);
                    Vec3::new(x, y, 0.3 * layer as f64 + 0.25 * x - 0.125 * y)
                };
                let (a, b, c, d) = (at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0));
                match (i + 2 * j + layer) % 5 {
                    0 => outlines.extend([vec![a, b, c], vec![a, c, d]]),
                    1 => outlines.extend([vec![a, b, at(0.75, 1.0), d], vec![b, c, at(0.75, 1.0)]]),
                    2 => outlines
                        .extend([vec![a, b, c, at(0.5, 1.0), at(0.0, 0.5)], vec![at(0.5, 1.0), d, at(0.0, 0.5)]]),
                    3 => outlines
                        .extend([vec![d, c, at(1.0, 1e-9), at(0.0, 1e-9)], vec![a, b, at(1.0, 1e-9), at(0.0, 1e-9)]]),
                    _ => outlines.push(vec![d, c, b, a]),
                }
            }
        }
    }
    outlines
}

/// Rays at corners, edges, and anywhere; from near, far, along edges, within planes, and through two corners at once.
fn ray(stream: &mut Stream, polygons: &[Polygon], size: f64, centre: Vec3) -> Ray {
    let corner = |stream: &mut Stream| {
        let polygon = pick(stream, polygons);
        *pick(stream, polygon.vertices())
    };
    let edge = |stream: &mut Stream| {
        let v = pick(stream, polygons).vertices();
        let k = (stream.uniform() * v.len() as f64) as usize % v.len();
        v[k] + stream.uniform() * (v[(k + 1) % v.len()] - v[k])
    };
    let inside = |stream: &mut Stream| {
        let polygon = pick(stream, polygons);
        polygon.sample(stream.uniform2())
    };
    let any = |stream: &mut Stream| match (stream.uniform() * 6.0) as u32 {
        0 => corner(stream),
        1 => edge(stream),
        2 => inside(stream),
        3 => centre + point(stream, 100.0 * size),
        _ => centre + point(stream, 0.8 * size),
    };
    let (from, mut to) = (any(stream), any(stream));
    while to == from {
        to = any(stream);
    }
    let stretch = if stream.uniform() < 0.5 { 1.0 } else { f64::exp2(20.0 * stream.uniform() - 10.0) };
    Ray { origin: from, direction: stretch * (to - from) }
}

fn bits(hit: Option<Hit>) -> Option<(usize, u64, bool)> {
    hit.map(|hit| (hit.polygon, hit.t.to_bits(), hit.front))
}

/// Every answer three ways: by all polygons, by the tree on this machine's vectors, and by the tree without them.
#[test]
fn trees_answer_as_every_polygon_does() {
    let turn = Mat3::from_axis_angle(Vec3::new(0.48, 0.6, 0.64), 0.9);
    let places =
        [(1.0, Vec3::ZERO), (1e-6, Vec3::ZERO), (1e6, Vec3::ZERO), (1.0, Vec3::new(1e5, -1e5, 3e4)), (1e-3, Vec3::ONE)];
    let (mut met, mut blocked, mut through_boxes) = (0, 0, 0);
    for (k, (size, offset)) in places.into_iter().enumerate() {
        for n in [1, 2, 7] {
            let map = |v: &Vec3| turn * (size * (*v - 0.4)) + offset;
            let polygons: Vec<Polygon> =
                lattice(n).iter().filter_map(|outline| Polygon::new(outline.iter().map(map).collect()).ok()).collect();
            let tracer = Tracer::new(&polygons.iter().collect::<Vec<_>>());
            let mut stream = Stream::new(0x7472_6565, k as u32, n as u64);
            for _ in 0..6_000 {
                let ray = ray(&mut stream, &polygons, size, offset);
                let start = (stream.uniform() * 2.0 * polygons.len() as f64) as usize;
                let start = (start < polygons.len()).then_some(start);
                let plane = start.map_or(u32::MAX, |id| tracer.planes[id]);
                let truth = tracer.closest_of_all(&ray, plane);
                met += usize::from(truth.is_some());
                assert_eq!(bits(tracer.closest(&ray, start)), bits(truth), "{ray:?}");
                if let Reach::Boxes(local) = tracer.local.ray(&ray, f64::MAX) {
                    let plainly = Closest { tracer: &tracer, ray: &ray, local, plane }.run(Scalar256b);
                    assert_eq!(bits(plainly), bits(truth), "{ray:?}");
                    through_boxes += 1;
                }

                let to = ray.origin + ray.direction;
                let segment = Ray { origin: ray.origin, direction: to - ray.origin };
                let planes = [start.unwrap_or(0), 0].map(|id| tracer.planes[id]);
                let truth = tracer.any_of_all(&segment, planes);
                blocked += usize::from(truth);
                assert_eq!(tracer.occluded(ray.origin, to, [start.unwrap_or(0), 0]), truth, "{segment:?}");
                if let Reach::Boxes(local) = tracer.local.ray(&segment, 1.0) {
                    assert_eq!(
                        Any { tracer: &tracer, ray: &segment, local, planes }.run(Scalar256b),
                        truth,
                        "{segment:?}"
                    );
                }
            }
        }
    }
    assert!(met > 30_000 && blocked > 20_000 && through_boxes > 60_000, "{met} {blocked} {through_boxes}");
}
