//! Arguments in, exit codes out; the only room that prints.

mod arguments;
mod check;
mod exit;
mod export;
mod gallery;
mod matrix;
mod memory;
mod output;
mod progress;
mod provenance;
mod record;
mod scene;
mod sensitivity;
mod solve;
mod spectrum;
mod study;
mod summary;
mod table;

use arguments::{Arguments, Command};
use clap::Parser;
use exit::{Exit, Failure};
use std::process::ExitCode;

/// Runs the program on the command line it was given.
pub fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return exit::usage(&error),
    };
    let command: Vec<String> = std::env::args_os().map(|a| a.to_string_lossy().into_owned()).collect();
    match exit::catch(|| run(&arguments, command)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            output::error(&failure.to_string());
            failure.exit().into()
        }
    }
}

fn run(arguments: &Arguments, command: Vec<String>) -> Result<(), Failure> {
    if let Some(n_threads) = arguments.threads {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build_global();
        pool.map_err(|error| Failure::new(Exit::Internal, format!("cannot start {n_threads} threads: {error}")))?;
    }
    match &arguments.command {
        Command::Study(study) => study::run(arguments, study, command),
        Command::Solve(solve) => solve::run(arguments, solve, command),
        Command::Spectrum(asked) => spectrum::run(arguments, asked, command),
        Command::Sensitivity(asked) => sensitivity::run(arguments, asked, command),
        Command::Export(export) => export::run(arguments, export, command),
        Command::Check(check) => check::run(arguments, check),
        Command::Gallery => gallery::run(arguments),
    }
}
