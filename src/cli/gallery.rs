//! `etendue gallery`: the built-in scenes, a line each.

use super::arguments::Arguments;
use super::exit::Failure;
use super::output;
use crate::gallery;
use serde_json::json;

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.json {
        let scenes: Vec<_> = gallery::list()
            .iter()
            .map(|entry| {
                json!({
                    "name": entry.name,
                    "summary": entry.summary,
                    "patch_size": entry.patch_size,
                    "closed": entry.closed,
                    "exact": (entry.exact)().is_some(),
                })
            })
            .collect();
        return output::print(&format!("{}\n", json!({ "schema": "etendue.gallery/1", "scenes": scenes })));
    }
    let width = gallery::list().iter().map(|entry| entry.name.len()).max().unwrap_or(0);
    let lines = gallery::list().iter().map(|entry| format!("{:width$}  {}\n", entry.name, entry.summary));
    output::print(&lines.collect::<String>())
}
