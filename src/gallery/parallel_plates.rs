//! `parallel-plates`: two unit squares facing each other across a gap of one half, in the open; one emits. Grey.
//!
//! # Geometry
//! Square 1 is [0, 1]² at z = 0 facing +z, square 2 is [0, 1]² at z = ½ facing −z. Both have albedo 0.8; square 1 emits
//! the exitance 1 W m⁻² (radiance 1/π), square 2 nothing. The surroundings are black and cold.
//!
//! # Exact answer
//! With B = πL the radiosity and h the gap, the two squares obey the coupled Fredholm equations
//!
//! ```text
//! B₁(x) = 1 + 0.8 ∫ k(x − y) B₂(y) dy,    B₂(y) = 0.8 ∫ k(y − x) B₁(x) dx,    k(d) = h² / (π (|d|² + h²)²),
//! ```
//!
//! both integrals over [0, 1]²: h/√(|d|² + h²) is the cosine at either end, squared over π r². The kernel is
//! analytic, so collocation at tensor Gauss points converges geometrically (the poles at distance h give a factor
//! of (1 + √2)⁻² a node and direction), and the equations themselves carry the values from the nodes to corners and
//! edges (Nyström). No closed form is known; the numbers below are certain to 12 digits. Source: reference case
//! C-SQUARES-2 (family `facing_squares_continuous`), computed by that method and by extrapolation of exact
//! uniform-patch solutions. `tests/it/gallery.rs` computes them once more.
//!
//! On n × n equal patches with exact form factors the *discrete* means are known too. They are alike for n = 1 and
//! n = 2: by symmetry the four quarters of a square have one radiosity.

use super::matte::{film, matte, scene};
use super::{Continuous, Exact, MeanRadiance, PointRadiance, UniformPatches};
use crate::geometry::Vec3;
use crate::scene::{Camera, Scene, SceneError};
use std::f64::consts::PI;

const GAP: f64 = 0.5;
const ALBEDO: f64 = 0.8;
const EXITANCE: f64 = 1.0;

/// Radiosities (x, y, B₁, B₂) of C-SQUARES-2: corner, middle of an edge, centre, and the centre of a quarter.
const POINTS: [(f64, f64, f64, f64); 4] = [
    (0.0, 0.0, 1.05995045826, 0.186774077659),
    (0.5, 0.0, 1.10239687958, 0.303193187997),
    (0.5, 0.5, 1.18341890547, 0.507410939209),
    (0.25, 0.25, 1.14052695750, 0.406938651614),
];
/// Mean radiosities (B₁, B₂).
const MEANS: (f64, f64) = (1.13026848938, 0.377391786099);
/// Mean radiosities (n, B₁, B₂) on n × n equal patches a square.
const UNIFORM_PATCHES: [(usize, f64, f64); 4] = [
    (1, 1.12404839014, 0.373411827923),
    (2, 1.12404839014, 0.373411827923),
    (4, 1.12841768721, 0.376177047454),
    (8, 1.12979258202, 0.377077099497),
];
/// Half a unit in the twelfth digit of a number that starts with 1.
const RELATIVE_UNCERTAINTY: f64 = 5e-12;

/// Two facing unit squares. Surfaces `plate-1` (z = 0, emits) and `plate-2` (z = ½).
pub fn parallel_plates() -> Scene {
    build().expect("the plates' own numbers are valid")
}

fn build() -> Result<Scene, SceneError> {
    let corner = |x, y, z| Vec3::new(x, y, z);
    let lower = vec![corner(0.0, 0.0, 0.0), corner(1.0, 0.0, 0.0), corner(1.0, 1.0, 0.0), corner(0.0, 1.0, 0.0)];
    let upper = vec![corner(0.0, 1.0, GAP), corner(1.0, 1.0, GAP), corner(1.0, 0.0, GAP), corner(0.0, 0.0, GAP)];
    let plates =
        vec![matte("plate-1", [lower], &[ALBEDO], &[EXITANCE / PI])?, matte("plate-2", [upper], &[ALBEDO], &[0.0])?];
    let middle = Vec3::new(0.5, 0.5, 0.5 * GAP);
    let camera = Camera::look_at(Vec3::new(0.5, -0.25, 0.5 * GAP), middle, Vec3::Z, 80_f64.to_radians(), film());
    scene("parallel-plates", 1, plates, camera)
}

/// The continuous radiance at four points of each plate and its means, and the discrete means on uniform meshes.
pub fn parallel_plates_exact() -> Exact {
    // Turn a radiosity of each plate into radiances.
    let mean = |surface, radiosity: f64| MeanRadiance { surface, radiance: vec![radiosity / PI] };
    let means = |first, second| vec![mean("plate-1", first), mean("plate-2", second)];
    let point = |surface, position, radiosity: f64| PointRadiance { surface, position, radiance: vec![radiosity / PI] };

    let on_plates =
        |(x, y, first, second)| [point("plate-1", [x, y, 0.0], first), point("plate-2", [x, y, GAP], second)];
    Exact::Continuous(Continuous {
        points: POINTS.into_iter().flat_map(on_plates).collect(),
        means: means(MEANS.0, MEANS.1),
        uniform_patches: UNIFORM_PATCHES
            .into_iter()
            .map(|(n_per_side, first, second)| UniformPatches { n_per_side, means: means(first, second) })
            .collect(),
        relative_uncertainty: RELATIVE_UNCERTAINTY,
        tessellation_error: 0.0,
    })
}
