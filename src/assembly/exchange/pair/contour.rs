//! Exchange of two unoccluded polygons as a double contour integral, for pairs that are close or touch.
//!
//! ```text
//! T = ∫∫ cosθ cosθ' / r² dA dA' = ½ ∮∮ ln r  dx·dx'
//! ```
//!
//! Of the inner integral along an edge with the unit tangent u, from q to q' = q + m u and seen from x = p + s t,
//!
//! ```text
//! ∫ ln r = s₁ ln r₁ − s₀ ln r₀ − m + h φ,   s₀ = (q − x)·u,   s₁ = s₀ + m,   h the distance of x from the line, φ the angle seen,
//! ```
//!
//! both logarithms are integrated along the outer edge in closed form, for s₀ is linear in s and r₀² quadratic; −m adds up to
//! nothing around the contour. What is left, h φ, is analytic but where the lines or their ends come near each other in the
//! complex plane, and analytic *up to* an end at which the edges touch. Gauss' rule takes it, with as many nodes as the
//! Bernstein ellipse through the nearest of those points asks for, on panels graded towards it. Nothing is shifted apart.
//!
//! Source: Sparrow (1963), "A new and simpler formulation for radiative angle factors", eq. 9; the error of Gauss' rule:
//! Trefethen, "Approximation Theory and Approximation Practice", theorem 19.3. Cost: 2 to 20 µs in f64, ten times that in
//! double-double. What it does not do: the sum cancels, so that only an absolute accuracy is its own; its `size` tells.

use super::real::{Real, Vector};
use pulp::{Arch, Simd, WithSimd};

/// An integral and what is known of its error.
#[derive(Clone, Copy, Debug)]
pub struct Integral<R> {
    pub value: R,
    /// A bound of what the quadrature leaves out.
    pub truncation: f64,
    /// Sum of the magnitudes of the terms that cancel in the value.
    pub size: f64,
}

/// T of two convex polygons, each wholly in front of the other's plane, in units of their coordinates squared; these should be
/// of order one. The truncation is kept below some `tolerance`, absolute.
pub fn exchange<R: Real>(arch: Arch, a: &[Vector<R>], b: &[Vector<R>], tolerance: f64) -> Integral<R> {
    let (outer, inner) = (edges_of(a), edges_of(b));
    let share = tolerance / (outer.len() * inner.len()) as f64;
    let mut total = Total { arch, sum: R::from(0.0), truncation: 0.0, size: 0.0, share };
    for e in &outer {
        let ends: Vec<End<R>> = b.iter().map(|q| End::new(e, *q)).collect();
        for f in &inner {
            total.add(e, f, [&ends[f.from], &ends[f.to]]);
        }
    }
    let half = |x: f64| 0.5 * x;
    Integral { value: R::from(0.5) * total.sum, truncation: half(total.truncation), size: half(total.size) }
}

/// A directed edge of a contour.
struct Edge<R> {
    /// Numbers of its corners.
    from: usize,
    to: usize,
    start: Vector<R>,
    end: Vector<R>,
    tangent: Vector<R>,
    length: R,
}

fn edges_of<R: Real>(p: &[Vector<R>]) -> Vec<Edge<R>> {
    let edge = |from: usize| {
        let to = (from + 1) % p.len();
        let along = p[to] - p[from];
        let length = along.length();
        (length.value() > 0.0).then(|| {
            let tangent = along.scaled(R::from(1.0) / length);
            Edge { from, to, start: p[from], end: p[to], tangent, length }
        })
    };
    (0..p.len()).filter_map(edge).collect()
}

/// A corner q of the inner contour as the outer edge sees it.
struct End<R> {
    /// q from the edge's start, and its part across the edge.
    offset: Vector<R>,
    across: Vector<R>,
    /// Parameter of the foot of q on the edge, and the distance from there.
    foot: R,
    distance: R,
    /// [σ ln r²] and [r² ln r²] between the edge's ends, σ = s − foot.
    sigma_log: R,
    square_log: R,
    /// distance × the angle that the edge subtends at q.
    arc: R,
    /// Sizes of the three above before differences were taken.
    sizes: [f64; 3],
}

impl<R: Real> End<R> {
    fn new(edge: &Edge<R>, q: Vector<R>) -> Self {
        let offset = q - edge.start;
        let foot = offset.dot(edge.tangent);
        let across = offset - edge.tangent.scaled(foot);
        let distance = offset.cross(edge.tangent).length();
        let beyond = q - edge.end;
        let squares = [offset.dot(offset), beyond.dot(beyond)];
        let sigmas = [-foot, edge.length - foot];
        let (sigma_log, square_log, sizes) = differences(squares, sigmas, edge.length);
        let angle = (distance * edge.length).angle(distance * distance + sigmas[0] * sigmas[1]);
        let arc = distance * angle;
        Self { offset, across, foot, distance, sigma_log, square_log, arc, sizes: [sizes[0], sizes[1], arc.value()] }
    }
}

/// σ ln r² and r² ln r² at the end of an edge less at its start, and the sizes of their terms.
fn differences<R: Real>(squares: [R; 2], sigmas: [R; 2], length: R) -> (R, R, [f64; 2]) {
    let size = |p: R, q: R| p.value().abs() + q.value().abs();
    let [start, end] = squares;
    if start.value() < 2.0 * end.value() && end.value() < 2.0 * start.value() {
        // Short as seen from q: the difference of logarithms first, so that terms are no larger than the edge.
        let difference = length * (sigmas[0] + sigmas[1]);
        let (log, change) = (end.ln(), (difference / start).ln_1p());
        let (sigma_terms, square_terms) = ([length * log, sigmas[0] * change], [difference * log, start * change]);
        let sizes = [size(sigma_terms[0], sigma_terms[1]), size(square_terms[0], square_terms[1])];
        return (sigma_terms[0] + sigma_terms[1], square_terms[0] + square_terms[1], sizes);
    }
    let logs = squares.map(|square| if square.value() > 0.0 { square.ln() } else { R::from(0.0) });
    let [[sigma_start, sigma_end], [square_start, square_end]] =
        [sigmas, squares].map(|factors| [factors[0] * logs[0], factors[1] * logs[1]]);
    let sizes = [size(sigma_start, sigma_end), size(square_start, square_end)];
    (sigma_end - sigma_start, square_end - square_start, sizes)
}

/// Where h φ is not analytic: a foot on the outer edge's line, and how far beside it in the complex plane.
type Singularity = (f64, f64);

struct Total<R> {
    arch: Arch,
    sum: R,
    truncation: f64,
    size: f64,
    /// Truncation allowed to a pair of edges.
    share: f64,
}

impl<R: Real> Total<R> {
    /// Adds the integral over a pair of edges.
    fn add(&mut self, e: &Edge<R>, f: &Edge<R>, ends: [&End<R>; 2]) {
        let cosine = e.tangent.dot(f.tangent);
        let w = cosine.value().abs();
        if w == 0.0 {
            return;
        }

        // The logarithms at both ends, ∫ s₀ ln r₀ ds, in closed form.
        let half = R::from(0.5);
        let (mut sum, mut size) = (half * e.length * f.length * cosine * cosine, 0.0);
        for (end, sign) in [(ends[0], -1.0), (ends[1], 1.0)] {
            let alpha = end.across.dot(f.tangent);
            let term = alpha * (half * end.sigma_log + end.arc) - R::from(0.25) * cosine * end.square_log;
            sum = sum + R::from(sign) * term;
            let [sigma_log, square_log, arc] = end.sizes;
            size += alpha.value().abs() * (0.5 * sigma_log + arc) + 0.25 * w * square_log;
        }

        // What is left by quadrature.
        let swept = Swept::new(self.arch, e, f, ends);
        let least = 1e-3 * R::EPSILON * e.length.value();
        let arcs = swept.integrate((self.share / w).max(least));
        self.sum = self.sum + cosine * (sum + arcs.value);
        self.truncation += w * arcs.truncation;
        self.size += w * (size + arcs.size + sum.value().abs());
    }
}

/// h φ along the outer edge.
struct Swept<R> {
    arch: Arch,
    /// The vector from the inner line to x is turn₀ − s turn₁ but for a right angle; its length is h.
    turns: [Vector<R>; 2],
    /// s₀ = along − s cosine.
    along: R,
    cosine: R,
    inner_length: R,
    outer_length: R,
    /// Sine of the angle between the lines.
    sine: f64,
    singularities: [Option<Singularity>; 3],
    /// Where the edges touch inside the outer one.
    cuts: [Option<f64>; 3],
}

impl<R: Real> Swept<R> {
    fn new(arch: Arch, e: &Edge<R>, f: &Edge<R>, ends: [&End<R>; 2]) -> Self {
        let turns = [f.tangent.cross(ends[0].offset), f.tangent.cross(e.tangent)];
        let along = ends[0].offset.dot(f.tangent);
        let cosine = e.tangent.dot(f.tangent);
        let mut swept = Self {
            arch,
            turns,
            along,
            cosine,
            inner_length: f.length,
            outer_length: e.length,
            sine: turns[1].length().value(),
            singularities: [None; 3],
            cuts: [None; 3],
        };

        // The ends of the inner edge, and the crossing of the lines if the inner edge is there.
        let touching = 16.0 * R::EPSILON;
        let mut note = |k: usize, s: f64, beside: f64| {
            if beside > touching {
                swept.singularities[k] = Some((s, beside));
            } else {
                swept.cuts[k] = Some(s);
            }
        };
        for (k, end) in ends.iter().enumerate() {
            note(k, end.foot.value(), end.distance.value());
        }
        let sine_squared = turns[1].dot(turns[1]);
        if sine_squared.value() > R::EPSILON {
            let s = turns[0].dot(turns[1]) / sine_squared;
            let from = (along - s * cosine).value();
            if from < 0.0 && from + f.length.value() > 0.0 {
                let h = (turns[0] - turns[1].scaled(s)).length().value();
                note(2, s.value(), h / sine_squared.value().sqrt());
            }
        }
        swept
    }

    /// h at s.
    #[inline(always)]
    fn height(&self, s: R) -> R {
        (self.turns[0] - self.turns[1].scaled(s)).length()
    }

    /// h φ at s.
    #[inline(always)]
    fn at(&self, s: R) -> R {
        let h = self.height(s);
        let from = self.along - s * self.cosine;
        h * (h * self.inner_length).angle(h * h + from * (from + self.inner_length))
    }

    /// ∫ h φ ds, cut where the edges touch.
    fn integrate(&self, tolerance: f64) -> Integral<R> {
        let length = self.outer_length.value();
        let mut cuts = [0.0, 1.0, 1.0, 1.0, 1.0];
        for (slot, cut) in cuts[1..4].iter_mut().zip(self.cuts) {
            *slot = cut.map_or(1.0, |s| (s / length).clamp(0.0, 1.0));
        }
        cuts[1..4].sort_by(f64::total_cmp);
        let mut total = Integral { value: R::from(0.0), truncation: 0.0, size: 0.0 };
        for pair in cuts.windows(2) {
            self.panel([pair[0], pair[1]], tolerance / length, &mut total);
        }
        total.value = self.outer_length * total.value;
        total.truncation *= length;
        total.size *= length;
        total
    }

    /// Adds the mean of h φ over a panel, in shares of the edge, by Gauss' rule or those of its parts.
    fn panel(&self, [from, to]: [f64; 2], tolerance: f64, total: &mut Integral<R>) {
        let share = to - from;
        if share <= 0.0 {
            return;
        }
        // Bound h φ on the panel, with room for the ellipse.
        let length = self.outer_length.value();
        let [h_from, h_to] = [from, to].map(|s| self.height(R::from(s) * self.outer_length).value());
        let bound = 16.0 * (h_from.max(h_to) + share * length * self.sine) * share;
        if bound == 0.0 {
            return;
        }

        // Choose the rule that leaves less than the tolerance.
        let (rho, nearest) = self.nearest_ellipse(from * length, to * length);
        let n = match () {
            () if bound <= tolerance => 1.0,
            () if rho <= 1.0 => f64::INFINITY,
            () => ((bound / tolerance).ln() / (2.0 * rho.ln())).ceil().max(2.0),
        };
        if n > R::MOST_NODES as f64 {
            // Cut at the foot of the nearest singularity, or grade towards it.
            let inside = (nearest / length - from) / share;
            let cut = match inside {
                _ if inside > 1e-3 && inside < 1.0 - 1e-3 => from + inside * share,
                _ if inside < 0.5 => from + 0.25 * share,
                _ => to - 0.25 * share,
            };
            self.panel([from, cut], tolerance, total);
            self.panel([cut, to], tolerance, total);
            return;
        }
        let mean = self.arch.dispatch(Panel { swept: self, from, to, rule: R::gauss(n as usize) });
        total.value = total.value + (R::from(to) - R::from(from)) * mean;
        total.size += share * mean.value();
        total.truncation += bound * rho.max(1.0).powi(-2 * n as i32);
    }

    /// The sum of the half axes of the largest Bernstein ellipse about a panel that no singularity is in, less a margin, and
    /// the foot of the nearest singularity.
    fn nearest_ellipse(&self, from: f64, to: f64) -> (f64, f64) {
        let half = 0.5 * (to - from);
        let (mut rho, mut nearest) = (f64::INFINITY, 0.5 * (from + to));
        for (s, beside) in self.singularities.iter().flatten() {
            // The ellipse through z has half axes that add to the one root, larger than 1, of this sum of distances to the
            // foci.
            let [x, y] = [(s - 0.5 * (from + to)) / half, beside / half];
            let sum = 0.5 * (((x + 1.0).powi(2) + y * y).sqrt() + ((x - 1.0).powi(2) + y * y).sqrt());
            let through = sum + (sum * sum - 1.0).max(0.0).sqrt();
            if through < rho {
                (rho, nearest) = (through, *s);
            }
        }
        (0.95 * rho.min(40.0), nearest)
    }
}

/// Nodes side by side.
pub const ABREAST: usize = 4;

/// A panel of the outer edge, in shares of it, and the rule that takes it.
struct Panel<'a, R: Real> {
    swept: &'a Swept<R>,
    from: f64,
    to: f64,
    rule: &'static [(R, R)],
}

impl<R: Real> WithSimd for Panel<'_, R> {
    type Output = R;

    /// The mean of h φ over the panel.
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> R {
        let (start, width) = (R::from(self.from), R::from(self.to) - R::from(self.from));
        let mut sums = [R::from(0.0); ABREAST];
        for nodes in self.rule.chunks_exact(ABREAST) {
            for (sum, (node, weight)) in sums.iter_mut().zip(nodes) {
                *sum = *sum + *weight * self.swept.at((start + *node * width) * self.swept.outer_length);
            }
        }
        let [a, b, c, d] = sums;
        (a + b) + (c + d)
    }
}
