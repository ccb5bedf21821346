//! Integration over quadrilaterals of a plane, the worst refined first, until the sum is good enough.

use super::integrand::{Integrand, Nature};
use super::kinks::Kink;
use crate::assembly::exchange::pair::{Rule, gauss_legendre};
use crate::geometry::Vec3;
use std::ops::Range;
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

/// What takes the place of doubt where the kinks are known.
const ACROSS: f64 = 4.0;

/// Along an axis on which the error falls faster than this with every point, cells are not cut.
const EASY: f64 = 0.15;

/// So far away from an apex, as a share of the way, it shows where kinks leave it.
const AWAY: f64 = 1e-6;

/// Share of the largest difference of values that a rule of one point may be off by about a singularity.
const UNTOLD: f64 = 0.1;

/// Points a pair may cost, some tenths of a second, and more for each of its cells. A few pairs among many facets need most of them.
const MOST_POINTS: usize = 1_000_000;
const POINTS_A_CELL: usize = 200;

/// A bilinear quadrilateral (two corners may coincide) and what is known about the integral over it.
#[derive(Clone, Debug)]
pub struct Cell {
    corners: [Vec3; 4],
    /// Which integrand.
    term: usize,
    nature: Nature,
    rung: usize,
    value: f64,
    /// By how much the error falls from a rule of n to one of n + 1 points an axis.
    decay: f64,
    /// Error of the last rule, were the constants one, and of the one before it.
    envelope: f64,
    before: f64,
    /// So many points an axis it had less.
    steps: i32,
    change: f64,
    error: f64,
}

impl Cell {
    /// A cell not yet looked at.
    pub fn new(corners: [Vec3; 4], term: usize) -> Self {
        let nature = Nature::Rough;
        Self {
            corners,
            term,
            nature,
            rung: 0,
            value: 0.0,
            decay: SLOWEST,
            envelope: 0.0,
            before: 0.0,
            steps: 0,
            change: 0.0,
            error: 0.0,
        }
    }

    /// The first two rules; a third where kinks can hide from them.
    fn begin(&mut self, integrand: &mut Integrand) {
        self.nature = integrand.nature(self.term, &self.corners);
        match self.nature {
            Nature::Smooth { decays: [one, other] } => self.decay = one.max(other).min(SLOWEST),
            Nature::Kinked(_) => self.lie_across(integrand),
            _ => {}
        }
        (self.value, _) = self.apply(0, integrand);
        self.climb(integrand);
        if !matches!(self.nature, Nature::Smooth { .. }) {
            self.climb(integrand);
        }
        if self.nature == Nature::Rough {
            self.error = self.error.max(self.overshoot(integrand));
        }
    }

    /// Turns the cell by a right angle where its kinks run along its lines rather than across.
    fn lie_across(&mut self, integrand: &Integrand) {
        let Nature::Kinked(kinks) = &self.nature else { return };
        let [a, b, c, d] = self.corners;
        let across = |from: Vec3, to: Vec3| {
            let change =
                |kink: &Kink| (kink.twist(to) - kink.twist(from)).abs() / (kink.twist(to) + kink.twist(from)).abs();
            integrand.kinks[kinks.clone()].iter().map(change).sum::<f64>()
        };
        let (ab, bc, cd, da) = (0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + d), 0.5 * (d + a));
        if across(ab, cd) > across(da, bc) {
            self.corners = [b, c, d, a];
        }
    }

    /// The next rule.
    fn climb(&mut self, integrand: &mut Integrand) {
        let rung = self.rung + 1;
        let (value, spread) = self.apply(rung, integrand);
        let change = (value - self.value).abs();
        let steps = (LADDER[rung] - LADDER[self.rung]) as i32;
        // One point is off by the second differences, which may cancel in the sum: the first ones do not.
        if rung == 1 {
            self.envelope = spread * self.decay.sqrt();
        }
        // Where the rate that was seen is slower than the one expected, it is the better judge.
        let before = change.max(self.envelope);
        let seen = if rung == 1 { 0.0 } else { (change / self.before).powf(1.0 / f64::from(self.steps)) };
        let decay = self.decay.max(FIRST[rung.min(FIRST.len() - 1)]).max(seen.min(SLOWEST));
        self.envelope = before * decay.powi(steps);
        (self.before, self.steps) = (before, steps);
        self.error = match self.nature {
            _ if self.decay < SLOWEST => CAUTION * self.envelope,
            Nature::Kinked(_) => ACROSS * change.max(0.5 * self.change),
            _ => DOUBT * change.max(0.5 * self.change),
        };
        if self.decay == SLOWEST && matches!(self.nature, Nature::Smooth { .. }) {
            // Parts of a singularity look like the whole: where rules agree by luck on one of them they do on all.
            self.error = self.error.max(UNTOLD * spread / (LADDER[rung] * LADDER[rung]) as f64);
        }
        self.change = if rung == 1 { change.max(0.4 * spread) } else { change };
        (self.rung, self.value) = (rung, value);
    }

    /// How far the corners lie off the parabola through the values of the three-point rule, times the area: shows kinks that lie beyond
    /// all its nodes.
    fn overshoot(&self, integrand: &mut Integrand) -> f64 {
        let [a, b, c, d] = self.corners;
        let rule = &RULES[2];
        let point = |s: f64, t: f64| (1.0 - s) * (1.0 - t) * a + s * (1.0 - t) * b + s * t * c + (1.0 - s) * t * d;
        let mut values = [[0.0; 3]; 3];
        for (row, t) in values.iter_mut().zip(&rule.nodes) {
            for (value, s) in row.iter_mut().zip(&rule.nodes) {
                *value = integrand.at(self.term, point(*s, *t));
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
            worst = worst.max((integrand.at(self.term, point(s, t)) - expected).abs());
        }
        let area = 0.5 * (c - a).cross(d - b).dot(integrand.normal).abs();
        0.1 * worst * area
    }

    /// True where smaller cells promise more than longer rules.
    fn wants_parts(&self) -> bool {
        match self.nature {
            Nature::Rough => true,
            Nature::Kinked(_) => self.rung >= 4,
            Nature::Smooth { .. } => self.rung + 1 == LADDER.len() || (self.decay > 0.3 && self.rung >= 3),
        }
    }

    /// The integral by one rule, and the difference of the largest and the smallest value times the area.
    fn apply(&self, rung: usize, integrand: &mut Integrand) -> (f64, f64) {
        let (kinks, rule) = (self.kinks(), &RULES[rung]);
        let [a, b, c, d] = self.corners;
        let (mut sum, mut area) = (0.0, 0.0);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        // Kinks leave or enter the lines across at the ends of panels.
        let near = if a == d { [a + AWAY * (b - a), a + AWAY * (c - a)] } else { [a, d] };
        let panels = Panels::between(integrand, &kinks, &[near, [b, c]]);
        for (t, wt) in panels.points(rule) {
            let (start, end) = (a + t * (d - a), b + t * (c - b));
            let slope = (1.0 - t) * (b - a) + t * (c - d);
            for (s, ws) in Panels::between(integrand, &kinks, &[[start, end]]).points(rule) {
                let across = (1.0 - s) * (d - a) + s * (c - b);
                let weight = ws * wt * slope.cross(across).dot(integrand.normal);
                let value = integrand.at(self.term, start + s * (end - start));
                (low, high) = (low.min(value), high.max(value));
                sum += weight * value;
                area += weight;
            }
        }
        (sum, area * (high - low))
    }

    fn kinks(&self) -> Range<usize> {
        match &self.nature {
            Nature::Kinked(kinks) => kinks.clone(),
            _ => 0..0,
        }
    }

    /// What to go on with instead: quarters, or halves where singularities are across one axis alone.
    fn parts(&self) -> impl Iterator<Item = [Vec3; 4]> {
        let [a, b, c, d] = self.corners;
        let (ab, bc, cd, da) = (0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + d), 0.5 * (d + a));
        let middle = 0.5 * (ab + cd);
        let parts = match self.nature {
            Nature::Smooth { decays: [one, other] } if other < EASY.min(one) => vec![[a, ab, cd, d], [ab, b, c, cd]],
            Nature::Smooth { decays: [one, other] } if one < EASY.min(other) => vec![[a, b, bc, da], [da, bc, c, d]],
            _ => vec![[a, ab, middle, da], [ab, b, bc, middle], [middle, bc, c, cd], [da, middle, cd, d]],
        };
        parts.into_iter()
    }
}

/// The interval [0, 1] parted where kinks cross a line.
struct Panels {
    ends: [f64; MOST_PANELS + 1],
    n: usize,
}

/// Kinks that would part it into more are left to refinement.
const MOST_PANELS: usize = 12;

impl Panels {
    /// Parts it where any of these kinks crosses one of these lines.
    fn between(integrand: &Integrand, kinks: &Range<usize>, lines: &[[Vec3; 2]]) -> Self {
        let mut panels = Self { ends: [0.0; MOST_PANELS + 1], n: 1 };
        panels.ends[1] = 1.0;
        for kink in &integrand.kinks[kinks.clone()] {
            for share in lines.iter().flat_map(|[from, to]| kink.crossings(*from, *to)) {
                if panels.n < MOST_PANELS {
                    panels.n += 1;
                    panels.ends[panels.n] = share;
                }
            }
        }
        panels.ends[..=panels.n].sort_unstable_by(f64::total_cmp);
        panels
    }

    /// The points of a rule on every panel, with their weights.
    fn points(&self, rule: &Rule) -> impl Iterator<Item = (f64, f64)> {
        self.ends[..=self.n].windows(2).flat_map(move |ends| {
            let width = ends[1] - ends[0];
            rule.nodes.iter().zip(&rule.weights).map(move |(x, w)| (ends[0] + width * x, width * w))
        })
    }
}

/// What integration found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sum {
    pub value: f64,
    pub error: f64,
}

/// Σ over the cells, counter-clockwise about the integrand's normal, and its error estimate.
pub fn integrate(cells: &mut Vec<Cell>, tolerance: f64, integrand: &mut Integrand) -> Sum {
    let most_points = MOST_POINTS + POINTS_A_CELL * cells.len();
    for cell in cells.iter_mut() {
        cell.begin(integrand);
    }
    let mut best = Sum { value: 0.0, error: f64::INFINITY };
    loop {
        let error: f64 = cells.iter().map(|cell| cell.error).sum();
        let worst = cells.iter().map(|cell| cell.error).fold(0.0, f64::max);
        // New cells know less than what they replace: where points run out, go back to the best sum there was.
        if error < best.error {
            best = Sum { value: cells.iter().map(|cell| cell.value).sum(), error };
        }
        if error <= tolerance || integrand.n_points > most_points {
            return best;
        }
        // Refine the worst, and where cells are many all that are nearly as bad.
        let bar = if cells.len() > 16 { 0.25 * worst } else { worst };
        for k in (0..cells.len()).rev() {
            if cells[k].error < bar {
                continue;
            }
            if cells[k].wants_parts() {
                let cell = cells.swap_remove(k);
                for corners in cell.parts() {
                    let mut part = Cell::new(corners, cell.term);
                    part.begin(integrand);
                    cells.push(part);
                }
            } else {
                cells[k].climb(integrand);
            }
        }
    }
}
