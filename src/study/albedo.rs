//! The same scene with all that reflects at one albedo after another: what each method makes of light that takes ever longer to die.

use super::StudyError;
use super::methods::solve_once;
use super::outcome::{AlbedoLevel, AlbedoStudy, SolverRun};
use crate::assembly::System;
use crate::linalg::Block;
use crate::solver::{Gth, Solver};
use std::time::Instant;

/// Holds albedos to their range, 0 ≤ albedo < 1: at 1 nothing is absorbed, and light that does not escape has no steady state.
///
/// # Errors
/// The first that is out of it.
pub fn check_albedos(albedos: &[f64]) -> Result<(), StudyError> {
    match albedos.iter().find(|albedo| !(0.0..1.0).contains(*albedo)) {
        Some(albedo) => Err(StudyError::AlbedoOutOfRange { albedo: *albedo }),
        None => Ok(()),
    }
}

/// Every method at every albedo, each within a budget of products, against elimination without subtraction. T is shared by all.
///
/// # Errors
/// An albedo out of range, or at which the reference finds no steady state; what a method refuses is recorded.
pub fn albedo_study(
    system: &System,
    methods: &[Box<dyn Solver>],
    albedos: &[f64],
    tolerance: f64,
    budget: f64,
    progress: &dyn Fn(f64),
) -> Result<AlbedoStudy, StudyError> {
    check_albedos(albedos)?;
    let mut albedos = albedos.to_vec();
    albedos.sort_by(f64::total_cmp);
    albedos.dedup();

    let mut levels = Vec::with_capacity(albedos.len());
    for (k, albedo) in albedos.iter().enumerate() {
        let system = at_albedo(system, *albedo);
        let truth = Gth.solve(system.equation(), &mut ())?.radiance;
        let mut runs = Vec::with_capacity(methods.len());
        for (m, method) in methods.iter().enumerate() {
            progress((k as f64 + m as f64 / methods.len() as f64) / albedos.len() as f64);
            let start = Instant::now();
            runs.push(match solve_once(&**method, &system, Some(&truth), budget) {
                Ok((run, _)) => SolverRun { history: Vec::new(), ..run },
                Err(error) => SolverRun::refused(&**method, start.elapsed().as_secs_f64(), &error),
            });
        }
        levels.push(AlbedoLevel { albedo: *albedo, runs });
    }
    Ok(AlbedoStudy { tolerance, budget, reference_solver: Gth.name().to_string(), levels })
}

/// What reflects at all, at this albedo.
fn at_albedo(system: &System, albedo: f64) -> System {
    let own = system.transport().scattering().values();
    let value = |i: usize, band: usize| if own.get(i, band) > 0.0 { albedo } else { 0.0 };
    system.with_albedo(Block::from_fn(own.n_rows(), own.n_columns(), value))
}
