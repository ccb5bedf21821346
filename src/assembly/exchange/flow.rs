//! What passes between two patches, and between many.

use super::pair::{Ladder, Nodes, facing, unoccluded};
use super::visibility::{self, Desk, End, Obstacles, View, Visibility};
use super::{Exchange, ExchangeReport, Occlusion};
use crate::geometry::Polygon;
use crate::sampling::mix;

/// The exchange of one pair, or of some added up.
#[derive(Clone, Copy, Debug, Default)]
pub struct Flow {
    /// T, m² sr.
    pub value: f64,
    /// The quadrature's error estimates added up, m² sr.
    pub quadrature_error: f64,
    /// Those of what is blocked, m² sr.
    pub occlusion_error: f64,
    /// Variance of what rays sampled.
    pub variance: f64,
    pub tally: Tally,
}

/// How flows came about.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    pub n_pairs: usize,
    /// Of these: not settled by clusters.
    pub n_open: usize,
    pub n_clear: usize,
    pub n_hidden: usize,
    pub n_integrated: usize,
    /// Largest error estimate of the quadrature relative to the pair's T.
    pub quadrature_error: f64,
}

/// What pairs are computed with.
pub struct Means<'a> {
    pub ladder: &'a Ladder,
    pub obstacles: &'a Obstacles,
    pub settings: Exchange,
    /// Where the tolerance of occlusion is that of a whole row: the patches that share it.
    pub n_sharing: Option<usize>,
}

impl Means<'_> {
    /// What passes between two patches, each with its number and nodes; `None` where they do not face each other. `view` is what is known of
    /// what stands between, if anything.
    ///
    /// `desk` is room to work in, and leaves no trace in the result.
    pub fn flow(&self, desk: &mut Desk, pair: [(usize, End, &Nodes); 2], view: Option<&View>) -> Option<Flow> {
        let whole = self.whole(pair.map(|(_, end, nodes)| (end.polygon, nodes)), view)?;
        Some(self.let_through(desk, pair.map(|(k, end, _)| (k, end)), whole, view))
    }

    /// T of two patches with nothing between them, and its error, m² sr; `None` where they do not face each other.
    pub fn whole(&self, [a, b]: [(&Polygon, &Nodes); 2], view: Option<&View>) -> Option<(f64, f64)> {
        match view {
            Some(View::Clear { is_facing: true }) => facing(self.ladder, a, b, self.settings.tolerance),
            _ => unoccluded(self.ladder, a, b, self.settings.tolerance),
        }
    }

    /// What is let through of T between two patches by what stands between them.
    pub fn let_through(
        &self,
        desk: &mut Desk,
        [(i, a), (j, b)]: [(usize, End); 2],
        (whole, error): (f64, f64),
        view: Option<&View>,
    ) -> Flow {
        let is_open = !matches!(view, Some(View::Clear { .. }));
        let tally =
            Tally { n_pairs: 1, n_open: usize::from(is_open), quadrature_error: error / whole, ..Tally::default() };
        let mut flow = Flow { quadrature_error: error, tally, ..Flow::default() };
        let visible = match view {
            Some(View::Clear { .. }) => Visibility::Full,
            _ => {
                let candidates = view.and_then(View::candidates);
                let key = mix(&[self.settings.seed, 0, i as u64, j as u64]);
                visibility::between(self.obstacles, desk, candidates, [a, b], self.occlusion(a, b, whole), key)
            }
        };
        match visible {
            Visibility::Full => (flow.value, flow.tally.n_clear) = (whole, 1),
            Visibility::None => (flow.quadrature_error, flow.tally.n_hidden) = (0.0, 1),
            Visibility::Integrated { blocked, error } => {
                (flow.value, flow.occlusion_error) = ((whole - blocked).max(0.0), error);
                flow.tally.n_integrated = 1;
            }
            Visibility::Sampled { share, variance } => {
                (flow.value, flow.variance) = (share * whole, variance * whole * whole);
            }
        }
        flow
    }

    /// The pair's own tolerance of occlusion, relative to the smaller étendue.
    fn occlusion(&self, a: End, b: End, whole: f64) -> Occlusion {
        match (self.settings.occlusion, self.n_sharing) {
            (Occlusion::Exact { tolerance }, Some(n)) => {
                let share = whole / a.etendue.min(b.etendue);
                Occlusion::Exact { tolerance: tolerance * share.max(1.0 / n as f64).min(1.0) }
            }
            (occlusion, _) => occlusion,
        }
    }
}

impl Flow {
    /// What visibility leaves uncertain, m² sr: estimates added, standard errors in squares.
    pub fn error(&self) -> f64 {
        self.variance.sqrt() + self.occlusion_error
    }

    /// Adds so many alike.
    pub fn add(&mut self, other: &Flow, count: f64) {
        self.value += count * other.value;
        self.quadrature_error += count * other.quadrature_error;
        self.occlusion_error += count * other.occlusion_error;
        self.variance += count * count * other.variance;
        self.tally.add(other.tally);
    }

    /// So many of it.
    pub fn scale(&mut self, count: f64) {
        self.value *= count;
        self.quadrature_error *= count;
        self.occlusion_error *= count;
        self.variance *= count * count;
    }
}

impl Tally {
    pub fn add(&mut self, other: Self) {
        self.n_pairs += other.n_pairs;
        self.n_open += other.n_open;
        self.n_clear += other.n_clear;
        self.n_hidden += other.n_hidden;
        self.n_integrated += other.n_integrated;
        self.quadrature_error = self.quadrature_error.max(other.quadrature_error);
    }

    /// The report of these pairs alone.
    pub fn report(&self) -> ExchangeReport {
        ExchangeReport {
            n_pairs: self.n_pairs,
            n_clear: self.n_clear,
            n_hidden: self.n_hidden,
            n_integrated: self.n_integrated,
            n_sampled: self.n_pairs - self.n_clear - self.n_hidden - self.n_integrated,
            quadrature_error: self.quadrature_error,
            ..ExchangeReport::default()
        }
    }
}
