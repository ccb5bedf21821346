//! Bundles gathered by where they are: tiles of patches, whole facets, whole surfaces, everything.

use super::Bundles;
use crate::linalg::{Aggregation, Hierarchy};
use crate::scene::{Scene, Side};

/// Tiles are doubled this often at most: no facet is cut into more than 2³¹ patches.
const DOUBLINGS: u32 = 31;

impl Bundles {
    /// Groups of bundles, finest first: 2 × 2 patches of one side of a facet, 4 × 4, … until a facet's side is one tile; one side of all
    /// facets of a surface; everything. Bins of directions stay apart, except in the last. Cost O(n log n).
    pub fn hierarchy(&self, scene: &Scene) -> Hierarchy {
        let mut levels = Vec::new();
        for k in 1..=DOUBLINGS {
            levels.push(self.gathered(|facet, side, patch| (facet, side, patch), k));
            // End where doubling gathers nothing more.
            let n = levels.len();
            if n > 1 && levels[n - 1].n_groups() == levels[n - 2].n_groups() {
                break;
            }
        }
        levels.push(self.gathered(|facet, side, _| (scene.facets()[facet].surface, side, 0), DOUBLINGS));
        levels.push(Aggregation::whole(self.n_bundles()));
        Hierarchy::new(levels)
    }

    /// Bundles with one label of (facet, side, tile of 2ᵏ × 2ᵏ patches) and bin are one group; elements that are no patches stay single.
    fn gathered(&self, label: impl Fn(usize, Side, usize) -> (usize, Side, usize), k: u32) -> Aggregation {
        let mut labels: Vec<_> = (0..self.elements().len()).map(|e| (usize::MAX, Side::Front, e)).collect();
        for (facet, patches) in self.facets().iter().enumerate() {
            let sides = [(Side::Front, Some(patches.first_front)), (Side::Back, patches.first_back)];
            let tiles = patches.grid.tiles(k);
            for (side, first) in sides.into_iter().filter_map(|(side, first)| Some((side, first?))) {
                tiles.iter().enumerate().for_each(|(patch, tile)| labels[first + patch] = label(facet, side, *tile));
            }
        }
        let bundles = labels.iter().enumerate();
        Aggregation::new(bundles.flat_map(|(e, label)| (0..self.bundles_of(e).len()).map(move |bin| (*label, bin))))
    }
}
