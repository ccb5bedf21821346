//! Exchange: the étendue that flows between every two bundles, T = Tᵀ, and what flows into sinks.
//!
//! Every pair of patches is looked at once and deposited both ways. What a patch loses to the environment and to black backs is
//! counted by rays of its own, so that closure, Σⱼ Tᵢⱼ + sinksᵢ = μᵢ, is a check and not a definition.

mod clip;
mod closure;
mod contour;
mod enclosure;
mod lambert;
mod point;
mod quadrature;
mod rules;
mod shadow;
mod single;
mod sinks;
mod visibility;

pub use closure::Repair;
pub use enclosure::{Enclosure, enclose};
pub use point::{point_factor, point_factors};
pub use single::exchange_of_pair;

use crate::basis::{Bundles, Patch};
use crate::geometry::{Polygon, Tracer};
use crate::linalg::{Block, Matrix};
use crate::sampling::mix;
use crate::scene::Scene;
use quadrature::{Ladder, Nodes};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use visibility::{End, Visibility};

/// How exchange is computed: accuracy is the caller's choice, and every number here enters the provenance of the result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exchange {
    /// Relative tolerance of unoccluded pairs.
    pub tolerance: f64,
    /// How partly visible pairs are computed.
    pub occlusion: Occlusion,
    /// Rays a pair whose visibility geometry does not settle.
    pub visibility_rays: usize,
    /// Rays a patch that count what it loses to sinks.
    pub sink_rays: usize,
    /// Key of the random shifts.
    pub seed: u64,
    /// Whether closure is repaired by symmetric scaling.
    pub repair: bool,
}

impl Default for Exchange {
    fn default() -> Self {
        Self {
            tolerance: 1e-10,
            occlusion: Occlusion::Sampled,
            visibility_rays: 64,
            sink_rays: 4096,
            seed: 0x00e7_e2d0_e000_0001,
            repair: true,
        }
    }
}

/// How the exchange of a partly visible pair is computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Occlusion {
    /// By rays: fast, with a standard error.
    Sampled,
    /// By the exact visible part from every point of an adaptive quadrature, to this absolute error of Tᵢⱼ / min(μᵢ, μⱼ).
    Exact { tolerance: f64 },
}

/// How the entries of T came about.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExchangeReport {
    /// Pairs of patches that face each other.
    pub n_pairs: usize,
    /// Of these: proved clear, so right to the quadrature's error.
    pub n_clear: usize,
    /// Of these: proved hidden.
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

#[derive(Clone, Copy, Default)]
struct Tally {
    n_pairs: usize,
    n_clear: usize,
    n_hidden: usize,
    n_integrated: usize,
    quadrature_error: f64,
}

/// T and sinks of all patches. Cost O(n²) pairs; `progress` hears the finished share, from any thread.
pub(super) fn compute(
    scene: &Scene,
    bundles: &Bundles,
    settings: Exchange,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Assembled, Overfull> {
    let polygons: Vec<&Polygon> = (0..scene.facets().len()).map(|facet| scene.polygon(facet)).collect();
    let occluders = Tracer::occluders(&polygons);
    let everything = Tracer::new(&polygons);
    let patches: Vec<&Patch> = (0..bundles.elements().len()).filter_map(|e| bundles.patch(e)).collect();
    let etendue = bundles.etendue();
    let ladder = Ladder::new();
    let nodes: Vec<Nodes> = patches.par_iter().map(|patch| ladder.nodes(&patch.polygon)).collect();

    // Visit the upper triangle row by row; long rows first, so that threads finish together.
    let n = patches.len();
    let done = AtomicUsize::new(0);
    let rows: Vec<(Vec<Entry>, Tally)> = (0..n)
        .into_par_iter()
        .with_max_len(1)
        .map(|i| {
            let row = upper_row(&patches, (&ladder, &nodes), etendue, &occluders, settings, i);
            let finished = done.fetch_add(n - i, Ordering::Relaxed) + (n - i);
            progress(0.95 * finished as f64 / (0.5 * (n * (n + 1)) as f64));
            row
        })
        .collect();

    // Count what every patch loses.
    let lost: Vec<sinks::Lost> = patches
        .par_iter()
        .enumerate()
        .map(|(i, patch)| {
            let end = End { polygon: &patch.polygon, facet: patch.facet, etendue: etendue[i] };
            sinks::lost_from(scene, &everything, end, settings.sink_rays, mix(&[settings.seed, 1, i as u64]))
        })
        .collect();
    let mut sinks =
        Block::from_fn(n, 2, |i, sink| etendue[i] * if sink == 0 { lost[i].escaped } else { lost[i].darkened });

    // Join the rows, each pair's variance counted at both of its ends.
    let mut report = ExchangeReport::default();
    let mut variance: Vec<f64> = lost.iter().zip(etendue).map(|(lost, mu)| lost.variance * mu * mu).collect();
    for (i, (row, tally)) in rows.iter().enumerate() {
        report.n_pairs += tally.n_pairs;
        report.n_clear += tally.n_clear;
        report.n_hidden += tally.n_hidden;
        report.n_integrated += tally.n_integrated;
        report.quadrature_error = report.quadrature_error.max(tally.quadrature_error);
        for entry in row {
            variance[i] += entry.variance;
            variance[entry.column as usize] += entry.variance;
        }
    }
    report.n_sampled = report.n_pairs - report.n_clear - report.n_hidden - report.n_integrated;
    let relative: f64 = variance.iter().zip(etendue).map(|(v, mu)| v / (mu * mu)).sum();
    report.visibility_error = (relative / n.max(1) as f64).sqrt();
    let upper: Vec<Vec<(u32, f64)>> = rows
        .into_iter()
        .map(|(row, _)| {
            row.into_iter().filter(|entry| entry.value > 0.0).map(|entry| (entry.column, entry.value)).collect()
        })
        .collect();
    let mut exchange = Matrix::symmetric(&upper);
    drop(upper);

    report.closure_before_repair = closure::violation(&exchange, &sinks, etendue);
    if let Some((bundle, fullness)) = closure::overfull(&exchange, etendue, &variance) {
        return Err(Overfull { bundle, fullness });
    }
    let mut repair_scale = Vec::new();
    if settings.repair {
        let (repair, scale) = closure::repair(&mut exchange, &mut sinks, etendue);
        (report.repair, repair_scale) = (Some(repair), scale);
    }
    progress(1.0);
    Ok(Assembled { exchange, sinks, repair_scale, report })
}

/// The pairs (i, j), j > i, that exchange anything.
fn upper_row(
    patches: &[&Patch],
    (ladder, nodes): (&Ladder, &[Nodes]),
    etendue: &[f64],
    occluders: &Tracer,
    settings: Exchange,
    i: usize,
) -> (Vec<Entry>, Tally) {
    let mut tally = Tally::default();
    let mut row = Vec::new();
    let a = patches[i];
    for j in i + 1..patches.len() {
        let b = patches[j];
        if occluders.coplanar(a.facet, b.facet) {
            continue;
        }
        let pair = quadrature::unoccluded(ladder, (&a.polygon, &nodes[i]), (&b.polygon, &nodes[j]), settings.tolerance);
        let Some((exchange, error)) = pair else { continue };
        tally.n_pairs += 1;
        tally.quadrature_error = tally.quadrature_error.max(error / exchange);

        let key = mix(&[settings.seed, 0, i as u64, j as u64]);
        let ends =
            [(a, i), (b, j)].map(|(patch, k)| End { polygon: &patch.polygon, facet: patch.facet, etendue: etendue[k] });
        match visibility::between(occluders, ends[0], ends[1], settings.occlusion, settings.visibility_rays, key) {
            Visibility::Full => {
                tally.n_clear += 1;
                row.push(Entry { column: j as u32, value: exchange, variance: 0.0 });
            }
            Visibility::None => tally.n_hidden += 1,
            Visibility::Integrated { blocked, error } => {
                tally.n_integrated += 1;
                let value = (exchange - blocked).max(0.0);
                if value > 0.0 {
                    row.push(Entry { column: j as u32, value, variance: error * error });
                }
            }
            Visibility::Sampled { share, variance } => {
                let variance = variance * exchange * exchange;
                row.push(Entry { column: j as u32, value: share * exchange, variance });
            }
        }
    }
    (row, tally)
}
