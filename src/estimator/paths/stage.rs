//! The scene as paths see it.

use super::super::EstimatorError;
use super::super::bounces::Columns;
use super::emitters::Emitters;
use super::reflection::Reflection;
use super::white;
use crate::basis::{Bundles, Patch};
use crate::geometry::{Frame, Hit, Polygon, Ray, Tracer, Vec3};
use crate::linalg::Block;
use crate::sampling::{Stream, warp};
use crate::scene::{Scene, Side};

/// A scene made ready for paths.
pub(super) struct Stage<'a> {
    pub scene: &'a Scene,
    pub bundles: &'a Bundles,
    /// The patch of every bundle.
    pub patches: Vec<&'a Patch>,
    pub tracer: Tracer,
    pub emitters: Emitters<'a>,
    /// Front and back of every facet.
    faces: Vec<[Face<'a>; 2]>,
}

/// One side of a facet.
pub(super) struct Face<'a> {
    pub frame: Frame,
    /// `None` where it is black.
    pub reflection: Option<Reflection<'a>>,
}

/// A point of a path, and the direction that the path comes from: the one in which light is wanted, or in which it arrives.
#[derive(Clone, Copy)]
pub(super) struct Vertex<'a> {
    pub facet: usize,
    pub side: Side,
    pub position: Vec3,
    pub frame: &'a Frame,
    pub reflection: &'a Reflection<'a>,
    /// Local, unit length.
    pub given: Vec3,
}

/// Where a ray ends.
pub(super) struct Arrival {
    pub facet: usize,
    pub side: Side,
    pub position: Vec3,
    pub distance: f64,
    /// Back along the ray: local, unit length.
    pub given: Vec3,
}

impl<'a> Stage<'a> {
    /// Cost O(facets log facets + bundles).
    ///
    /// # Errors
    /// Bundles that are not all on patches of this scene, emission beyond what can be summed, a closed part that absorbs nothing.
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
        let face = |facet: usize, side, normal| Face {
            frame: Frame::about(normal),
            reflection: scene.surface_of(facet).brdf(side).map(Reflection::new),
        };
        let faces = polygons.iter().map(|polygon| polygon.normal()).enumerate();
        let faces = faces.map(|(k, normal)| [face(k, Side::Front, normal), face(k, Side::Back, -normal)]).collect();
        let emitters = Emitters::new(scene)?;
        let stage = Self { scene, bundles, patches, tracer: Tracer::new(&polygons), emitters, faces };
        match white::closed_part(&stage) {
            Some(bundle) => Err(EstimatorError::NeverEnds { bundle }),
            None => Ok(stage),
        }
    }

    /// Where a path starts: uniform in the étendue of a bundle.
    #[inline]
    pub fn leave(&self, patch: &Patch, stream: &mut Stream) -> Option<Vertex<'_>> {
        let position = patch.polygon.sample(stream.uniform2());
        let given = warp::cosine_hemisphere(stream.uniform2()).into();
        let face = self.face(patch.facet, patch.side);
        let reflection = face.reflection.as_ref()?;
        Some(Vertex { facet: patch.facet, side: patch.side, position, frame: &face.frame, reflection, given })
    }

    /// What every bundle emits, n × columns.
    pub fn emitted(&self, columns: Columns) -> Block {
        let mut emitted = Block::zeros(self.patches.len(), columns.count());
        let Some(here) = columns.of(0) else { return emitted };
        for (bundle, patch) in self.patches.iter().enumerate() {
            let emission = here.clone().zip(self.emission(patch.facet, patch.side));
            emission.for_each(|(column, emission)| emitted.set(bundle, column, *emission));
        }
        emitted
    }

    /// Follows a ray from a point of a facet to the first surface; `None` where it leaves the scene.
    #[inline]
    pub fn follow(&self, facet: usize, position: Vec3, direction: Vec3) -> Option<Arrival> {
        let ray = Ray { origin: position, direction };
        let Hit { polygon, t, front } = self.tracer.closest(&ray, Some(facet))?;
        let side = if front { Side::Front } else { Side::Back };
        let given = self.face(polygon, side).frame.to_local(-direction);
        Some(Arrival { facet: polygon, side, position: ray.at(t), distance: t, given })
    }

    /// The vertex where a ray ends; `None` on what is black.
    #[inline]
    pub fn vertex(&self, arrival: &Arrival) -> Option<Vertex<'_>> {
        let Arrival { facet, side, position, given, .. } = *arrival;
        let face = self.face(facet, side);
        let reflection = face.reflection.as_ref()?;
        Some(Vertex { facet, side, position, frame: &face.frame, reflection, given })
    }

    /// The bundle that light leaving a vertex belongs to.
    #[inline]
    pub fn locate(&self, vertex: &Vertex<'_>) -> Option<usize> {
        let direction = vertex.frame.to_world(vertex.given);
        self.bundles.locate(vertex.facet, vertex.side, vertex.position, direction)
    }

    /// Radiance emitted by a side, one value a band; empty where it is dark.
    #[inline]
    pub fn emission(&self, facet: usize, side: Side) -> &'a [f64] {
        match side {
            Side::Front => &self.scene.surface_of(facet).emission,
            Side::Back => &[],
        }
    }

    #[inline]
    pub fn face(&self, facet: usize, side: Side) -> &Face<'a> {
        let [front, back] = &self.faces[facet];
        match side {
            Side::Front => front,
            Side::Back => back,
        }
    }
}
