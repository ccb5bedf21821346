//! Integration over quadrilaterals of a plane, the worst refined first, until the sum is good enough.

use super::super::rules::{Rule, gauss_legendre};
use crate::geometry::Vec3;
use std::sync::LazyLock;

/// Gauss points an axis, tried in turn.
const LADDER: [usize; 8] = [1, 2, 3, 4, 6, 8, 12, 16];

static RULES: LazyLock<[Rule; LADDER.len()]> = LazyLock::new(|| LADDER.map(gauss_legendre));

/// Of a function that is smooth on a cell, differences of successive rules fall geometrically. What is left after the last is at
/// most this many times what that predicts.
const CAUTION: f64 = 4.0;

/// Points a pair may cost.
const MOST_POINTS: usize = 2_000_000;

/// A bilinear quadrilateral (two corners may coincide) and what is known about the integral over it.
#[derive(Clone, Copy, Debug)]
pub struct Cell {
    corners: [Vec3; 4],
    /// Which integrand.
    pub term: usize,
    /// Whether the integrand is known to be smooth on it.
    pub is_smooth: bool,
    rung: usize,
    value: f64,
    change: f64,
    /// Of this change to the one before.
    ratio: f64,
    error: f64,
}

impl Cell {
    fn new(corners: [Vec3; 4], term: usize, is_smooth: bool) -> Self {
        Self { corners, term, is_smooth, rung: 0, value: 0.0, change: 0.0, ratio: 1.0, error: 0.0 }
    }

    /// Covers a convex polygon.
    pub fn cover(polygon: &[Vec3], term: usize, is_smooth: bool, into: &mut Vec<Self>) {
        let mut k = 1;
        while k + 1 < polygon.len() {
            let last = polygon.get(k + 2).copied().unwrap_or(polygon[0]);
            into.push(Self::new([polygon[0], polygon[k], polygon[k + 1], last], term, is_smooth));
            k += 2;
        }
    }

    /// The first two rules; a third where kinks can hide from them.
    fn begin(&mut self, normal: Vec3, n_points: &mut usize, integrand: &mut impl FnMut(usize, Vec3) -> f64) {
        let term = self.term;
        self.value = self.apply(normal, 0, |x| integrand(term, x));
        *n_points += 1;
        self.climb(normal, n_points, integrand);
        if !self.is_smooth {
            self.climb(normal, n_points, integrand);
        }
    }

    /// The next rule.
    fn climb(&mut self, normal: Vec3, n_points: &mut usize, integrand: &mut impl FnMut(usize, Vec3) -> f64) {
        let term = self.term;
        let rung = self.rung + 1;
        let value = self.apply(normal, rung, |x| integrand(term, x));
        let change = (value - self.value).abs();
        let is_settling = self.is_smooth && rung > 1 && change < self.change;
        self.ratio = if self.change > 0.0 { change / self.change } else { 0.0 };
        self.error = if is_settling { change * (CAUTION * self.ratio).min(1.0) } else { change };
        (self.rung, self.value, self.change) = (rung, value, change);
        *n_points += LADDER[rung] * LADDER[rung];
    }

    /// True where smaller cells promise more than longer rules.
    fn wants_quarters(&self) -> bool {
        if self.is_smooth {
            self.rung + 1 == LADDER.len() || (self.rung >= 4 && self.ratio > 0.2)
        } else {
            self.rung >= 3
        }
    }

    fn apply(&self, normal: Vec3, rung: usize, mut integrand: impl FnMut(Vec3) -> f64) -> f64 {
        let [a, b, c, d] = self.corners;
        let rule = &RULES[rung];
        let mut sum = 0.0;
        for (t, wt) in rule.nodes.iter().zip(&rule.weights) {
            let (low, high) = (a + *t * (d - a), b + *t * (c - b));
            let slope = (1.0 - t) * (b - a) + *t * (c - d);
            for (s, ws) in rule.nodes.iter().zip(&rule.weights) {
                let across = (1.0 - s) * (d - a) + *s * (c - b);
                let weight = ws * wt * slope.cross(across).dot(normal);
                sum += weight * integrand(low + *s * (high - low));
            }
        }
        sum
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
        for k in (0..cells.len()).rev().filter(|k| cells[*k].error >= bar).collect::<Vec<_>>() {
            if cells[k].wants_quarters() {
                let cell = cells.swap_remove(k);
                for corners in cell.quarters() {
                    let mut part = Cell::new(corners, cell.term, cell.is_smooth);
                    part.begin(normal, &mut n_points, &mut integrand);
                    cells.push(part);
                }
            } else {
                cells[k].climb(normal, &mut n_points, &mut integrand);
            }
        }
    }
}
