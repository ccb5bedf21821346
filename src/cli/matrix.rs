//! `etendue solve --matrix`: an equation that someone else made.

use super::arguments::{Arguments, Solve};
use super::exit::{Exit, Failure};
use super::output;
use super::record::ReportRecord;
use super::solve::{check_converged, observer};
use crate::linalg::format::{MatrixFileCode, MatrixFileError, read_matrix};
use crate::linalg::{Block, Equation, LinearOperator, PerBand};
use crate::solver::{RowGain, Solver};
use serde::Serialize;
use std::path::Path;
use std::time::Instant;

/// What `solve --matrix --json` prints.
#[derive(Serialize)]
struct Record {
    schema: &'static str,
    n_unknowns: usize,
    n_bands: usize,
    /// A list a band, in the order of K's rows.
    radiance: Vec<Vec<f64>>,
    /// The bracket around it, likewise; null where K has entries below zero, or loses nothing.
    low: Option<Vec<Vec<f64>>>,
    high: Option<Vec<Vec<f64>>>,
    report: ReportRecord,
}

pub fn run(
    arguments: &Arguments,
    solve: &Solve,
    method: &dyn Solver,
    matrix: &Path,
    emission: &Path,
) -> Result<(), Failure> {
    if let Some(path) = &solve.output {
        output::check_file(path)?;
    }
    // Some methods write out the matrix and its factors.
    let share = if method.writes_out() { 3 } else { 1 };
    let limit = solve.scene.memory.0 / share;
    let transport = read_matrix(matrix, limit)?;
    let emission_columns = read_matrix(emission, limit)?;

    // See that they fit together.
    let wrong = |found: String, expected: String| MatrixFileError::shape(matrix, found, expected);
    let n = transport[0].n_rows();
    if transport[0].n_columns() != n || n == 0 {
        let found = format!("a matrix of {n} × {}", transport[0].n_columns());
        return Err(wrong(found, "K, as many rows as columns".to_string()).into());
    }
    let mut columns = Vec::new();
    for component in &emission_columns {
        if component.n_rows() != n {
            let found = format!("{} rows in {}", component.n_rows(), emission.display());
            return Err(wrong(found, format!("{n} rows, as K has")).into());
        }
        for c in 0..component.n_columns() {
            let mut column = vec![0.0; n];
            component.column(0, c, &mut column);
            columns.push(column);
        }
    }
    let n_bands = columns.len();
    if transport.len() > 1 && transport.len() != n_bands {
        let found = format!("a K of {} components, an E of {n_bands}", transport.len());
        return Err(wrong(found, "a column of E for every component of K".to_string()).into());
    }
    let emission = Block::from_fn(n, n_bands, |i, band| columns[band][i]);
    let transport: Box<dyn LinearOperator> = match <[_; 1]>::try_from(transport) {
        Ok([grey]) => Box::new(grey),
        Err(bands) => Box::new(PerBand::new(bands)),
    };

    let equation = Equation::plain(&*transport, &emission);
    if let (Some(gain), false) = (RowGain::of(equation), arguments.quiet) {
        output::error(&format!("note: {gain}"));
    }
    let start = Instant::now();
    let solution = method.solve(equation, &mut observer(arguments, solve))?;
    let seconds = start.elapsed().as_secs_f64();

    let lists = |block: &Block| block.columns().map(<[f64]>::to_vec).collect::<Vec<_>>();
    let bracket = solution.report.bracket.as_ref();
    let record = Record {
        schema: "etendue.solve-matrix/1",
        n_unknowns: n,
        n_bands,
        radiance: lists(&solution.radiance),
        low: bracket.map(|bracket| lists(&bracket.low)),
        high: bracket.map(|bracket| lists(&bracket.high)),
        report: ReportRecord::new(&solution.report, seconds),
    };
    let text = serde_json::to_string(&record).map_err(|e| Failure::new(Exit::Internal, e.to_string()))? + "\n";
    if let Some(path) = &solve.output {
        output::write_file(path, text.as_bytes())?;
    }
    if arguments.json {
        output::print(&text)?;
    } else {
        output::print(&table(&record))?;
    }
    check_converged(&solution.report, solve)
}

fn table(record: &Record) -> String {
    let report = &record.report;
    let mut text =
        format!("{} unknowns\n\n{:<6}{:>14}{:>14}{:>14}\n", record.n_unknowns, "band", "least", "mean", "most");
    for (band, radiance) in record.radiance.iter().enumerate() {
        let least = radiance.iter().copied().fold(f64::INFINITY, f64::min);
        let most = radiance.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mean = radiance.iter().sum::<f64>() / radiance.len() as f64;
        text += &format!("{band:<6}{least:>14.6e}{mean:>14.6e}{most:>14.6e}\n");
    }
    let bound =
        report.error_bound.map_or(String::new(), |b| format!(", error at most {b:.1e} of the largest radiance"));
    text += &format!(
        "\n{}: {}, {} products with K, {:.3} s\ntrue residual {:.1e}{bound}\n",
        report.solver, report.stop, report.products, report.seconds, report.true_residual
    );
    text
}

impl From<MatrixFileError> for Failure {
    fn from(error: MatrixFileError) -> Self {
        let exit = if error.code == MatrixFileCode::TooLarge { Exit::Memory } else { Exit::Input };
        Self::new(exit, error.to_string())
    }
}
