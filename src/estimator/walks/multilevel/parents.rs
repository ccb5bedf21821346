//! Which coarse bundle every fine one is a part of.

use crate::basis::Bundles;
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

        // The parts must make up the whole.
        let mut parts = vec![0.0; coarse.n_bundles()];
        of.iter().zip(fine.etendue()).for_each(|(parent, mu)| parts[*parent as usize] += mu);
        for (bundle, (part, whole)) in parts.iter().zip(coarse.etendue()).enumerate() {
            let found = part / whole;
            if (found - 1.0).abs() > WHOLE_TOLERANCE {
                return Err(NestingError::NotWhole { bundle, found });
            }
        }
        Ok(Self { of })
    }
}
