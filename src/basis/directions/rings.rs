//! Rings of polar angle, each cut into equal sectors.

use crate::geometry::Vec3;
use std::f64::consts::{PI, TAU};

/// The first sector of every ring is centred on +x; a ring of one sector is a cap or a whole belt.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Rings {
    /// sin²θ at the inner edge of each ring, rising from 0, and 1 at the end.
    edges: Vec<f64>,
    /// First bin of each ring, and the number of bins at the end.
    first: Vec<usize>,
}

impl Rings {
    /// From the polar angle at each inner edge, in degrees, and the number of sectors.
    pub fn new(rings: impl IntoIterator<Item = (f64, usize)>) -> Self {
        Self::of_equal_sectors(rings.into_iter().map(|(degrees, n)| (degrees.to_radians().sin().powi(2), n)))
    }

    /// From sin²θ at each inner edge and the number of sectors.
    pub fn of_equal_sectors(rings: impl IntoIterator<Item = (f64, usize)>) -> Self {
        let (mut edges, mut first) = (Vec::new(), vec![0]);
        for (edge, n_sectors) in rings {
            edges.push(edge);
            first.push(first[first.len() - 1] + n_sectors);
        }
        edges.push(1.0);
        Self { edges, first }
    }

    /// n bins of π/n each.
    ///
    /// The disk inside a ring holds k of them within radius √(k/n), in units where a bin's area is π/n. A ring as high as its sectors are
    /// wide leaves (√k − √π)² inside; rounded so that what the ring takes is even.
    pub fn of_equal_bins(n: usize) -> Self {
        let mut inside = vec![n];
        let mut k = n;
        while k > 1 {
            let target = (k as f64).sqrt() - PI.sqrt();
            let inner = if target > 0.0 { (target * target).round() as usize } else { 0 };
            k = if (k - inner).is_multiple_of(2) { inner } else { (inner + 1).min(k - 1) };
            inside.push(k);
        }
        if k == 1 {
            inside.push(0);
        }
        inside.reverse();
        Self::of_equal_sectors(inside.windows(2).map(|pair| (pair[0] as f64 / n as f64, pair[1] - pair[0])))
    }

    pub fn n_bins(&self) -> usize {
        self.first[self.first.len() - 1]
    }

    pub fn projected_solid_angle(&self, bin: usize) -> f64 {
        let (ring, _) = self.place(bin);
        PI * (self.edges[ring + 1] - self.edges[ring]) / self.n_sectors(ring) as f64
    }

    pub fn locate(&self, direction: Vec3) -> usize {
        let squared = direction.x * direction.x + direction.y * direction.y;
        let inner_edges = &self.edges[1..self.edges.len() - 1];
        let ring = inner_edges.partition_point(|edge| *edge <= squared);
        let n_sectors = self.n_sectors(ring);
        let turn = direction.y.atan2(direction.x) / TAU;
        let sector = (turn * n_sectors as f64 + 0.5).floor().rem_euclid(n_sectors as f64) as usize;
        self.first[ring] + sector.min(n_sectors - 1)
    }

    pub fn sample(&self, bin: usize, [u, v]: [f64; 2]) -> Vec3 {
        let (ring, sector) = self.place(bin);
        let squared = self.edges[ring] + (self.edges[ring + 1] - self.edges[ring]) * u;
        let (sin, cos) = (TAU * (sector as f64 - 0.5 + v) / self.n_sectors(ring) as f64).sin_cos();
        let sine = squared.sqrt();
        Vec3::new(sine * cos, sine * sin, (1.0 - squared).max(0.0).sqrt())
    }

    pub fn mirrored(&self, bin: usize) -> usize {
        let (ring, sector) = self.place(bin);
        let n_sectors = self.n_sectors(ring);
        self.first[ring] + (sector + n_sectors / 2) % n_sectors
    }

    /// The ring of a bin and its sector there.
    fn place(&self, bin: usize) -> (usize, usize) {
        let ring = self.first.partition_point(|first| *first <= bin) - 1;
        (ring, bin - self.first[ring])
    }

    fn n_sectors(&self, ring: usize) -> usize {
        self.first[ring + 1] - self.first[ring]
    }
}
