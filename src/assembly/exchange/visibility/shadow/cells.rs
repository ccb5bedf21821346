//! Convex polygons cut along straight lines.

use crate::geometry::Vec3;

/// Corners closer to a line than this, relative to the size of their polygon, lie on it: thinner slivers carry nothing.
const SLIVER: f64 = 1e-10;

/// Corners no further than this from a plane, relative to the size of their polygon, are left in it: the sides that rounding would make
/// there have no direction.
const GRAIN: f64 = 1e-13;

/// Heights of this polygon's corners over a plane that are none.
pub fn grain(polygon: &[Vec3]) -> f64 {
    GRAIN * polygon.iter().map(|v| v.distance_squared(polygon[0])).fold(0.0, f64::max).sqrt()
}

/// Convex polygons in one allocation.
#[derive(Clone, Default)]
pub struct Pieces {
    corners: Vec<Vec3>,
    ends: Vec<usize>,
}

impl Pieces {
    pub fn clear(&mut self) {
        self.corners.clear();
        self.ends.clear();
    }

    pub fn push(&mut self, corner: Vec3) {
        self.corners.push(corner);
    }

    /// Closes the piece whose corners have been pushed since the last; drops it if it is none.
    pub fn close(&mut self) {
        let start = self.ends.last().copied().unwrap_or(0);
        if self.corners.len() - start >= 3 {
            self.ends.push(self.corners.len());
        } else {
            self.corners.truncate(start);
        }
    }

    pub fn add(&mut self, piece: &[Vec3]) {
        self.corners.extend_from_slice(piece);
        self.close();
    }

    pub fn iter(&self) -> impl Iterator<Item = &[Vec3]> {
        let start = |k: usize| if k == 0 { 0 } else { self.ends[k - 1] };
        self.ends.iter().enumerate().map(move |(k, end)| &self.corners[start(k)..*end])
    }
}

/// Where a linear function vanishes: normal · (x − point) = 0.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    pub normal: Vec3,
    pub point: Vec3,
}

impl Line {
    pub fn at(&self, x: Vec3) -> f64 {
        self.normal.dot(x - self.point)
    }

    /// Heights that count as none: those of a sliver, or what rounding makes of zero. Of a function that vanishes all over the polygon's
    /// plane nothing else is left.
    fn grain(&self, polygon: &[Vec3], slope: f64, size: f64) -> f64 {
        let reach = self.point.distance(polygon[0]) + size;
        let rounding = 8.0 * f64::EPSILON * (reach + self.point.abs().max_element()) * self.normal.length();
        (SLIVER * size * slope).max(rounding)
    }

    /// Where the line enters and leaves a convex polygon, if it crosses it by more than a sliver.
    pub fn chord(&self, polygon: &[Vec3], slope: f64, size: f64) -> Option<[Vec3; 2]> {
        let sliver = self.grain(polygon, slope, size);
        let (mut above, mut below) = (false, false);
        let mut ends = [None; 2];
        let mut from = polygon[polygon.len() - 1];
        let mut height = self.at(from);
        for &to in polygon {
            let next = self.at(to);
            above |= next > sliver;
            below |= next < -sliver;
            if (height > 0.0) != (next > 0.0) {
                let crossing = from + (height / (height - next)) * (to - from);
                ends[usize::from(ends[0].is_some())] = Some(crossing);
            }
            (from, height) = (to, next);
        }
        match ends {
            [Some(first), Some(last)] if above && below => Some([first, last]),
            _ => None,
        }
    }

    /// Adds the one or two parts of a convex polygon on either side.
    pub fn split(&self, polygon: &[Vec3], slope: f64, size: f64, into: &mut Pieces) {
        let sliver = self.grain(polygon, slope, size);
        let (mut above, mut below) = (false, false);
        for v in polygon {
            let height = self.at(*v);
            above |= height > sliver;
            below |= height < -sliver;
        }
        if !(above && below) {
            into.add(polygon);
            return;
        }
        for sign in [1.0, -1.0] {
            self.keep(polygon, sign, sliver, into);
        }
    }

    /// Adds the part where sign · height ≥ 0.
    pub fn keep(&self, polygon: &[Vec3], sign: f64, sliver: f64, into: &mut Pieces) {
        let height_of = |v: Vec3| {
            let height = sign * self.at(v);
            if height.abs() <= sliver { 0.0 } else { height }
        };
        let mut from = polygon[polygon.len() - 1];
        let mut height = height_of(from);
        for &to in polygon {
            let next = height_of(to);
            if height * next < 0.0 {
                into.push(from + (height / (height - next)) * (to - from));
            }
            if next >= 0.0 {
                into.push(to);
            }
            (from, height) = (to, next);
        }
        into.close();
    }
}
