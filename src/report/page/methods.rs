//! What was computed from the matrix: solvers and the truncated series.

use super::markup::{Column, Table, section};
use super::{FigureOnPage, figure};
use crate::report::number::{products, scientific, seconds};
use crate::study::StudyOutcome;

/// Convergence figure and the table of all solvers.
pub fn solvers(outcome: &StudyOutcome, on_page: &FigureOnPage) -> String {
    use Column::{Numbers, Words};
    let mut table = Table::new(&[
        ("solver", Words),
        ("kind", Words),
        ("stopped", Words),
        ("products", Numbers),
        ("time", Numbers),
        ("true residual", Numbers),
        ("error", Numbers),
        ("error bound", Numbers),
        ("duality", Numbers),
    ]);
    for run in &outcome.solvers {
        let reference = run.solver == outcome.reference_solver;
        let error = if reference { "reference".into() } else { scientific(run.error, 2) };
        let bound = run.error_bound.map_or("—".into(), |bound| scientific(bound, 2));
        table.row(&[
            &run.solver,
            &run.kind,
            &run.stop,
            &products(run.products),
            &seconds(run.seconds),
            &scientific(run.true_residual, 2),
            &error,
            &bound,
            &run.adjoint.as_ref().map_or("—".into(), |adjoint| scientific(adjoint.difference, 2)),
        ]);
    }
    let lead = format!(
        "The discrete truth is the answer by {}. Every other solver is held against it; the residual is recomputed from the answer, \
         and the bound trusts no solver at all: it needs only the residual and the absorption of the scene.",
        outcome.reference_solver
    );
    let shown = figure(
        on_page,
        "Error of every iterative solver against products with K and against seconds, logarithmic",
        "Error ‖L − L*‖∞ / ‖L*‖∞ against the direct solution L*, over work in products with K and over wall time; dashed, where there is a \
         theory, what the leading eigenvalues of K foretold. Grey: the methods of the other panels.",
    );
    let refusals = outcome.solvers.iter().filter_map(|run| run.refusal.as_ref());
    let refusals: String = refusals.map(|refusal| format!(" Refused: {refusal}.")).collect();
    let caption = format!(
        "Every solver; work in products with K: entries touched over entries of K. Residual, error and bound are relative. \
         Duality: how far ⟨W, L⟩ and ⟨E, J⟩ are apart, J being the importance of W ({}) by the same method.{refusals}",
        outcome.duality.sensor
    );
    section("solvers", "Solvers", &lead, &(shown + &table.html(&caption)))
}

/// Truncation figure.
pub fn truncation(outcome: &StudyOutcome, on_page: &FigureOnPage) -> String {
    let enough = outcome.truncation.iter().find(|t| t.error < 0.01);
    let enough = enough.map_or(String::new(), |t| {
        let plural = if t.bounces == 1 { "bounce leaves" } else { "bounces leave" };
        format!(" Here {} {plural} out less than one per cent.", t.bounces)
    });
    let lead = format!(
        "Whoever stops after k bounces leaves out Kᵏ⁺¹E + Kᵏ⁺²E + …; since K ≥ 0, that is at most ‖Kᵏ⁺¹E‖∞ / (1 − ‖K‖∞).{enough}"
    );
    let shown = figure(
        on_page,
        "Truncation error of the Neumann series and its bound against the number of bounces, logarithmic",
        "Error of E + K E + … + KᵏE in the maximum norm, relative to the solution, beside the bound known beforehand.",
    );
    section("truncation", "How many bounces are enough", &lead, &shown)
}
