//! A named thing made of polygons, with what its two sides do to light.

use crate::geometry::Polygon;
use crate::scattering::Brdf;
use std::sync::Arc;

/// One side of a polygon. The front is the side from which its vertices run counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Side {
    Front,
    Back,
}

/// A named surface. Every surface is opaque: a ray ends where it meets either side.
#[derive(Clone, Debug)]
pub struct Surface {
    pub name: String,
    pub polygons: Vec<Polygon>,
    /// What the front does to light.
    pub front: Arc<dyn Brdf>,
    /// What the back does to light; `None` is the black back of a one-sided surface.
    pub back: Option<Arc<dyn Brdf>>,
    /// Radiance emitted by the front, one value a band, W m⁻² sr⁻¹. Backs do not emit.
    pub emission: Vec<f64>,
    /// Set where the polygons stand for a curved shape.
    pub tessellation: Option<Tessellation>,
}

/// How a curved shape was replaced by polygons: named in every result, for it is an approximation.
#[derive(Clone, Debug, PartialEq)]
pub struct Tessellation {
    /// "sphere", "disk", "cylinder".
    pub shape: &'static str,
    pub n_polygons: usize,
    /// Largest distance between the shape and its polygons, in metres.
    pub deviation: f64,
}

impl Surface {
    /// What one side does to light; `None` where it is black.
    pub fn brdf(&self, side: Side) -> Option<&dyn Brdf> {
        match side {
            Side::Front => Some(&*self.front),
            Side::Back => self.back.as_deref(),
        }
    }

    /// Radiance emitted by one side in one band.
    pub fn emitted(&self, side: Side, band: usize) -> f64 {
        match side {
            Side::Front => self.emission[band],
            Side::Back => 0.0,
        }
    }

    /// Sum of the areas of the polygons, m².
    pub fn area(&self) -> f64 {
        self.polygons.iter().map(Polygon::area).sum()
    }
}
