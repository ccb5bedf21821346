//! Which coarse bundle every fine one is a part of.

use crate::basis::Bundles;
use crate::sampling::AliasTable;
use thiserror::Error;

/// Parts must add up to the whole to this, relatively: étendues are sums of products of some coordinates.
const WHOLE_TOLERANCE: f64 = 1e-9;

/// Corners are looked up this far towards the centroid, to be on one side of the grid's lines.
const INWARD: f64 = 1e-6;

/// Fine bundles by coarse ones.
#[derive(Clone, Debug)]
pub struct Parents {
    /// The coarse bundle of every fine one.
    pub of: Vec<u32>,
    /// The fine bundles of every coarse one, with a table to draw one by étendue.
    children: Vec<(Vec<u32>, AliasTable)>,
    /// μ of every fine bundle over that of its coarse one.
    pub share: Vec<f64>,
}

/// Why one mesh is no refinement of another.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum NestingError {
    #[error("element {element} is not a patch")]
    NotAPatch { element: usize },
    #[error("bundle {bundle} reaches over several coarser ones")]
    Straddles { bundle: usize },
    #[error("the parts of coarse bundle {bundle} have {found:e} of its étendue, must have all")]
    NotWhole { bundle: usize, found: f64 },
}

impl Parents {
    /// Cost O(n).
    ///
    /// # Errors
    /// A fine bundle that is not inside one coarse bundle, or a coarse one that is not covered.
    pub fn new(fine: &Bundles, coarse: &Bundles) -> Result<Self, NestingError> {
        let mut of = Vec::with_capacity(fine.n_bundles());
        for bundle in 0..fine.n_bundles() {
            let (element, _) = fine.element_of(bundle);
            let patch = fine.patch(element).ok_or(NestingError::NotAPatch { element })?;
            let centroid = patch.polygon.centroid();
            let locate = |point| coarse.locate(patch.facet, patch.side, point, patch.polygon.normal());
            let parent = locate(centroid).ok_or(NestingError::Straddles { bundle })?;
            let is_inside =
                |corner: &crate::geometry::Vec3| locate(*corner + INWARD * (centroid - *corner)) == Some(parent);
            if !patch.polygon.vertices().iter().all(is_inside) {
                return Err(NestingError::Straddles { bundle });
            }
            of.push(parent as u32);
        }

        // Gather the parts, which must make up the whole.
        let mut parts = vec![Vec::new(); coarse.n_bundles()];
        of.iter().enumerate().for_each(|(i, parent)| parts[*parent as usize].push(i as u32));
        let mut children = Vec::with_capacity(parts.len());
        for (bundle, parts) in parts.into_iter().enumerate() {
            let etendue: Vec<f64> = parts.iter().map(|i| fine.etendue()[*i as usize]).collect();
            let found = etendue.iter().sum::<f64>() / coarse.etendue()[bundle];
            let table = AliasTable::new(&etendue).ok().filter(|_| (found - 1.0).abs() <= WHOLE_TOLERANCE);
            children.push((parts, table.ok_or(NestingError::NotWhole { bundle, found })?));
        }
        let share = of.iter().zip(fine.etendue()).map(|(parent, mu)| mu / coarse.etendue()[*parent as usize]).collect();
        Ok(Self { of, children, share })
    }

    /// A part of a coarse bundle, by étendue.
    #[inline]
    pub fn draw(&self, coarse: usize, uniform: f64) -> usize {
        let (parts, table) = &self.children[coarse];
        parts[table.sample(uniform)] as usize
    }
}
