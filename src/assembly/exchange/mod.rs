//! Exchange: the étendue that flows between every two bundles, T = Tᵀ, and what flows into sinks.
//!
//! Every pair of patches is looked at once and deposited both ways. What a patch loses to the environment and to black backs is
//! computed on its own, so that closure, Σⱼ Tᵢⱼ + sinksᵢ = μᵢ, is a check and not a definition.

mod closure;
mod enclosure;
mod flow;
mod folded;
mod pair;
mod repair;
mod sinks;
mod visibility;

pub(super) use closure::row_totals;
pub use enclosure::{Enclosure, enclose};
pub(super) use folded::compute as folded;
pub use pair::{Ladder, Nodes, exchange_of_pair, point_factor, point_factors, point_to_disk, unoccluded};
pub(super) use repair::repair_by;
pub use repair::{Repair, RepairMethod};

use crate::basis::Bundles;
use crate::geometry::{Polygon, Tracer};
use crate::linalg::{Block, Matrix};
use crate::sampling::mix;
use crate::scene::Scene;
use flow::{Means, Tally};
use rayon::prelude::*;
use sinks::{Backs, Lost, Sink};
use std::sync::atomic::{AtomicUsize, Ordering};
use visibility::{Clusters, Desk, End, Obstacles};

/// How exchange is computed: accuracy is the caller's choice, and every number here enters the provenance of the result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exchange {
    /// Relative tolerance of unoccluded pairs.
    pub tolerance: f64,
    /// How partly visible pairs are computed.
    pub occlusion: Occlusion,
    /// Key of the random shifts.
    pub seed: u64,
    /// Whether closure is repaired by symmetric scaling.
    pub repair: bool,
}

impl Default for Exchange {
    /// What the command line computes where it is not told otherwise: everything by integrals, nothing by rays.
    fn default() -> Self {
        let occlusion = Occlusion::Exact { tolerance: 1e-7 };
        Self { tolerance: 1e-10, occlusion, seed: 0x00e7_e2d0_e000_0001, repair: true }
    }
}

/// How the exchange of a partly visible pair is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Occlusion {
    /// By rays: fast, with a standard error.
    Sampled {
        /// Rays a pair whose visibility geometry does not settle.
        rays: usize,
        /// Rays a patch that count what it loses to sinks.
        sink_rays: usize,
    },
    /// By the exact visible part from every point of an adaptive quadrature, to this absolute error of Tᵢⱼ / min(μᵢ, μⱼ).
    Exact { tolerance: f64 },
}

impl Occlusion {
    /// By so many rays a pair, and 4096 a patch for what it loses to sinks.
    pub fn by_rays(rays: usize) -> Self {
        Self::Sampled { rays, sink_rays: 4096 }
    }
}

/// How the entries of T came about.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExchangeReport {
    /// Pairs of patches that whole clusters settled at once: averted, hidden or clear.
    pub n_by_clusters: usize,
    /// How often something was looked for between two clusters, or two patches: the work that visibility takes before any integral
    /// or ray.
    pub n_shafts: usize,
    /// Pairs of patches that face each other.
    pub n_pairs: usize,
    /// Of these: proved clear, so right to the quadrature's error.
    pub n_clear: usize,
    /// Of these: proved hidden, one by one or as whole clusters.
    pub n_hidden: usize,
    /// Of these: what is blocked integrated.
    pub n_integrated: usize,
    /// Of these: visibility sampled by rays.
    pub n_sampled: usize,
    /// Largest quadrature error estimate relative to the pair's T.
    pub quadrature_error: f64,
    /// Root mean square over bundles of the standard error of their row sum, relative to μ.
    pub visibility_error: f64,
    /// max |Σⱼ Tᵢⱼ + sinksᵢ − μᵢ| / μᵢ before any repair.
    pub closure_before_repair: f64,
    /// `None` if no repair was asked for.
    pub repair: Option<Repair>,
}

/// T with its sinks, after repair.
pub(super) struct Assembled {
    pub exchange: Matrix,
    /// Absolute errors of T, see [`System::exchange_error`](super::System::exchange_error).
    pub error: Matrix,
    /// n × 2: étendue that escapes, étendue that ends on black backs.
    pub sinks: Block,
    /// The diagonal of D in D T D; empty without repair.
    pub repair_scale: Vec<f64>,
    pub report: ExchangeReport,
}

/// A bundle that exchanges far more étendue than it has, which only overlapping surfaces do.
pub(super) struct Overfull {
    pub bundle: usize,
    /// What it exchanges over what it has.
    pub fullness: f64,
}

/// One facing pair, as its row keeps it until the rows are joined.
struct Entry {
    column: u32,
    value: f64,
    variance: f64,
}

/// T and sinks of all patches. Cost O(n²) pairs; `progress` hears the finished share, from any thread.
pub(super) fn compute(
    scene: &Scene,
    bundles: &Bundles,
    settings: Exchange,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Assembled, Overfull> {
    // Name everything that light can end on: patches, and of sinks those that are computed like patches.
    let facets: Vec<&Polygon> = (0..scene.facets().len()).map(|facet| scene.polygon(facet)).collect();
    let backs = Backs::new(scene, &facets);
    let sinks = match settings.occlusion {
        Occlusion::Sampled { .. } => Vec::new(),
        Occlusion::Exact { .. } => sinks::of_scene(&backs, &facets),
    };
    let planes: Vec<&Polygon> = facets.iter().copied().chain(sinks.iter().filter_map(Sink::opening)).collect();
    let obstacles = Obstacles::new(&planes);
    let patches = (0..bundles.elements().len()).filter_map(|e| bundles.patch(e));
    let mut ends: Vec<End> = patches.map(|patch| End::new(&patch.polygon, patch.facet)).collect();
    let n = ends.len();
    ends.extend(sinks.iter().map(|sink| End::new(&sink.polygon, sink.plane)));
    let etendue = bundles.etendue();
    let ladder = Ladder::new();
    let nodes: Vec<Nodes> = ends.par_iter().map(|end| ladder.nodes(end.polygon)).collect();
    let clusters = Clusters::new(&ends, n, &planes, &obstacles.tracer);

    // Visit the upper triangle row by row; long rows first, so that threads finish together.
    let means = Means { ladder: &ladder, obstacles: &obstacles, settings, n_sharing: None };
    let parts = Parts { ends: &ends, n_sources: n, nodes: &nodes, clusters: &clusters, means: &means };
    let done = AtomicUsize::new(0);
    let rows: Vec<Row> = (0..n)
        .into_par_iter()
        .with_max_len(1)
        .map_init(Desk::default, |desk, i| {
            let row = parts.upper_row(desk, i);
            let finished = done.fetch_add(n - i, Ordering::Relaxed) + (n - i);
            progress(0.95 * finished as f64 / (0.5 * (n * (n + 1)) as f64));
            row
        })
        .collect();

    // Add up what every patch loses, or count it by rays.
    let lost: Vec<Lost> = match settings.occlusion {
        Occlusion::Exact { .. } => {
            rows.par_iter().enumerate().map(|(i, row)| sinks::lost_to(&sinks, &facets, ends[i], &row.lost)).collect()
        }
        Occlusion::Sampled { sink_rays, .. } => {
            let everything = Tracer::new(&facets);
            let key = |i| mix(&[settings.seed, 1, i as u64]);
            let rays = |i| sinks::lost_by_rays(&backs, &everything, ends[i], sink_rays, key(i));
            (0..n).into_par_iter().map(rays).collect()
        }
    };
    let mut sinks = Block::from_fn(n, 2, |i, sink| if sink == 0 { lost[i].escaped } else { lost[i].darkened });

    // Join the rows, each pair's variance counted at both of its ends.
    let mut total = Tally::default();
    let mut variance: Vec<f64> = lost.iter().map(|lost| lost.variance).collect();
    for (i, Row { entries, tally, .. }) in rows.iter().enumerate() {
        total.add(*tally);
        for entry in entries {
            variance[i] += entry.variance;
            variance[entry.column as usize] += entry.variance;
        }
    }
    let census = clusters.census;
    let mut report = ExchangeReport {
        n_by_clusters: census.n_averted + census.n_hidden + census.n_clear,
        n_shafts: census.n_shafts + total.n_open,
        n_pairs: total.n_pairs + census.n_hidden,
        n_hidden: total.n_hidden + census.n_hidden,
        ..total.report()
    };
    let relative: f64 = variance.iter().zip(etendue).map(|(v, mu)| v / (mu * mu)).sum();
    report.visibility_error = (relative / n.max(1) as f64).sqrt();
    let upper = |value: fn(&Entry) -> f64| -> Vec<Vec<(u32, f64)>> {
        let pick = |entry: &Entry| Some((entry.column, value(entry))).filter(|(_, value)| *value > 0.0);
        rows.iter().map(|row| row.entries.iter().filter_map(pick).collect()).collect()
    };
    let error = Matrix::symmetric(&upper(|entry| entry.variance.sqrt()));
    let upper = upper(|entry| entry.value);
    drop(rows);
    let mut exchange = Matrix::symmetric(&upper);
    drop(upper);

    report.closure_before_repair = closure::violation(&exchange, &sinks, etendue);
    if let Some((bundle, fullness)) = closure::overfull(&exchange, etendue, &variance) {
        return Err(Overfull { bundle, fullness });
    }
    let mut repair_scale = Vec::new();
    if settings.repair {
        let (repair, scale) = repair::repair(&mut exchange, &mut sinks, etendue);
        (report.repair, repair_scale) = (Some(repair), scale);
    }
    progress(1.0);
    Ok(Assembled { exchange, error, sinks, repair_scale, report })
}

/// So many times its error estimate what flows into a sink has to be to be taken for more than nothing.
const TRUST: f64 = 4.0;

/// One row of the upper triangle, and what its patch loses to sinks.
struct Row {
    entries: Vec<Entry>,
    /// By sink, `column` its number.
    lost: Vec<Entry>,
    tally: Tally,
}

/// What rows are computed from.
struct Parts<'a> {
    /// Patches, then sinks.
    ends: &'a [End<'a>],
    n_sources: usize,
    nodes: &'a [Nodes],
    clusters: &'a Clusters,
    means: &'a Means<'a>,
}

impl Parts<'_> {
    /// The pairs (i, j), j > i, that exchange anything.
    fn upper_row(&self, desk: &mut Desk, i: usize) -> Row {
        let mut row = Row { entries: Vec::new(), lost: Vec::new(), tally: Tally::default() };
        self.clusters.for_each_partner(i, |j, view| {
            let pair = [i, j].map(|k| (k, self.ends[k], &self.nodes[k]));
            let Some(flow) = self.means.flow(desk, pair, Some(view)) else { return };
            let (value, variance) = (flow.value, flow.error().powi(2));
            let (list, first) = if j < self.n_sources {
                row.tally.add(flow.tally);
                (&mut row.entries, 0)
            } else {
                (&mut row.lost, self.n_sources)
            };
            // Nothing is lost to a sink that may be hidden as well, even if the estimate is some way off: closed scenes stay closed.
            let is_certain = j < self.n_sources || value > TRUST * flow.error();
            if value > 0.0 && is_certain {
                list.push(Entry { column: (j - first) as u32, value, variance });
            }
        });
        row.entries.sort_unstable_by_key(|entry| entry.column);
        row.lost.sort_unstable_by_key(|entry| entry.column);
        row
    }
}
