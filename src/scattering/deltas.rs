//! The mirror-like part of a surface.

use crate::geometry::Vec3;
use std::ops::Deref;

/// Light that arrives from one direction alone and leaves toward the outgoing one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Delta {
    /// Where the light comes from, away from the surface, unit length.
    pub incident: Vec3,
    /// The share w in `outgoing radiance = w · incident radiance` (basic radiance where the light crosses the surface).
    pub weight: f64,
}

/// The finite sum of mirror-like terms a surface adds to its smooth part: at most one reflected and one transmitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deltas {
    terms: [Delta; 2],
    n_terms: usize,
}

impl Deltas {
    /// No mirror.
    pub const NONE: Self = Self { terms: [Delta { incident: Vec3::Z, weight: 0.0 }; 2], n_terms: 0 };

    /// Light from the mirrored direction.
    pub fn mirror(outgoing: Vec3, weight: f64) -> Self {
        Self::NONE.with(mirrored(outgoing), weight)
    }

    /// These and one more. A surface joins two media, and each has one direction: light from the side of one that is there already is
    /// added to it.
    #[must_use]
    pub fn with(mut self, incident: Vec3, weight: f64) -> Self {
        let above = incident.z > 0.0;
        match self.terms[..self.n_terms].iter_mut().find(|term| (term.incident.z > 0.0) == above) {
            Some(term) => term.weight += weight,
            None => {
                self.terms[self.n_terms] = Delta { incident, weight };
                self.n_terms += 1;
            }
        }
        self
    }

    /// Σ of the weights: the mirror-like share of the directional albedo.
    pub fn weight(&self) -> f64 {
        self.iter().map(|term| term.weight).sum()
    }
}

impl Deref for Deltas {
    type Target = [Delta];

    fn deref(&self) -> &[Delta] {
        &self.terms[..self.n_terms]
    }
}

/// The direction a mirror would send this one's light to; both point away from the surface.
pub(super) fn mirrored(direction: Vec3) -> Vec3 {
    Vec3::new(-direction.x, -direction.y, direction.z)
}
