//! Convex obstacles: what a ray has to pass is asked of their outline, not of every facet.

use super::cells::{Line, Pieces, grain};
use crate::geometry::{Vec3, height};

/// A convex polyhedron, or a flat convex polygon, which is one with two opposite faces.
#[derive(Clone, Debug)]
pub struct Body {
    /// Planes of its faces, normals outward.
    pub faces: Vec<Plane>,
    pub rims: Vec<Rim>,
    /// The rims of every face.
    rims_of: Vec<Vec<u32>>,
    pub corners: Vec<Vec3>,
    /// A ball around the corners.
    pub centre: Vec3,
    pub radius: f64,
    /// The face that is not there: the opening of a body that stands on something.
    pub opening: Option<usize>,
}

/// An oriented plane.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    pub normal: Vec3,
    pub point: Vec3,
}

/// An edge between two faces, counter-clockwise about the first.
#[derive(Clone, Copy, Debug)]
pub struct Rim {
    pub from: Vec3,
    pub to: Vec3,
    pub faces: [u32; 2],
}

/// How a polygon lies to a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lie {
    /// Somewhere above, nowhere below.
    Above,
    /// Nowhere above.
    Below,
    /// On both sides.
    Across,
}

impl Plane {
    /// Signed height of a point, zero within rounding.
    pub fn height(&self, point: Vec3) -> f64 {
        height(self.normal, self.point, point)
    }

    pub fn lie(&self, corners: &[Vec3]) -> Lie {
        let (mut above, mut below) = (false, false);
        for corner in corners {
            let height = self.height(*corner);
            above |= height > 0.0;
            below |= height < 0.0;
        }
        match (above, below) {
            (true, true) => Lie::Across,
            (true, false) => Lie::Above,
            (false, _) => Lie::Below,
        }
    }
}

impl Body {
    /// A flat body: a convex outline, counter-clockwise about the normal.
    pub fn flat(mut outline: Vec<Vec3>, normal: Vec3) -> Option<Self> {
        straighten(&mut outline);
        if outline.len() < 3 {
            return None;
        }
        let plane = Plane { normal, point: outline[0] };
        let rims = (0..outline.len())
            .map(|k| Rim { from: outline[k], to: outline[(k + 1) % outline.len()], faces: [0, 1] })
            .collect();
        Some(Self::new(vec![plane, Plane { normal: -normal, ..plane }], rims, outline, None))
    }

    /// A body of these faces and edges.
    pub fn new(faces: Vec<Plane>, rims: Vec<Rim>, corners: Vec<Vec3>, opening: Option<usize>) -> Self {
        let centre = corners.iter().copied().sum::<Vec3>() / corners.len() as f64;
        let radius = corners.iter().map(|v| v.distance(centre)).fold(0.0, f64::max);
        let mut rims_of = vec![Vec::new(); faces.len()];
        for (number, rim) in rims.iter().enumerate() {
            rim.faces.iter().for_each(|face| rims_of[*face as usize].push(number as u32));
        }
        Self { faces, rims, rims_of, corners, centre, radius, opening }
    }

    /// The edges of a face, counter-clockwise about it.
    pub fn edges_of(&self, face: usize) -> impl Iterator<Item = (Vec3, Vec3)> {
        self.rims_of[face].iter().map(move |&number| {
            let rim = &self.rims[number as usize];
            if rim.faces[0] as usize == face { (rim.from, rim.to) } else { (rim.to, rim.from) }
        })
    }

    /// True if some of a polygon lies inside.
    pub fn holds(&self, polygon: &[Vec3]) -> bool {
        let (mut inside, mut spare) = (Pieces::default(), Pieces::default());
        inside.add(polygon);
        for face in &self.faces {
            spare.clear();
            let line = Line { normal: face.normal, point: face.point };
            for piece in inside.iter() {
                if face.lie(piece) != Lie::Below {
                    line.keep(piece, -1.0, grain(piece), &mut spare);
                } else {
                    spare.add(piece);
                }
            }
            std::mem::swap(&mut inside, &mut spare);
        }
        inside.iter().next().is_some()
    }

    /// True if no corner lies above the plane.
    pub fn is_behind(&self, plane: &Plane) -> bool {
        // Ask the ball first, leaving rounding to the corners.
        if plane.normal.dot(self.centre - plane.point) > self.radius * (1.0 + 1e-9) {
            return false;
        }
        self.corners.iter().all(|v| plane.height(*v) <= 0.0)
    }

    /// True if the polygon, with this normal, is outside: beyond some face, or on it and facing away, or with the whole body before it.
    pub fn excludes(&self, polygon: &[Vec3], normal: Vec3) -> bool {
        if self.corners.iter().all(|v| height(normal, polygon[0], *v) > 0.0) {
            return true;
        }
        self.faces.iter().any(|face| {
            let heights = || polygon.iter().map(|v| face.height(*v));
            heights().all(|h| h >= 0.0) && (heights().any(|h| h > 0.0) || normal.dot(face.normal) > 0.0)
        })
    }
}

/// Drops corners on the line between their neighbours: what is left of cutting a face into patches.
pub fn straighten(outline: &mut Vec<Vec3>) {
    let mut k = 0;
    while outline.len() > 3 && k < outline.len() {
        let n = outline.len();
        let (before, here, after) = (outline[(k + n - 1) % n], outline[k], outline[(k + 1) % n]);
        let sine = (here - before).cross(after - here).length();
        if sine <= STRAIGHT * here.distance(before) * after.distance(here) {
            outline.remove(k);
            k = k.saturating_sub(1);
        } else {
            k += 1;
        }
    }
}

/// Sine of an angle that is none: some ulp of coordinates a thousand lengths away.
const STRAIGHT: f64 = 1e-12;
