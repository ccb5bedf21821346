//! Arguments, help, streams.

use super::{Desk, etendue};
use std::process::Stdio;

#[test]
fn help_and_version_are_no_errors() {
    for arguments in [&["--help"][..], &["-h"], &["help"], &["help", "solve"], &["solve", "--help"], &["study", "-h"]] {
        let run = etendue(arguments);
        assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{arguments:?}");
        assert!(run.stdout.contains("Usage:"), "{arguments:?}");
    }
    let version = etendue(&["--version"]);
    assert_eq!(
        (version.code, version.stdout.as_str()),
        (Some(0), concat!("etendue ", env!("CARGO_PKG_VERSION"), "\n"))
    );
    let help = etendue(&["--help"]).stdout;
    for words in
        ["Exit codes: 0 ok, 2 check failed, 4 input, 5 memory, 6 not converged, 64 usage, 70 internal", "gallery"]
    {
        assert!(help.contains(words), "{help}");
    }
}

#[test]
fn misuse_ends_in_64_and_says_what_was_expected() {
    let cases: [(&[&str], &[&str]); 20] = [
        (&["--bogus"], &["--bogus"]),
        (&["solve"], &["<SCENE>"]),
        (&["study"], &["<SCENE>"]),
        (&["sovle", "cornell-box"], &["sovle", "similar", "solve"]),
        (&["solve", "furnace-cube", "--patchsize", "1"], &["--patchsize", "--patch-size"]),
        (&["solve", "furnace-cube", "furnace-cube"], &["unexpected argument"]),
        (&["solve", "furnace-cube", "--patch-size", "abc"], &["abc", "above zero"]),
        (&["solve", "furnace-cube", "--patch-size", "-1"], &["-1", "above zero"]),
        (&["solve", "furnace-cube", "--patch-size", "0"], &["above zero"]),
        (&["solve", "furnace-cube", "--patch-size", "nan"], &["nan", "finite"]),
        (&["solve", "furnace-cube", "--tolerance", "inf"], &["inf", "finite"]),
        (&["solve", "furnace-cube", "--memory", "lots"], &["lots", "8GiB"]),
        (&["solve", "furnace-cube", "--memory", "0GiB"], &["0GiB", "8GiB"]),
        (&["solve", "furnace-cube", "--solver", "gc"], &["gc", "gauss-seidel", "southwell", "cg"]),
        (&["solve", "furnace-cube", "--max-products", "0"], &["0", "whole number from 1"]),
        (&["solve", "furnace-cube", "--seed", "1.5"], &["1.5"]),
        (&["solve", "furnace-cube", "--threads", "0"], &["0", "whole number from 1 to 1024"]),
        (&["solve", "furnace-cube", "-D", "albedo"], &["albedo", "NAME=VALUE"]),
        (&["study", "furnace-cube", "--walk-samples", "1"], &["whole number from 4"]),
        (&["solve", "furnace-cube", "-q", "-v"], &["--quiet", "--verbose", "cannot be used with"]),
    ];
    for (arguments, words) in cases {
        etendue(arguments).assert_refused(64, words);
    }
    // Without a command there is only help to give.
    let run = etendue(&[]);
    assert_eq!((run.code, run.stdout.as_str()), (Some(64), ""));
    assert!(run.stderr.contains("Usage:"), "{}", run.stderr);
}

#[test]
fn gallery_lists_every_scene() {
    let (plain, object) = (etendue(&["gallery"]), etendue(&["gallery", "--json"]).object());
    assert_eq!((plain.code, plain.stderr.as_str()), (Some(0), ""));
    let entries = etendue::gallery::list();
    assert_eq!(plain.stdout.lines().count(), entries.len());
    assert_eq!(object["schema"], "etendue.gallery/1");
    assert_eq!(object["scenes"].as_array().map(Vec::len), Some(entries.len()));
    for (k, (entry, line)) in entries.iter().zip(plain.stdout.lines()).enumerate() {
        assert!(line.starts_with(entry.name) && line.contains(entry.summary), "{line}");
        assert_eq!(object["scenes"][k]["name"], entry.name);
    }
}

#[test]
fn a_reader_that_hangs_up_is_no_error() {
    // More than a pipe holds: the program is still writing when nobody reads any more.
    let desk = Desk::new(&[]);
    let arguments = ["solve", "furnace-cube", "--patch-size", "0.15", "--json", "--quiet"];
    assert!(desk.run(&arguments).stdout.len() > 1 << 16);
    let mut child = desk.command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), output.stderr), (Some(0), Vec::new()));
}

#[test]
fn standard_error_is_empty_plain_or_detailed_as_asked() {
    let desk = Desk::new(&[]);
    let stderr = |flags: &[&str]| {
        let run = desk.run(&[&["solve", "furnace-cube", "--patch-size", "0.5"], flags].concat());
        assert_eq!(run.code, Some(0), "{}", run.stderr);
        // Off the terminal there are no bars: no escape sequence, no carriage return.
        assert!(!run.stderr.contains(['\u{1b}', '\r']), "{:?}", run.stderr);
        run.stderr
    };
    assert_eq!(stderr(&["--quiet"]), "");
    let plain = stderr(&[]);
    assert!(plain.contains("24 bundles at patch size 0.5") && !plain.contains("preset"), "{plain}");
    let detailed = stderr(&["-v"]);
    assert!(detailed.lines().any(|line| line.trim_start().starts_with("assemble ")), "{detailed}");
    assert!(stderr(&["-vv"]).contains("residual"));
}

#[test]
fn presets_are_named_as_such() {
    let run = etendue(&["solve", "furnace-cube", "--memory", "64MiB"]);
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    assert!(run.stderr.contains("patch size 0.125 (preset; --patch-size chooses another)"), "{}", run.stderr);
}
