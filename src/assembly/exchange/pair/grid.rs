//! Product Gauss rules on the unit square, in groups of lanes.

use super::rules::{Rule, gauss_legendre};
use std::sync::OnceLock;

/// Lanes that are computed side by side, and summed in an order of their own: so bits depend on no machine.
pub const LANES: usize = 8;

/// The most points an axis.
pub const MOST: usize = 24;

/// One number for each lane.
pub type Group = [f64; LANES];

/// Points (s, t) and weights of a product rule, in groups of lanes; what fills the last has weight zero.
pub struct Grid {
    pub groups: Vec<[Group; 3]>,
    pub n_points: usize,
}

impl Grid {
    fn new(along: &Rule, across: &Rule) -> Self {
        let mut points = Vec::with_capacity(along.nodes.len() * across.nodes.len());
        for (t, wt) in across.nodes.iter().zip(&across.weights) {
            points.extend(along.nodes.iter().zip(&along.weights).map(|(s, ws)| [*s, *t, ws * wt]));
        }
        let group = |chunk: &[[f64; 3]]| {
            let filling = [chunk[0][0], chunk[0][1], 0.0];
            [0, 1, 2].map(|k| std::array::from_fn(|lane| chunk.get(lane).unwrap_or(&filling)[k]))
        };
        Self { groups: points.chunks(LANES).map(group).collect(), n_points: points.len() }
    }
}

/// The grids of 1 to [`MOST`] points along either axis, each made when it is first asked for.
pub struct Grids {
    rules: Vec<Rule>,
    grids: Vec<OnceLock<Grid>>,
}

impl Grids {
    pub fn new() -> Self {
        let rules = (1..=MOST).map(gauss_legendre).collect();
        Self { rules, grids: std::iter::repeat_with(OnceLock::new).take(MOST * MOST).collect() }
    }

    /// The grid of so many points along s and along t.
    #[inline]
    pub fn of(&self, [along, across]: [usize; 2]) -> &Grid {
        let made = || Grid::new(&self.rules[along - 1], &self.rules[across - 1]);
        self.grids[(along - 1) * MOST + across - 1].get_or_init(made)
    }
}
