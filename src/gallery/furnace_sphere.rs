//! `furnace-sphere`: a closed sphere of triangles of one albedo and one emission.
//!
//! # Geometry
//! The icosahedron inscribed in the unit sphere around the origin, every triangle cut into four at the midpoints of
//! its edges, `n_subdivisions` times, each new vertex pushed out to the sphere: 20 · 4ⁿ triangles facing inward.
//! Two triangles that share an edge share its vertices bit for bit, so there are no cracks.
//!
//! # Exact answer
//! L = e / (1 − a), as in [the cube](mod@super::furnace_cube): the argument asks for nothing but a closed scene,
//! so it holds for the polyhedron itself and the tessellation adds no error.

use super::matte::{film, matte, scene};
use super::shape::Outline;
use crate::geometry::Vec3;
use crate::scene::{Camera, Scene, SceneError, Surface, Tessellation};

/// The unit sphere seen from inside, of this albedo and emitting this radiance, one value a band.
///
/// One surface, `sphere`, of 20 · 4^n_subdivisions triangles. The answer is [`furnace_exact`](super::furnace_exact).
/// O(4^n_subdivisions) time and memory.
///
/// # Errors
/// An albedo outside [0, 1], a negative or infinite emission, no emission at all, lists of different length or empty.
pub fn furnace_sphere(n_subdivisions: usize, albedo: &[f64], emission: &[f64]) -> Result<Scene, SceneError> {
    let triangles =
        (0..n_subdivisions).fold(icosahedron(), |triangles, _| triangles.iter().flat_map(quarter).collect());
    let mut sphere = matte("sphere", triangles.into_iter().map(Outline::from), albedo, emission)?;
    sphere.tessellation = Some(tessellation(&sphere));
    let camera = Camera::look_at(Vec3::new(0.0, 0.0, 0.9), Vec3::ZERO, Vec3::Y, 75_f64.to_radians(), film());
    scene("furnace-sphere", albedo.len(), vec![sphere], camera)
}

/// The twenty triangles of the icosahedron inscribed in the unit sphere, facing inward.
fn icosahedron() -> Vec<[Vec3; 3]> {
    // Place the corners at the cyclic permutations of (0, ±1, ±golden ratio).
    let golden = 0.5 * (1.0 + 5_f64.sqrt());
    let corner = |axis: usize, one: f64, long: f64| {
        let mut v = [0.0; 3];
        v[(axis + 1) % 3] = one;
        v[(axis + 2) % 3] = long * golden;
        Vec3::from_array(v).normalize()
    };
    let signs = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
    let corners: Vec<Vec3> = (0..3).flat_map(|axis| signs.map(|(one, long)| corner(axis, one, long))).collect();

    // Join every three corners that are neighbours of each other, clockwise seen from outside.
    let edge = 2.0 / (1.0 + golden * golden).sqrt();
    let neighbours = |a: Vec3, b: Vec3| a.distance(b) < 1.1 * edge;
    let mut triangles = Vec::with_capacity(20);
    for (i, &a) in corners.iter().enumerate() {
        for (j, &b) in corners.iter().enumerate().skip(i + 1).filter(|(_, b)| neighbours(a, **b)) {
            for &c in corners[j + 1..].iter().filter(|c| neighbours(a, **c) && neighbours(b, **c)) {
                triangles.push(if a.cross(b).dot(c) < 0.0 { [a, b, c] } else { [a, c, b] });
            }
        }
    }
    triangles
}

/// One spherical triangle as four. Sums commute in floating point, so neighbours get the same midpoints.
fn quarter(&[a, b, c]: &[Vec3; 3]) -> [[Vec3; 3]; 4] {
    let [ab, bc, ca] = [(a + b).normalize(), (b + c).normalize(), (c + a).normalize()];
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
}

/// The plane of an inscribed triangle is nearest to the centre at the triangle's circumcentre, which lies inside it.
fn tessellation(sphere: &Surface) -> Tessellation {
    let sagitta = |p: &crate::geometry::Polygon| 1.0 - p.vertices()[0].dot(p.normal()).abs();
    Tessellation {
        shape: "sphere",
        n_polygons: sphere.polygons.len(),
        deviation: sphere.polygons.iter().map(sagitta).fold(0.0, f64::max),
    }
}
