//! Quadrature over directions and χ² tests of what samples them, shared by the tests of surfaces and media.

use etendue::geometry::Vec3;
use etendue::sampling::Streams;
use etendue::stats::{ChiSquared, chi_squared_test};
use std::f64::consts::TAU;

/// Gauss–Legendre nodes and weights on [0, 1], by Newton's method on the Legendre polynomial.
pub fn gauss(n: usize) -> Vec<(f64, f64)> {
    (0..n)
        .map(|k| {
            let mut x = (std::f64::consts::PI * (k as f64 + 0.75) / (n as f64 + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..100 {
                let (mut before, mut value) = (1.0, x);
                for j in 2..=n {
                    let j = j as f64;
                    (before, value) = (value, ((2.0 * j - 1.0) * x * value - (j - 1.0) * before) / j);
                }
                slope = n as f64 * (x * value - before) / (x * x - 1.0);
                let step = value / slope;
                x -= step;
                if step.abs() < 1e-15 {
                    break;
                }
            }
            (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// A band of the sphere: cosines `low..high` to +z, split into rings, and rings into equal sectors.
#[derive(Clone, Copy)]
pub struct Cells {
    pub low: f64,
    pub n_rings: usize,
    pub n_sectors: usize,
}

impl Cells {
    pub fn n(&self) -> usize {
        self.n_rings * self.n_sectors
    }

    fn ring(&self, k: usize) -> (f64, f64) {
        let edge = |k: usize| self.low + (1.0 - self.low) * k as f64 / self.n_rings as f64;
        (edge(k), edge(k + 1))
    }

    /// The cell of a direction.
    pub fn find(&self, direction: Vec3) -> usize {
        let ring = ((direction.z - self.low) / (1.0 - self.low) * self.n_rings as f64).max(0.0) as usize;
        let sector = (direction.y.atan2(direction.x).rem_euclid(TAU) / TAU * self.n_sectors as f64) as usize;
        ring.min(self.n_rings - 1) * self.n_sectors + sector.min(self.n_sectors - 1)
    }

    /// ∫ f dω over each cell, by a product rule of n_nodes² nodes; where one of half as many nodes along each side says otherwise, of the
    /// cell's quarters.
    pub fn integrate(&self, n_nodes: usize, f: impl Fn(Vec3) -> f64) -> Vec<f64> {
        let rules = [gauss(n_nodes / 2), gauss(n_nodes)];
        let sector = TAU / self.n_sectors as f64;
        let cell = |k: usize| {
            let (low, high) = self.ring(k / self.n_sectors);
            let start = (k % self.n_sectors) as f64 * sector;
            over_box(&rules, [low, high], [start, start + sector], N_QUARTERINGS, &f)
        };
        (0..self.n()).map(cell).collect()
    }
}

/// Cells are cut this often at most.
const N_QUARTERINGS: usize = 4;
/// Two rules that differ by less agree on a probability.
const AGREEMENT: f64 = 1e-10;

fn over_box(
    rules: &[Vec<(f64, f64)>; 2],
    z: [f64; 2],
    azimuth: [f64; 2],
    n_left: usize,
    f: &impl Fn(Vec3) -> f64,
) -> f64 {
    let (height, width) = (z[1] - z[0], azimuth[1] - azimuth[0]);
    let [coarse, fine] = [0, 1].map(|k| {
        let mut sum = 0.0;
        for (u, weight_u) in &rules[k] {
            let z = z[0] + height * u;
            let radius = ((1.0 - z) * (1.0 + z)).sqrt();
            for (v, weight_v) in &rules[k] {
                let (sin, cos) = (azimuth[0] + width * v).sin_cos();
                sum += weight_u * weight_v * f(Vec3::new(radius * cos, radius * sin, z));
            }
        }
        sum * height * width
    });
    if n_left == 0 || (fine - coarse).abs() < AGREEMENT {
        return fine;
    }
    let ([a, c], [d, g]) = (z, azimuth);
    let (b, e) = (0.5 * (a + c), 0.5 * (d + g));
    let quarters = [([a, b], [d, e]), ([a, b], [e, g]), ([b, c], [d, e]), ([b, c], [e, g])];
    quarters.into_iter().map(|(z, azimuth)| over_box(rules, z, azimuth, n_left - 1, f)).sum()
}

/// Draws `n_samples` directions and tests their counts against the density; `None` has a cell of its own.
pub fn test_sampler(
    cells: Cells,
    purpose: &str,
    n_samples: u64,
    sample: impl Fn([f64; 2]) -> Option<Vec3>,
    pdf: impl Fn(Vec3) -> f64,
) -> ChiSquared {
    let mut probabilities = cells.integrate(12, pdf);
    probabilities.push((1.0 - probabilities.iter().sum::<f64>()).max(0.0));
    let mut counts = vec![0; probabilities.len()];
    let streams = Streams::new(0x5eed_1e57, purpose);
    for k in 0..n_samples {
        let cell = sample(streams.stream(0, k).uniform2()).map_or(cells.n(), |direction| cells.find(direction));
        counts[cell] += 1;
    }
    let expected: Vec<f64> = probabilities.iter().map(|p| p * n_samples as f64).collect();
    chi_squared_test(&counts, &expected).expect("the cells cover all outcomes")
}
