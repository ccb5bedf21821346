//! `etendue export`: the matrices of a scene as files, with what their rows stand for beside them.

use super::arguments::{Arguments, Export};
use super::exit::Failure;
use super::memory;
use super::output;
use super::progress::Bars;
use super::provenance::provenance;
use super::record::{BundleRecord, bundle_records};
use super::scene::choose;
use crate::assembly::Letter;
use crate::linalg::format::{MatrixFormat, content_hash};
use crate::linalg::{Dense, LinearOperator, Matrix};
use crate::report::{Artifact, check_folder};
use crate::scene::Scene;
use crate::study::{Provenance, Watch};
use serde::Serialize;
use std::path::PathBuf;

/// Bytes that an entry may take in a file: a line of text with its indices.
const BYTES_AN_ENTRY: u64 = 40;

/// The side-car: which files there are, and what their rows and columns stand for.
#[derive(Serialize)]
struct Record<'a> {
    schema: &'static str,
    files: Vec<String>,
    matrices: Vec<MatrixRecord>,
    scene: &'a str,
    n_bundles: usize,
    bands: &'a [String],
    /// Row and column i of every matrix is bundle i.
    bundles: Vec<BundleRecord<'a>>,
    provenance: Provenance,
}

#[derive(Serialize)]
struct MatrixRecord {
    file: String,
    letter: String,
    /// The band, or null where the matrix is that of all, or the file holds all.
    band: Option<String>,
    n_rows: usize,
    n_columns: usize,
    n_entries: u64,
    blake3: String,
}

pub fn run(arguments: &Arguments, export: &Export, command: Vec<String>) -> Result<(), Failure> {
    let n_files = |n_bands: usize| -> u64 {
        export.what.iter().map(|letter| if letter.has_bands() { n_bands as u64 } else { 1 }).sum()
    };
    let an_entry = |scene: &Scene| BYTES_AN_ENTRY.saturating_mul(n_files(scene.n_bands()));
    let chosen = choose(&export.scene, |scene, n| memory::with_square(n, an_entry(scene)))?;
    let folder =
        export.output.clone().unwrap_or_else(|| PathBuf::from("out").join(format!("{}-matrices", chosen.scene.name())));
    check_folder(&folder)?;
    output::check_folder(&folder)?;

    let bars = Bars::new(arguments);
    let exchange = export.scene.exchange();
    let (bundles, system) = chosen.assemble(arguments, exchange, &bars)?;
    bars.progress("write", 0.0);

    // Write every matrix, a file for every band in which it differs where a file holds one.
    let bands = chosen.scene.bands();
    let mut artifacts = Vec::new();
    let mut matrices = Vec::new();
    for letter in &export.what {
        let n_bands = if letter.has_bands() { bands.len() } else { 1 };
        let mut written: Vec<Matrix> = (0..n_bands).map(|band| system.written_out(*letter, band)).collect();
        // Emission is a block of columns; where a file holds components, they are its bands.
        if let (Letter::E, true) = (*letter, export.format.holds_components()) {
            let block = written.remove(0);
            let mut column = vec![0.0; block.n_rows()];
            written = (0..block.n_columns())
                .map(|c| {
                    block.column(0, c, &mut column);
                    Matrix::Dense(Dense::from_fn(column.len(), 1, |r, _| column[r]))
                })
                .collect();
        } else if written.windows(2).all(|pair| pair[0] == pair[1]) {
            written.truncate(1);
        }
        let groups: Vec<Vec<&Matrix>> = match export.format.holds_components() {
            true => vec![written.iter().collect()],
            false => written.iter().map(|matrix| vec![matrix]).collect(),
        };
        for (k, group) in groups.iter().enumerate() {
            let band = (groups.len() > 1).then(|| bands[k].clone());
            let infix = band.as_ref().map_or(String::new(), |band| format!(".{band}"));
            let name = format!("{letter}{infix}.{}", export.format.extension());
            let bytes = export.format.write(group);
            matrices.push(matrix_record(&name, *letter, band, group, &bytes));
            artifacts.push(Artifact { name, bytes });
        }
    }

    // Say what they are.
    let settings = [("format", export.format.to_string())];
    let record = Record {
        schema: "etendue.export/1",
        files: output::report_names(&artifacts),
        matrices,
        scene: chosen.scene.name(),
        n_bundles: bundles.n_bundles(),
        bands,
        bundles: bundle_records(&chosen.scene, &bundles, &system),
        provenance: provenance(&chosen, command, &exchange, settings),
    };
    let text = output::write_report(&folder, artifacts, &record)?;
    bars.progress("write", 1.0);
    drop(bars);

    if arguments.json {
        return output::print(&text);
    }
    let list: String = record
        .matrices
        .iter()
        .map(|matrix| {
            let MatrixRecord { file, n_rows, n_columns, n_entries, .. } = matrix;
            format!("{file:<16}  {n_rows} × {n_columns}, {n_entries} entries\n")
        })
        .collect();
    output::print(&format!("{list}{}\n", folder.display()))
}

fn matrix_record(name: &str, letter: Letter, band: Option<String>, group: &[&Matrix], bytes: &[u8]) -> MatrixRecord {
    MatrixRecord {
        file: name.to_string(),
        letter: letter.to_string(),
        band,
        n_rows: group[0].n_rows(),
        n_columns: group[0].n_columns(),
        n_entries: group.iter().map(|matrix| matrix.n_entries()).sum(),
        blake3: content_hash(bytes),
    }
}

/// The names of formats, for the command line.
pub fn format(text: &str) -> Result<MatrixFormat, String> {
    let found = MatrixFormat::ALL.into_iter().find(|format| format.to_string() == text);
    found.ok_or_else(|| "expected mtx, npz or radiance".to_string())
}
