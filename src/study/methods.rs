//! Every method on one equation, held against one answer.

use super::StudyError;
use super::duality::{Duality, LinearSensor};
use super::foretold::Foretold;
use super::outcome::{AdjointRun, Family, HistoryPoint, SolverRun};
use crate::assembly::System;
use crate::compare::relative_max;
use crate::linalg::Block;
use crate::solver::{Budget, Iteration, SolveError, Solver};
use std::ops::ControlFlow;
use std::time::Instant;

/// Names of the methods of two families; a method that is neither direct nor among them is accelerated by something it has set up.
const STATIONARY: [&str; 10] = [
    "neumann",
    "jacobi",
    "richardson",
    "gauss-seidel",
    "symmetric-gauss-seidel",
    "sor",
    "southwell",
    "progressive",
    "overshooting",
    "chebyshev",
];
const KRYLOV: [&str; 7] = ["cg", "minres", "bicg", "bicgstab", "gmres", "fgmres", "anderson"];

impl Family {
    /// What this method rests on.
    pub fn of(method: &dyn Solver) -> Self {
        match method.name() {
            _ if method.is_direct() => Self::Direct,
            name if STATIONARY.contains(&name) => Self::Stationary,
            name if KRYLOV.contains(&name) => Self::Krylov,
            _ => Self::Accelerated,
        }
    }
}

/// What all methods made of one equation.
pub(super) struct Solved {
    /// Name of the first method, whose answer is the truth.
    pub reference_solver: String,
    pub truth: Block,
    /// By the reference.
    pub duality: Duality,
    pub runs: Vec<SolverRun>,
}

/// Runs every method on the equation and on its adjoint; the first is the reference that the histories of all are held against.
///
/// # Errors
/// No method, or a first one that refuses; what another refuses is recorded.
pub(super) fn solve_all(
    methods: &[Box<dyn Solver>],
    system: &System,
    sensor: &LinearSensor,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Solved, StudyError> {
    let (first, others) = methods.split_first().ok_or(StudyError::NoSolver)?;
    let (mut reference, truth) = solve_once(&**first, system, None, f64::INFINITY)?;
    let duality = sensor.duality(system, &truth, &**first, &mut ())?;
    reference.adjoint = Some(AdjointRun::from(&duality));
    let mut runs = vec![reference];

    let foretold = Foretold::of(system, &truth, methods)?;
    for (k, method) in others.iter().enumerate() {
        progress((k + 1) as f64 / methods.len() as f64);
        let start = Instant::now();
        runs.push(match solve_once(&**method, system, Some(&truth), f64::INFINITY) {
            Ok((mut run, radiance)) => {
                let dual = sensor.duality(system, &radiance, &**method, &mut ()).ok();
                run.adjoint = dual.as_ref().map(AdjointRun::from);
                foretold.write_into(&mut run);
                run
            }
            Err(error) => SolverRun::refused(&**method, start.elapsed().as_secs_f64(), &error),
        });
    }
    Ok(Solved { reference_solver: first.name().to_string(), truth, duality, runs })
}

/// One method within a budget of products, its history against `truth` where that is known, and its answer.
///
/// # Errors
/// What the method refuses.
pub(super) fn solve_once(
    method: &dyn Solver,
    system: &System,
    truth: Option<&Block>,
    budget: f64,
) -> Result<(SolverRun, Block), SolveError> {
    let mut history = Vec::new();
    // The observer's own time is not the method's.
    let mut watching = 0.0;
    let start = Instant::now();
    let mut record = |iteration: Iteration<'_>| {
        let paused = Instant::now();
        let seconds = start.elapsed().as_secs_f64() - watching;
        if let Some(truth) = truth {
            let Iteration { products, residual, iterate, .. } = iteration;
            let error = relative_max(iterate, truth);
            history.push(HistoryPoint { products, seconds, residual, error, predicted: None });
        }
        watching += paused.elapsed().as_secs_f64();
        ControlFlow::Continue(())
    };
    let solution = method.solve(system.equation(), &mut Budget { products: budget, observer: &mut record })?;
    let seconds = start.elapsed().as_secs_f64() - watching;

    let report = &solution.report;
    let run = SolverRun {
        solver: method.name().to_string(),
        kind: if method.is_direct() { "direct" } else { "iterative" }.to_string(),
        family: Family::of(method),
        stop: report.stop.to_string(),
        refusal: None,
        n_applies: report.n_applies,
        n_adjoint_applies: report.n_adjoint_applies,
        products: report.products,
        seconds,
        true_residual: report.true_residual,
        error: truth.map_or(0.0, |truth| relative_max(&solution.radiance, truth)),
        error_bound: report.bracket.as_ref().map(|bracket| bracket.relative_width()),
        adjoint: None,
        history,
    };
    Ok((run, solution.radiance))
}

impl SolverRun {
    /// A method that could not claim the equation, in its own words.
    pub(super) fn refused(method: &dyn Solver, seconds: f64, refusal: &SolveError) -> Self {
        Self {
            solver: method.name().to_string(),
            kind: if method.is_direct() { "direct" } else { "iterative" }.to_string(),
            family: Family::of(method),
            stop: "refused".to_string(),
            refusal: Some(refusal.to_string()),
            n_applies: 0,
            n_adjoint_applies: 0,
            products: f64::NAN,
            seconds,
            true_residual: f64::NAN,
            error: f64::NAN,
            error_bound: None,
            adjoint: None,
            history: Vec::new(),
        }
    }
}

impl From<&Duality> for AdjointRun {
    fn from(duality: &Duality) -> Self {
        let Duality { stop, products, seconds, difference, .. } = duality;
        Self { stop: stop.clone(), products: *products, seconds: *seconds, difference: *difference }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver;

    #[test]
    fn every_name_of_a_family_is_a_method() {
        for name in STATIONARY.iter().chain(&KRYLOV) {
            assert!(solver::named(name, 1.0).is_some(), "{name}");
        }
    }
}
