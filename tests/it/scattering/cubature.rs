//! Integrals over directions, by rules that know nothing of the surfaces' own.

use crate::sphere::gauss;
use etendue::geometry::Vec3;
use etendue::scattering::Brdf;
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A box, its integral and the error estimated for it.
struct Cell {
    x: [f64; 2],
    y: [f64; 2],
    value: f64,
    error: f64,
}

impl PartialEq for Cell {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Cell {}

impl PartialOrd for Cell {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Cell {
    fn cmp(&self, other: &Self) -> Ordering {
        self.error.total_cmp(&other.error)
    }
}

/// ∫ f dx dy over boxes by adaptive cubature: the worst is cut in four until the estimated errors, differences of two Gauss rules, sum to
/// less than the tolerance or `n_cells` are there. Returns value and estimate.
fn adaptive(boxes: Vec<[[f64; 2]; 2]>, tolerance: f64, n_cells: usize, f: impl Fn(f64, f64) -> f64) -> (f64, f64) {
    let rules = [gauss(6), gauss(9)];
    let cell = |[x, y]: [[f64; 2]; 2]| {
        let (width, height) = (x[1] - x[0], y[1] - y[0]);
        let [coarse, fine] = [0, 1].map(|k| {
            let rule: &Vec<(f64, f64)> = &rules[k];
            let line = |u: f64| rule.iter().map(|(v, w)| w * f(x[0] + width * u, y[0] + height * v)).sum::<f64>();
            rule.iter().map(|(u, w)| w * line(*u)).sum::<f64>() * width * height
        });
        Cell { x, y, value: fine, error: (fine - coarse).abs() }
    };
    let mut cells: BinaryHeap<Cell> = boxes.into_iter().map(cell).collect();
    let mut error: f64 = cells.iter().map(|c| c.error).sum();
    while error > tolerance && cells.len() < n_cells {
        let worst = cells.pop().unwrap();
        let ([a, b], [c, d]) = (worst.x, worst.y);
        let (m, n) = (0.5 * (a + b), 0.5 * (c + d));
        error -= worst.error;
        for part in [[[a, m], [c, n]], [[a, m], [n, d]], [[m, b], [c, n]], [[m, b], [n, d]]] {
            let part = cell(part);
            error += part.error;
            cells.push(part);
        }
    }
    (cells.iter().map(|c| c.value).sum(), cells.iter().map(|c| c.error).sum())
}

/// ∫ f dω over the sphere (or the upper hemisphere), adaptive in polar angle and azimuth.
pub fn over_directions(whole: bool, tolerance: f64, n_cells: usize, f: impl Fn(Vec3) -> f64) -> (f64, f64) {
    let halves = if whole { vec![[0.0, FRAC_PI_2], [FRAC_PI_2, PI]] } else { vec![[0.0, FRAC_PI_2]] };
    let quarter = |k: i32| [FRAC_PI_2 * f64::from(k), FRAC_PI_2 * f64::from(k + 1)];
    let boxes = halves.into_iter().flat_map(|polar| (0..4).map(move |k| [polar, quarter(k)])).collect();
    adaptive(boxes, tolerance, n_cells, |polar, azimuth| {
        let ((sin, cos), (y, x)) = (polar.sin_cos(), azimuth.sin_cos());
        sin * f(Vec3::new(sin * x, sin * y, cos))
    })
}

/// ∫ f |cosθ| dω over all directions of incidence that facets m, above the horizon and facing the outgoing direction, mirror or bend into it:
/// adaptive in m, in coordinates about the outgoing direction, cut at the critical angle and where circles about it meet the horizon.
pub fn over_facets(brdf: &dyn Brdf, band: usize, outgoing: Vec3, tolerance: f64, n_cells: usize) -> (f64, f64) {
    let side = outgoing.z.signum();
    let [n, n_beyond] = if side > 0.0 { [1.0, brdf.relative_index()] } else { [brdf.relative_index(), 1.0] };
    let (cosine, sine) = (outgoing.z.abs(), outgoing.x.hypot(outgoing.y));
    let up = if sine > 0.0 { (side * Vec3::Z - cosine * outgoing) / sine } else { Vec3::X };
    let across = outgoing.cross(up);
    let critical = if n_beyond < n { (n_beyond / n).asin() } else { FRAC_PI_2 };
    let mut edges = [0.0, cosine.asin(), critical, FRAC_PI_2];
    edges.sort_by(f64::total_cmp);

    let boxes = (0..3).flat_map(|k| [[0.0, 1.0], [-1.0, 0.0]].map(|turn| [[f64::from(k), f64::from(k + 1)], turn]));
    adaptive(boxes.collect(), tolerance, n_cells, |x, turn| {
        // (3 − 2v)v² smooths the roots at both ends of a piece.
        let (k, v) = (x.min(2.999_999_999).floor(), x - x.min(2.999_999_999).floor());
        let (low, width) = (edges[k as usize], edges[k as usize + 1] - edges[k as usize]);
        let tilt = low + width * (3.0 - 2.0 * v) * v * v;
        let (sin, facing) = tilt.sin_cos();
        let reach = -facing * cosine / (sin * sine);
        let half = if reach > -1.0 { reach.acos() } else { PI };
        let (y, x) = (half * turn).sin_cos();
        let facet = facing * outgoing + sin * (x * up + y * across);
        let stretched = width * 6.0 * v * (1.0 - v) * half * sin;
        if side * facet.z <= 0.0 || facing <= 0.0 || stretched == 0.0 {
            return 0.0;
        }
        let f = |incident: Vec3| brdf.eval(band, incident.normalize(), outgoing) * incident.z.abs();

        // Mirrored: dωᵢ = 4 (o·m) dω_m.
        let mirrored = 2.0 * facing * facet - outgoing;
        let mut sum = if side * mirrored.z > 0.0 { f(mirrored) * 4.0 * facing } else { 0.0 };

        // Bent: dωᵢ = |n(o) o + n(i) i|²/(n(i)² |i·m|) dω_m.
        let along = (facing * facet - outgoing) * (n / n_beyond);
        let squared = 1.0 - along.length_squared();
        if squared > 0.0 {
            let bent = along - squared.sqrt() * facet;
            let jacobian = (n * outgoing + n_beyond * bent).length_squared() / (n_beyond * n_beyond * squared.sqrt());
            sum += if side * bent.z < 0.0 { f(bent) * jacobian } else { 0.0 };
        }
        sum * stretched
    })
}

/// ∫ f cosθ dω over the hemisphere in coordinates about the mirror direction, split where the lobe meets the horizon.
pub fn about_the_mirror(brdf: &dyn Brdf, band: usize, outgoing: Vec3) -> f64 {
    let axis = Vec3::new(-outgoing.x, -outgoing.y, outgoing.z);
    let across = if axis.z > 1.0 - 1e-12 { Vec3::X } else { (Vec3::Z - axis.z * axis).normalize() };
    let side = axis.cross(across);
    let (cosine, sine) = (axis.z, (1.0 - axis.z * axis.z).max(0.0).sqrt());
    let rule = gauss(64);

    // The polar angle about the mirror direction: full circles first, then arcs; x = (3 − 2u)u² smooths the arc's root at both ends.
    let tilt = cosine.acos();
    let right = std::f64::consts::FRAC_PI_2;
    let mut sum = 0.0;
    for (low, high) in [(0.0, right - tilt), (right - tilt, right), (right, right + tilt)] {
        for panel in 0..8 {
            for (u, weight) in &rule {
                let u = (f64::from(panel) + u) / 8.0;
                let alpha = low + (high - low) * (3.0 - 2.0 * u) * u * u;
                let stretch = (high - low) * 6.0 * u * (1.0 - u) / 8.0;
                let (sin_alpha, cos_alpha) = alpha.sin_cos();
                let reach = -cos_alpha * cosine / (sin_alpha * sine);
                let half_arc = if reach <= -1.0 || sine == 0.0 { 0.5 * TAU } else { reach.min(1.0).acos() };
                for (v, weight_v) in &rule {
                    let (sin, cos) = (half_arc * v).sin_cos();
                    let incident = cos_alpha * axis + sin_alpha * (cos * across + sin * side);
                    if incident.z > 0.0 {
                        let f = brdf.eval(band, incident.normalize(), outgoing);
                        sum += weight * stretch * weight_v * 2.0 * half_arc * sin_alpha * f * incident.z;
                    }
                }
            }
        }
    }
    sum
}
