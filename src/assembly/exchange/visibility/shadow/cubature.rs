//! Integration over quadrilaterals of a plane, the worst refined first, until the sum is good enough.

use crate::assembly::exchange::pair::{Rule, gauss_legendre};
use crate::geometry::Vec3;
use std::sync::LazyLock;

/// Gauss points an axis, tried in turn.
const LADDER: [usize; 8] = [1, 2, 3, 4, 6, 8, 12, 16];

static RULES: LazyLock<[Rule; LADDER.len()]> = LazyLock::new(|| LADDER.map(gauss_legendre));

/// What the estimate of a smooth cell is multiplied with: constants that the rate of convergence leaves open.
const CAUTION: f64 = 8.0;

/// What short rules gain by a point more at best, whatever comes later: by rung.
const FIRST: [f64; 4] = [1.0, 0.08, 0.03, 0.01];

/// Where the error falls no faster than this, cells that touch a singularity or hold kinks, the change from rule to rule is all there is to
/// go by, times the doubt.
const SLOWEST: f64 = 0.5;
const DOUBT: f64 = 16.0;

/// Share of the largest difference of values that a rule of one point may be off by about a singularity.
const UNTOLD: f64 = 0.1;

/// Points a pair may cost.
const MOST_POINTS: usize = 100_000;

/// What an integrand is like on a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Nature {
    /// Analytic, up to singularities at this distance from the centre in units of the cell's radius.
    Smooth { reach: f64 },
    /// Its second derivative may jump on some curve.
    Kinked,
}

/// A bilinear quadrilateral (two corners may coincide) and what is known about the integral over it.
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    corners: [Vec3; 4],
    /// Which integrand.
    pub term: usize,
    is_kinked: bool,
    /// Whether it holds a singularity, or may as well.
    is_singular: bool,
    rung: usize,
    value: f64,
    /// By how much the error falls from a rule of n to one of n + 1 points an axis.
    decay: f64,
    /// Error of the last rule, were the constants one.
    envelope: f64,
    change: f64,
    error: f64,
}

impl Cell {
    /// A cell of that nature.
    pub fn new(corners: [Vec3; 4], term: usize, nature: Nature) -> Self {
        let is_kinked = nature == Nature::Kinked;
        let (decay, is_singular) = match nature {
            // Gauss rules converge as ρ^(−2n), ρ the sum of the axes of the ellipse about ±1 that reaches the singularity.
            Nature::Smooth { reach } if reach > 1.0 => {
                ((reach - (reach * reach - 1.0).sqrt()).powi(2).min(SLOWEST), false)
            }
            _ => (SLOWEST, !is_kinked),
        };
        Self {
            corners,
            term,
            is_kinked,
            is_singular,
            rung: 0,
            value: 0.0,
            decay,
            envelope: 0.0,
            change: 0.0,
            error: 0.0,
        }
    }

    /// The first two rules; a third where kinks can hide from them.
    fn begin(&mut self, normal: Vec3, n_points: &mut usize, integrand: &mut impl FnMut(usize, Vec3) -> f64) {
        (self.value, _) = self.apply(normal, 0, integrand);
        *n_points += 1;
        self.climb(normal, n_points, integrand);
        if self.is_kinked {
            self.climb(normal, n_points, integrand);
            self.error = self.error.max(self.overshoot(normal, integrand));
            *n_points += 4;
        }
    }

    /// The next rule.
    fn climb(&mut self, normal: Vec3, n_points: &mut usize, integrand: &mut impl FnMut(usize, Vec3) -> f64) {
        let rung = self.rung + 1;
        let (value, spread) = self.apply(normal, rung, integrand);
        let change = (value - self.value).abs();
        let steps = (LADDER[rung] - LADDER[self.rung]) as i32;
        // One point is off by the second differences, which may cancel in the sum: the first ones do not.
        if rung == 1 {
            self.envelope = spread * self.decay.sqrt();
        }
        self.envelope = change.max(self.envelope) * self.decay.max(FIRST[rung.min(FIRST.len() - 1)]).powi(steps);
        if self.decay < SLOWEST {
            self.error = CAUTION * self.envelope;
        } else {
            self.error = DOUBT * change.max(0.5 * self.change);
        }
        if self.is_singular {
            // Parts of a singularity look like the whole: where rules agree by luck on one of them they do on all.
            self.error = self.error.max(UNTOLD * spread / (LADDER[rung] * LADDER[rung]) as f64);
        }
        self.change = if rung == 1 { change.max(0.4 * spread) } else { change };
        (self.rung, self.value) = (rung, value);
        *n_points += LADDER[rung] * LADDER[rung];
    }

    /// How far the corners lie off the parabola through the values of the three-point rule, times the area: shows kinks that lie beyond
    /// all its nodes.
    fn overshoot(&self, normal: Vec3, integrand: &mut impl FnMut(usize, Vec3) -> f64) -> f64 {
        let [a, b, c, d] = self.corners;
        let rule = &RULES[2];
        let point = |s: f64, t: f64| (1.0 - s) * (1.0 - t) * a + s * (1.0 - t) * b + s * t * c + (1.0 - s) * t * d;
        let mut values = [[0.0; 3]; 3];
        for (row, t) in values.iter_mut().zip(&rule.nodes) {
            for (value, s) in row.iter_mut().zip(&rule.nodes) {
                *value = integrand(self.term, point(*s, *t));
            }
        }
        // Lagrange's weights at either end of [0, 1].
        let [x, y, z] = [rule.nodes[0], rule.nodes[1], rule.nodes[2]];
        let weights = |s: f64| {
            [
                (s - y) * (s - z) / ((x - y) * (x - z)),
                (s - x) * (s - z) / ((y - x) * (y - z)),
                (s - x) * (s - y) / ((z - x) * (z - y)),
            ]
        };
        let mut worst: f64 = 0.0;
        for (s, t) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
            let (across, along) = (weights(t), weights(s));
            let expected: f64 = (0..3).map(|k| across[k] * (0..3).map(|l| along[l] * values[k][l]).sum::<f64>()).sum();
            worst = worst.max((integrand(self.term, point(s, t)) - expected).abs());
        }
        let area = 0.5 * (c - a).cross(d - b).dot(normal).abs();
        0.1 * worst * area
    }

    /// True where smaller cells promise more than longer rules.
    fn wants_quarters(&self) -> bool {
        self.is_kinked || self.rung + 1 == LADDER.len() || (self.decay > 0.3 && self.rung >= 3)
    }

    /// The integral by one rule, and the difference of the largest and the smallest value times the area.
    fn apply(&self, normal: Vec3, rung: usize, integrand: &mut impl FnMut(usize, Vec3) -> f64) -> (f64, f64) {
        let [a, b, c, d] = self.corners;
        let rule = &RULES[rung];
        let (mut sum, mut area) = (0.0, 0.0);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for (t, wt) in rule.nodes.iter().zip(&rule.weights) {
            let (start, end) = (a + *t * (d - a), b + *t * (c - b));
            let slope = (1.0 - t) * (b - a) + *t * (c - d);
            for (s, ws) in rule.nodes.iter().zip(&rule.weights) {
                let across = (1.0 - s) * (d - a) + *s * (c - b);
                let weight = ws * wt * slope.cross(across).dot(normal);
                let value = integrand(self.term, start + *s * (end - start));
                (low, high) = (low.min(value), high.max(value));
                sum += weight * value;
                area += weight;
            }
        }
        (sum, area * (high - low))
    }

    fn quarters(&self) -> [[Vec3; 4]; 4] {
        let [a, b, c, d] = self.corners;
        let (ab, bc, cd, da) = (0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + d), 0.5 * (d + a));
        let middle = 0.5 * (ab + cd);
        [[a, ab, middle, da], [ab, b, bc, middle], [middle, bc, c, cd], [da, middle, cd, d]]
    }
}

/// What integration found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sum {
    pub value: f64,
    pub error: f64,
    pub n_points: usize,
}

/// Σ over the cells, and its error estimate. Cells are counter-clockwise about `normal`.
///
/// `integrand(term, x)` is called with points inside the cells of that term.
pub fn integrate(
    cells: &mut Vec<Cell>,
    normal: Vec3,
    tolerance: f64,
    nature: &impl Fn(usize, &[Vec3; 4]) -> Nature,
    mut integrand: impl FnMut(usize, Vec3) -> f64,
) -> Sum {
    let mut n_points = 0;
    for cell in cells.iter_mut() {
        cell.begin(normal, &mut n_points, &mut integrand);
    }
    loop {
        let error: f64 = cells.iter().map(|cell| cell.error).sum();
        let worst = cells.iter().map(|cell| cell.error).fold(0.0, f64::max);
        if error <= tolerance || n_points > MOST_POINTS {
            return Sum { value: cells.iter().map(|cell| cell.value).sum(), error, n_points };
        }
        // Refine the worst, and where cells are many all that are nearly as bad.
        let bar = if cells.len() > 16 { 0.25 * worst } else { worst };
        for k in (0..cells.len()).rev() {
            if cells[k].error < bar {
                continue;
            }
            if cells[k].wants_quarters() {
                let cell = cells.swap_remove(k);
                for corners in cell.quarters() {
                    let mut part = Cell::new(corners, cell.term, nature(cell.term, &corners));
                    part.begin(normal, &mut n_points, &mut integrand);
                    cells.push(part);
                }
            } else {
                cells[k].climb(normal, &mut n_points, &mut integrand);
            }
        }
    }
}
