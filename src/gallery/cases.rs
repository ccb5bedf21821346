//! Reference cases that are built in: geometries with known answers, each with its source and derivation.

/// A file of cases: a JSON list, as [`oracle::cases::read`](../oracle/cases/fn.read.html) takes it.
pub const CASES: &str = include_str!("cases.json");
