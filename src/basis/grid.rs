//! Subdivision of one polygon into patches, and the way back from a point to its patch.

use crate::geometry::{Polygon, PolygonError, Vec3};

/// A polygon cut into patches no longer than the patch size along its edges. Halving the patch size nests exactly where every
/// edge is a multiple of it.
#[derive(Clone, Debug)]
pub enum Grid {
    /// n² triangles, all congruent to the whole.
    Triangle { corners: [Vec3; 3], n: usize },
    /// n × m quadrilaterals on the bilinear map (parallelograms stay parallelograms).
    Quadrilateral { corners: [Vec3; 4], n: usize, m: usize },
    /// A polygon of five or more corners: the triangles of its fan, each cut by itself.
    Fan { normal: Vec3, triangles: Vec<Grid> },
}

impl Grid {
    /// Chooses the counts. Cost O(corners).
    pub fn new(polygon: &Polygon, patch_size: f64) -> Self {
        let v = polygon.vertices();
        // One ulp of slack, so that 0.3 / 0.1 is three patches.
        let count = |length: f64| ((length / patch_size) * (1.0 - 1e-9)).ceil().max(1.0) as usize;
        match *v {
            [a, b, c] => {
                let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
                Self::Triangle { corners: [a, b, c], n: count(longest) }
            }
            [a, b, c, d] => Self::Quadrilateral {
                corners: [a, b, c, d],
                n: count(a.distance(b).max(c.distance(d))),
                m: count(b.distance(c).max(d.distance(a))),
            },
            _ => {
                let triangle = |pair: &[Vec3]| {
                    let [a, b, c] = [v[0], pair[0], pair[1]];
                    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
                    Self::Triangle { corners: [a, b, c], n: count(longest) }
                };
                Self::Fan { normal: polygon.normal(), triangles: v[1..].windows(2).map(triangle).collect() }
            }
        }
    }

    /// Number of patches.
    pub fn n_patches(&self) -> usize {
        match self {
            Self::Triangle { n, .. } => n.saturating_mul(*n),
            Self::Quadrilateral { n, m, .. } => n.saturating_mul(*m),
            Self::Fan { triangles, .. } => triangles.iter().map(Grid::n_patches).fold(0, usize::saturating_add),
        }
    }

    /// The patches, in order. Neighbours share their corners bit for bit.
    pub fn patches(&self) -> Result<Vec<Polygon>, PolygonError> {
        match self {
            Self::Triangle { corners: [a, b, c], n } => {
                let point = |i: usize, j: usize| {
                    let (s, t) = (i as f64 / *n as f64, j as f64 / *n as f64);
                    *a * (1.0 - s - t).max(0.0) + *b * s + *c * t
                };
                let mut patches = Vec::with_capacity(n * n);
                for j in 0..*n {
                    for i in 0..*n - j {
                        patches.push(Polygon::new(vec![point(i, j), point(i + 1, j), point(i, j + 1)])?);
                        if i + j + 1 < *n {
                            patches.push(Polygon::new(vec![point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)])?);
                        }
                    }
                }
                Ok(patches)
            }
            Self::Quadrilateral { corners: [a, b, c, d], n, m } => {
                let point = |i: usize, j: usize| {
                    let (s, t) = (i as f64 / *n as f64, j as f64 / *m as f64);
                    (*a * (1.0 - s) + *b * s) * (1.0 - t) + (*d * (1.0 - s) + *c * s) * t
                };
                let corners =
                    |i: usize, j: usize| vec![point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)];
                (0..*m).flat_map(|j| (0..*n).map(move |i| (i, j))).map(|(i, j)| Polygon::new(corners(i, j))).collect()
            }
            Self::Fan { triangles, .. } => {
                let mut patches = Vec::new();
                for triangle in triangles {
                    patches.extend(triangle.patches()?);
                }
                Ok(patches)
            }
        }
    }

    /// For every patch, in order, which tile of 2ᵏ × 2ᵏ patches it lies in; a triangle that is not cut evenly is one tile.
    pub fn tiles(&self, k: u32) -> Vec<usize> {
        match self {
            Self::Quadrilateral { n, m, .. } => {
                let across = (n >> k) + 1;
                (0..*m).flat_map(|j| (0..*n).map(move |i| (j >> k) * across + (i >> k))).collect()
            }
            Self::Triangle { corners: [a, b, c], n } => {
                if k > n.trailing_zeros() {
                    return vec![0; n * n];
                }
                let coarse = Self::Triangle { corners: [*a, *b, *c], n: n >> k };
                let third = 1.0 / 3.0;
                let centroid = |i: usize, j: usize, offset: f64| {
                    let (s, t) = ((i as f64 + offset) / *n as f64, (j as f64 + offset) / *n as f64);
                    *a * (1.0 - s - t) + *b * s + *c * t
                };
                let mut tiles = Vec::with_capacity(n * n);
                for j in 0..*n {
                    for i in 0..*n - j {
                        tiles.push(coarse.locate(centroid(i, j, third)));
                        if i + j + 1 < *n {
                            tiles.push(coarse.locate(centroid(i, j, 2.0 * third)));
                        }
                    }
                }
                tiles
            }
            Self::Fan { triangles, .. } => {
                let mut tiles = Vec::new();
                for triangle in triangles {
                    let first = tiles.len();
                    tiles.extend(triangle.tiles(k).into_iter().map(|tile| first + tile));
                }
                tiles
            }
        }
    }

    /// Which patch holds this point of the polygon. Points on borders go to one of the neighbours; points off the polygon by
    /// rounding go to the nearest patch.
    pub fn locate(&self, point: Vec3) -> usize {
        match self {
            Self::Triangle { corners: [a, b, c], n } => {
                let [s, t] = barycentric(*a, *b, *c, point).map(|x| x * *n as f64);
                let row = (t.max(0.0) as usize).min(n - 1);
                let column = (s.max(0.0) as usize).min(n - 1 - row);
                let upper = (s - column as f64) + (t - row as f64) > 1.0 && row + column + 1 < *n;
                // Rows get shorter by one cell (two triangles) each: row r starts at Σ_{q<r} (2(n − q) − 1) = r (2n − r).
                row * (2 * n - row) + 2 * column + usize::from(upper)
            }
            Self::Quadrilateral { corners, n, m } => {
                let [s, t] = inverse_bilinear(corners, point);
                let cell = |x: f64, n: usize| ((x * n as f64).max(0.0) as usize).min(n - 1);
                cell(t, *m) * n + cell(s, *n)
            }
            Self::Fan { normal, triangles } => {
                // Take the triangle that the point is furthest inside of.
                let inside = |grid: &Grid| {
                    let Self::Triangle { corners: [a, b, c], .. } = grid else { return f64::NEG_INFINITY };
                    let depth = |from: Vec3, to: Vec3| normal.cross(to - from).dot(point - from) / to.distance(from);
                    depth(*a, *b).min(depth(*b, *c)).min(depth(*c, *a))
                };
                let mut first = 0;
                let mut best = (f64::NEG_INFINITY, 0, 0);
                for (k, grid) in triangles.iter().enumerate() {
                    let depth = inside(grid);
                    if depth > best.0 {
                        best = (depth, k, first);
                    }
                    first += grid.n_patches();
                }
                best.2 + triangles[best.1].locate(point)
            }
        }
    }
}

/// (s, t) with p = a + s (b − a) + t (c − a).
fn barycentric(a: Vec3, b: Vec3, c: Vec3, p: Vec3) -> [f64; 2] {
    let (u, v, w) = (b - a, c - a, p - a);
    let normal = u.cross(v);
    let square = normal.length_squared();
    [w.cross(v).dot(normal) / square, u.cross(w).dot(normal) / square]
}

/// (s, t) with p = (1−t)((1−s)a + s b) + t((1−s)d + s c), by Newton's method from the centre; one step for a parallelogram.
fn inverse_bilinear([a, b, c, d]: &[Vec3; 4], p: Vec3) -> [f64; 2] {
    let (u, v, twist) = (*b - *a, *d - *a, *a - *b + *c - *d);
    let (mut s, mut t) = (0.5, 0.5);
    for _ in 0..20 {
        let (du, dv) = (u + t * twist, v + s * twist);
        let [ds, dt] = barycentric(Vec3::ZERO, du, dv, p - *a - s * u - t * v - s * t * twist);
        s += ds;
        t += dt;
        if ds.abs().max(dt.abs()) < 1e-14 {
            break;
        }
    }
    [s, t]
}
