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
    let occluders = &obstacles.tracer;
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
    let pair = |desk: &mut Desk, i: usize, j: usize| -> Option<Flow> {
        if i == j || occluders.coplanar(patches[i].facet, patches[j].facet) {
            return None;
        }
        let end = |k: usize| Some((k, End::new(&patches[k].polygon, patches[k].facet), nodes[k].as_ref()?));
        means.flow(desk, [end(i)?, end(j)?], None)
    };

    // Visit the upper triangle of orbits.
    let rows: Vec<Vec<(u32, Flow)>> = (0..n)
        .into_par_iter()
        .with_max_len(1)
        .map_init(Desk::default, |desk, i| {
            let mut row = Vec::new();
            for j in (i..n).filter(|j| asked(i, *j)) {
                let (mine, other) = (orbits.members(i), orbits.members(j));
                let (one, all) = if mine.len() >= other.len() { (mine, j) } else { (other, i) };
                let mut total = Flow::default();
                for (k, count) in orbits.seen_from(one[0], all) {
                    let flow = pair(desk, one[0].min(k), one[0].max(k));
                    flow.iter().for_each(|flow| total.add(flow, count as f64));
                }
                if total.tally.n_pairs > 0 {
                    total.scale(one.len() as f64);
                    row.push((j as u32, total));
                }
            }
            row
        })
        .collect();

    // Join the rows.
    let mut tally = Tally::default();
    let (mut error, mut variance) = (vec![0.0; n], vec![0.0; n]);
    for (i, row) in rows.iter().enumerate() {
        for (j, flow) in row {
            tally.add(flow.tally);
            for k in [i, *j as usize] {
                error[k] += flow.quadrature_error + flow.occlusion_error;
                variance[k] += flow.variance;
            }
        }
    }
    let mut report = tally.report();
    let mu = |orbit: usize| orbits.members(orbit).iter().map(|k| etendue[*k]).sum::<f64>();
    let relative: f64 = variance.iter().enumerate().map(|(k, v)| v / mu(k).powi(2)).sum();
    report.visibility_error = (relative / n.max(1) as f64).sqrt();
    let upper = |value: fn(&Flow) -> f64| -> Vec<Vec<(u32, f64)>> {
        let pick = |(j, flow): &(u32, Flow)| Some((*j, value(flow))).filter(|(_, value)| *value > 0.0);
        rows.iter().map(|row| row.iter().filter_map(pick).collect()).collect()
    };
    let assembled = Assembled {
        exchange: Matrix::symmetric(&upper(|flow| flow.value)),
        error: Matrix::symmetric(&upper(Flow::error)),
        sinks: Block::zeros(n, 2),
        repair_scale: Vec::new(),
        report,
    };
    (assembled, error)
}
