//! Exchange between orbits of bundles, only between those that are asked for.

use super::flow::{Flow, Means, Tally};
use super::pair::{Ladder, Nodes};
use super::visibility::{Desk, End, Obstacles};
use super::{Assembled, Exchange};
use crate::assembly::orbits::Orbits;
use crate::basis::{Bundles, Patch};
use crate::geometry::Polygon;
use crate::linalg::{Block, Matrix};
use crate::scene::Scene;
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

/// T between orbits, and the absolute error of every row's sum, m² sr. `wanted(i, j)` says which surfaces are asked to exchange, either way
/// round. Sinks are not counted, and closure is neither measured nor repaired.
///
/// Every pair of orbits is summed from one member of the larger to all of the smaller. Of the tolerance of occlusion a pair takes its share
/// of its row, so that rows keep to it.
pub(in crate::assembly) fn compute(
    scene: &Scene,
    bundles: &Bundles,
    orbits: &Orbits,
    wanted: &(dyn Fn(usize, usize) -> bool + Sync),
    settings: Exchange,
) -> (Assembled, Vec<f64>) {
    let polygons: Vec<&Polygon> = (0..scene.facets().len()).map(|facet| scene.polygon(facet)).collect();
    let obstacles = Obstacles::new(&polygons);
    let patches: Vec<&Patch> = (0..bundles.elements().len()).filter_map(|e| bundles.patch(e)).collect();
    let etendue = bundles.etendue();
    let n = orbits.n_orbits();
    let surface: Vec<usize> =
        (0..n).map(|orbit| scene.facets()[patches[orbits.members(orbit)[0]].facet].surface).collect();
    let asked = |i: usize, j: usize| wanted(surface[i], surface[j]) || wanted(surface[j], surface[i]);

    // Lay quadrature on patches that take part.
    let takes_part: Vec<bool> = (0..n).into_par_iter().map(|i| (0..n).any(|j| asked(i, j))).collect();
    let ladder = Ladder::new();
    let nodes: Vec<Option<Nodes>> = patches
        .par_iter()
        .enumerate()
        .map(|(k, patch)| orbits.orbit_of(k).filter(|i| takes_part[*i]).map(|_| ladder.nodes(&patch.polygon)))
        .collect();

    let means = Means { ladder: &ladder, obstacles: &obstacles, settings, n_sharing: Some(patches.len()) };
    let parts = Parts { orbits, patches: &patches, nodes: &nodes, means: &means, alike: Alike::new(patches.len()) };

    // Visit the upper triangle of orbits.
    let rows: Vec<Row> = (0..n)
        .into_par_iter()
        .with_max_len(1)
        .map_init(Desk::default, |desk, i| parts.upper_row(desk, i, (i..n).filter(|j| asked(i, *j))))
        .collect();

    // Join the rows.
    let mut tally = Tally::default();
    let (mut error, mut variance) = (vec![0.0; n], vec![0.0; n]);
    for (i, row) in rows.iter().enumerate() {
        tally.add(row.tally);
        for entry in &row.entries {
            for k in [i, entry.column as usize] {
                error[k] += entry.error;
                variance[k] += entry.variance;
            }
        }
    }
    let mut report = tally.report();
    let mu = |orbit: usize| orbits.members(orbit).iter().map(|k| etendue[*k]).sum::<f64>();
    let relative: f64 = variance.iter().enumerate().map(|(k, v)| v / mu(k).powi(2)).sum();
    report.visibility_error = (relative / n.max(1) as f64).sqrt();
    let upper = |value: fn(&Entry) -> f64| -> Vec<Vec<(u32, f64)>> {
        let pick = |entry: &Entry| Some((entry.column, value(entry))).filter(|(_, value)| *value > 0.0);
        rows.iter().map(|row| row.entries.iter().filter_map(pick).collect()).collect()
    };
    let assembled = Assembled {
        exchange: Matrix::symmetric(&upper(|entry| entry.value)),
        error: Matrix::symmetric(&upper(|entry| entry.hidden_error)),
        sinks: Block::zeros(n, 2),
        repair_scale: Vec::new(),
        report,
    };
    (assembled, error)
}

/// One row of the upper triangle of orbits.
#[derive(Default)]
struct Row {
    entries: Vec<Entry>,
    tally: Tally,
}

struct Entry {
    column: u32,
    value: f64,
    /// All error estimates added up, m² sr.
    error: f64,
    /// What visibility leaves uncertain of it.
    hidden_error: f64,
    variance: f64,
}

/// What rows are computed from.
struct Parts<'a> {
    orbits: &'a Orbits,
    patches: &'a [&'a Patch],
    /// Of patches that take part.
    nodes: &'a [Option<Nodes>],
    means: &'a Means<'a>,
    alike: Alike,
}

impl Parts<'_> {
    /// What an orbit exchanges with others.
    fn upper_row(&self, desk: &mut Desk, i: usize, others: impl Iterator<Item = usize>) -> Row {
        let mut row = Row::default();
        for j in others {
            let (mine, other) = (self.orbits.members(i), self.orbits.members(j));
            let (one, all) = if mine.len() >= other.len() { (mine, j) } else { (other, i) };
            let mut total = Flow::default();
            for (k, count) in self.orbits.seen_from(one[0], all) {
                let flow = self.pair(desk, [one[0].min(k), one[0].max(k)]);
                flow.iter().for_each(|flow| total.add(flow, count as f64));
            }
            if total.tally.n_pairs > 0 {
                total.scale(one.len() as f64);
                row.tally.add(total.tally);
                row.entries.push(Entry {
                    column: j as u32,
                    value: total.value,
                    error: total.quadrature_error + total.occlusion_error,
                    hidden_error: total.error(),
                    variance: total.variance,
                });
            }
        }
        row
    }

    /// What passes between two patches, the first one's number the lower.
    fn pair(&self, desk: &mut Desk, pair: [usize; 2]) -> Option<Flow> {
        let ends = pair.map(|k| (k, End::new(&self.patches[k].polygon, self.patches[k].facet)));
        if pair[0] == pair[1] || self.means.obstacles.tracer.coplanar(ends[0].1.facet, ends[1].1.facet) {
            return None;
        }
        let whole = |[i, j]: [usize; 2]| {
            let nodes = |k: usize| Some((&self.patches[k].polygon, self.nodes[k].as_ref()?));
            self.means.whole([nodes(i)?, nodes(j)?], None)
        };
        let translates = self.orbits.translates();
        let whole = match translates.is_empty() {
            true => whole(pair),
            false => self.alike.get(translates.first_of(pair), whole),
        };
        Some(self.means.let_through(desk, ends, whole?, None))
    }
}

/// T of pairs that others are translates of, and its error, as far as known.
///
/// A value depends on its pair alone, not on who asked first: results have the same bits on any number of threads.
struct Alike {
    /// By the second of the pair, a shelf for every first one: those of a row stay near each other in memory.
    shelves: Vec<Mutex<Shelf>>,
}

/// T of what faces each other, and its error.
type Shelf = HashMap<usize, Option<(f64, f64)>>;

impl Alike {
    fn new(n_patches: usize) -> Self {
        Self { shelves: (0..n_patches).map(|_| Mutex::default()).collect() }
    }

    fn get(&self, pair: [usize; 2], compute: impl Fn([usize; 2]) -> Option<(f64, f64)>) -> Option<(f64, f64)> {
        let [first, second] = pair;
        // Nothing panics while it holds a lock, and if it did, what was put in before is still right.
        let shelf = || self.shelves[first].lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = shelf().get(&second) {
            return *known;
        }
        let value = compute(pair);
        shelf().insert(second, value);
        value
    }
}
