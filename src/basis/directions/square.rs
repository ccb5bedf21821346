//! A chessboard, mapped to the disk and lifted to the hemisphere.

use crate::geometry::Vec3;
use crate::sampling::warp;
use std::f64::consts::PI;

/// n × n bins, row by row.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Square {
    pub n: usize,
}

impl Square {
    pub fn projected_solid_angle(&self) -> f64 {
        PI / (self.n * self.n) as f64
    }

    pub fn locate(&self, direction: Vec3) -> usize {
        let [column, row] = warp::disk_inverse([direction.x, direction.y])
            .map(|u| ((u * self.n as f64).max(0.0) as usize).min(self.n - 1));
        row * self.n + column
    }

    pub fn sample(&self, bin: usize, [u, v]: [f64; 2]) -> Vec3 {
        let (row, column) = (bin / self.n, bin % self.n);
        warp::cosine_hemisphere([(column as f64 + u) / self.n as f64, (row as f64 + v) / self.n as f64]).into()
    }
}
