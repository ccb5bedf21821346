//! Standard output and standard error. A reader that hangs up early is no error.

use super::exit::{Exit, Failure};
use crate::report::{Artifact, MANIFEST, write_whole};
use serde::Serialize;
use std::io::{self, Write};
use std::path::Path;

/// Prints to standard output.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::new(Exit::Input, format!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Prints a line to standard error; where that fails there is nobody to tell.
pub fn error(text: &str) {
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// Refuses, before hours of work, a file that could not be written after them.
pub fn check_file(path: &Path) -> Result<(), Failure> {
    let folder = folder_of(path);
    if path.is_dir() {
        return Err(unwritable(path, "it is a folder; -o wants the name of a file"));
    }
    if path.exists() && !path.is_file() {
        return Err(unwritable(path, "it is no regular file"));
    }
    if !folder.is_dir() {
        return Err(unwritable(path, &format!("there is no folder '{}'", folder.display())));
    }
    check_inside(folder, path)
}

/// Refuses a folder that could not be made or replaced: by trying a file in the nearest folder above it that is there.
pub fn check_folder(path: &Path) -> Result<(), Failure> {
    let mut above = folder_of(path);
    while !above.exists() {
        above = folder_of(above);
    }
    if !above.is_dir() {
        return Err(unwritable(path, &format!("'{}' is a file, not a folder", above.display())));
    }
    check_inside(above, path)
}

/// Writes a file whole or not at all: beside it first, then in its place.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    // Write through links, so that a link stays one.
    let place = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let written = builder.tempfile_in(folder_of(&place)).and_then(|mut file| {
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        file.persist(&place).map_err(|error| error.error)
    });
    written.map(|_| ()).map_err(|error| unwritable(path, &error.kind().to_string()))
}

/// The names that a folder of these files has, its report among them.
pub fn report_names(files: &[Artifact]) -> Vec<String> {
    files.iter().map(|file| file.name.as_str()).chain([MANIFEST]).map(str::to_string).collect()
}

/// Writes a folder of files whole or not at all, with the record that lists them; the text of that.
pub fn write_report(folder: &Path, mut files: Vec<Artifact>, record: &impl Serialize) -> Result<String, Failure> {
    let text = serde_json::to_string_pretty(record).map_err(|e| Failure::new(Exit::Internal, e.to_string()))? + "\n";
    files.push(Artifact { name: MANIFEST.to_string(), bytes: text.clone().into_bytes() });
    write_whole(folder, &files)?;
    Ok(text)
}

/// The folder that a path lies in, as far as its text tells.
fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if parent != Path::new("") => parent,
        Some(_) => Path::new("."),
        None => path,
    }
}

fn check_inside(folder: &Path, path: &Path) -> Result<(), Failure> {
    tempfile::tempfile_in(folder).map(|_| ()).map_err(|error| unwritable(path, &error.kind().to_string()))
}

fn unwritable(path: &Path, reason: &str) -> Failure {
    Failure::new(Exit::Input, format!("cannot write '{}': {reason}", path.display()))
}
