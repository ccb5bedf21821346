//! `spherical-crater`: a bowl under a low sun. Partly in shadow, and yet its interreflection is known exactly.
//!
//! # Geometry
//! The bowl is the part of the unit sphere around the origin within [`HALF_ANGLE_DEGREES`] (θ) of its lowest point,
//! facing inward, of albedo a. Its rim is a circle of radius r = sin θ at the height −c = −cos θ. The sun is a small
//! square of albedo 0, parallel to the rim's plane and facing down, whose centre P lies at [`SUN_DISTANCE`] from the
//! centre of the rim, in the direction +x raised by [`SUN_ELEVATION_DEGREES`]. Its radiance e is such that a plane
//! facing it at the centre of the rim receives [`SUN_IRRADIANCE`]. Nothing else is there.
//!
//! # Exact answer
//! *Interreflection.* Two elements of a sphere of radius R see each other over a chord of length ℓ, both under the
//! cosine ℓ/(2R), and the bowl is concave, so nothing hides them: their form factor is (ℓ/2R)² dA/(πℓ²) =
//! dA/(4πR²), wherever they are. Hence what the bowl sends to its own points is the same everywhere, in light and in
//! shadow (Ingersoll, Svitek and Murray, Icarus 100, 1992). With H the direct irradiance, Φ = ∫ H dA, A the area of
//! the bowl and f = A/(4πR²) = (1 − cos θ)/2:
//!
//! ```text
//! H_indirect = ∫ a (H + H_indirect) dA / (4πR²),    H_indirect = a Φ / (4πR² (1 − a f)),    L = a (H + H_indirect) / π.
//! ```
//!
//! *Direct flux.* All light that passes the rim's disk falls on the bowl, and no other does: Φ = π e A_sun F, with F
//! the form factor from the sun to the disk. For an element parallel to a disk of radius r, at height h above its plane
//! and offset l from its axis,
//!
//! ```text
//! F = ½ (1 − (h² + l² − r²) / √((h² + l² + r²)² − 4 r² l²)).
//! ```
//!
//! (A far sun has Φ = S sin(elevation) π r²; this one is 1 % from that limit, and needs no limit.) The sun's extent is
//! integrated by the 2 × 2 Gauss rule, whose error is of the fourth order in the angle [`SUN_SIDE`]/[`SUN_DISTANCE`]
//! = 0.01: about 1e-9 measured. The sun is no farther than it need be, so that its radiance, 2.4e4, does not swamp
//! every norm that it enters.
//!
//! *Shadow.* p is lit if the segment from p to P leaves through the rim's disk, that is, if the other end q of the
//! chord through p and P lies above the rim's plane. The map p → q is the harmonic homology of the sphere with
//! centre P, which takes planes to planes. With λ = (p·P − 1)/(|P|² − 1), q = (p − 2λP)/(1 − 2λ), and 1 − 2λ > 0
//! for P outside the sphere: p is lit where
//!
//! ```text
//! σ(p) = (p_y + c) − 2 λ(p) (P_y + c) > 0,
//! ```
//!
//! linear in p: the shadow is bounded by a circle, the mirrored rim. Points that face away from the sun have λ > 0
//! and are in shadow by the same test.
//!
//! # Limits
//! All this is the continuous truth of the *sphere*. The scene has 6 n² triangles inscribed in it instead (n
//! rings), and the continuous truth of those differs by up to 0.25/n² relative; only more rings reduce it. It is
//! given at the one point of each triangle where the sphere behind has the triangle's normal, for triangles that
//! with half a ring around them are wholly lit or wholly in shadow. The mean over a triangle, and so a coarse
//! bundle, differs from that point's value in the first order of the triangle's size.

use super::matte::{film, matte, scene};
use super::shape::{Outline, parallelogram};
use super::{Continuous, Exact, MeanRadiance, PointRadiance};
use crate::geometry::{Polygon, Vec3};
use crate::scene::{Camera, Scene, SceneError, Tessellation};
use std::f64::consts::{PI, TAU};

/// Angle between the lowest point and the rim, seen from the centre of the sphere.
pub const HALF_ANGLE_DEGREES: f64 = 60.0;
/// Above the plane of the rim, seen from its centre.
pub const SUN_ELEVATION_DEGREES: f64 = 25.0;
/// From the centre of the rim, in radii of the sphere.
pub const SUN_DISTANCE: f64 = 10.0;
/// Edge of the square, in radii of the sphere.
pub const SUN_SIDE: f64 = 0.1;
/// On a plane at the centre of the rim that faces the sun, W m⁻², in every band.
pub const SUN_IRRADIANCE: f64 = 1.0;
/// The default albedo, a band each.
pub const ALBEDO: [f64; 3] = [0.8, 0.5, 0.2];
/// The default number of rings: 384 triangles.
pub const N_RINGS: usize = 8;
/// The relative effect of n rings of triangles is below this over n²: measured 0.16, 0.18, 0.22 at n = 4, 8, 16.
const TESSELLATION_CONSTANT: f64 = 0.25;
/// Fourth order in the sun's angular size, with room.
const RELATIVE_UNCERTAINTY: f64 = 1e-7;

/// The crater of this albedo, one value a band, as 6 n_rings² triangles. Surfaces `bowl` and `sun`. The answer is
/// [`spherical_crater_exact`]. O(n_rings²) time and memory.
///
/// # Errors
/// No rings, no bands, an albedo outside [0, 1].
pub fn spherical_crater(albedo: &[f64], n_rings: usize) -> Result<Scene, SceneError> {
    let n_bands = albedo.len();
    let mut bowl = matte("bowl", triangles(n_rings).into_iter().map(Outline::from), albedo, &vec![0.0; n_bands])?;
    let sagitta = |p: &Polygon| 1.0 - p.vertices()[0].dot(p.normal()).abs();
    bowl.tessellation = Some(Tessellation {
        shape: "spherical cap",
        n_polygons: bowl.polygons.len(),
        deviation: bowl.polygons.iter().map(sagitta).fold(0.0, f64::max),
    });
    let half = 0.5 * SUN_SIDE;
    let square = parallelogram(sun_centre(), half * Vec3::X, half * Vec3::Z);
    let sun = matte("sun", [square], &vec![0.0; n_bands], &vec![sun_radiance(); n_bands])?;
    let rim_centre = Vec3::new(0.0, rim_height(), 0.0);
    let camera = Camera::look_at(Vec3::new(-0.5, 1.5, 1.5), rim_centre, Vec3::Y, 36_f64.to_radians(), film());
    scene("spherical-crater", n_bands, vec![bowl, sun], camera)
}

/// The continuous radiance in light and in shadow, and its mean over the bowl, for the same parameters. O(n_rings²).
pub fn spherical_crater_exact(albedo: &[f64], n_rings: usize) -> Exact {
    // Solve for the interreflection: Φ from the sun, f from the bowl's share of the sphere.
    let flux: f64 = sun_nodes().iter().map(|node| 0.25 * sun_power() * disk_form_factor(*node)).sum();
    let bowl_area = TAU * (1.0 + rim_height());
    let share = bowl_area / (4.0 * PI);
    let indirect: Vec<f64> = albedo.iter().map(|a| a * flux / (4.0 * PI * (1.0 - a * share))).collect();
    let radiance = |direct: f64| albedo.iter().zip(&indirect).map(|(a, h)| a * (direct + h) / PI).collect();

    // Evaluate wherever a triangle is clear of the shadow's edge.
    let margin = 0.5 * HALF_ANGLE_DEGREES.to_radians() / n_rings as f64;
    let point = |triangle: &[Vec3; 3]| {
        let (is_lit, tangent) = (light(triangle, margin)?, tangent_point(triangle)?);
        let direct = if is_lit { direct_irradiance(tangent.normalize()) } else { 0.0 };
        Some(PointRadiance { surface: "bowl", position: tangent.to_array(), radiance: radiance(direct) })
    };
    let points = triangles(n_rings).iter().filter_map(point).collect();
    Exact::Continuous(Continuous {
        points,
        means: vec![MeanRadiance { surface: "bowl", radiance: radiance(flux / bowl_area) }],
        uniform_patches: Vec::new(),
        relative_uncertainty: RELATIVE_UNCERTAINTY,
        tessellation_error: TESSELLATION_CONSTANT / (n_rings * n_rings) as f64,
    })
}

/// Height of the rim's plane, −c.
fn rim_height() -> f64 {
    -HALF_ANGLE_DEGREES.to_radians().cos()
}

fn sun_centre() -> Vec3 {
    let (sin, cos) = SUN_ELEVATION_DEGREES.to_radians().sin_cos();
    Vec3::new(SUN_DISTANCE * cos, rim_height() + SUN_DISTANCE * sin, 0.0)
}

/// e from S = e A_sun sin(elevation) / distance²: the sun faces down and is seen under its elevation.
fn sun_radiance() -> f64 {
    let sin = SUN_ELEVATION_DEGREES.to_radians().sin();
    SUN_IRRADIANCE * SUN_DISTANCE * SUN_DISTANCE / (SUN_SIDE * SUN_SIDE * sin)
}

/// Power the sun emits, π e A_sun.
fn sun_power() -> f64 {
    PI * sun_radiance() * SUN_SIDE * SUN_SIDE
}

/// The four points of the 2 × 2 Gauss rule on the sun, each of a quarter of its area.
fn sun_nodes() -> [Vec3; 4] {
    around_sun(0.5 * SUN_SIDE / 3_f64.sqrt())
}

fn around_sun(offset: f64) -> [Vec3; 4] {
    [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].map(|(x, z)| sun_centre() + offset * Vec3::new(x, 0.0, z))
}

/// Form factor from an element of the sun to the rim's disk, which is parallel to it.
fn disk_form_factor(sun_point: Vec3) -> f64 {
    let height_squared = (sun_point.y - rim_height()).powi(2);
    let offset_squared = sun_point.x * sun_point.x + sun_point.z * sun_point.z;
    let radius_squared = HALF_ANGLE_DEGREES.to_radians().sin().powi(2);
    let sum = height_squared + offset_squared + radius_squared;
    let root = (sum * sum - 4.0 * radius_squared * offset_squared).sqrt();
    0.5 * (1.0 - (sum - 2.0 * radius_squared) / root)
}

/// Irradiance from the whole sun at a lit point of the sphere, whose normal is −p.
fn direct_irradiance(p: Vec3) -> f64 {
    let from = |node: Vec3| {
        let to_sun = node - p;
        let cosines = to_sun.y * -p.dot(to_sun) / to_sun.length_squared();
        0.25 * sun_power() / PI * cosines / to_sun.length_squared()
    };
    sun_nodes().map(from).iter().sum()
}

/// The point of an inscribed triangle where its plane is parallel to the sphere's tangent plane: its circumcentre, None
/// where that is not inside.
fn tangent_point([a, b, c]: &[Vec3; 3]) -> Option<Vec3> {
    let normal = (b - a).cross(c - a).normalize();
    let centre = normal * normal.dot(*a);
    let is_left = |from: &Vec3, to: &Vec3| (to - from).cross(centre - from).dot(normal) > 0.0;
    (is_left(a, b) && is_left(b, c) && is_left(c, a)).then_some(centre)
}

/// Some(true) where the triangle and a margin around it see all of the sun, Some(false) where they see none of it.
fn light(triangle: &[Vec3; 3], margin: f64) -> Option<bool> {
    let corners_of_sun = around_sun(0.5 * SUN_SIDE);
    let distances = || corners_of_sun.iter().flat_map(|sun| triangle.iter().map(|p| height_above_shadow(*p, *sun)));
    if distances().all(|d| d > margin) {
        Some(true)
    } else if distances().all(|d| d < -margin) {
        Some(false)
    } else {
        None
    }
}

/// Signed distance of p from the plane σ = 0 that bounds the shadow cast from one point of the sun; above is lit.
fn height_above_shadow(p: Vec3, sun: Vec3) -> f64 {
    // Write σ(p) = gradient · p + constant.
    let lift = 2.0 * (sun.y - rim_height()) / (sun.length_squared() - 1.0);
    let gradient = Vec3::Y - lift * sun;
    let constant = lift - rim_height();
    (gradient.dot(p) + constant) / gradient.length()
}

/// The bowl as triangles with corners on the sphere: ring k of n has 6 k corners at angle k θ/n, joined like a
/// hexagonal grid. Corners are computed from their place in the grid alone, so neighbours share them bit for bit.
fn triangles(n_rings: usize) -> Vec<[Vec3; 3]> {
    let corner = |ring: usize, step: usize| {
        let (radius, depth) = (HALF_ANGLE_DEGREES.to_radians() * ring as f64 / n_rings as f64).sin_cos();
        let n_steps = (6 * ring).max(1);
        let (z, x) = (TAU * (step % n_steps) as f64 / n_steps as f64).sin_cos();
        Vec3::new(radius * x, -depth, -radius * z)
    };
    let mut triangles = Vec::with_capacity(6 * n_rings * n_rings);
    for ring in 1..=n_rings {
        for sector in 0..6 {
            let outer = |i| corner(ring, sector * ring + i);
            let inner = |i| corner(ring - 1, sector * (ring - 1) + i);
            triangles.extend((0..ring).map(|i| [outer(i), outer(i + 1), inner(i)]));
            triangles.extend((1..ring).map(|i| [inner(i - 1), outer(i), inner(i)]));
        }
    }
    triangles
}
