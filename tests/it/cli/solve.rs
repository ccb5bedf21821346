//! `etendue solve`: the object it prints, its numbers, its files.

use super::{CORNELL, Desk, etendue, number, numbers};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::fs;

/// Relative; a radiance whose residual is at most 1e-12 of the emission is off by at most 1e-12 of itself in a furnace, where both
/// grow by 1 / (1 − a).
const FURNACE_ERROR: f64 = 1e-12;

/// Relative; the area of a patch, and π times it, come out of a few products and sums.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

fn solve(arguments: &[&str]) -> Value {
    Desk::new(&[]).json(&[&["solve", "--json", "--quiet"], arguments].concat())
}

/// The fields of an object are exactly these.
fn assert_fields(value: &Value, names: &[&str]) {
    let mut found: Vec<&str> = value.as_object().expect("an object").keys().map(String::as_str).collect();
    let mut names = names.to_vec();
    found.sort_unstable();
    names.sort_unstable();
    assert_eq!(found, names);
}

#[test]
fn the_object_has_every_field_in_its_shape() {
    let object = solve(&["cornell-box", "--patch-size", "1"]);
    assert_fields(
        &object,
        &[
            "schema",
            "scene",
            "n_bundles",
            "n_bands",
            "bands",
            "bundles",
            "laws",
            "exchange",
            "report",
            "duality",
            "notes",
            "provenance",
        ],
    );
    assert_eq!(object["schema"], "etendue.solve/1");
    assert_eq!((&object["scene"], &object["bands"]), (&json!("cornell-box"), &json!(["red", "green", "blue"])));
    let bundles = object["bundles"].as_array().unwrap();
    let n_bands = object["n_bands"].as_u64().unwrap() as usize;
    assert_eq!((object["n_bundles"].as_u64(), n_bands), (Some(bundles.len() as u64), 3));

    for (k, bundle) in bundles.iter().enumerate() {
        let per_band = ["emission", "radiance", "irradiance"];
        let fields = ["element", "surface", "side", "centre", "normal", "area", "bin", "etendue"];
        assert_fields(bundle, &[&fields[..], &per_band].concat());
        assert_eq!((bundle["element"].as_u64(), bundle["bin"].as_u64()), (Some(k as u64), Some(0)));
        assert_eq!(bundle["side"], "front");
        assert!(!bundle["surface"].as_str().unwrap().is_empty());
        assert_eq!(numbers(&bundle["centre"]).len(), 3);
        let normal = numbers(&bundle["normal"]);
        let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!(normal.len() == 3 && (length - 1.0).abs() < ROUNDING, "{normal:?}");
        for quantity in per_band {
            let values = numbers(&bundle[quantity]);
            assert!(values.len() == n_bands && values.iter().all(|v| *v >= 0.0), "{quantity}: {values:?}");
        }
    }
    assert_fields(&object["laws"], &["reciprocity", "closure", "positivity", "conservation"]);
    let counts = ["n_iterations", "n_applies", "n_adjoint_applies"];
    let rest = ["solver", "stop", "products", "true_residual", "error_bound", "seconds"];
    assert_fields(&object["report"], &[&counts[..], &rest].concat());
    assert!(counts.iter().all(|count| object["report"][count].is_u64()));
    assert_eq!((&object["report"]["solver"], &object["report"]["stop"]), (&json!("cg"), &json!("converged")));
    let dual = ["sensor", "unit", "solver", "reading", "dual_reading", "difference", "stop", "products", "seconds"];
    assert_fields(&object["duality"], &dual);
    assert_fields(
        &object["provenance"],
        &["version", "command", "scene", "scene_hash", "patch_size", "n_directions", "seed", "settings"],
    );
    assert_eq!(object["provenance"]["scene_hash"].as_str().map(str::len), Some(64));
    assert_eq!(object["provenance"]["settings"]["solver_tolerance"], "1e-12");
}

/// Of the white, the green and the red of the Cornell box.
fn albedo(surface: &str) -> [f64; 3] {
    match surface {
        "green-wall" => [0.105421, 0.37798, 0.076425],
        "red-wall" => [0.570068, 0.0430135, 0.0443706],
        _ => [0.885809, 0.698859, 0.666422],
    }
}

#[test]
fn the_numbers_are_those_of_the_equation() {
    let object = solve(&["cornell-box", "--patch-size", "0.6"]);
    for law in ["reciprocity", "closure", "positivity", "conservation"] {
        assert!(number(&object["laws"][law]) <= 1e-12, "{law}: {}", object["laws"]);
    }
    let residual = number(&object["report"]["true_residual"]);
    assert!(residual <= 1e-12, "{residual}");

    let light: [f64; 3] = [18.387, 13.9873, 6.75357];
    let mut areas: BTreeMap<&str, f64> = BTreeMap::new();
    for bundle in object["bundles"].as_array().unwrap() {
        let (surface, area) = (bundle["surface"].as_str().unwrap(), number(&bundle["area"]));
        *areas.entry(surface).or_default() += area;
        assert!((number(&bundle["etendue"]) / (PI * area) - 1.0).abs() < ROUNDING, "{bundle}");
        assert_eq!(numbers(&bundle["emission"]), if surface == "light" { light } else { [0.0; 3] });

        // Light gets everywhere but under the boxes.
        let under_a_box = surface.ends_with("-box") && numbers(&bundle["normal"])[1] < -0.5;
        assert!(numbers(&bundle["radiance"]).iter().all(|l| *l > 0.0 || under_a_box), "{bundle}");

        // L = E + albedo H / π, to the residual that is reported.
        let [emission, radiance, irradiance] = ["emission", "radiance", "irradiance"].map(|q| numbers(&bundle[q]));
        for band in 0..3 {
            let reflected = albedo(surface)[band] * irradiance[band] / PI;
            let allowed = 1.1 * residual * light[band] + ROUNDING * radiance[band];
            assert!((radiance[band] - emission[band] - reflected).abs() <= allowed, "{surface}: {bundle}");
        }
    }
    // The areas are those of the scene: sides of 2, a lamp of 0.46 × 0.38.
    for (surface, area) in [("floor", 4.0), ("back", 4.0), ("red-wall", 4.0), ("light", 0.46 * 0.38)] {
        assert!((areas[surface] / area - 1.0).abs() < 64.0 * ROUNDING, "{surface}: {}", areas[surface]);
    }
}

#[test]
fn every_solver_answers_the_furnace() {
    let exact = [2.0, 2.0, 2.5];
    for method in etendue::solver::all(1e-12) {
        let object = solve(&["furnace-cube", "--patch-size", "0.5", "--solver", method.name()]);
        let report = &object["report"];
        assert_eq!(report["solver"], method.name());
        assert_eq!(report["stop"], if method.is_direct() { "direct" } else { "converged" });
        for bundle in object["bundles"].as_array().unwrap() {
            for (radiance, exact) in numbers(&bundle["radiance"]).iter().zip(exact) {
                assert!((radiance / exact - 1.0).abs() <= FURNACE_ERROR, "{}: {radiance}", method.name());
            }
        }
        let bound = number(&report["error_bound"]);
        assert!(bound > 0.0 && bound < 1e-11, "{}: {bound}", method.name());
    }
}

#[test]
fn the_numbers_do_not_depend_on_the_number_of_threads() {
    for solver in ["cg", "lu"] {
        // All digits of all bundles and laws, as text.
        let results = ["1", "2", "3", "8"].map(|n_threads| {
            let scene = ["solve", CORNELL, "--patch-size", "0.8", "--json", "--solver", solver, "--threads", n_threads];
            let text = etendue(&scene).stdout;
            let (from, to) = (text.find("\"bundles\"").unwrap(), text.find("\"report\"").unwrap());
            text[from..to].to_string()
        });
        assert!(results[0].contains("radiance") && results[0].contains("closure"));
        for result in &results[1..] {
            assert_eq!(*result, results[0], "{solver}");
        }
    }
}

#[test]
fn the_seed_decides_what_is_sampled() {
    let radiance = |seed: &str| {
        let object = solve(&["cornell-box", "--patch-size", "0.8", "--visibility-rays", "64", "--seed", seed]);
        assert_eq!(object["provenance"]["seed"].to_string(), seed);
        object["bundles"].as_array().unwrap().iter().map(|bundle| bundle["radiance"].to_string()).collect::<Vec<_>>()
    };
    let first = radiance("20261");
    assert_eq!(first, radiance("20261"));
    assert_ne!(first, radiance("20262"));
}

#[test]
fn running_out_of_products_ends_in_6_with_the_answer_so_far() {
    let arguments = ["solve", "cornell-box", "--patch-size", "1", "--solver", "neumann", "--max-products", "2"];
    let run = etendue(&[&arguments[..], &["--json"]].concat());
    assert_eq!(run.code, Some(6), "{}", run.stderr);
    let object = run.object();
    assert_eq!((&object["report"]["stop"], &object["report"]["n_applies"]), (&json!("budget"), &json!(2)));
    for words in ["neumann did not converge", "2 products", "1e-12", "--max-products 2"] {
        assert!(run.stderr.contains(words), "{}", run.stderr);
    }
    let table = etendue(&arguments);
    assert!(table.code == Some(6) && table.stdout.contains("neumann: budget"), "{}", table.stdout);

    // A tolerance below rounding cannot be met, whatever the method believes.
    let run = etendue(&["solve", "furnace-cube", "--patch-size", "0.5", "--tolerance", "1e-40"]);
    assert!(run.code == Some(6) && run.stderr.contains("did not converge"), "{}", run.stderr);
}

#[test]
fn light_that_nothing_absorbs_has_no_answer() {
    let desk = Desk::new(&[("white.xml", super::FURNACE.as_bytes())]);
    let white = ["white.xml", "-D", "albedo=1", "--patch-size", "2"];
    for solver in ["cg", "lu"] {
        let run = desk.run(&[&["solve", "--solver", solver], &white[..]].concat());
        assert_eq!(run.code, Some(6), "{solver}: {}", run.stderr);
        assert!(run.stderr.contains("no steady state"), "{solver}: {}", run.stderr);
    }
    // Whether rounding leaves the matrix singular decides if the solver or the walk notices first.
    let run = desk.run(&[&["study"], &white[..]].concat());
    run.assert_refused(if run.stderr.contains("never ends") { 4 } else { 6 }, &[]);
    assert_eq!(desk.names("."), ["white.xml"]);
}

#[test]
fn output_is_a_whole_file_with_the_same_object() {
    let desk = Desk::new(&[("old.json", b"old")]);
    for (flags, name) in [(&["--json"][..], "new.json"), (&[], "old.json")] {
        let run = desk.run(&[&["solve", "furnace-cube", "--patch-size", "1", "--quiet", "-o", name], flags].concat());
        assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
        let written = super::read_json(&desk.path(name));
        assert_eq!(written["schema"], "etendue.solve/1");
        if flags.is_empty() {
            assert!(run.stdout.contains("mean radiance"), "{}", run.stdout);
        } else {
            assert_eq!(written, run.object());
        }
    }
    assert_eq!(desk.names("."), ["new.json", "old.json"]);
    // A run that fails leaves what was there.
    desk.run(&["solve", "furnace-cube", "--memory", "1", "-o", "old.json"])
        .assert_refused(5, &["1 B", "no --patch-size would fit"]);
    assert!(fs::read_to_string(desk.path("old.json")).unwrap().contains("etendue.solve/1"));
}

#[test]
fn the_table_lists_surfaces_bands_and_laws() {
    let run = etendue(&["solve", "cornell-box", "--patch-size", "1"]);
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let lines: Vec<&str> = run.stdout.lines().collect();
    assert!(lines[0].contains("mean radiance, W m⁻² sr⁻¹") && lines[0].contains("mean irradiance, W m⁻²"));
    assert_eq!(
        lines[1].split_whitespace().collect::<Vec<_>>(),
        ["surface", "red", "green", "blue", "red", "green", "blue"]
    );
    // Eight surfaces, six numbers each, every line as long as the heading.
    for line in &lines[2..10] {
        let words: Vec<&str> = line.split_whitespace().collect();
        assert!(words.len() == 7 && words[1..].iter().all(|word| word.parse::<f64>().is_ok()), "{line}");
        assert_eq!(line.chars().count(), lines[1].chars().count(), "{line}");
    }
    let laws = lines.iter().find(|line| line.starts_with("laws")).expect("the laws are told");
    for law in ["reciprocity", "closure", "positivity", "conservation"] {
        assert!(laws.contains(law), "{laws}");
    }
}
