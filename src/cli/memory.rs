//! How much memory a run may take, said before it takes it.

use super::exit::{Exit, Failure};
use std::fmt;
use std::str::FromStr;

/// A number of bytes, written with a unit: 8GiB, 500MB, 1024.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Bytes(pub u64);

const UNITS: [(&str, u64); 9] = [
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
            _ => Err("must be a number above zero and a unit: B, kB, MB, GB, TB, KiB, MiB, GiB or TiB".to_string()),
        }
    }
}

impl fmt::Display for Bytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let binary = UNITS[..4].iter().find(|(_, scale)| self.0 >= *scale);
        match binary {
            Some((name, scale)) => write!(f, "{:.1} {name}", self.0 as f64 / *scale as f64),
            None => write!(f, "{} B", self.0),
        }
    }
}

/// Refuses what would take more than is allowed.
pub fn check(needed: Bytes, allowed: Bytes, n_bundles: usize, patch_size: f64) -> Result<(), Failure> {
    if needed <= allowed {
        return Ok(());
    }
    Err(Failure::new(
        Exit::Memory,
        format!(
            "{n_bundles} bundles (patch size {patch_size}) need about {needed}, allowed are {allowed}\n  \
             = nothing was allocated; cut less finely (--patch-size) or allow more (--memory)"
        ),
    ))
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
}
