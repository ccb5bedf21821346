//! Measured isotropic surfaces: a table over half and difference angles.

use super::Brdf;
use super::parameter::{Examination, ParameterError};
use super::quadrature::{Quadrature, gauss_legendre};
use crate::geometry::Vec3;
use crate::sampling::{mix, warp};
use std::f64::consts::{FRAC_PI_2, PI};

/// f constant over cells of (θ_h, θ_d, φ_d), the layout of the MERL files (Matusik et al. 2003):
///
/// ```text
/// h = (i + o)/|i + o|,   θ_h = 90° (cell/n_θh)²,   cos θ_d = i·h,   φ_d of (i − o)/2 about h, modulo 180°
/// ```
///
/// Reciprocal by its coordinates: the other way round φ_d turns by 180°. Whether it conserves energy is the measurement's affair: see
/// [`HalfDifferenceTable::largest_albedo`]. Samples the cosine. Source: Rusinkiewicz 1998.
#[derive(Clone, Debug, PartialEq)]
pub struct HalfDifferenceTable {
    name: String,
    n_cells: [usize; 3],
    values: Vec<Vec<f64>>,
}

impl HalfDifferenceTable {
    /// Numbers of cells in θ_h, θ_d and φ_d of the MERL files.
    pub const MERL: [usize; 3] = [90, 90, 180];

    /// For each band f in sr⁻¹, φ_d running fastest, then θ_d.
    ///
    /// # Errors
    /// No cell along an axis, no band or too few values, a value that is negative or not finite.
    pub fn new(name: &str, n_cells: [usize; 3], values: Vec<Vec<f64>>) -> Result<Self, ParameterError> {
        let examine = Examination("half-difference table");
        examine.within("number of bands", values.len() as f64, 1.0..=f64::MAX, "at least 1")?;
        for (axis, n) in ["cells in theta_h", "cells in theta_d", "cells in phi_d"].into_iter().zip(n_cells) {
            examine.within(axis, n as f64, 1.0..=1e6, "within [1, 1e6]")?;
        }
        let n: usize = n_cells.iter().product();
        for band in &values {
            examine.within(
                "number of values",
                band.len() as f64,
                n as f64..=n as f64,
                "the product of the numbers of cells",
            )?;
            band.iter().try_for_each(|f| examine.within("f", *f, 0.0..=f64::MAX, "finite and not negative"))?;
        }
        Ok(Self { name: name.to_string(), n_cells, values })
    }

    /// The largest of the albedos at 32 cosines in all bands; above 1 the surface makes light.
    pub fn largest_albedo(&self) -> f64 {
        let cosines = (0..32).map(|k| (f64::from(k) + 0.5) / 32.0);
        let albedos = cosines.flat_map(|cosine| {
            let outgoing = Vec3::from(warp::around_z(cosine, 0.0));
            (0..self.n_bands()).map(move |band| self.albedo(band, outgoing))
        });
        albedos.fold(0.0, f64::max)
    }

    /// The directional albedo by a product rule of 96² directions, and how much it differs from that of 48²: a table of steps lets no rule
    /// converge fast.
    pub fn albedo_with_error(&self, band: usize, outgoing: Vec3) -> Quadrature {
        if outgoing.z <= 0.0 {
            return Quadrature::ZERO;
        }
        let [coarse, value] = [48, 96].map(|n| {
            let rule = gauss_legendre(n);
            let turns = (0..n).map(|k| (k as f64 + 0.5) / n as f64);
            let at = |u: f64, turn| self.eval(band, warp::around_z((1.0 - u).sqrt(), turn).into(), outgoing);
            let ring = |turn| rule.iter().map(|(u, weight)| weight * at(*u, turn)).sum::<f64>();
            turns.map(|turn| PI * ring(turn) / n as f64).sum::<f64>()
        });
        Quadrature { value, error: (value - coarse).abs() }
    }

    /// The cell of a pair of directions above the horizon, the same both ways to the bit.
    fn cell(&self, incident: Vec3, outgoing: Vec3) -> usize {
        let (sum, difference) = (incident + outgoing, incident - outgoing);
        let half = sum.normalize();
        let [n_half, n_difference, n_turn] = self.n_cells;
        let index = |fraction: f64, n: usize| ((fraction * n as f64) as usize).min(n - 1);
        let theta_half = half.z.clamp(0.0, 1.0).acos();
        let theta_difference = difference.length().atan2(sum.length());

        // Axes about h: across in the plane of the normal (any, at the normal itself), and beside it.
        let radius = half.x.hypot(half.y);
        let (x, y) = if radius > 0.0 { (half.x / radius, half.y / radius) } else { (1.0, 0.0) };
        let along = difference.dot(Vec3::new(x * half.z, y * half.z, -radius));
        let beside = difference.dot(Vec3::new(-y, x, 0.0));
        let (along, beside) =
            if beside < 0.0 || (beside == 0.0 && along < 0.0) { (-along, -beside) } else { (along, beside) };
        let turn = beside.abs().atan2(along) / PI;
        let row = index((theta_half / FRAC_PI_2).sqrt(), n_half) * n_difference
            + index(theta_difference / FRAC_PI_2, n_difference);
        row * n_turn + index(turn, n_turn)
    }
}

impl Brdf for HalfDifferenceTable {
    fn n_bands(&self) -> usize {
        self.values.len()
    }

    fn eval(&self, band: usize, incident: Vec3, outgoing: Vec3) -> f64 {
        if incident.z <= 0.0 || outgoing.z <= 0.0 {
            return 0.0;
        }
        self.values[band][self.cell(incident, outgoing)]
    }

    fn sample(&self, outgoing: Vec3, uniform: [f64; 2]) -> Option<Vec3> {
        (outgoing.z > 0.0).then(|| warp::cosine_hemisphere(uniform).into())
    }

    fn pdf(&self, outgoing: Vec3, incident: Vec3) -> f64 {
        if outgoing.z > 0.0 { warp::cosine_hemisphere_pdf(incident.to_array()) } else { 0.0 }
    }

    fn albedo(&self, band: usize, outgoing: Vec3) -> f64 {
        self.albedo_with_error(band, outgoing).value
    }

    fn lambertian(&self) -> Option<&[f64]> {
        None
    }

    fn description(&self) -> String {
        let bits: Vec<u64> = self.values.iter().flatten().map(|f| f.to_bits()).collect();
        let (bands, cells) = (self.values.len(), self.n_cells);
        format!("half-difference {:?} bands={bands} cells={cells:?} digest={:016x}", self.name, mix(&bits))
    }
}
