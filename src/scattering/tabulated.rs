//! Measured surfaces: a table of f over pairs of direction patches.

use super::Brdf;
use crate::geometry::Vec3;
use crate::sampling::mix;
use std::f64::consts::{PI, TAU};
use thiserror::Error;

/// Patches of the hemisphere: rings of polar angle, each cut into equal sectors, the first of them centred on azimuth 0.
#[derive(Clone, Debug, PartialEq)]
pub struct PatchRings {
    /// sin² of the polar angle at the edges, from 0 to 1.
    edges: Vec<f64>,
    /// Sectors of each ring.
    n_sectors: Vec<usize>,
    /// Number of the first patch of each ring, and the number of patches.
    first: Vec<usize>,
}

/// A table that is none.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum TableError {
    #[error("polar angles must rise from above 0 to 90 degrees, ring {ring} ends at {degrees}")]
    Rings { ring: usize, degrees: f64 },
    #[error("ring {ring} has no sector")]
    NoSector { ring: usize },
    #[error("band {band} has {found} values, {expected} are needed: patches squared")]
    Length { band: usize, found: usize, expected: usize },
    #[error("band {band} has {value:e} from patch {incident} to patch {outgoing}, must be finite and not negative")]
    Value { band: usize, incident: usize, outgoing: usize, value: f64 },
    #[error("there is no band")]
    NoBand,
    #[error("the table breaks laws: {0}")]
    Unlawful(Violations),
}

/// By how much a table breaks the laws of a BRDF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Violations {
    /// max |f(i, o) − f(o, i)| over pairs and bands, over the largest f.
    pub reciprocity: f64,
    /// The largest directional albedo.
    pub albedo: f64,
}

impl std::fmt::Display for Violations {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { reciprocity, albedo } = self;
        write!(out, "reciprocity is off by {reciprocity:.3e} of the largest value, the largest albedo is {albedo:.6}")
    }
}

impl Violations {
    /// Whether nothing is broken, but for rounding.
    pub fn is_lawful(&self) -> bool {
        self.reciprocity == 0.0 && self.albedo <= 1.0 + 1e-12
    }
}

impl PatchRings {
    /// Rings by the polar angle in degrees at which each ends, and its number of sectors.
    ///
    /// # Errors
    /// Angles that do not rise to 90 degrees, a ring without sectors.
    pub fn new(rings: &[(f64, usize)]) -> Result<Self, TableError> {
        let mut before = 0.0;
        for (ring, &(degrees, n_sectors)) in rings.iter().enumerate() {
            let rises = degrees > before && degrees <= 90.0 && ((ring + 1 == rings.len()) == (degrees == 90.0));
            if !rises {
                return Err(TableError::Rings { ring, degrees });
            }
            if n_sectors == 0 {
                return Err(TableError::NoSector { ring });
            }
            before = degrees;
        }
        if rings.is_empty() {
            return Err(TableError::Rings { ring: 0, degrees: 0.0 });
        }
        Ok(Self::of(rings))
    }

    /// Klems' (1994) 145 patches, the "full" basis of WINDOW and Radiance.
    pub fn klems_full() -> Self {
        Self::of(&[
            (5.0, 1),
            (15.0, 8),
            (25.0, 16),
            (35.0, 20),
            (45.0, 24),
            (55.0, 24),
            (65.0, 24),
            (75.0, 16),
            (90.0, 12),
        ])
    }

    /// The "half" basis of 73 patches.
    pub fn klems_half() -> Self {
        Self::of(&[(6.5, 1), (19.5, 8), (32.5, 12), (46.5, 16), (61.5, 20), (76.5, 12), (90.0, 4)])
    }

    /// The "quarter" basis of 41 patches.
    pub fn klems_quarter() -> Self {
        Self::of(&[(9.0, 1), (27.0, 8), (46.0, 12), (66.0, 12), (90.0, 8)])
    }

    fn of(rings: &[(f64, usize)]) -> Self {
        let mut first = vec![0];
        first.extend(rings.iter().scan(0, |sum, ring| {
            *sum += ring.1;
            Some(*sum)
        }));
        let ends = rings.iter().map(|ring| if ring.0 == 90.0 { 1.0 } else { ring.0.to_radians().sin().powi(2) });
        let edges = std::iter::once(0.0).chain(ends).collect();
        Self { edges, n_sectors: rings.iter().map(|ring| ring.1).collect(), first }
    }

    /// Number of patches.
    pub fn n_patches(&self) -> usize {
        self.first[self.n_sectors.len()]
    }

    /// The patch of a direction above the horizon.
    pub fn find(&self, direction: Vec3) -> usize {
        let squared = direction.x * direction.x + direction.y * direction.y;
        let ring = self.edges[1..].partition_point(|edge| *edge <= squared).min(self.n_sectors.len() - 1);
        let n = self.n_sectors[ring];
        let turn = direction.y.atan2(direction.x) / TAU;
        self.first[ring] + ((turn * n as f64 + 0.5).floor() as i64).rem_euclid(n as i64) as usize
    }

    /// ∫ cosθ dω over a patch; over all of them it is π.
    pub fn projected_solid_angle(&self, patch: usize) -> f64 {
        let ring = self.ring(patch);
        PI * (self.edges[ring + 1] - self.edges[ring]) / self.n_sectors[ring] as f64
    }

    /// A direction of a patch, uniform in projected solid angle.
    fn sample(&self, patch: usize, [u, v]: [f64; 2]) -> Vec3 {
        let ring = self.ring(patch);
        let squared = self.edges[ring] + (self.edges[ring + 1] - self.edges[ring]) * u;
        let sector = (patch - self.first[ring]) as f64;
        let (sin, cos) = (TAU * (sector - 0.5 + v) / self.n_sectors[ring] as f64).sin_cos();
        let radius = squared.sqrt();
        Vec3::new(radius * cos, radius * sin, (1.0 - squared).max(0.0).sqrt())
    }

    fn ring(&self, patch: usize) -> usize {
        self.first[1..].partition_point(|first| *first <= patch)
    }
}

/// f constant over pairs of patches, as WINDOW's and Radiance's matrices (Klems 1994) have it: reflection from one side.
///
/// Albedos are exact sums of f over projected solid angles. Samples a patch by its share of the light of all bands, then its projected
/// solid angle.
#[derive(Clone, Debug, PartialEq)]
pub struct Tabulated {
    name: String,
    patches: PatchRings,
    /// Of each band f (incident, outgoing), the outgoing patch's row first.
    values: Vec<Vec<f64>>,
    /// Of each outgoing patch, the share of light from patches up to each.
    cumulative: Vec<f64>,
}

impl Tabulated {
    /// A table that keeps every law.
    ///
    /// # Errors
    /// Values that are negative or not finite or too few, and broken laws, with their numbers: see [`Tabulated::symmetrised`].
    pub fn new(name: &str, patches: PatchRings, values: Vec<Vec<f64>>) -> Result<Self, TableError> {
        let table = Self::as_measured(name, patches, values)?;
        let violations = table.violations();
        if violations.is_lawful() { Ok(table) } else { Err(TableError::Unlawful(violations)) }
    }

    /// A table as it is, whatever law it breaks. For each band f in sr⁻¹, n_patches² values, the row of the outgoing patch first.
    ///
    /// # Errors
    /// Values that are negative or not finite or too few.
    pub fn as_measured(name: &str, patches: PatchRings, values: Vec<Vec<f64>>) -> Result<Self, TableError> {
        let n = patches.n_patches();
        if values.is_empty() {
            return Err(TableError::NoBand);
        }
        for (band, table) in values.iter().enumerate() {
            if table.len() != n * n {
                return Err(TableError::Length { band, found: table.len(), expected: n * n });
            }
            if let Some((k, &value)) = table.iter().enumerate().find(|(_, f)| !(f.is_finite() && **f >= 0.0)) {
                return Err(TableError::Value { band, incident: k % n, outgoing: k / n, value });
            }
        }
        let cumulative = (0..n).flat_map(|outgoing| row_shares(&patches, &values, outgoing)).collect();
        Ok(Self { name: name.to_string(), patches, values, cumulative })
    }

    /// The table with f(i, o) and f(o, i) replaced by their mean, which no measurement tells apart.
    #[must_use]
    pub fn symmetrised(self) -> Self {
        let n = self.patches.n_patches();
        let Self { name, patches, mut values, .. } = self;
        for table in &mut values {
            for i in 0..n {
                for o in 0..i {
                    let mean = 0.5 * (table[o * n + i] + table[i * n + o]);
                    (table[o * n + i], table[i * n + o]) = (mean, mean);
                }
            }
        }
        let cumulative = (0..n).flat_map(|outgoing| row_shares(&patches, &values, outgoing)).collect();
        Self { name, patches, values, cumulative }
    }

    /// By how much it breaks the laws. Cost O(bands · patches²).
    pub fn violations(&self) -> Violations {
        let n = self.patches.n_patches();
        let mut violations = Violations { reciprocity: 0.0, albedo: 0.0 };
        let largest = self.values.iter().flatten().fold(0.0, |max: f64, f| max.max(*f));
        for (band, table) in self.values.iter().enumerate() {
            for o in 0..n {
                violations.albedo = violations.albedo.max(self.patch_albedo(band, o));
                for i in 0..o {
                    let difference = (table[o * n + i] - table[i * n + o]).abs();
                    violations.reciprocity = violations.reciprocity.max(difference / largest);
                }
            }
        }
        violations
    }

    fn patch_albedo(&self, band: usize, outgoing: usize) -> f64 {
        let n = self.patches.n_patches();
        let row = &self.values[band][outgoing * n..][..n];
        row.iter().enumerate().map(|(i, f)| f * self.patches.projected_solid_angle(i)).sum()
    }
}

/// The shares of light that arrive from patches up to each and leave toward one; zeros where there is none.
fn row_shares(patches: &PatchRings, values: &[Vec<f64>], outgoing: usize) -> Vec<f64> {
    let n = patches.n_patches();
    let mut sum = 0.0;
    let mut shares: Vec<f64> = (0..n)
        .map(|incident| {
            let light: f64 = values.iter().map(|table| table[outgoing * n + incident]).sum();
            sum += light * patches.projected_solid_angle(incident);
            sum
        })
        .collect();
    if sum > 0.0 {
        shares.iter_mut().for_each(|share| *share /= sum);
    }
    shares
}

impl Brdf for Tabulated {
    fn n_bands(&self) -> usize {
        self.values.len()
    }

    fn eval(&self, band: usize, incident: Vec3, outgoing: Vec3) -> f64 {
        if incident.z <= 0.0 || outgoing.z <= 0.0 {
            return 0.0;
        }
        let [i, o] = [incident, outgoing].map(|direction| self.patches.find(direction));
        self.values[band][o * self.patches.n_patches() + i]
    }

    fn sample(&self, outgoing: Vec3, [u, v]: [f64; 2]) -> Option<Vec3> {
        if outgoing.z <= 0.0 {
            return None;
        }
        let n = self.patches.n_patches();
        let shares = &self.cumulative[self.patches.find(outgoing) * n..][..n];
        let patch = shares.partition_point(|share| *share <= u);
        if patch == n {
            return None;
        }
        let below = if patch == 0 { 0.0 } else { shares[patch - 1] };
        let rest = ((u - below) / (shares[patch] - below)).clamp(0.0, 1.0 - f64::EPSILON);
        let incident = self.patches.sample(patch, [rest, v]);
        (incident.z > 0.0).then_some(incident)
    }

    fn pdf(&self, outgoing: Vec3, incident: Vec3) -> f64 {
        if incident.z <= 0.0 || outgoing.z <= 0.0 {
            return 0.0;
        }
        let [i, o] = [incident, outgoing].map(|direction| self.patches.find(direction));
        let shares = &self.cumulative[o * self.patches.n_patches()..];
        let below = if i == 0 { 0.0 } else { shares[i - 1] };
        (shares[i] - below) * incident.z / self.patches.projected_solid_angle(i)
    }

    fn albedo(&self, band: usize, outgoing: Vec3) -> f64 {
        if outgoing.z > 0.0 { self.patch_albedo(band, self.patches.find(outgoing)) } else { 0.0 }
    }

    fn lambertian(&self) -> Option<&[f64]> {
        None
    }

    fn description(&self) -> String {
        let bits: Vec<u64> = self.values.iter().flatten().map(|f| f.to_bits()).collect();
        let (rings, digest) = (&self.patches, mix(&bits));
        format!("tabulated {:?} bands={} {rings:?} digest={digest:016x}", self.name, self.values.len())
    }
}
