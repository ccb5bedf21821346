//! What becomes of every method as surfaces turn white.

use super::markup::{Column, Table, section};
use super::{FigureOnPage, figure};
use crate::report::number::{count, products, scientific, trimmed};
use crate::study::{AlbedoStudy, SolverRun};

/// Figure of products against albedo, and the table of all methods at all albedos.
pub fn albedos(study: &AlbedoStudy, on_page: &FigureOnPage) -> String {
    let names: Vec<String> = study.levels.iter().map(|level| format!("albedo {}", level.albedo)).collect();
    let columns = names.iter().map(|name| (name.as_str(), Column::Numbers));
    let columns: Vec<(&str, Column)> = [("solver", Column::Words)].into_iter().chain(columns).collect();
    let mut table = Table::new(&columns);
    for method in 0..study.levels.first().map_or(0, |level| level.runs.len()) {
        let cells: Vec<String> = study.levels.iter().map(|level| cell(&level.runs[method], study.budget)).collect();
        let name = study.levels[0].runs[method].solver.as_str();
        table.row(&[name].into_iter().chain(cells.iter().map(String::as_str)).collect::<Vec<_>>());
    }
    let lead = format!(
        "Every surface that is not black at one albedo after another, and the same T. Light in a closed scene dies as albedoᵏ, so that whoever \
         follows it bounce by bounce needs ln ε / ln albedo of them, some 1/(1 − albedo); the best polynomials need the root of that, and \
         methods that take the slow light out first need neither. An open scene loses light whatever its walls, and levels off. Every method goes to \
         a residual of {}, or {} products.",
        trimmed(study.tolerance, 2),
        count(study.budget as u64)
    );
    let shown = figure(
        on_page,
        "Products with K of every iterative solver against one minus albedo, both logarithmic, with guides of slope minus one and minus one half",
        "Products until the residual is below the tolerance, whiter to the right. An empty marker beside an arrow: not there within the \
         budget. Grey: what theory says of a closed scene without structure.",
    );
    let refusals = study.levels.iter().flat_map(|level| level.runs.iter().map(move |run| (level.albedo, run)));
    let refusals: String = refusals
        .filter_map(|(albedo, run)| Some(format!(" Refused at {albedo}: {}.", run.refusal.as_ref()?)))
        .collect();
    let caption = format!(
        "Products, and the error against {}, elimination without subtraction, which is right in every digit at any albedo. Direct methods \
         count no products.{refusals}",
        study.reference_solver
    );
    section("albedos", "As walls turn white", &lead, &(shown + &table.html(&caption)))
}

/// Products and error of one method at one albedo.
fn cell(run: &SolverRun, budget: f64) -> String {
    let error = scientific(run.error, 1);
    match run.stop.as_str() {
        "refused" => "refused".into(),
        "budget" => format!("> {} · {error}", count(budget as u64)),
        _ if run.kind == "direct" => error,
        "converged" => format!("{} · {error}", products(run.products)),
        other => format!("{other} · {error}"),
    }
}
