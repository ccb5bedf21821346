//! How good the matrices are, whatever is computed from them.

use super::markup::{Column, Table, definitions, escape, section};
use super::verdict::percent;
use crate::report::number::{count, scientific, significant};
use crate::study::StudyOutcome;

/// A law that holds to this is written as kept: rounding over sums of some thousand terms.
const KEPT: f64 = 1e-12;

/// The four laws as measured, and how the exchange came about.
pub fn matrices(outcome: &StudyOutcome) -> String {
    let laws = &outcome.laws;
    let cards = [
        ("Reciprocity", "T = Tᵀ, R = Rᵀ", laws.reciprocity, "Light flows alike in both directions."),
        ("Closure", "Σⱼ Tᵢⱼ = μᵢ", laws.closure, "Every ray arrives somewhere, if only outside."),
        ("Positivity", "T ≥ 0, R ≥ 0", laws.positivity, "No bundle sends darkness."),
        ("Conservation", "Σₒ Rₒᵢ ≤ μᵢ", laws.conservation, "No surface returns more than it receives."),
    ];
    let cards = cards.map(|(name, equation, violation, meaning)| {
        // A NaN is not kept either.
        let class = if violation.abs() <= KEPT { "law" } else { "law broken" };
        format!(
            "<div class=\"{class}\"><h3>{name}</h3><p class=\"equation\">{equation}</p><p class=\"violation\">{}</p><p>{}</p></div>\n",
            escape(&if violation == 0.0 { "exact".into() } else { scientific(violation, 2) }),
            escape(meaning)
        )
    });

    let exchange = &outcome.exchange;
    let share = |n: usize| format!("{} ({})", count(n as u64), percent(n as f64 / exchange.n_pairs.max(1) as f64));
    let facts = definitions(&[
        ("pairs of patches that face each other", count(exchange.n_pairs as u64)),
        ("of them proved clear", share(exchange.n_unoccluded)),
        ("proved hidden", share(exchange.n_hidden)),
        ("partly visible, integrated", share(exchange.n_integrated)),
        ("partly visible, sampled by rays", share(exchange.n_sampled)),
        ("pairs settled by whole clusters", count(exchange.n_by_clusters as u64)),
        ("worst quadrature error estimate, of a pair's T", significant(exchange.quadrature_error, 2)),
        ("error of a row sum by partly visible pairs, of μ", significant(exchange.visibility_error, 2)),
        ("closure before the repair", significant(exchange.closure_before_repair, 2)),
        ("sweeps of symmetric scaling, T ← D T D", count(exchange.repair_sweeps as u64)),
        ("change of L by the repair", scientific(exchange.repair_change, 2)),
        ("étendue that leaves the scene", percent(exchange.escaped)),
    ]);
    let lead = "Four laws hold in the assembled matrices whatever their accuracy; the worst relative violation is measured, not assumed. \
                T is the exchange of étendue between bundles, R the scattering in étendue form, μ the étendue of a bundle.";
    let body = format!(
        "<div class=\"laws\">\n{}</div>\n<h3>How the exchange came about</h3>\n{facts}{}",
        cards.concat(),
        repairs(outcome)
    );
    section("laws", "The four laws, as measured", lead, &body)
}

/// The ways of closing T, side by side.
fn repairs(outcome: &StudyOutcome) -> String {
    if outcome.repairs.is_empty() {
        return String::new();
    }
    let shown = |violation: f64| if violation == 0.0 { "exact".into() } else { scientific(violation, 1) };
    let mut table = Table::new(&[
        ("Repair", Column::Words),
        ("Sweeps", Column::Numbers),
        ("Reciprocity", Column::Numbers),
        ("Closure", Column::Numbers),
        ("Positivity", Column::Numbers),
        ("Change of L", Column::Numbers),
        ("From the one in use", Column::Numbers),
    ]);
    for run in &outcome.repairs {
        table.row(&[
            &run.method,
            &count(run.sweeps as u64),
            &shown(run.laws.reciprocity),
            &shown(run.laws.closure),
            &shown(run.laws.positivity),
            &scientific(run.change, 1),
            &scientific(run.from_reference, 1),
        ]);
    }
    format!("<h3>Ways of closing T</h3>\n{}", table.html(
        "Every repair starts from the same unrepaired T, and the laws are measured after it. Change of L: max |L − Lraw| / max |L|; a repair \
         that changes L much repairs an exchange that is not good enough. Symmetric scaling is the default: it keeps every law by \
         construction. All are solved by Gauss–Seidel to the tolerance of the study, which is as near as two answers can be told apart.",
    ))
}
