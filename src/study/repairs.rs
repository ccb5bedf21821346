//! What the ways of closing T do to the laws, and to the answer.

use super::outcome::{LawsMeasured, RepairRun};
use crate::assembly::{Laws, RepairMethod, System};
use crate::compare::relative_max;
use crate::linalg::Block;
use crate::solver::{GaussSeidel, Solver};

/// Closes the unrepaired system by every method and solves it; `reference` is the answer of the system as it is.
///
/// Solved by Gauss–Seidel to `tolerance`, which needs no symmetry. Cost: a copy of T and a solution each.
pub fn compare(system: &System, tolerance: f64, reference: &Block, progress: &dyn Fn(f64)) -> Vec<RepairRun> {
    let solver = GaussSeidel { tolerance };
    // A matrix that is not closed, or closed badly, may create light and then has no steady state: that ends no study.
    let solve = |system: &System| solver.solve(system.equation(), &mut ()).ok().map(|solution| solution.radiance);
    let raw = solve(&system.without_repair());
    let difference = |a: &Option<Block>, b: &Option<Block>| match (a, b) {
        (Some(a), Some(b)) => relative_max(a, b),
        _ => f64::NAN,
    };
    let reference = Some(reference.clone());
    let methods = RepairMethod::ALL;
    let mut runs = Vec::with_capacity(methods.len());
    for (k, method) in methods.into_iter().enumerate() {
        progress(k as f64 / methods.len() as f64);
        let (repaired, sweeps) = system.repaired_by(method);
        let radiance = solve(&repaired);
        runs.push(RepairRun {
            method: method.name().to_string(),
            sweeps,
            laws: repaired.laws().into(),
            change: difference(&raw, &radiance),
            from_reference: difference(&radiance, &reference),
        });
    }
    runs
}

impl From<Laws> for LawsMeasured {
    fn from(laws: Laws) -> Self {
        let Laws { reciprocity, closure, positivity, conservation } = laws;
        Self { reciprocity, closure, positivity, conservation }
    }
}
