//! What becomes of every method as surfaces turn white.

use super::markup::{Column, Table, section};
use super::{FigureOnPage, figure};
use crate::report::number::{count, products, scientific, seconds, significant};
use crate::study::{AlbedoStudy, SolverRun};

/// Figure of products against albedo, and the table of all methods at all albedos.
pub fn albedos(study: &AlbedoStudy, on_page: &FigureOnPage) -> String {
    use Column::{Numbers, Words};
    let columns = [
        ("solver", Words),
        ("albedo", Numbers),
        ("stopped", Words),
        ("products", Numbers),
        ("time", Numbers),
        ("true residual", Numbers),
        ("error", Numbers),
    ];
    let mut table = Table::new(&columns);
    let n_methods = study.levels.first().map_or(0, |level| level.runs.len());
    for method in 0..n_methods {
        for (k, level) in study.levels.iter().enumerate() {
            // Name a method once.
            let run = &level.runs[method];
            table.row(&[
                if k == 0 { &run.solver } else { "" },
                &level.albedo.to_string(),
                &run.stop,
                &work(run, study.budget),
                &seconds(run.seconds),
                &scientific(run.true_residual, 2),
                &scientific(run.error, 2),
            ]);
        }
    }
    let lead = format!(
        "Every surface that is not black at one albedo after another, and the same T. Light in a closed scene dies as albedoᵏ, so that whoever \
         follows it bounce by bounce needs ln ε / ln albedo of them, some 1/(1 − albedo); the best polynomials need the root of that, and \
         methods that take the slow light out first need neither. An open scene loses light whatever its walls, and levels off. Every method goes to \
         a residual of {}, or {} products.",
        significant(study.tolerance, 2),
        count(study.budget as u64)
    );
    let shown = figure(
        on_page,
        "Products with K of every iterative solver against one minus albedo, both logarithmic, with guides of slope minus one and minus one half",
        "Products until the residual is below the tolerance, whiter to the right. An empty marker under an arrow head: not there within the \
         budget. Grey: what theory says of a closed scene without structure.",
    );
    let refusals = study.levels.iter().flat_map(|level| level.runs.iter().map(move |run| (level.albedo, run)));
    let refusals: String = refusals
        .filter_map(|(albedo, run)| Some(format!(" Refused at {albedo}: {}.", run.refusal.as_ref()?)))
        .collect();
    let caption = format!(
        "Every method at every albedo. Error against {}, elimination without subtraction, which is right in every digit at any of them.{refusals}",
        study.reference_solver
    );
    section("albedos", "As walls turn white", &lead, &(shown + &table.html(&caption)))
}

fn work(run: &SolverRun, budget: f64) -> String {
    match run.stop.as_str() {
        "budget" => format!("> {}", count(budget as u64)),
        _ if run.kind == "direct" => "—".into(),
        _ => products(run.products),
    }
}
