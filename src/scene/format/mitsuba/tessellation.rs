//! Curved shapes as polygons: vertices on the shape, shared along every edge.

use crate::geometry::{Affine3, Polygon, Vec3};
use std::f64::consts::{FRAC_PI_4, PI, TAU};

/// Polygons around a sphere or a cylinder.
pub const N_MERIDIANS: usize = 32;
/// Bands of polygons from pole to pole of a sphere: triangles at the poles, trapezoids between, 512 polygons in all.
pub const N_PARALLELS: usize = 16;
/// Rings of a disk, the images of concentric squares: 64 quadrilaterals with 32 vertices on the rim.
pub const N_DISK_RINGS: usize = 4;

/// A shape in its own coordinates.
pub(super) struct Outline {
    /// "sphere", "disk" or "cylinder" where the shape is curved.
    pub curved: Option<&'static str>,
    /// Vertices of the polygons, counter-clockwise seen from the front.
    pub polygons: Vec<Vec<Vec3>>,
    /// Beginning, middle and end of each arc that became an edge, where the shape is curved in one direction.
    arcs: Vec<[Vec3; 3]>,
    /// Centre and a point of the shape, where it is curved in two.
    sphere: Option<[Vec3; 2]>,
}

impl Outline {
    pub(super) fn flat(polygons: Vec<Vec<Vec3>>) -> Self {
        Self { curved: None, polygons, arcs: Vec::new(), sphere: None }
    }

    /// [−1, 1]² in the plane z = 0, facing +z.
    pub(super) fn rectangle() -> Self {
        Self::flat(vec![
            [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec(),
        ])
    }

    /// [−1, 1]³, facing outward.
    pub(super) fn cube() -> Self {
        let face = |normal: Vec3, across: Vec3| {
            let along = normal.cross(across);
            let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
            corners.map(|(a, b)| normal + a * across + b * along).to_vec()
        };
        let axes = [(Vec3::X, Vec3::Y), (Vec3::Y, Vec3::Z), (Vec3::Z, Vec3::X)];
        Self::flat(axes.iter().flat_map(|(normal, across)| [face(*normal, *across), face(-*normal, *across)]).collect())
    }

    /// A sphere facing outward: meridians and parallels, triangles at the poles.
    pub(super) fn sphere(centre: Vec3, radius: f64) -> Self {
        let pole = |z: f64| centre + Vec3::new(0.0, 0.0, z * radius);
        let vertex = |parallel: usize, meridian: usize| {
            if parallel == 0 || parallel == N_PARALLELS {
                return pole(if parallel == 0 { 1.0 } else { -1.0 });
            }
            let (sine, cosine) = (PI * parallel as f64 / N_PARALLELS as f64).sin_cos();
            let around = circle(meridian, N_MERIDIANS);
            centre + radius * Vec3::new(sine * around.x, sine * around.y, cosine)
        };
        let mut polygons = Vec::with_capacity(N_PARALLELS * N_MERIDIANS);
        for parallel in 0..N_PARALLELS {
            for meridian in 0..N_MERIDIANS {
                let (north, south) = (parallel, parallel + 1);
                let mut corners = vec![vertex(north, meridian), vertex(south, meridian)];
                if south < N_PARALLELS {
                    corners.push(vertex(south, meridian + 1));
                }
                if north > 0 {
                    corners.push(vertex(north, meridian + 1));
                }
                polygons.push(corners);
            }
        }
        Self { curved: Some("sphere"), polygons, arcs: Vec::new(), sphere: Some([centre, pole(1.0)]) }
    }

    /// The unit disk in the plane z = 0, facing +z: a square grid whose concentric squares became circles (Shirley
    /// and Chiu 1997).
    pub(super) fn disk() -> Self {
        let n = N_DISK_RINGS as i64;
        let vertex = |i: i64, j: i64| {
            let ring = i.abs().max(j.abs());
            if ring == 0 {
                return Vec3::ZERO;
            }
            // Walk around the ring of 8 · ring vertices, from the middle of its right side.
            let step = match (i, j) {
                _ if i == ring => j,
                _ if j == ring => 2 * ring - i,
                _ if i == -ring => 4 * ring - j,
                _ => 6 * ring + i,
            };
            ring as f64 / n as f64 * circle(step.rem_euclid(8 * ring) as usize, 8 * ring as usize)
        };
        let cells = (-n..n).flat_map(|i| (-n..n).map(move |j| (i, j)));
        let polygons =
            cells.map(|(i, j)| vec![vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]).collect();
        let n_rim = 8 * N_DISK_RINGS;
        let arcs = (0..n_rim).map(|k| [0, 1, 2].map(|half| circle(2 * k + half, 2 * n_rim))).collect();
        Self { curved: Some("disk"), polygons, arcs, sphere: None }
    }

    /// The wall of a cylinder around the line from `p0` to `p1`, facing outward, without its caps. The points must
    /// differ.
    pub(super) fn cylinder(p0: Vec3, p1: Vec3, radius: f64) -> Self {
        let axis = (p1 - p0).normalize();
        let (across, along) = axis.any_orthonormal_pair();
        let handed = across.cross(along).dot(axis).signum();
        let vertex = |base: Vec3, k: usize, n: usize| {
            let around = circle(k, n);
            base + radius * (around.x * across + around.y * handed * along)
        };
        let wall = |k| {
            let corner = |base, k| vertex(base, k, N_MERIDIANS);
            vec![corner(p0, k), corner(p0, k + 1), corner(p1, k + 1), corner(p1, k)]
        };
        let arcs = (0..N_MERIDIANS).map(|k| [0, 1, 2].map(|half| vertex(p0, 2 * k + half, 2 * N_MERIDIANS))).collect();
        Self { curved: Some("cylinder"), polygons: (0..N_MERIDIANS).map(wall).collect(), arcs, sphere: None }
    }

    /// Largest distance between the transformed shape and its polygons. A sphere's transform must be a similarity.
    pub(super) fn deviation(&self, to_world: &Affine3, polygons: &[Polygon]) -> f64 {
        if let Some(sphere) = self.sphere {
            let [centre, pole] = sphere.map(|p| to_world.transform_point3(p));
            let nearest = polygons.iter().map(|p| distance_to_polygon(centre, p)).fold(f64::INFINITY, f64::min);
            return centre.distance(pole) - nearest;
        }
        // The middle of an arc is furthest from its chord under every affine map: there the tangent is parallel to it.
        let rise = |arc: &[Vec3; 3]| {
            let [a, middle, b] = arc.map(|p| to_world.transform_point3(p));
            distance_to_segment(middle, a, b)
        };
        self.arcs.iter().map(rise).fold(0.0, f64::max)
    }
}

/// The point at k/n of the way around the unit circle; the same bits for k and k + n, and mirror images for mirrored
/// k.
fn circle(k: usize, n: usize) -> Vec3 {
    let k = k % n;
    // Turn the first octant: sine and cosine of the others are its values with signs changed and swapped.
    let octant = 8 * k / n;
    let angle = TAU * k as f64 / n as f64;
    let within = if 8 * k == octant * n { 0.0 } else { angle - octant as f64 * FRAC_PI_4 };
    if !octant.is_multiple_of(2) {
        let (sine, cosine) = (FRAC_PI_4 - within).sin_cos();
        let (sine, cosine) = if within == 0.0 { (0.5f64.sqrt(), 0.5f64.sqrt()) } else { (sine, cosine) };
        return quadrant(octant / 2, sine, cosine);
    }
    let (sine, cosine) = within.sin_cos();
    quadrant(octant / 2, cosine, sine)
}

/// A point of the first quadrant turned by quarter turns.
fn quadrant(n_quarters: usize, x: f64, y: f64) -> Vec3 {
    match n_quarters {
        0 => Vec3::new(x, y, 0.0),
        1 => Vec3::new(-y, x, 0.0),
        2 => Vec3::new(-x, -y, 0.0),
        _ => Vec3::new(y, -x, 0.0),
    }
}

fn distance_to_polygon(point: Vec3, polygon: &Polygon) -> f64 {
    let corners = polygon.vertices();
    let edges = || corners.iter().zip(corners.iter().cycle().skip(1));
    let inside = edges().all(|(a, b)| (*b - *a).cross(point - *a).dot(polygon.normal()) >= 0.0);
    if inside {
        return (point - corners[0]).dot(polygon.normal()).abs();
    }
    edges().map(|(a, b)| distance_to_segment(point, *a, *b)).fold(f64::INFINITY, f64::min)
}

fn distance_to_segment(point: Vec3, a: Vec3, b: Vec3) -> f64 {
    let along = ((point - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    point.distance(a + along * (b - a))
}
