//! `write_whole`: all files or none, and nothing of the user's lost.

use etendue::report::{Artifact, Foreign, ReportError, render, write_whole};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

fn artifact(name: &str, bytes: &str) -> Artifact {
    Artifact { name: name.into(), bytes: bytes.into() }
}

/// A report of one file and its list.
fn report(bytes: &str) -> Vec<Artifact> {
    vec![artifact("report.json", "{\"files\": [\"a.txt\"]}"), artifact("a.txt", bytes)]
}

/// Every file of a folder by name; a folder inside counts as empty.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap());
    entries.map(|e| (e.file_name().into_string().unwrap(), fs::read(e.path()).unwrap_or_default())).collect()
}

fn names(folder: &Path) -> Vec<String> {
    contents(folder).into_keys().collect()
}

#[test]
fn a_folder_appears_with_its_parents_and_nothing_beside_it() {
    let place = tempfile::tempdir().unwrap();
    let target = place.path().join("out/deep/study");
    write_whole(&target, &report("one")).unwrap();
    assert_eq!(names(&target), ["a.txt", "report.json"]);
    assert_eq!(names(target.parent().unwrap()), ["study"]);
}

#[test]
fn a_report_replaces_a_report_of_other_files() {
    let place = tempfile::tempdir().unwrap();
    let target = place.path().join("study");
    write_whole(&target, &report("one")).unwrap();
    let second = vec![artifact("report.json", "{\"files\": [\"b.txt\"]}"), artifact("b.txt", "two")];
    write_whole(&target, &second).unwrap();
    assert_eq!(names(&target), ["b.txt", "report.json"]);
    assert_eq!(names(place.path()), ["study"]);
}

/// The real report twice over itself: its own report.json must vouch for all of its files.
#[test]
fn a_rendered_report_can_be_written_again() {
    let place = tempfile::tempdir().unwrap();
    let target = place.path().join("study");
    let files = render(&super::mock::cornell()).unwrap();
    for _ in 0..2 {
        write_whole(&target, &files).unwrap();
    }
    let written = contents(&target);
    assert_eq!(written.len(), files.len());
    assert!(files.iter().all(|file| written[&file.name] == file.bytes));
}

#[test]
fn an_empty_folder_and_droppings_of_file_managers_are_no_obstacle() {
    let place = tempfile::tempdir().unwrap();
    let target = place.path().join("study");
    fs::create_dir(&target).unwrap();
    write_whole(&target, &report("one")).unwrap();
    fs::write(target.join(".DS_Store"), "x").unwrap();
    write_whole(&target, &report("two")).unwrap();
    assert_eq!(contents(&target)["a.txt"], b"two");
}

/// Whatever is not ours is refused by name and stays as it was.
#[test]
fn what_is_not_a_report_is_left_alone() {
    let place = tempfile::tempdir().unwrap();
    let target = place.path().join("study");
    let refused = |reason: Foreign| {
        let before = contents(&target);
        match write_whole(&target, &report("new")) {
            Err(ReportError::NotAReport { reason: found, .. }) => assert_eq!(found, reason),
            other => panic!("{other:?}"),
        }
        assert_eq!(contents(&target), before);
        assert_eq!(names(place.path()), ["study"]);
    };

    // A folder of someone's notes; the same with a report.json that lists nothing; a report with a note in it.
    fs::create_dir(&target).unwrap();
    fs::write(target.join("thesis.tex"), "years of work").unwrap();
    refused(Foreign::NoManifest);
    fs::write(target.join("report.json"), "{}").unwrap();
    refused(Foreign::NoManifest);
    fs::write(target.join("report.json"), "{\"files\": [\"a.txt\"]}").unwrap();
    refused(Foreign::Stranger("thesis.tex".into()));
    fs::remove_file(target.join("thesis.tex")).unwrap();
    fs::create_dir(target.join("photos")).unwrap();
    refused(Foreign::Stranger("photos".into()));
}

#[test]
fn a_file_in_the_way_is_left_alone() {
    let place = tempfile::tempdir().unwrap();
    let target = place.path().join("study");
    fs::write(&target, "mine").unwrap();
    assert!(matches!(write_whole(&target, &report("new")), Err(ReportError::NotAFolder { .. })));
    assert_eq!(fs::read(&target).unwrap(), b"mine");

    // And so is a file where a parent should be.
    assert!(matches!(write_whole(&target.join("deeper"), &report("new")), Err(ReportError::Write { .. })));
    assert_eq!(names(place.path()), ["study"]);
}

#[test]
fn names_that_lead_elsewhere_or_come_twice_are_refused_before_anything_is_written() {
    let place = tempfile::tempdir().unwrap();
    let target = place.path().join("study");
    for name in ["", ".", "..", "../a", "a/b", "a\\b", "C:a", ".hidden"] {
        let outcome = write_whole(&target, &[artifact(name, "x")]);
        assert!(matches!(outcome, Err(ReportError::ArtifactName(found)) if found == name), "{name:?}");
    }
    let twice = [artifact("a.txt", "x"), artifact("A.txt", "y")];
    assert!(matches!(write_whole(&target, &twice), Err(ReportError::ArtifactName(_))));
    assert!(matches!(write_whole(Path::new("/"), &report("x")), Err(ReportError::Nameless { .. })));
    assert!(names(place.path()).is_empty());
}

/// The last name is too long for the file system, after the first file is written: nothing of either is left, and an
/// older report stays whole.
#[test]
fn a_failure_half_way_leaves_no_trace() {
    let place = tempfile::tempdir().unwrap();
    let target = place.path().join("study");
    let mut files = report("new");
    files.push(artifact(&"n".repeat(5000), "x"));
    assert!(matches!(write_whole(&target, &files), Err(ReportError::Write { action: "writing", .. })));
    assert!(names(place.path()).is_empty());

    write_whole(&target, &report("old")).unwrap();
    assert!(write_whole(&target, &files).is_err());
    assert_eq!(contents(&target)["a.txt"], b"old");
    assert_eq!(names(place.path()), ["study"]);
}

#[cfg(unix)]
#[test]
fn a_link_to_a_report_stays_a_link_and_a_dangling_one_is_refused() {
    let place = tempfile::tempdir().unwrap();
    let (real, link) = (place.path().join("real"), place.path().join("link"));
    write_whole(&real, &report("one")).unwrap();
    std::os::unix::fs::symlink(&real, &link).unwrap();
    write_whole(&link, &report("two")).unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(contents(&real)["a.txt"], b"two");

    fs::remove_dir_all(&real).unwrap();
    assert!(matches!(write_whole(&link, &report("three")), Err(ReportError::Write { .. })));
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
}

#[cfg(unix)]
#[test]
fn others_may_read_what_the_user_lets_them_read() {
    use std::os::unix::fs::PermissionsExt;
    let place = tempfile::tempdir().unwrap();
    let (plain, target) = (place.path().join("plain"), place.path().join("study"));
    fs::create_dir(&plain).unwrap();
    write_whole(&target, &report("one")).unwrap();
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&target), mode(&plain));
}
