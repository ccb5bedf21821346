//! The scene as paths see it.

use super::super::EstimatorError;
use super::emitters::Emitters;
use crate::basis::{Bundles, Patch};
use crate::geometry::{Frame, Polygon, Tracer, Vec3};
use crate::sampling::{Stream, warp};
use crate::scattering::Brdf;
use crate::scene::{Scene, Side};

/// A scene made ready for paths.
pub(super) struct Stage<'a> {
    pub scene: &'a Scene,
    /// The patch of every bundle.
    pub patches: Vec<&'a Patch>,
    pub tracer: Tracer,
    pub emitters: Emitters,
    /// Of every facet, about the normals of its front and of its back.
    frames: Vec<[Frame; 2]>,
}

/// A point of a path, and the direction in which its light is wanted.
pub(super) struct Vertex<'a> {
    pub facet: usize,
    pub position: Vec3,
    pub frame: &'a Frame,
    pub brdf: &'a dyn Brdf,
    /// Local, unit length.
    pub outgoing: Vec3,
}

impl<'a> Stage<'a> {
    /// Cost O(facets log facets + bundles).
    ///
    /// # Errors
    /// Bundles that are not all on patches of this scene, or emission beyond what can be summed.
    pub fn new(scene: &'a Scene, bundles: &'a Bundles) -> Result<Self, EstimatorError> {
        let n_facets = scene.facets().len();
        let patches = (0..bundles.n_bundles()).map(|bundle| {
            let (element, _) = bundles.element_of(bundle);
            let patch = bundles.patch(element).ok_or(EstimatorError::NotAPatch { element })?;
            let belongs = patch.facet < n_facets && scene.surface_of(patch.facet).brdf(patch.side).is_some();
            let foreign = EstimatorError::ForeignBundles { element, facet: patch.facet, n_facets };
            if belongs { Ok(patch) } else { Err(foreign) }
        });
        let patches = patches.collect::<Result<_, _>>()?;
        let polygons: Vec<&Polygon> = (0..n_facets).map(|facet| scene.polygon(facet)).collect();
        let frames = polygons.iter().map(|p| [Frame::about(p.normal()), Frame::about(-p.normal())]).collect();
        Ok(Self { scene, patches, tracer: Tracer::new(&polygons), emitters: Emitters::new(scene)?, frames })
    }

    /// Where a path starts: uniform in the étendue of a bundle.
    pub fn leave(&self, patch: &Patch, stream: &mut Stream) -> Option<Vertex<'_>> {
        let position = patch.polygon.sample(stream.uniform2());
        let outgoing = warp::cosine_hemisphere(stream.uniform2()).into();
        self.vertex(patch.facet, patch.side, position, outgoing)
    }

    /// A point of a facet's side; `None` where it is black.
    pub fn vertex(&self, facet: usize, side: Side, position: Vec3, outgoing: Vec3) -> Option<Vertex<'_>> {
        let brdf = self.scene.surface_of(facet).brdf(side)?;
        Some(Vertex { facet, position, frame: self.frame(facet, side), brdf, outgoing })
    }

    pub fn frame(&self, facet: usize, side: Side) -> &Frame {
        let [front, back] = &self.frames[facet];
        match side {
            Side::Front => front,
            Side::Back => back,
        }
    }
}
