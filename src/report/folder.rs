//! A folder of files that appears whole or not at all.

use super::{Artifact, Foreign, ReportError};
use serde::Deserialize;
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// The file that lists what belongs to a report.
pub const MANIFEST: &str = "report.json";

/// What file managers drop into folders they have shown.
const DROPPINGS: [&str; 3] = [".DS_Store", "Thumbs.db", "desktop.ini"];

/// The part of report.json that tells which files are ours.
#[derive(Deserialize)]
struct Manifest {
    files: Vec<String>,
}

/// Whether [`write_whole`] would agree to replace what is there: asked before hours of work, and again by the writing itself.
///
/// # Errors
/// What is there is not a report.
pub fn check_folder(directory: &Path) -> Result<(), ReportError> {
    may_replace(&fs::canonicalize(directory).unwrap_or_else(|_| directory.to_path_buf())).map(|_| ())
}

/// Makes `directory` hold exactly these files.
///
/// They are written and synced in a hidden folder beside it, which then takes its place by renaming. What is there
/// already is replaced only if it is empty or a report: it holds a `report.json` whose `"files"` lists everything else
/// in it. Anything else, and a file of that name, is refused and left alone; if a step fails, what was there before is
/// there again. Missing parents are made. Between the two renames of a replacement there is an instant without
/// `directory`; whoever kills the program right then finds both folders in the hidden one.
pub fn write_whole(directory: &Path, artifacts: &[Artifact]) -> Result<(), ReportError> {
    check_names(artifacts)?;

    // Find the place: through links, so that a link stays one.
    let directory = fs::canonicalize(directory).unwrap_or_else(|_| directory.to_path_buf());
    let name = directory.file_name().ok_or_else(|| ReportError::Nameless { path: directory.clone() })?.to_owned();
    let parent = match directory.parent() {
        Some(parent) if parent != Path::new("") => parent.to_path_buf(),
        _ => PathBuf::from("."),
    };
    let replacing = may_replace(&directory)?;
    fs::create_dir_all(&parent).map_err(failed(&parent, "making the folder"))?;

    // Write and sync everything beside it.
    let prefix = format!(".{}.", name.to_string_lossy());
    let staging = tempfile::Builder::new()
        .prefix(&prefix)
        .tempdir_in(&parent)
        .map_err(failed(&parent, "making a temporary folder"))?;
    let fresh = staging.path().join("new");
    fs::create_dir(&fresh).map_err(failed(&fresh, "making the folder"))?;
    for artifact in artifacts {
        let path = fresh.join(&artifact.name);
        write_synced(&path, &artifact.bytes).map_err(failed(&path, "writing"))?;
    }
    sync_folder(&fresh).map_err(failed(&fresh, "syncing"))?;

    // Let the new folder take the old one's place, or put the old one back.
    let old = staging.path().join("old");
    if replacing {
        fs::rename(&directory, &old).map_err(failed(&directory, "setting the old report aside"))?;
    }
    if let Err(source) = fs::rename(&fresh, &directory) {
        if replacing && fs::rename(&old, &directory).is_err() {
            let kept = staging.keep().join("old");
            return Err(ReportError::NotRestored { path: directory, kept, source });
        }
        return Err(ReportError::Write { path: directory, action: "renaming the new report", source });
    }
    sync_folder(&parent).map_err(failed(&parent, "syncing"))
}

/// Whether there is a folder to be replaced; an error if what is there must be kept.
fn may_replace(directory: &Path) -> Result<bool, ReportError> {
    // Look at what is there.
    match fs::metadata(directory) {
        Err(error) if error.kind() == io::ErrorKind::NotFound && fs::symlink_metadata(directory).is_err() => {
            return Ok(false);
        }
        Err(source) => return Err(ReportError::Write { path: directory.into(), action: "looking at it", source }),
        Ok(found) if !found.is_dir() => return Err(ReportError::NotAFolder { path: directory.into() }),
        Ok(_) => {}
    }
    let mut strangers = BTreeSet::new();
    for entry in fs::read_dir(directory).map_err(failed(directory, "listing"))? {
        let entry = entry.map_err(failed(directory, "listing"))?;
        strangers.insert(entry.file_name().to_string_lossy().into_owned());
    }
    strangers.retain(|name| !DROPPINGS.contains(&name.as_str()));
    if strangers.is_empty() {
        return Ok(true);
    }

    // Everything must be on the report's own list.
    let refuse = |reason| Err(ReportError::NotAReport { path: directory.into(), reason });
    let manifest =
        fs::read(directory.join(MANIFEST)).ok().and_then(|bytes| serde_json::from_slice::<Manifest>(&bytes).ok());
    let Some(manifest) = manifest else { return refuse(Foreign::NoManifest) };
    strangers.remove(MANIFEST);
    for file in &manifest.files {
        strangers.remove(file);
    }
    match strangers.pop_first() {
        Some(stranger) => refuse(Foreign::Stranger(stranger)),
        None => Ok(true),
    }
}

/// Plain file names, each once, in any letter case.
fn check_names(artifacts: &[Artifact]) -> Result<(), ReportError> {
    let mut seen = BTreeSet::new();
    for Artifact { name, .. } in artifacts {
        let plain = !name.is_empty() && !name.starts_with('.') && !name.contains(['/', '\\', ':', '\0']);
        if !plain || !seen.insert(name.to_lowercase()) {
            return Err(ReportError::ArtifactName(name.clone()));
        }
    }
    Ok(())
}

fn write_synced(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = File::create_new(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

/// Makes renames and new names in a folder last; only Unix opens folders as files.
fn sync_folder(path: &Path) -> io::Result<()> {
    if cfg!(unix) { File::open(path)?.sync_all() } else { Ok(()) }
}

fn failed(path: &Path, action: &'static str) -> impl FnOnce(io::Error) -> ReportError {
    let path = path.to_path_buf();
    move |source| ReportError::Write { path, action, source }
}
