//! Exchange between orbits of bundles, only between those that are asked for.

use super::ladder::{Ladder, Nodes};
use super::quadrature;
use super::shadow::Desk;
use super::visibility::{self, End, Obstacles, Visibility};
use super::{Assembled, Exchange, ExchangeReport, Occlusion};
use crate::assembly::orbits::Orbits;
use crate::basis::{Bundles, Patch};
use crate::geometry::Polygon;
use crate::linalg::{Block, Matrix};
use crate::sampling::mix;
use crate::scene::Scene;
use rayon::prelude::*;

/// The sum of some pairs.
#[derive(Clone, Copy, Default)]
struct Sum {
    value: f64,
    /// Absolute, the estimates of all pairs added up.
    error: f64,
    /// Of that, what is due to occlusion.
    occlusion_error: f64,
    variance: f64,
    n_pairs: usize,
    n_clear: usize,
    n_hidden: usize,
    n_integrated: usize,
    quadrature_error: f64,
}

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

    let pair = |desk: &mut Desk, i: usize, j: usize| -> Option<Sum> {
        let (a, b) = (patches[i], patches[j]);
        if i == j || occluders.coplanar(a.facet, b.facet) {
            return None;
        }
        let ends = ((&a.polygon, nodes[i].as_ref()?), (&b.polygon, nodes[j].as_ref()?));
        let (exchange, error) = quadrature::unoccluded(&ladder, ends.0, ends.1, settings.tolerance)?;
        let mut sum = Sum { n_pairs: 1, quadrature_error: error / exchange, ..Sum::default() };
        let ends = [a, b].map(|patch| End::new(&patch.polygon, patch.facet));
        let occlusion = match settings.occlusion {
            Occlusion::Exact { tolerance } => {
                let share = exchange / etendue[i].min(etendue[j]);
                Occlusion::Exact { tolerance: tolerance * share.max(1.0 / patches.len() as f64).min(1.0) }
            }
            sampled => sampled,
        };
        let key = mix(&[settings.seed, 0, i as u64, j as u64]);
        match visibility::between(&obstacles, desk, None, ends, occlusion, settings.visibility_rays, key) {
            Visibility::Full => (sum.value, sum.error, sum.n_clear) = (exchange, error, 1),
            Visibility::None => sum.n_hidden = 1,
            Visibility::Integrated { blocked, error: estimate } => {
                (sum.value, sum.n_integrated) = ((exchange - blocked).max(0.0), 1);
                (sum.error, sum.occlusion_error) = (error + estimate, estimate);
            }
            Visibility::Sampled { share, variance } => {
                (sum.value, sum.error, sum.variance) = (share * exchange, error, variance * exchange * exchange);
            }
        }
        Some(sum)
    };

    // Visit the upper triangle of orbits.
    let rows: Vec<Vec<(u32, Sum)>> = (0..n)
        .into_par_iter()
        .with_max_len(1)
        .map_init(Desk::default, |desk, i| {
            let mut row = Vec::new();
            for j in (i..n).filter(|j| asked(i, *j)) {
                let (mine, other) = (orbits.members(i), orbits.members(j));
                let (one, all) = if mine.len() >= other.len() { (mine, j) } else { (other, i) };
                let mut total = Sum::default();
                for (k, count) in orbits.seen_from(one[0], all) {
                    let sum = pair(desk, one[0].min(k), one[0].max(k));
                    sum.into_iter().for_each(|sum| total.add(&sum, count as f64));
                }
                if total.n_pairs > 0 {
                    total.scale(one.len() as f64);
                    row.push((j as u32, total));
                }
            }
            row
        })
        .collect();

    // Join the rows.
    let mut report = ExchangeReport::default();
    let (mut error, mut variance) = (vec![0.0; n], vec![0.0; n]);
    for (i, row) in rows.iter().enumerate() {
        for (j, sum) in row {
            report.n_pairs += sum.n_pairs;
            report.n_clear += sum.n_clear;
            report.n_hidden += sum.n_hidden;
            report.n_integrated += sum.n_integrated;
            report.quadrature_error = report.quadrature_error.max(sum.quadrature_error);
            for k in [i, *j as usize] {
                error[k] += sum.error;
                variance[k] += sum.variance;
            }
        }
    }
    report.n_sampled = report.n_pairs - report.n_clear - report.n_hidden - report.n_integrated;
    let mu = |orbit: usize| orbits.members(orbit).iter().map(|k| etendue[*k]).sum::<f64>();
    let relative: f64 = variance.iter().enumerate().map(|(k, v)| v / mu(k).powi(2)).sum();
    report.visibility_error = (relative / n.max(1) as f64).sqrt();
    let upper = |value: fn(&Sum) -> f64| -> Vec<Vec<(u32, f64)>> {
        let pick = |(j, sum): &(u32, Sum)| Some((*j, value(sum))).filter(|(_, value)| *value > 0.0);
        rows.iter().map(|row| row.iter().filter_map(pick).collect()).collect()
    };
    let (upper, upper_error) = (upper(|sum| sum.value), upper(|sum| sum.variance.sqrt() + sum.occlusion_error));
    let assembled = Assembled {
        exchange: Matrix::symmetric(&upper),
        error: Matrix::symmetric(&upper_error),
        sinks: Block::zeros(n, 2),
        repair_scale: Vec::new(),
        report,
    };
    (assembled, error)
}

impl Sum {
    /// Adds so many alike.
    fn add(&mut self, other: &Sum, count: f64) {
        self.value += count * other.value;
        self.error += count * other.error;
        self.occlusion_error += count * other.occlusion_error;
        self.variance += count * count * other.variance;
        self.n_pairs += other.n_pairs;
        self.n_clear += other.n_clear;
        self.n_hidden += other.n_hidden;
        self.n_integrated += other.n_integrated;
        self.quadrature_error = self.quadrature_error.max(other.quadrature_error);
    }

    fn scale(&mut self, count: f64) {
        self.value *= count;
        self.error *= count;
        self.occlusion_error *= count;
        self.variance *= count * count;
    }
}
