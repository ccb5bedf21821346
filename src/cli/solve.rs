//! `etendue solve`: one scene, one method, the light field as JSON or as a table.

use super::arguments::{Arguments, Solve};
use super::exit::{Exit, Failure, NO_STEADY_STATE};
use super::matrix;
use super::memory;
use super::output;
use super::progress::Bars;
use super::provenance::provenance;
use super::record::record;
use super::scene::choose;
use super::summary;
use super::table::table;
use crate::solver::{Budget, Iteration, SolveReport, Stop};
use crate::study::{LinearSensor, Watch};
use std::ops::ControlFlow;
use std::time::Instant;

/// A true residual this much above the tolerance is not what was asked for, whatever the method believes.
const DRIFT: f64 = 10.0;

/// A true residual above this is no matter of rounding.
const NO_ANSWER: f64 = 1e-3;

pub fn run(arguments: &Arguments, solve: &Solve, command: Vec<String>) -> Result<(), Failure> {
    let method = solve.method.solver()?;

    if let (Some(matrix), Some(emission)) = (&solve.matrix, &solve.emission) {
        return matrix::run(arguments, solve, &*method, matrix, emission);
    }

    let chosen = choose(&solve.scene, |_, n| memory::to_solve(&*method, n))?;
    if let Some(path) = &solve.output {
        output::check_file(path)?;
    }

    let bars = Bars::new(arguments);
    let exchange = solve.scene.exchange();
    let (bundles, system) = chosen.assemble(arguments, exchange, &bars)?;
    bars.progress("solve", 0.0);

    let start = Instant::now();
    let solution = method.solve(system.equation(), &mut observer(arguments, solve))?;
    let seconds = start.elapsed().as_secs_f64();
    bars.progress("solve", 1.0);

    // Read one sensor twice, by L and by its importance; an answer needs no second opinion to be one.
    bars.progress("importance", 0.0);
    let sensor = LinearSensor::of(&chosen.scene, &bundles, &system);
    let mut within = Budget { products: budget(solve), observer: &mut () };
    let duality = sensor.duality(&system, &solution.radiance, &*method, &mut within);
    bars.progress("importance", 1.0);
    drop(bars);

    // Write the JSON object where it is wanted, or show a table.
    if arguments.json || solve.output.is_some() {
        let settings =
            [("solver", method.name().to_string()), ("solver_tolerance", format!("{:e}", solve.method.tolerance))];
        let source = provenance(&chosen, command, &exchange, settings);
        let object = record(&chosen.scene, &bundles, &system, (&solution, seconds), duality.as_ref().ok(), source);
        let text = serde_json::to_string(&object).map_err(|e| Failure::new(Exit::Internal, e.to_string()))? + "\n";
        if let Some(path) = &solve.output {
            output::write_file(path, text.as_bytes())?;
        }
        if arguments.json {
            output::print(&text)?;
        }
    }
    if !arguments.json {
        let duality = match &duality {
            Ok(duality) => summary::duality(duality),
            Err(error) => format!("duality: no importance, for {error}\n"),
        };
        output::print(&(table(&chosen.scene, &bundles, &system, &solution, seconds) + &duality))?;
    }
    check_converged(&solution.report, solve)
}

/// Tells of iterations where that was asked for, and ends them at the budget of products.
pub fn observer(arguments: &Arguments, solve: &Solve) -> impl FnMut(Iteration<'_>) -> ControlFlow<()> {
    let budget = budget(solve);
    let is_told = arguments.verbose > 1;
    move |iteration| {
        if is_told {
            let Iteration { index, products, residual, .. } = iteration;
            output::error(&format!("{index:>16}  {products:.1} products, residual {residual:.1e}"));
        }
        if iteration.products >= budget { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

fn budget(solve: &Solve) -> f64 {
    solve.max_products.map_or(f64::INFINITY, |n| n as f64)
}

/// The answer is there either way; whether it is the one asked for, the exit code says.
pub fn check_converged(report: &SolveReport, solve: &Solve) -> Result<(), Failure> {
    let SolveReport { method, products, true_residual, .. } = report;
    let asked = solve.method.tolerance;
    let remark = match (report.stop, solve.max_products) {
        (Stop::Budget | Stop::Observer, Some(most)) => format!("--max-products {most} ended it"),
        (Stop::Budget | Stop::Observer, None) => "another --solver may get there".to_string(),
        (Stop::Stagnated, _) => {
            "the residual no longer falls: the scene loses no light, or rounding allows no less".to_string()
        }
        _ if *true_residual <= DRIFT * asked => return Ok(()),
        _ if *true_residual > NO_ANSWER => NO_STEADY_STATE.to_string(),
        _ => "rounding allows no less; ask for a larger --tolerance".to_string(),
    };
    let message = format!(
        "{method} did not converge: true residual {true_residual:.1e} after {products} products with K, asked for {asked:e}\n  \
         = {remark}\n  = the answer so far was written all the same"
    );
    Err(Failure::new(Exit::NotConverged, message))
}
