//! `etendue study`: the folder it writes, and what it prints.

use super::{CORNELL, Desk, FURNACE, read_json};
use etendue::image::decode_exr;
use std::fs;

/// Enough samples for a report, too few for a good one.
const FEW: [&str; 4] = ["--walk-samples", "16", "--path-samples", "16"];

/// Holds a file to the beginning and the end of its format.
fn assert_whole(name: &str, bytes: &[u8]) {
    let text = || std::str::from_utf8(bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
    match name.rsplit('.').next() {
        Some("png") => assert!(bytes.starts_with(b"\x89PNG") && bytes.windows(4).any(|w| w == b"IEND"), "{name}"),
        Some("exr") => {
            let image = decode_exr(bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert!(image.width == image.height && image.width > 0, "{name}");
            assert!(image.values.iter().all(|value| value.is_finite() && *value >= 0.0), "{name}");
        }
        Some("svg") => assert!(text().contains("<svg") && text().trim_end().ends_with("</svg>"), "{name}"),
        Some("html") => assert!(text().starts_with("<!") && text().trim_end().ends_with("</html>"), "{name}"),
        Some("csv") => assert!(text().lines().count() > 1 && text().ends_with('\n'), "{name}"),
        Some("json") => assert!(serde_json::from_slice::<serde_json::Value>(bytes).is_ok(), "{name}"),
        _ => panic!("{name} is no file of a report"),
    }
}

/// Holds a folder to its list, and every file in it to its format.
fn assert_folder(desk: &Desk, folder: &str) -> Vec<String> {
    let report = read_json(&desk.path(folder).join("report.json"));
    let mut listed: Vec<String> =
        report["files"].as_array().unwrap().iter().map(|name| name.as_str().unwrap().to_string()).collect();
    listed.push("report.json".into());
    listed.sort();
    let found = desk.names(folder);
    assert_eq!(found, listed);
    for name in &found {
        assert_whole(name, &fs::read(desk.path(folder).join(name)).unwrap());
    }
    found
}

#[test]
fn a_study_writes_its_folder_whole_and_replaces_its_own() {
    let desk = Desk::new(&[]);
    let scene = ["study", CORNELL, "-D", "resolution=12", "--patch-size", "1", "--solvers", "all"];

    // By default to out/SCENE, with a summary for people.
    let first = desk.run(&[&scene[..], &FEW].concat());
    assert_eq!(first.code, Some(0), "{}", first.stderr);
    assert!(!first.stderr.contains(['\u{1b}', '\r']), "{:?}", first.stderr);
    let names = assert_folder(&desk, "out/cornell");
    let solved = decode_exr(&fs::read(desk.path("out/cornell/solved.exr")).unwrap()).unwrap();
    assert_eq!((solved.width, solved.height), (12, 12));
    for name in ["report.html", "report.json", "convergence.svg", "convergence.png", "convergence.csv", "solved.exr"] {
        assert!(names.iter().any(|found| found == name), "{name} is not in {names:?}");
    }
    assert_eq!(desk.names("out"), ["cornell"]);
    for method in etendue::solver::all(1.0) {
        assert!(first.stdout.lines().any(|line| line.starts_with(method.name())), "{}", first.stdout);
    }
    assert!(first.stdout.trim_end().ends_with("report.html"), "{}", first.stdout);

    // Again, replacing it: with --json, the object printed is the one written.
    fs::remove_file(desk.path("out/cornell/solved.exr")).unwrap();
    let second = desk.run(&[&scene[..], &FEW, &["--json", "--quiet", "--seed", "4711"]].concat());
    assert_eq!((second.code, second.stderr.as_str()), (Some(0), ""));
    assert_eq!(assert_folder(&desk, "out/cornell"), names);
    assert_eq!(second.object(), read_json(&desk.path("out/cornell/report.json")));
    assert_eq!(second.object()["provenance"]["seed"], 4711);

    // Once something else lies in it, it is nobody's to replace.
    fs::write(desk.path("out/cornell/notes.txt"), "mine").unwrap();
    desk.run(&[&scene[..], &FEW].concat()).assert_refused(4, &["notes.txt", "not a report"]);
    assert!(desk.path("out/cornell/notes.txt").exists());
}

#[test]
fn a_scene_without_a_camera_has_a_report_without_pictures() {
    let desk = Desk::new(&[("room.xml", FURNACE.as_bytes())]);
    let run = desk.run(&[&["study", "room.xml", "--patch-size", "1", "-o", "a/b/report", "--json"], &FEW[..]].concat());
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    let names = assert_folder(&desk, "a/b/report");
    assert!(names.iter().all(|name| !name.ends_with(".exr")), "{names:?}");
    let object = run.object();
    assert_eq!((object["scene"].as_str(), object["n_bundles"].as_u64()), (Some("room"), Some(24)));
    for run in object["solvers"].as_array().unwrap() {
        assert!(super::number(&run["true_residual"]) <= 1e-12, "{run}");
    }
}

#[test]
fn albedos_are_looked_at_in_order_and_within_their_budget() {
    let desk = Desk::new(&[("room.xml", FURNACE.as_bytes())]);
    let arguments = [
        &["study", "room.xml", "--patch-size", "1", "--solvers", "gth,neumann,cg", "-o", "report"][..],
        &["--albedo", "0.99,0.5", "--max-products", "50"],
        &FEW,
    ]
    .concat();
    let run = desk.run(&arguments);
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    // 0.5⁴⁰ is the first power of ½ below 10⁻¹²; at 0.99 it takes 2750.
    let table = run.stdout.split("products and error against gth at albedo").nth(1).expect("a table of albedos");
    let neumann = table.lines().find(|line| line.starts_with("neumann")).expect("a line of the Neumann series");
    let words: Vec<&str> = neumann.split_whitespace().collect();
    assert!(words[1] == "40.0" && words[3] == ">50", "{neumann}");
    assert!(run.stdout.contains("duality by gth: reflected flux of all surfaces"), "{}", run.stdout);
    let names = assert_folder(&desk, "report");
    for name in ["albedos.svg", "albedos.png", "albedos.csv"] {
        assert!(names.iter().any(|found| found == name), "{name} is not in {names:?}");
    }

    let albedos = &read_json(&desk.path("report/report.json"))["albedos"];
    assert_eq!((super::number(&albedos["budget"]), albedos["reference_solver"].as_str()), (50.0, Some("gth")));
    let levels = albedos["levels"].as_array().unwrap();
    assert_eq!(levels.iter().map(|level| super::number(&level["albedo"])).collect::<Vec<_>>(), [0.5, 0.99]);
    for level in levels {
        let runs = level["runs"].as_array().unwrap();
        let names: Vec<&str> = runs.iter().map(|run| run["solver"].as_str().unwrap()).collect();
        assert_eq!(names, ["gth", "neumann", "cg"]);
        assert_eq!(super::number(&runs[0]["error"]), 0.0);
        assert!(super::number(&runs[2]["error"]) < 1e-11, "{}", runs[2]);
    }
    let neumann = |level: usize| &levels[level]["runs"][1];
    assert_eq!((neumann(0)["stop"].as_str(), neumann(1)["stop"].as_str()), (Some("converged"), Some("budget")));
    // After 50 bounces 0.99⁵⁰ of the light is still to come.
    assert!((super::number(&neumann(1)["error"]) - 0.99_f64.powi(50)).abs() < 1e-9, "{}", neumann(1));
}

#[test]
fn albedos_out_of_range_are_refused_before_the_work() {
    for (albedos, words) in [
        ("1", ["1 is out of range", "0 ≤ albedo < 1"]),
        ("0.5,1.5", ["1.5 is out of range", "nothing is absorbed"]),
        ("-0.1", ["-0.1 is out of range", "albedo"]),
        ("nan", ["NaN is out of range", "albedo"]),
    ] {
        let run = super::etendue(&["study", "maze", "--albedo", albedos]);
        run.assert_refused(4, &words);
        assert!(run.took < super::AT_ONCE, "{albedos}");
    }
    super::etendue(&["study", "maze", "--albedo", "white"]).assert_refused(64, &["white", "--albedo"]);
    super::etendue(&["study", "maze", "--max-products", "9"]).assert_refused(64, &["--albedo"]);
}

#[test]
fn a_black_scene_is_a_study_too() {
    // K = 0: there is no spectrum to foretell from, and what rests on a coarse space may say so.
    let desk = Desk::new(&[("room.xml", FURNACE.as_bytes())]);
    let black = ["study", "room.xml", "-D", "albedo=0", "--patch-size", "1", "--solvers", "all", "-o", "report"];
    let run = desk.run(&[&black[..], &FEW, &["--albedo", "0"]].concat());
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    for run in read_json(&desk.path("report/report.json"))["solvers"].as_array().unwrap() {
        assert!(run["stop"] == "refused" || super::number(&run["error"]) == 0.0, "{run}");
    }
}

#[test]
fn random_methods_are_chosen_by_name_and_the_path_tracer_is_always_there() {
    let desk = Desk::new(&[]);
    let scene = ["study", "furnace-cube", "--patch-size", "0.5", "--solvers", "gth,cg", "-o", "report", "--estimators"];
    let run = desk.run(&[&scene[..], &["sequential-walk,light-tracer,absorption-walk"], &FEW].concat());
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    for words in
        ["absorption-walk (discrete)", "path-tracer (continuous)", "light-tracer (continuous)", "sequential-walk:"]
    {
        assert!(run.stdout.contains(words), "'{words}' is not in\n{}", run.stdout);
    }
    let names = assert_folder(&desk, "report");
    for name in ["monte-carlo.svg", "sequential.svg", "sequential.csv", "estimators.csv"] {
        assert!(names.iter().any(|found| found == name), "{name} is not in {names:?}");
    }
    let report = read_json(&desk.path("report/report.json"));
    let runs = report["estimators"].as_array().unwrap();
    let found: Vec<&str> = runs.iter().map(|run| run["estimator"].as_str().unwrap()).collect();
    assert_eq!(found, ["absorption-walk", "path-tracer", "light-tracer"]);
    assert!(report["sequential"]["stages"].as_array().unwrap().len() > 1);
    let point = &runs[0]["points"][0];
    for key in ["samples_per_bundle", "error", "standard_error", "predicted", "steps", "seconds"] {
        assert!(!point[key].is_null(), "{key} is not in {point}");
    }
}

#[test]
fn an_unknown_random_method_is_refused_before_the_work_and_all_are_named() {
    let run = super::etendue(&["study", "maze", "--estimators", "patch-tracer,collision-walk"]);
    run.assert_refused(4, &["patch-tracer", "path-tracer", "collision-walk", "sequential-walk", "all"]);
    assert!(run.took < super::AT_ONCE);
}
