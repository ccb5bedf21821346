//! Where the time went, where the numbers come from, and where they lie.

use super::markup::{Column, Table, definitions, escape, section};
use crate::report::Artifact;
use crate::report::number::{count, seconds, trimmed};
use crate::study::StudyOutcome;

/// Wall time by stage.
pub fn stages(outcome: &StudyOutcome) -> String {
    let total: f64 = outcome.stages.iter().map(|(_, s)| s).sum();
    let mut table = Table::new(&[("stage", Column::Words), ("time", Column::Numbers), ("share", Column::Numbers)]);
    for (stage, time) in &outcome.stages {
        let share = if total > 0.0 { format!("{:.0} %", 100.0 * time / total) } else { "—".into() };
        table.row(&[stage, &seconds(*time), &share]);
    }
    section(
        "time",
        "Where the time went",
        &format!("{} of wall time.", seconds(total)),
        &table.html("Wall time by stage."),
    )
}

/// Everything needed to get the same numbers again.
pub fn provenance(outcome: &StudyOutcome) -> String {
    let source = &outcome.provenance;
    let mut facts = vec![
        ("version", format!("etendue {}", source.version)),
        ("command", source.command.join(" ")),
        ("scene", source.scene.clone()),
        ("scene hash (BLAKE3)", source.scene_hash.clone()),
        ("patch size", trimmed(source.patch_size, 6)),
        ("directions a patch", count(source.n_directions as u64)),
        ("seed", source.seed.to_string()),
        ("bands", outcome.bands.join(", ")),
    ];
    let settings: Vec<(String, &String)> = source.settings.iter().map(|(k, v)| (k.replace('_', " "), v)).collect();
    facts.extend(settings.iter().map(|(name, value)| (name.as_str(), value.to_string())));
    section("provenance", "Provenance", "Everything needed to get the same numbers again.", &definitions(&facts))
}

/// Links to the files beside the page.
pub fn downloads(files: &[Artifact]) -> String {
    let names = std::iter::once("report.json").chain(files.iter().map(|file| file.name.as_str()));
    let links = names.map(|name| format!("<li><a href=\"{0}\">{0}</a></li>\n", escape(name)));
    let list = format!("<ul class=\"downloads\">\n{}</ul>\n", links.collect::<String>());
    section(
        "files",
        "Files beside this page",
        "Figures as SVG and PNG, their numbers as CSV, pictures as float32 EXR.",
        &list,
    )
}
