//! A coarse space and its Galerkin equation, formed by reading every entry of K once.
//!
//! ```text
//! B = K P,      C = Pᵀ W (I − K) P = diag(Pᵀ W a) + diag(F 1) − F,      F = Pᵀ W B,      a = 1 − K P 1
//! ```
//!
//! P spreads a value a group over the unknowns of the group (those of weight zero left out), W weighs: where K is self-adjoint, so that
//! W K is symmetric. What a row loses, a, is what it absorbs and what it hands to unknowns that are left out: known without
//! subtracting, so that C is, too.
//!
//! On the way the strong entries of K are kept, see [`Near`].
//!
//! Corrections come as a constant and a rest, δ = P (β 1 + d), and what they do to a residual is told without a product with K:
//! (I − K) P (β 1 + d) = β a + P d − B d.

use super::super::SolveError;
use super::levels::Levels;
use super::near::{self, Near};
use crate::linalg::{Aggregation, Block, Dense, Equation, FactorError, LossFactor, SelfAdjoint, Unknown};
use rayon::prelude::*;

/// Rows that one task reads.
const ROWS_A_TASK: usize = 32;

/// Weights that make K self-adjoint, n × bands: μ/s for radiance, μ s for importance, and zero where s is; `None` if S^½ is not diagonal.
pub fn weights(form: SelfAdjoint<'_>, n_bands: usize) -> Option<Block> {
    let n = form.etendue.len();
    let mut root = Block::zeros(n, n_bands);
    form.scattering_root.apply(&Block::from_fn(n, n_bands, |_, _| 1.0), &mut root);
    let wave = Block::from_fn(n, n_bands, |i, band| (1.618 * (i + band) as f64 + 1.0).sin());
    let mut image = Block::zeros(n, n_bands);
    form.scattering_root.apply(&wave, &mut image);
    let is_diagonal = image
        .values()
        .iter()
        .zip(root.values().iter().zip(wave.values()))
        .all(|(image, (root, wave))| *image == root * wave);
    let weight = |i: usize, band: usize| {
        let scattering = root.get(i, band) * root.get(i, band);
        match form.unknown {
            _ if scattering == 0.0 => 0.0,
            Unknown::Radiance => form.etendue[i] / scattering,
            Unknown::Importance => form.etendue[i] * scattering,
        }
    };
    is_diagonal.then(|| Block::from_fn(n, n_bands, weight))
}

/// How a coarse equation is to be answered.
#[derive(Clone, Copy)]
pub(super) enum Wanted<'a> {
    /// By elimination, ⅓ m³.
    Factor,
    /// By cycles over coarser levels of the same unknowns, finest first, each of which is asked so many times.
    Levels { coarser: &'a [Aggregation], n_visits: usize },
}

/// What answers it.
enum Inverse {
    Factor(LossFactor),
    Levels(Levels),
}

impl Inverse {
    fn new(
        wanted: Wanted<'_>,
        aggregation: &Aggregation,
        flows: Dense,
        losses: Vec<f64>,
        weight: &[f64],
    ) -> Result<Self, FactorError> {
        match wanted {
            Wanted::Factor => Ok(Self::Factor(LossFactor::new(flows, losses)?)),
            Wanted::Levels { coarser, n_visits } => {
                let mut gathered = vec![0.0; losses.len()];
                aggregation.groups().zip(weight).for_each(|(group, w)| gathered[group] += w);
                let onto: Vec<Aggregation> = coarser.iter().filter_map(|level| aggregation.onto(level)).collect();
                Ok(Self::Levels(Levels::new(flows, losses, gathered, &onto, n_visits)?))
            }
        }
    }
}

/// One band of a coarse space.
struct Band {
    /// B, n × m.
    spread: Dense,
    /// a, n: what (I − K) P makes of 1 where P is one; where P is zero, minus what K P makes of 1.
    loss: Vec<f64>,
    inverse: Inverse,
    near: Near,
}

/// A coarse space of every band.
pub(super) struct Coarse {
    aggregation: Aggregation,
    weights: Block,
    bands: Vec<Band>,
}

impl Coarse {
    /// Reads every row of every band of K once. `images` ← K `sources`, on the way: the bands of several blocks at no further reading.
    ///
    /// # Errors
    /// A coarse equation that is singular, or has entries that are not finite.
    pub fn new(
        method: &'static str,
        equation: Equation<'_>,
        aggregation: Aggregation,
        wanted: Wanted<'_>,
        weights: Block,
        sources: &[&Block],
        images: &mut [Block],
    ) -> Result<Self, SolveError> {
        let (n, m) = (equation.n_unknowns(), aggregation.n_groups());
        // Zipped chunks need something to chunk, also where no image is asked for.
        let stride = sources.len().max(1);
        let mut bands = Vec::with_capacity(equation.n_bands());
        for band in 0..equation.n_bands() {
            let weight = weights.column(band);
            let is_left_out = weight.contains(&0.0);
            let mut spread = Dense::zeros(n, m);
            let mut loss = vec![0.0; n];
            let mut products = vec![0.0; n * stride];
            let mut near: Vec<Vec<(u32, f64)>> = vec![Vec::new(); n];
            let root: Vec<f64> = weight.iter().map(|w| w.sqrt()).collect();
            let threshold = near::STRONG / n as f64;
            let tasks =
                spread.values_mut().par_chunks_mut(ROWS_A_TASK * m.max(1)).zip(loss.par_chunks_mut(ROWS_A_TASK));
            let tasks = tasks.zip(products.par_chunks_mut(ROWS_A_TASK * stride)).zip(near.par_chunks_mut(ROWS_A_TASK));
            tasks.enumerate().for_each_init(
                || vec![0.0; n],
                |row, (task, (((spread, loss), products), near))| {
                    for (k, ((gathered, loss), near)) in spread.chunks_mut(m.max(1)).zip(loss).zip(near).enumerate() {
                        let i = task * ROWS_A_TASK + k;
                        equation.transport.row(band, i, row);
                        let dots = products[k * stride..][..sources.len()].iter_mut().zip(sources);
                        dots.for_each(|(dot, x)| *dot = row.iter().zip(x.column(band)).map(|(k, x)| k * x).sum());
                        // Keep what is strong.
                        let strong = row
                            .iter()
                            .enumerate()
                            .filter(|(j, k)| root[i] * *k > threshold * root[*j] && root[*j] > 0.0);
                        near.extend(strong.map(|(j, k)| (j as u32, *k)));
                        // Gather the row by groups; what it hands to unknowns that are left out is lost.
                        let mut handed = 0.0;
                        if is_left_out {
                            for ((k, group), w) in row.iter().zip(aggregation.groups()).zip(weight) {
                                if *w == 0.0 { handed += k } else { gathered[group] += k }
                            }
                        } else {
                            row.iter().zip(aggregation.groups()).for_each(|(k, group)| gathered[group] += k);
                        }
                        *loss = if weight[i] == 0.0 {
                            -gathered.iter().sum::<f64>()
                        } else {
                            match equation.absorption {
                                Some(absorption) => absorption.get(i, band) + handed,
                                None => 1.0 - gathered.iter().sum::<f64>(),
                            }
                        };
                    }
                },
            );
            for (s, image) in images.iter_mut().enumerate() {
                let column = image.column_mut(band).iter_mut().enumerate();
                column.for_each(|(i, out)| *out = products[i * stride + s]);
            }

            // Gather the rows.
            let (mut flows, mut losses) = (Dense::zeros(m, m), vec![0.0; m]);
            for (i, (group, w)) in aggregation.groups().zip(weight).enumerate() {
                if *w > 0.0 {
                    losses[group] += w * loss[i];
                    flows.row_mut(group).iter_mut().zip(spread.row_slice(i)).for_each(|(f, b)| *f += w * b);
                }
            }
            let inverse = Inverse::new(wanted, &aggregation, flows, losses, weight)
                .map_err(|source| SolveError::Factor { method, band, source })?;
            bands.push(Band { spread, loss, inverse, near: Near::from_rows(&near) });
        }
        Ok(Self { aggregation, weights, bands })
    }

    /// m.
    pub fn n_groups(&self) -> usize {
        self.aggregation.n_groups()
    }

    /// Work of forming the coarse equation in products: K once, the elimination's ⅓ m³ multiplications, and what coarser levels read.
    pub fn setup_work(&self) -> f64 {
        1.0 + self.share(|inverse, m| match inverse {
            Inverse::Factor(_) => m * m * m / 3.0,
            Inverse::Levels(levels) => levels.n_formed(),
        })
    }

    /// Work of one pass over B and one coarse solve, in products.
    pub fn pass_work(&self) -> f64 {
        self.spread_work()
            + self.share(|inverse, m| match inverse {
                Inverse::Factor(_) => m * m,
                Inverse::Levels(levels) => levels.n_read(),
            })
    }

    /// Work of one pass over B and one [`Coarse::solve_first`], in products.
    pub fn first_pass_work(&self) -> f64 {
        self.spread_work()
            + self.share(|inverse, m| match inverse {
                Inverse::Factor(_) => m * m,
                Inverse::Levels(levels) => levels.n_read_nested(),
            })
    }

    fn spread_work(&self) -> f64 {
        self.n_groups() as f64 / self.aggregation.n_unknowns() as f64
    }

    /// Entries over those of K; the bands' coarse equations are of one size.
    fn share(&self, entries: impl Fn(&Inverse, f64) -> f64) -> f64 {
        let (n, m) = (self.aggregation.n_unknowns() as f64, self.n_groups() as f64);
        self.bands.first().map_or(0.0, |band| entries(&band.inverse, m)) / (n * n)
    }

    pub fn weight(&self, band: usize) -> &[f64] {
        self.weights.column(band)
    }

    /// out ← Pᵀ W x of one band.
    pub fn gather(&self, band: usize, x: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for ((group, w), x) in self.aggregation.groups().zip(self.weight(band)).zip(x) {
            out[group] += w * x;
        }
    }

    /// out ← Bᵀ W x of one band. One pass over B.
    pub fn gather_spread(&self, band: usize, x: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for ((i, w), x) in self.weight(band).iter().enumerate().zip(x) {
            let factor = w * x;
            if factor != 0.0 {
                out.iter_mut().zip(self.bands[band].spread.row_slice(i)).for_each(|(out, b)| *out += factor * b);
            }
        }
    }

    /// What the strong entries of one band do on their own.
    pub fn near(&self, band: usize) -> &Near {
        &self.bands[band].near
    }

    /// Work of [`Near::apply`] in products, in the fullest band.
    pub fn near_work(&self) -> f64 {
        let n = self.aggregation.n_unknowns() as f64;
        self.bands.iter().map(|band| band.near.n_read()).max().unwrap_or(0) as f64 / (n * n)
    }

    /// q ← d of C (β 1 + d) = q, and β; by cycles about so.
    pub fn solve(&mut self, band: usize, q: &mut [f64]) -> f64 {
        match &mut self.bands[band].inverse {
            Inverse::Factor(factor) => factor.solve(q),
            Inverse::Levels(levels) => levels.solve(q),
        }
    }

    /// The same where nothing is known of the answer yet: cycles begin on the coarsest level.
    pub fn solve_first(&mut self, band: usize, q: &mut [f64]) -> f64 {
        match &mut self.bands[band].inverse {
            Inverse::Factor(factor) => factor.solve(q),
            Inverse::Levels(levels) => levels.solve_nested(q),
        }
    }

    /// out ← K P (β 1 + d) of one band. One pass over B.
    pub fn bounce(&self, band: usize, constant: f64, d: &[f64], out: &mut [f64]) {
        let Band { spread, loss, .. } = &self.bands[band];
        for (i, ((w, loss), out)) in self.weight(band).iter().zip(loss).zip(out).enumerate() {
            let gathered: f64 = spread.row_slice(i).iter().zip(d).map(|(b, d)| b * d).sum();
            let whole = if *w > 0.0 { 1.0 - loss } else { -loss };
            *out = gathered + constant * whole;
        }
    }

    /// x ← x + P d of one band.
    pub fn prolong(&self, band: usize, d: &[f64], x: &mut [f64]) {
        for ((group, w), x) in self.aggregation.groups().zip(self.weight(band)).zip(x) {
            if *w > 0.0 {
                *x += d[group];
            }
        }
    }

    /// x ← x + β P 1 of one band.
    pub fn prolong_constant(&self, band: usize, constant: f64, x: &mut [f64]) {
        for (w, x) in self.weight(band).iter().zip(x) {
            if *w > 0.0 {
                *x += constant;
            }
        }
    }

    /// r ← r − (I − K) P (β 1 + d) of one band. One pass over B.
    pub fn correct(&self, band: usize, constant: f64, d: &[f64], r: &mut [f64]) {
        let Band { spread, loss, .. } = &self.bands[band];
        let rows = self.aggregation.groups().zip(self.weight(band)).zip(loss).zip(r).enumerate();
        for (i, (((group, w), loss), r)) in rows {
            let gathered: f64 = spread.row_slice(i).iter().zip(d).map(|(b, d)| b * d).sum();
            let own = if *w > 0.0 { d[group] } else { 0.0 };
            *r += gathered - own - constant * loss;
        }
    }
}
