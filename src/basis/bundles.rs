//! The bundles of a scene at a resolution.

use super::grid::Grid;
use crate::geometry::{Polygon, PolygonError, Vec3};
use crate::scene::{Scene, Side};
use std::f64::consts::PI;
use std::ops::Range;
use thiserror::Error;

/// How finely the light field is cut. There is no default: the resolution is the experiment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// Longest edge of a patch, metres.
    pub patch_size: f64,
    /// Bins of directions an element. One is the radiosity method.
    pub n_directions: usize,
}

/// A carrier of bundles.
#[derive(Clone, Debug, PartialEq)]
pub enum Element {
    /// One side of a piece of a surface.
    Patch(Patch),
    /// One cell of a participating medium, by its ∫ σ_t dV in m²; its unknown is the source function.
    Cell { medium: usize, optical_volume: f64 },
    /// The sphere around an open scene, where it emits, by the étendue that reaches the scene.
    Environment { etendue: f64 },
}

/// One side of a piece of a polygon.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// Number of the facet it was cut from, see [`Scene::facets`].
    pub facet: usize,
    pub side: Side,
    /// The piece, its front turned to this side.
    pub polygon: Polygon,
}

/// All bundles of a scene, with their étendue.
///
/// Sides that are black backs are no elements: what they and the environment of an open scene take in, they keep, so they are
/// sinks of the exchange and not unknowns.
#[derive(Clone, Debug)]
pub struct Bundles {
    resolution: Resolution,
    elements: Vec<Element>,
    /// Bundles of element e are first_bundle[e] .. first_bundle[e + 1].
    first_bundle: Vec<usize>,
    etendue: Vec<f64>,
    facets: Vec<FacetPatches>,
}

/// The patches of one facet.
#[derive(Clone, Debug)]
pub(super) struct FacetPatches {
    pub grid: Grid,
    pub first_front: usize,
    pub first_back: Option<usize>,
}

/// Why a scene cannot be cut at this resolution.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum BasisError {
    #[error("the patch size is {value:e}, must be finite and above zero")]
    PatchSize { value: f64 },
    #[error("{found} bins of directions asked for: diffuse scenes have 1, more need directional bases")]
    Directions { found: usize },
    #[error("a patch size of {patch_size:e} makes {n_patches} patches, more than the {limit} that can be numbered")]
    TooMany { patch_size: f64, n_patches: usize, limit: usize },
    #[error("surface '{surface}' cannot be cut into patches of {patch_size:e}: {source}")]
    Patch { surface: String, patch_size: f64, source: PolygonError },
}

impl Bundles {
    /// More elements than this cannot be numbered; far beyond what a matrix can hold.
    pub const LIMIT: usize = 1 << 31;

    /// How many bundles a scene would have at this resolution, without making them. Cost O(facets).
    pub fn count(scene: &Scene, resolution: Resolution) -> Result<usize, BasisError> {
        resolution.check()?;
        let patches = |facet| {
            let sides = 1 + usize::from(scene.surface_of(facet).back.is_some());
            Grid::new(scene.polygon(facet), resolution.patch_size).n_patches().saturating_mul(sides)
        };
        let n_patches = (0..scene.facets().len()).map(patches).fold(0, usize::saturating_add);
        if n_patches > Self::LIMIT {
            let patch_size = resolution.patch_size;
            return Err(BasisError::TooMany { patch_size, n_patches, limit: Self::LIMIT });
        }
        Ok(n_patches)
    }

    /// Cuts every surface. Elements come facet by facet, fronts before backs. Cost O(n).
    ///
    /// # Errors
    /// A resolution that makes no sense, more patches than can be numbered, patches too small for the coordinates.
    pub fn new(scene: &Scene, resolution: Resolution) -> Result<Self, BasisError> {
        let n_elements = Self::count(scene, resolution)?;
        let mut elements = Vec::with_capacity(n_elements);
        let mut facets = Vec::with_capacity(scene.facets().len());
        for facet in 0..scene.facets().len() {
            let surface = scene.surface_of(facet);
            let grid = Grid::new(scene.polygon(facet), resolution.patch_size);
            let pieces = grid.patches().map_err(|source| BasisError::Patch {
                surface: surface.name.clone(),
                patch_size: resolution.patch_size,
                source,
            })?;
            let first_front = elements.len();
            let first_back = surface.back.is_some().then_some(first_front + pieces.len());
            let backs = first_back.map(|_| pieces.iter().map(Polygon::flipped).collect::<Vec<_>>()).unwrap_or_default();
            let patch = |side| move |polygon| Element::Patch(Patch { facet, side, polygon });
            elements.extend(pieces.into_iter().map(patch(Side::Front)));
            elements.extend(backs.into_iter().map(patch(Side::Back)));
            facets.push(FacetPatches { grid, first_front, first_back });
        }

        // Number the bundles and weigh them: Ω⊥ = π for the one bin of a hemisphere, Ω = 4π for the one bin of a sphere.
        let first_bundle = (0..=elements.len()).collect();
        let etendue = elements
            .iter()
            .map(|element| match element {
                Element::Patch(patch) => PI * patch.polygon.area(),
                Element::Cell { optical_volume, .. } => 4.0 * PI * optical_volume,
                Element::Environment { etendue } => *etendue,
            })
            .collect();
        Ok(Self { resolution, elements, first_bundle, etendue, facets })
    }

    pub fn resolution(&self) -> Resolution {
        self.resolution
    }

    pub fn n_bundles(&self) -> usize {
        self.etendue.len()
    }

    pub fn elements(&self) -> &[Element] {
        &self.elements
    }

    /// The numbers of an element's bundles.
    pub fn bundles_of(&self, element: usize) -> Range<usize> {
        self.first_bundle[element]..self.first_bundle[element + 1]
    }

    /// The element of a bundle and which of its bins it is.
    pub fn element_of(&self, bundle: usize) -> (usize, usize) {
        let element = self.first_bundle.partition_point(|first| *first <= bundle) - 1;
        (element, bundle - self.first_bundle[element])
    }

    pub(super) fn facets(&self) -> &[FacetPatches] {
        &self.facets
    }

    /// μ of every bundle, m² sr.
    pub fn etendue(&self) -> &[f64] {
        &self.etendue
    }

    /// The patch of an element, where it is one.
    pub fn patch(&self, element: usize) -> Option<&Patch> {
        match &self.elements[element] {
            Element::Patch(patch) => Some(patch),
            Element::Cell { .. } | Element::Environment { .. } => None,
        }
    }

    /// The bundle that holds light leaving this point of a facet's side in this direction; `None` on a black back.
    pub fn locate(&self, facet: usize, side: Side, point: Vec3, _direction: Vec3) -> Option<usize> {
        let patches = &self.facets[facet];
        let first = match side {
            Side::Front => patches.first_front,
            Side::Back => patches.first_back?,
        };
        Some(self.first_bundle[first + patches.grid.locate(point)])
    }
}

impl Resolution {
    fn check(&self) -> Result<(), BasisError> {
        if !(self.patch_size.is_finite() && self.patch_size > 0.0) {
            return Err(BasisError::PatchSize { value: self.patch_size });
        }
        if self.n_directions != 1 {
            return Err(BasisError::Directions { found: self.n_directions });
        }
        Ok(())
    }
}
