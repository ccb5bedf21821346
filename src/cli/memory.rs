//! How much memory a run may take, said before it takes it.

use super::exit::{Exit, Failure};
use crate::assembly::System;
use crate::basis::{BasisError, Bundles, Resolution};
use crate::scene::Scene;
use crate::solver::Solver;
use std::fmt;
use std::str::FromStr;

/// A number of bytes, written with a unit: 8GiB, 500MB, 1024.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Bytes(pub u64);

const UNITS: [(&str, u64); 11] = [
    ("EiB", 1 << 60),
    ("PiB", 1 << 50),
    ("TiB", 1 << 40),
    ("GiB", 1 << 30),
    ("MiB", 1 << 20),
    ("KiB", 1 << 10),
    ("TB", 1_000_000_000_000),
    ("GB", 1_000_000_000),
    ("MB", 1_000_000),
    ("kB", 1_000),
    ("B", 1),
];

impl FromStr for Bytes {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let unit = UNITS.iter().find(|(name, _)| text.len() > name.len() && text.ends_with(name));
        let (number, scale) = unit.map_or((text, 1), |(name, scale)| (&text[..text.len() - name.len()], *scale));
        match number.trim().parse::<f64>() {
            Ok(value) if value.is_finite() && value > 0.0 => Ok(Self((value * scale as f64) as u64)),
            _ => Err("expected a number above zero and a unit, such as 8GiB, 1.5GB or 500MiB".to_string()),
        }
    }
}

impl fmt::Display for Bytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0 == u64::MAX {
            return f.write_str("more than 16 EiB");
        }
        let binary = UNITS[..6].iter().find(|(_, scale)| self.0 >= *scale);
        match binary {
            Some((name, scale)) => write!(f, "{:.1} {name}", self.0 as f64 / *scale as f64),
            None => write!(f, "{} B", self.0),
        }
    }
}

/// Bytes that the program takes before it has a scene, and that its threads take to run.
const PROGRAM: u64 = 16 << 20;

/// Refuses what would take more than is allowed, and says what would not.
pub fn check(
    scene: &Scene,
    resolution: Resolution,
    allowed: Bytes,
    needed: impl Fn(usize) -> u64,
) -> Result<Demand, Failure> {
    let needed = |n: usize| needed(n).saturating_add(PROGRAM);
    let n_bundles = match Bundles::count(scene, resolution) {
        Err(BasisError::TooMany { n_patches, .. }) => n_patches,
        count => count?,
    };
    let demand = Demand { n_bundles, bytes: Bytes(needed(n_bundles)) };
    if n_bundles <= Bundles::LIMIT && demand.bytes <= allowed {
        return Ok(demand);
    }
    let fits = |patch_size: f64| {
        let count = Bundles::count(scene, Resolution { patch_size, ..resolution });
        count.is_ok_and(|n| Bytes(needed(n)) <= allowed)
    };
    let remedy = match finest_that_fits(resolution.patch_size, fits) {
        Some(patch_size) => format!("--patch-size {patch_size} would fit; --memory SIZE allows more"),
        None => "no --patch-size would fit; --memory SIZE allows more".to_string(),
    };
    let (patch_size, bytes) = (resolution.patch_size, demand.bytes);
    Err(Failure::new(
        Exit::Memory,
        format!(
            "{n_bundles} bundles at patch size {patch_size} need {bytes} of memory, allowed are {allowed}\n  \
             = nothing was started\n  = {remedy}"
        ),
    ))
}

/// Bytes to assemble n bundles and then hold this many more for every pair of them.
pub fn with_square(n: usize, an_entry: u64) -> u64 {
    let square = (n as u64).saturating_mul(n as u64);
    System::memory_estimate(n).saturating_add(square.saturating_mul(an_entry))
}

/// Bytes to assemble and solve: some methods write out the matrix, its factors, and one of them a copy.
pub fn to_solve(method: &dyn Solver, n: usize) -> u64 {
    with_square(n, if method.writes_out() { 16 } else { 0 })
}

/// What a run will take.
#[derive(Clone, Copy, Debug)]
pub struct Demand {
    pub n_bundles: usize,
    pub bytes: Bytes,
}

/// The smallest patch size above this one that fits, to two digits; `None` where none does.
fn finest_that_fits(too_small: f64, fits: impl Fn(f64) -> bool) -> Option<f64> {
    // Double until it fits, then halve the interval, on a logarithmic scale.
    let mut below = too_small;
    let mut above = (1..=64).map(|k| too_small * 2f64.powi(k)).find(|size| {
        let enough = fits(*size);
        if !enough {
            below = *size;
        }
        enough
    })?;
    for _ in 0..12 {
        let middle = (below * above).sqrt();
        if fits(middle) { above = middle } else { below = middle }
    }

    // Round to nearest where that still fits, else up.
    let digits = (1.0 - above.log10().floor()).clamp(0.0, 30.0) as usize;
    let up = above + 0.5 * 10f64.powi(-(digits as i32));
    let rounded = [above, up].map(|size| format!("{size:.digits$}").parse::<f64>());
    rounded.into_iter().flatten().find(|size| fits(*size))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_numbers_with_and_without_units() {
        for (text, bytes) in [("8GiB", 8 << 30), ("1.5KiB", 1536), ("500MB", 500_000_000), ("1024", 1024), ("3 B", 3)] {
            assert_eq!(text.parse(), Ok(Bytes(bytes)), "{text}");
        }
        for text in ["", "GiB", "-1GiB", "nan", "8 gib", "1e999B"] {
            assert!(text.parse::<Bytes>().is_err(), "{text}");
        }
    }

    #[test]
    fn writes_numbers_with_the_largest_unit_below_them() {
        for (bytes, text) in [(0, "0 B"), (1023, "1023 B"), (1536, "1.5 KiB"), (3 << 50, "3.0 PiB")] {
            assert_eq!(Bytes(bytes).to_string(), text);
        }
        assert_eq!(Bytes(u64::MAX).to_string(), "more than 16 EiB");
    }

    #[test]
    fn the_finest_size_that_fits_has_two_digits_and_fits() {
        for (limit, expected) in [(0.0123, Some(0.013)), (0.5, Some(0.5)), (123.0, Some(123.0)), (1e300, None)] {
            let found = finest_that_fits(1e-4, |size| size >= limit);
            assert_eq!(found, expected, "{limit}");
        }
    }
}
