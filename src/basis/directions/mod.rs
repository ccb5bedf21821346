//! Partitions of the hemisphere into bins of directions.

mod rings;
mod square;

use crate::geometry::Vec3;
use rings::Rings;
use square::Square;
use std::fmt;
use thiserror::Error;

/// A hemisphere of directions about +z, cut into bins.
///
/// Bin b holds the projected solid angle Ω⊥_b = ∫_b cosθ dω, and Σ_b Ω⊥_b = π. Turning everything half a circle about the normal maps
/// bins onto bins, so that a mirror, which sends light from (θ, φ) on to (θ, φ + π), is a permutation of them.
///
/// Directions are unit vectors with z ≥ 0. Borders belong to one of their neighbours.
#[derive(Clone, Debug, PartialEq)]
pub struct Directions {
    name: String,
    cut: Cut,
}

#[derive(Clone, Debug, PartialEq)]
enum Cut {
    Rings(Rings),
    Square(Square),
}

/// Counts that make no partition.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum DirectionsError {
    #[error("a hemisphere cannot be cut into {found} bins: there must be 1 … {limit}")]
    Count { found: usize, limit: usize },
    #[error("rings of {found} sectors are not mapped onto themselves by a mirror: the count must be even")]
    OddSectors { found: usize },
}

impl Directions {
    /// More bins than this on one element are a mistake.
    pub const LIMIT: usize = 1 << 20;

    /// The one bin of the radiosity method.
    pub fn whole() -> Self {
        Self::rings("whole", Rings::new([(0.0, 1)]))
    }

    /// Klems' full basis (1994): 145 bins, 9 rings of polar angle. What windows and blinds are measured in.
    pub fn klems() -> Self {
        let rings =
            [(0.0, 1), (5.0, 8), (15.0, 16), (25.0, 20), (35.0, 24), (45.0, 24), (55.0, 24), (65.0, 16), (75.0, 12)];
        Self::rings("klems", Rings::new(rings))
    }

    /// Klems' half basis: 73 bins.
    pub fn klems_half() -> Self {
        let rings = [(0.0, 1), (6.5, 8), (19.5, 12), (32.5, 16), (46.5, 20), (61.5, 12), (76.5, 4)];
        Self::rings("klems-half", Rings::new(rings))
    }

    /// Klems' quarter basis: 41 bins.
    pub fn klems_quarter() -> Self {
        Self::rings("klems-quarter", Rings::new([(0.0, 1), (9.0, 8), (27.0, 12), (46.0, 12), (66.0, 8)]))
    }

    /// Tregenza's subdivision of the sky (1987): 145 bins of similar solid angle, 8 rings.
    pub fn tregenza() -> Self {
        Self { name: "tregenza".into(), ..Self::reinhart(1).expect("145 bins") }
    }

    /// Reinhart's refinement of it: every ring of Tregenza's cut into `n` rings and every sector into `n`, one cap: 144 n² + 1 bins.
    ///
    /// # Errors
    /// No or too many bins.
    pub fn reinhart(n: usize) -> Result<Self, DirectionsError> {
        const SECTORS: [usize; 7] = [6, 12, 18, 24, 24, 30, 30];
        check_count(n.saturating_mul(n).saturating_mul(144).saturating_add(usize::from(n > 0)))?;
        let height = 90.0 / (7.0 * n as f64 + 0.5);
        let ring = |k: usize| ((k as f64 + 0.5) * height, n * SECTORS[k / n]);
        let rings = std::iter::once((0.0, 1)).chain((0..7 * n).map(ring));
        Ok(Self::rings(&format!("reinhart-{n}"), Rings::new(rings)))
    }

    /// `n_rings` rings of equal projected solid angle, each cut into `n_sectors`.
    ///
    /// # Errors
    /// No or too many bins, or an odd number of sectors above 1.
    pub fn polar(n_rings: usize, n_sectors: usize) -> Result<Self, DirectionsError> {
        check_count(n_rings.saturating_mul(n_sectors))?;
        if n_sectors > 1 && n_sectors % 2 == 1 {
            return Err(DirectionsError::OddSectors { found: n_sectors });
        }
        let edge = |k: usize| (k as f64 / n_rings as f64, n_sectors);
        Ok(Self::rings(&format!("polar-{n_rings}x{n_sectors}"), Rings::of_equal_sectors((0..n_rings).map(edge))))
    }

    /// `n` bins of equal projected solid angle π/n, nearly as wide as they are high: rings in the manner of Beckers & Beckers (2012), with
    /// even counts.
    ///
    /// # Errors
    /// No or too many bins.
    pub fn equal_etendue(n: usize) -> Result<Self, DirectionsError> {
        check_count(n)?;
        Ok(Self::rings(&format!("equal-{n}"), Rings::of_equal_bins(n)))
    }

    /// n × n bins of equal projected solid angle: the squares of a chessboard, mapped to the disk (Shirley & Chiu 1997) and lifted.
    ///
    /// # Errors
    /// No or too many bins.
    pub fn shirley_chiu(n: usize) -> Result<Self, DirectionsError> {
        check_count(n.saturating_mul(n))?;
        Ok(Self { name: format!("shirley-chiu-{n}x{n}"), cut: Cut::Square(Square { n }) })
    }

    fn rings(name: &str, rings: Rings) -> Self {
        Self { name: name.into(), cut: Cut::Rings(rings) }
    }

    pub fn n_bins(&self) -> usize {
        match &self.cut {
            Cut::Rings(rings) => rings.n_bins(),
            Cut::Square(square) => square.n * square.n,
        }
    }

    /// Ω⊥ of a bin, sr; relative error of a few ulp.
    pub fn projected_solid_angle(&self, bin: usize) -> f64 {
        match &self.cut {
            Cut::Rings(rings) => rings.projected_solid_angle(bin),
            Cut::Square(square) => square.projected_solid_angle(),
        }
    }

    /// The bin of a direction. Cost O(log rings).
    pub fn locate(&self, direction: Vec3) -> usize {
        match &self.cut {
            Cut::Rings(rings) => rings.locate(direction),
            Cut::Square(square) => square.locate(direction),
        }
    }

    /// A direction of the bin, with density cosθ/Ω⊥ by solid angle, from two numbers uniform in [0, 1).
    pub fn sample(&self, bin: usize, uniform: [f64; 2]) -> Vec3 {
        match &self.cut {
            Cut::Rings(rings) => rings.sample(bin, uniform),
            Cut::Square(square) => square.sample(bin, uniform),
        }
    }

    /// The bin half a turn about the normal away: where a mirror sends what comes from this one.
    pub fn mirrored(&self, bin: usize) -> usize {
        match &self.cut {
            Cut::Rings(rings) => rings.mirrored(bin),
            Cut::Square(square) => square.n * square.n - 1 - bin,
        }
    }
}

impl fmt::Display for Directions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)
    }
}

fn check_count(found: usize) -> Result<(), DirectionsError> {
    let limit = Directions::LIMIT;
    if (1..=limit).contains(&found) { Ok(()) } else { Err(DirectionsError::Count { found, limit }) }
}
