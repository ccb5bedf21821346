//! `etendue export`, `solve --matrix`, `sensitivity`, `spectrum`: matrices out and in, and what is read off them.

use super::{Desk, etendue, number, numbers};
use serde_json::Value;
use std::fs;

/// Two unknowns of which each sees the other: K = ((0, 0.4), (0.1, 0)), E = (1, 0); L = (1, 0.1) / 0.96.
const K: &[u8] = b"%%MatrixMarket matrix coordinate real general\n2 2 2\n1 2 0.4\n2 1 0.1\n";
const E: &[u8] = b"%%MatrixMarket matrix array real general\n2 1\n1\n0\n";

#[test]
fn an_exported_equation_has_the_answer_of_its_scene() {
    let desk = Desk::new(&[]);
    let scene = ["furnace-cube", "--patch-size", "0.5"];
    for format in ["mtx", "npz", "radiance"] {
        let what = ["--json", "--quiet", "--what", "K,E,T", "--format", format, "-o", format];
        let exported = desk.json(&[&["export"], &scene[..], &what].concat());
        assert_eq!(exported["schema"], "etendue.export/1");
        let files: Vec<&str> = exported["files"].as_array().unwrap().iter().map(|f| f.as_str().unwrap()).collect();
        let mut names = files.clone();
        names.sort_unstable();
        assert_eq!(desk.names(format), names);
        let text = fs::read_to_string(desk.path(format).join("report.json")).unwrap();
        assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), exported);
        for matrix in exported["matrices"].as_array().unwrap() {
            let bytes = fs::read(desk.path(format).join(matrix["file"].as_str().unwrap())).unwrap();
            assert_eq!(matrix["blake3"], etendue::linalg::format::content_hash(&bytes));
        }

        // A file a band, or one with a component a band: K of red with E of all, or all with all.
        let first = |letter: &str| files.iter().find(|name| name.starts_with(letter)).unwrap();
        let [k, e] = [first("K"), first("E")].map(|name| format!("{format}/{name}"));
        let solved = desk.json(&["solve", "--json", "--quiet", "--solver", "lu", "--matrix", &k, "--emission", &e]);
        assert_eq!(solved["schema"], "etendue.solve-matrix/1");
        let bands = solved["radiance"].as_array().unwrap();
        assert_eq!(bands.len(), 3);
        // The furnace of albedo 0.5 that emits 1 glows with 2.
        assert!(numbers(&bands[0]).iter().all(|l| (l - 2.0).abs() < 1e-12), "{format}");
    }

    // Only what a report of ours lists is replaced.
    fs::write(desk.path("mtx/notes.txt"), "mine").unwrap();
    let run = desk.run(&[&["export"], &scene[..], &["-o", "mtx"]].concat());
    assert_eq!(run.code, Some(4));
    assert!(run.stderr.contains("notes.txt") && desk.path("mtx/notes.txt").exists(), "{}", run.stderr);
}

#[test]
fn an_equation_of_someone_else_is_solved_within_bounds() {
    let desk = Desk::new(&[("K.mtx", K), ("E.mtx", E)]);
    let solved =
        desk.json(&["solve", "--json", "--quiet", "--solver", "gmres", "--matrix", "K.mtx", "--emission", "E.mtx"]);
    let list = |name: &str| numbers(&solved[name][0]);
    for (i, exact) in [1.0 / 0.96, 0.1 / 0.96].into_iter().enumerate() {
        assert!((list("radiance")[i] - exact).abs() < 1e-11);
        assert!(list("low")[i] <= exact && exact <= list("high")[i]);
    }
    let run = desk.run(&["solve", "--matrix", "K.mtx", "--emission", "E.mtx", "--solver", "lu"]);
    assert!(run.code == Some(0) && run.stdout.contains("2 unknowns"), "{}{}", run.stdout, run.stderr);
}

#[test]
fn rows_that_gain_are_named_and_divergence_ends_in_6() {
    let gaining = b"%%MatrixMarket matrix coordinate real general\n2 2 2\n1 2 1.5\n2 1 1.2\n";
    let desk = Desk::new(&[("K.mtx", gaining), ("E.mtx", E)]);
    let run = desk.run(&["solve", "--solver", "neumann", "--matrix", "K.mtx", "--emission", "E.mtx"]);
    assert_eq!(run.code, Some(6));
    assert!(run.stderr.contains("row 0 of K sums to 1.5") && run.stderr.contains("diverges"), "{}", run.stderr);
}

#[test]
fn files_that_are_no_equation_are_refused_with_their_place() {
    let wide = b"%%MatrixMarket matrix array real general\n1 2\n1\n2\n";
    let broken = b"%%MatrixMarket matrix coordinate real general\n2 2 1\n1 x 1\n";
    let long = b"%%MatrixMarket matrix array real general\n3 1\n1\n2\n3\n";
    let desk = Desk::new(&[("K.mtx", K), ("E.mtx", E), ("wide.mtx", wide), ("broken.mtx", broken), ("long.mtx", long)]);
    for (matrix, emission, said) in [
        ("wide.mtx", "E.mtx", "1 × 2"),
        ("broken.mtx", "E.mtx", "broken.mtx:3:3"),
        ("K.mtx", "long.mtx", "3 rows"),
        ("none.mtx", "E.mtx", "none.mtx"),
        ("K.mtx", "E.csv", ".csv"),
    ] {
        let run = desk.run(&["solve", "--matrix", matrix, "--emission", emission]);
        assert_eq!(run.code, Some(4), "{}", run.stderr);
        assert!(run.stderr.starts_with("error[E06") && run.stderr.contains(said), "{}", run.stderr);
    }
    let run = desk.run(&["solve", "--matrix", "K.mtx", "--emission", "E.mtx", "--memory", "10B"]);
    assert_eq!(run.code, Some(5), "{}", run.stderr);
    let run = desk.run(&["solve", "--matrix", "K.mtx"]);
    assert_eq!(run.code, Some(64), "{}", run.stderr);
    let run = desk.run(&["solve"]);
    assert_eq!(run.code, Some(64), "{}", run.stderr);
}

#[test]
fn a_sensor_is_read_twice_and_unknown_surfaces_are_refused() {
    let desk = Desk::new(&[]);
    let scene = ["sensitivity", "cornell-box", "--patch-size", "1", "--sensor"];
    let found = desk.json(&[&scene[..], &["irradiance:floor", "--json", "--quiet"]].concat());
    let (reading, dual) = (numbers(&found["reading"]), numbers(&found["dual_reading"]));
    assert!(reading.iter().zip(&dual).all(|(a, b)| (a / b - 1.0).abs() < 1e-10));
    for surface in found["surfaces"].as_array().unwrap() {
        assert!(numbers(&surface["albedo"]).iter().chain(&numbers(&surface["emission"])).all(|d| *d >= 0.0));
    }
    let run = desk.run(&[&scene[..], &["irradiance:roof"]].concat());
    assert!(run.code == Some(4) && run.stderr.contains("'floor'"), "{}", run.stderr);
}

#[test]
fn the_spectrum_of_a_furnace_is_led_by_its_albedo() {
    let desk = Desk::new(&[]);
    let found = desk.json(&["spectrum", "furnace-cube", "--patch-size", "0.5", "-o", "s", "--json", "--quiet"]);
    for (band, albedo) in found["bands"].as_array().unwrap().iter().zip([0.5, 0.75, 0.9]) {
        let radius = numbers(&band["radius"]);
        assert!(radius[0] <= albedo + 1e-13 && albedo - 1e-13 <= radius[1], "{band}");
        assert!((numbers(&band["eigenvalues"][0])[0] - albedo).abs() < 1e-9);
        assert!(number(&band["condition"]) >= 1.0);
    }
    assert_eq!(desk.names("s"), ["report.json", "spectrum.csv", "spectrum.png", "spectrum.svg"]);
}

#[test]
fn what_if_answers_are_exact_and_told_beside_what_the_derivatives_foretold() {
    let desk = Desk::new(&[]);
    let scene = ["sensitivity", "cornell-box", "--patch-size", "1", "--sensor", "irradiance:floor", "--quiet"];
    let changes = ["--what-if", "light.emission=9", "--what-if", "back.albedo=0.3,0.2,0.1"];
    let object = desk.json(&[&scene[..], &changes, &["--json"]].concat());
    let found = object["what_ifs"].as_array().unwrap();
    assert_eq!(found.len(), 2);
    for what in found {
        let [exact, first_order, fresh] = ["reading", "first_order", "fresh"].map(|name| numbers(&what[name]));
        for band in 0..3 {
            // A fresh solution by conjugate gradients to 1e-12 of the emission.
            assert!((exact[band] / fresh[band] - 1.0).abs() < 1e-10, "{what}");
            // Light is linear in emission, and only nearly so in albedo.
            let gap = (first_order[band] / exact[band] - 1.0).abs();
            let is_linear = what["change"] == "light.emission=9";
            assert!(if is_linear { gap < 1e-10 } else { gap > 1e-3 && gap < 0.2 }, "{gap} {what}");
        }
    }
    // An emission changes no row of K; the back wall of 5 patches or so its own.
    assert!(found[0]["n_rows"] == 0 && found[1]["n_rows"].as_u64().is_some_and(|n| n > 0 && n < 20), "{object}");
    let table = desk.run(&[&scene[..], &changes].concat()).stdout;
    for words in ["light.emission=9         exactly", "first order", "solved afresh", "back.albedo=0.3,0.2,0.1"] {
        assert!(table.contains(words), "'{words}' is not in: {table}");
    }
}

#[test]
fn what_is_no_change_of_a_surface_is_refused() {
    let cases: [(&str, &[&str]); 9] = [
        ("floor", &["no change of a surface", "SURFACE.albedo=VALUE"]),
        ("floor=0.3", &["no change of a surface"]),
        ("flor.albedo=0.3", &["there is no surface 'flor'", "'floor'"]),
        ("floor.colour=0.3", &["'colour' is no property", "SURFACE.emission=VALUE"]),
        ("floor.albedo=1.5", &["'1.5' is out of range", "from 0 to 1"]),
        ("floor.albedo=nan", &["'nan' is out of range"]),
        ("light.emission=-1", &["'-1' is out of range", "0 or more"]),
        ("light.emission=inf", &["'inf' is out of range"]),
        ("floor.albedo=0.1,0.2", &["there are 2 values", "red, green, blue"]),
    ];
    for (change, words) in cases {
        let run = etendue(&["sensitivity", "cornell-box", "--sensor", "radiance:floor", "--what-if", change]);
        run.assert_refused(4, &[&["--what-if", change][..], words].concat());
        assert!(run.took < super::AT_ONCE, "{change}");
    }
}
