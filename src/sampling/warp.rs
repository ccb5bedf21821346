//! Pure functions from uniform numbers to points and directions, each with its density beside it.
//!
//! Directions are unit vectors around +z; densities of directions are with respect to solid angle (sr⁻¹), of points with respect to
//! area. A density is that of the function above it, and is zero where that function never goes.

use std::f64::consts::{FRAC_1_PI, FRAC_PI_4, PI, TAU};

/// A point of the unit disk, uniform by area; neighbours stay neighbours (Shirley & Chiu 1997), which keeps stratification.
pub fn disk(uniform: [f64; 2]) -> [f64; 2] {
    let (_, point) = concentric(uniform);
    point
}

/// The numbers that [`disk`] warps to a point of the unit disk, to rounding.
pub fn disk_inverse(point: [f64; 2]) -> [f64; 2] {
    let [x, y] = point;
    let radius = x.hypot(y);
    let (a, b) = if x.abs() > y.abs() {
        (radius.copysign(x), radius.copysign(x) * ((y / x).atan() / FRAC_PI_4))
    } else if y != 0.0 {
        (radius.copysign(y) * ((x / y).atan() / FRAC_PI_4), radius.copysign(y))
    } else {
        (0.0, 0.0)
    };
    [0.5 * (a + 1.0), 0.5 * (b + 1.0)]
}

/// 1/π inside the unit disk.
pub fn disk_pdf(point: [f64; 2]) -> f64 {
    if point[0] * point[0] + point[1] * point[1] <= 1.0 { FRAC_1_PI } else { 0.0 }
}

/// A direction of the upper hemisphere with density cosθ/π: a point of the disk, lifted (Malley).
///
/// The horizon itself (cosθ = 0) comes up only for numbers that are exactly 0, with probability 2⁻⁵².
#[inline(always)]
pub fn cosine_hemisphere(uniform: [f64; 2]) -> [f64; 3] {
    let (radius, [x, y]) = concentric(uniform);
    [x, y, ((1.0 - radius) * (1.0 + radius)).sqrt()]
}

/// cosθ/π above the horizon.
#[inline(always)]
pub fn cosine_hemisphere_pdf(direction: [f64; 3]) -> f64 {
    direction[2].max(0.0) * FRAC_1_PI
}

/// A direction of the upper hemisphere, uniform by solid angle.
pub fn uniform_hemisphere(uniform: [f64; 2]) -> [f64; 3] {
    around_z(1.0 - uniform[0], uniform[1])
}

/// 1/2π above the horizon.
pub fn uniform_hemisphere_pdf(direction: [f64; 3]) -> f64 {
    if direction[2] >= 0.0 { 1.0 / TAU } else { 0.0 }
}

/// A direction of the sphere, uniform by solid angle.
pub fn uniform_sphere(uniform: [f64; 2]) -> [f64; 3] {
    around_z(1.0 - 2.0 * uniform[0], uniform[1])
}

/// 1/4π everywhere.
pub fn uniform_sphere_pdf() -> f64 {
    1.0 / (4.0 * PI)
}

/// A direction of the lobe cosⁿα about +z, n ≥ 0: cosα = (1 − u)^{1/(n+1)}.
pub fn phong_lobe(exponent: f64, uniform: [f64; 2]) -> [f64; 3] {
    around_z((1.0 - uniform[0]).powf(1.0 / (exponent + 1.0)), uniform[1])
}

/// (n+1)/(2π) cosⁿα above the plane of the lobe.
pub fn phong_lobe_pdf(exponent: f64, cosine: f64) -> f64 {
    if cosine > 0.0 { (exponent + 1.0) / TAU * cosine.powf(exponent) } else { 0.0 }
}

/// The direction with this cosine to +z, turned by this fraction of a full circle.
pub fn around_z(cosine: f64, turn: f64) -> [f64; 3] {
    let sine = ((1.0 - cosine) * (1.0 + cosine)).max(0.0).sqrt();
    let (sin, cos) = (TAU * turn).sin_cos();
    [sine * cos, sine * sin, cosine]
}

/// A point of a triangle, uniform by area: the unit square folded along its diagonals onto barycentric coordinates without a
/// square root (Heitz 2019), which keeps stratification.
pub fn triangle(vertices: [[f64; 3]; 3], uniform: [f64; 2]) -> [f64; 3] {
    let [u, v] = uniform;
    let (a, b) = if v > u { (0.5 * u, v - 0.5 * u) } else { (u - 0.5 * v, 0.5 * v) };
    let c = 1.0 - a - b;
    std::array::from_fn(|k| a * vertices[0][k] + b * vertices[1][k] + c * vertices[2][k])
}

/// 1/area of the triangle.
pub fn triangle_pdf(vertices: [[f64; 3]; 3]) -> f64 {
    1.0 / triangle_area(vertices)
}

/// A convex polygon prepared for sampling: its fan of triangles and their shares of the area.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvexPolygon {
    vertices: Vec<[f64; 3]>,
    /// Area of the fan's triangles up to and including each.
    cumulative_area: Vec<f64>,
}

impl ConvexPolygon {
    /// At least three vertices in order, not all on one line.
    pub fn new<V: Into<[f64; 3]>>(vertices: impl IntoIterator<Item = V>) -> Self {
        let vertices: Vec<[f64; 3]> = vertices.into_iter().map(Into::into).collect();
        let mut area = 0.0;
        let fan = vertices.iter().zip(vertices.iter().skip(1)).skip(1);
        let cumulative_area = fan
            .map(|(b, c)| {
                area += triangle_area([vertices[0], *b, *c]);
                area
            })
            .collect();
        Self { vertices, cumulative_area }
    }

    /// A point of the polygon, uniform by area. Picks the triangle with the first number, then uses the rest of it again.
    ///
    /// Cost O(log n_vertices).
    pub fn sample(&self, uniform: [f64; 2]) -> [f64; 3] {
        let target = uniform[0] * self.area();
        let last = self.cumulative_area.len() - 1;
        let k = self.cumulative_area.partition_point(|c| *c <= target).min(last);
        let below = if k == 0 { 0.0 } else { self.cumulative_area[k - 1] };
        let rest = ((target - below) / (self.cumulative_area[k] - below)).clamp(0.0, 1.0);
        triangle([self.vertices[0], self.vertices[k + 1], self.vertices[k + 2]], [rest, uniform[1]])
    }

    /// 1/area.
    pub fn pdf(&self) -> f64 {
        1.0 / self.area()
    }

    /// Sum of the triangles' areas.
    pub fn area(&self) -> f64 {
        self.cumulative_area.last().copied().unwrap_or(0.0)
    }
}

/// The concentric map from the unit square to the unit disk: the radius, up to its sign, and the point.
///
/// A square around the centre goes to a circle; along the side that it lies on, the point moves by an angle of at most π/4 from the axis.
#[inline(always)]
fn concentric(uniform: [f64; 2]) -> (f64, [f64; 2]) {
    let [a, b] = uniform.map(|u| 2.0 * u - 1.0);
    let is_wide = a.abs() > b.abs();
    let (radius, along) = if is_wide { (a, b) } else { (b, a) };
    // The centre itself has no angle: 0/0 is kept from being one.
    let turn = along / if radius == 0.0 { 1.0 } else { radius };
    let (sin, cos) = sin_cos_within_eighth(FRAC_PI_4 * turn);
    let (straight, across) = (radius * cos, radius * sin);
    (radius, if is_wide { [straight, across] } else { [across, straight] })
}

/// Sine and cosine of |x| ≤ π/4 by their Taylor series, to 10⁻¹⁶: faster than for any x, and a pure function of x on every machine.
#[inline(always)]
fn sin_cos_within_eighth(x: f64) -> (f64, f64) {
    const SIN: [f64; 7] = [
        1.0 / 6.0,
        1.0 / 120.0,
        1.0 / 5040.0,
        1.0 / 362_880.0,
        1.0 / 39_916_800.0,
        1.0 / 6_227_020_800.0,
        1.0 / 1_307_674_368_000.0,
    ];
    const COS: [f64; 8] = [
        1.0 / 2.0,
        1.0 / 24.0,
        1.0 / 720.0,
        1.0 / 40_320.0,
        1.0 / 3_628_800.0,
        1.0 / 479_001_600.0,
        1.0 / 87_178_291_200.0,
        1.0 / 20_922_789_888_000.0,
    ];
    let y = x * x;
    let series = |terms: &[f64]| terms.iter().rev().fold(0.0, |sum, term| term - y * sum);
    (x - x * y * series(&SIN), 1.0 - y * series(&COS))
}

fn triangle_area(vertices: [[f64; 3]; 3]) -> f64 {
    let [a, b] = [1, 2].map(|k| -> [f64; 3] { std::array::from_fn(|i| vertices[k][i] - vertices[0][i]) });
    let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    0.5 * (cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]).sqrt()
}
