//! The house rules that a machine can check: which room may use which, who may use an outside crate, what no file may hold.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// The rooms, top to bottom; a room uses rooms of later lines only, never one of its own line but itself.
const FLOORS: [&[&str]; 17] = [
    &["cli"],
    &["report"],
    &["study"],
    &["oracle"],
    &["compare"],
    &["solver", "estimator"],
    &["assembly"],
    &["basis"],
    &["gallery"],
    &["scene"],
    &["scattering", "medium"],
    &["geometry"],
    &["linalg"],
    &["image"],
    &["sampling"],
    &["stats"],
    &[],
];

/// Outside crates and the rooms that are their only doors.
const DOORS: [(&str, &[&str]); 21] = [
    ("faer", &["linalg"]),
    ("sprs", &["linalg"]),
    ("zip", &["linalg"]),
    ("nalgebra", &["linalg"]),
    ("glam", &["geometry"]),
    ("obvhs", &["geometry"]),
    ("pulp", &["assembly", "estimator", "geometry", "linalg"]),
    ("robust", &["geometry"]),
    ("plotters", &["report"]),
    ("dejavu", &["report"]),
    ("base64", &["report"]),
    ("exr", &["image"]),
    ("png", &["image"]),
    ("roxmltree", &["scene"]),
    ("rand_philox", &["sampling"]),
    ("libm", &["stats"]),
    ("clap", &["cli"]),
    ("indicatif", &["cli"]),
    ("blake3", &["linalg", "scene"]),
    ("tempfile", &["report", "cli"]),
    ("strsim", &["gallery", "scene"]),
];

struct Source {
    path: PathBuf,
    /// First folder or file under src; empty for lib.rs and main.rs.
    room: String,
    text: String,
}

fn sources() -> Vec<Source> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = Vec::new();
    let mut folders = vec![root.clone()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).expect("a readable folder") {
            let path = entry.expect("a readable entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let text = fs::read_to_string(&path).expect("a readable source");
                let inside = path.strip_prefix(&root).expect("a path under src");
                let depth = inside.components().count();
                let first = inside.components().next().expect("a name").as_os_str().to_string_lossy().into_owned();
                let room = if depth > 1 { first } else { String::new() };
                found.push(Source { path: inside.to_path_buf(), room, text });
            }
        }
    }
    assert!(found.len() > 50, "the sources were not found");
    found
}

/// Code without comments and strings' contents, line by line; good enough for names.
fn code_lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.lines().enumerate().map(|(k, line)| (k + 1, line.split("//").next().unwrap_or(line)))
}

fn floor(room: &str) -> Option<usize> {
    FLOORS.iter().position(|floor| floor.contains(&room))
}

/// Rooms named after `crate::` in a line, groups like `crate::{a, b}` included.
fn rooms_used(code: &str) -> Vec<String> {
    let word = |text: &str| -> String { text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect() };
    let mut rooms = Vec::new();
    for (at, _) in code.match_indices("crate::") {
        let rest = &code[at + "crate::".len()..];
        match rest.strip_prefix('{') {
            // In a group, names at depth one are rooms.
            Some(group) => {
                let mut depth = 0;
                let mut start = true;
                for (k, c) in group.char_indices() {
                    match c {
                        '{' => depth += 1,
                        '}' if depth == 0 => break,
                        '}' => depth -= 1,
                        ',' if depth == 0 => start = true,
                        c if start && depth == 0 && c.is_alphabetic() => {
                            rooms.push(word(&group[k..]));
                            start = false;
                        }
                        _ => {}
                    }
                }
            }
            None => rooms.push(word(rest)),
        }
    }
    rooms
}

#[test]
fn every_room_has_a_floor_and_every_floor_a_room() {
    let rooms: std::collections::BTreeSet<String> =
        sources().into_iter().map(|s| s.room).filter(|room| !room.is_empty()).collect();
    let known: std::collections::BTreeSet<String> =
        FLOORS.iter().flat_map(|floor| floor.iter().map(|room| room.to_string())).collect();
    assert_eq!(rooms, known);
}

#[test]
fn rooms_use_only_rooms_below_them() {
    let mut wrong = Vec::new();
    for source in sources().iter().filter(|s| !s.room.is_empty()) {
        let own = floor(&source.room).expect("a known room");
        for (line, code) in code_lines(&source.text) {
            for used in rooms_used(code).iter().filter(|used| **used != source.room) {
                if floor(used).is_some_and(|other| other <= own) {
                    wrong.push(format!("{}:{line}: {} uses {used}", source.path.display(), source.room));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "arrows that run up or sideways:\n{}", wrong.join("\n"));
}

#[test]
fn solvers_know_operators_and_vectors_only() {
    for source in sources().iter().filter(|s| s.room == "solver") {
        for (line, code) in code_lines(&source.text) {
            for used in rooms_used(code) {
                assert!(["linalg", "solver"].contains(&used.as_str()), "{}:{line} uses {used}", source.path.display());
            }
        }
    }
}

#[test]
fn sampling_statistics_and_images_know_no_light() {
    for source in sources().iter().filter(|s| ["sampling", "stats", "image"].contains(&s.room.as_str())) {
        for (line, code) in code_lines(&source.text) {
            for used in rooms_used(code) {
                let allowed = used == source.room || ["sampling", "stats"].contains(&used.as_str());
                assert!(allowed, "{}:{line} uses {used}", source.path.display());
            }
        }
    }
}

#[test]
fn outside_crates_come_in_through_their_doors() {
    let doors: BTreeMap<&str, &[&str]> = DOORS.into_iter().collect();
    let mut wrong = Vec::new();
    for source in &sources() {
        for (line, code) in code_lines(&source.text) {
            for (name, rooms) in &doors {
                let path = format!("{name}::");
                let uses = code.match_indices(&path).any(|(at, _)| {
                    let before = code[..at].chars().next_back();
                    !before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':')
                });
                if uses && !rooms.contains(&source.room.as_str()) {
                    wrong.push(format!(
                        "{}:{line}: {name} is used outside {}",
                        source.path.display(),
                        rooms.join(", ")
                    ));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "crates used outside their doors:\n{}", wrong.join("\n"));
}

#[test]
fn every_dependency_has_a_door_or_is_for_all() {
    let everywhere = ["rayon", "serde", "serde_json", "thiserror"];
    let manifest = include_str!("../Cargo.toml");
    let dependencies =
        manifest.split("[dependencies]").nth(1).and_then(|rest| rest.split("\n[").next()).expect("dependencies");
    for line in dependencies.lines().filter(|line| !line.starts_with('#') && line.contains('=')) {
        let name = line.split('=').next().expect("a name").trim().replace('-', "_");
        let known = everywhere.contains(&name.as_str()) || DOORS.iter().any(|(door, _)| *door == name);
        assert!(known, "{name} has no door");
    }
}

#[test]
fn only_the_command_line_prints_and_exits() {
    for source in sources().iter().filter(|s| s.room != "cli") {
        for (line, code) in code_lines(&source.text) {
            for word in ["println!", "print!", "eprintln!", "eprint!", "dbg!", "process::exit"] {
                assert!(!code.contains(word), "{}:{line}: {word}", source.path.display());
            }
        }
    }
}

#[test]
fn nothing_is_left_undone_or_unsafe() {
    for source in &sources() {
        for (line, code) in code_lines(&source.text) {
            for word in ["todo!", "unimplemented!", "#[ignore", "unsafe {", "unsafe fn", "#[allow(dead_code)]"] {
                assert!(!code.contains(word), "{}:{line}: {word}", source.path.display());
            }
        }
    }
}

#[test]
fn files_stay_readable() {
    for source in &sources() {
        let n_lines = source.text.lines().count();
        assert!(n_lines <= 420, "{} has {n_lines} lines: split it by noun", source.path.display());
        assert!(
            source.text.starts_with("//!") || source.path == Path::new("main.rs"),
            "{} does not say what it is",
            source.path.display()
        );
    }
}

#[test]
fn the_top_level_holds_what_it_should() {
    let allowed = [
        "Cargo.toml",
        "Cargo.lock",
        "src",
        "notebooks",
        "tests",
        "benches",
        "README.md",
        "LICENSE-MIT",
        "LICENSE-APACHE",
        "CHANGELOG.md",
        "pyproject.toml",
        "target",
        "out",
    ];
    for entry in fs::read_dir(env!("CARGO_MANIFEST_DIR")).expect("a readable folder") {
        let name = entry.expect("a readable entry").file_name().to_string_lossy().into_owned();
        assert!(name.starts_with('.') || allowed.contains(&name.as_str()), "{name} does not belong at the top level");
    }
}
