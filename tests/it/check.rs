//! Reference cases: what the check command says about them, and how it ends.

use etendue::oracle::cases::{self, CasesError, Verdict};
use serde_json::{Value, json};
use std::io::Write;
use std::process::{Command, Output};

/// The gallery's cases that are answered at once: exact polygons and closed scenes.
const QUICK: [&str; 8] =
    ["A-PAR-02", "A-TRI-D02", "A-EP-CLIP1", "A-ED-PERP1", "B-BLK-02", "C-BOX-2", "C-FURN-5", "G-LIN-3"];

fn etendue(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_etendue")).arg("check").args(arguments).output().expect("the program starts")
}

fn file(text: &str) -> tempfile::NamedTempFile {
    let mut file = tempfile::NamedTempFile::new().expect("a temporary file can be made");
    file.write_all(text.as_bytes()).expect("it can be written");
    file
}

/// A pair of facing unit squares at distance 1, with this reference for F_12.
fn squares(reference: &str) -> Value {
    json!([{
        "id": "squares", "group": "A", "family": "rectangles", "digits_certain": 12,
        "geometry": {
            "type": "polygon_pair",
            "polygon_1": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]],
            "polygon_2": [[0, 1, 1], [1, 1, 1], [1, 0, 1], [0, 0, 1]],
            "occluders": [],
        },
        "values": { "F_12": reference },
    }])
}

#[test]
fn quick_cases_of_the_gallery_pass_and_the_json_says_how() {
    let output = etendue(&["--json", "--id", &QUICK.join(",")]);
    let record: Value = serde_json::from_slice(&output.stdout).expect("standard output is JSON");
    assert_eq!(output.status.code(), Some(0), "{record:#}");
    assert_eq!(record["schema"], "etendue.check/1");
    assert_eq!(
        [&record["n_passed"], &record["n_failed"], &record["n_skipped"]].map(Value::as_u64),
        [Some(QUICK.len() as u64), Some(0), Some(0)]
    );
    for case in record["cases"].as_array().expect("a list of cases") {
        assert_eq!(case["verdict"], "pass", "{case:#}");
        assert!(case["error"].as_f64() <= case["allowed"].as_f64() && case["error"].is_number(), "{case:#}");
        let (computed, reference) = (&case["computed"], &case["reference"]);
        for (name, value) in reference.as_object().expect("values by name") {
            assert_eq!(computed[name].is_array(), value.is_array(), "{name}: {case:#}");
        }
    }
}

#[test]
fn a_wrong_reference_fails_with_exit_code_2_and_the_right_one_passes() {
    // Howell, catalogue of configuration factors, C-11.
    for (reference, code) in [("0.199824895698387", 0), ("0.199824895600000", 2)] {
        let file = file(&squares(reference).to_string());
        let output = etendue(&[&file.path().display().to_string()]);
        let table = String::from_utf8_lossy(&output.stdout).into_owned();
        assert_eq!(output.status.code(), Some(code), "{table}");
        assert_eq!(table.contains("FAIL"), code == 2, "{table}");
    }
}

#[test]
fn later_capabilities_are_skipped_by_name() {
    let mut cases = squares("0.2");
    cases[0]["geometry"]["type"] = "strips_2d".into();
    let read = cases::read(&cases.to_string()).expect("a well-formed file");
    assert_eq!(cases::run(&read[0]).verdict, Verdict::Skipped("flatland".to_string()));
    for (group, needs) in [("D", "directions"), ("E", "media"), ("F", "photometry")] {
        cases[0]["group"] = group.into();
        let read = cases::read(&cases.to_string()).expect("a well-formed file");
        assert_eq!(cases::run(&read[0]).verdict, Verdict::Skipped(needs.to_string()));
    }
}

#[test]
fn malformed_files_are_refused_with_a_position_and_exit_code_4() {
    let truncated = squares("0.2").to_string();
    let mut no_values = squares("0.2");
    no_values[0].as_object_mut().expect("an object").remove("values");
    let refusals = [
        (truncated[..truncated.len() / 2].to_string(), "line 1, column"),
        ("{}".to_string(), "must be a list"),
        (no_values.to_string(), "'values' must be an object"),
    ];
    for (text, words) in refusals {
        assert!(cases::read(&text).is_err_and(|error: CasesError| error.to_string().contains(words)), "{words}");
        let file = file(&text);
        let output = etendue(&[&file.path().display().to_string()]);
        assert_eq!(output.status.code(), Some(4));
        assert!(output.stdout.is_empty());
        assert!(String::from_utf8_lossy(&output.stderr).contains(words));
    }
    assert_eq!(etendue(&["--id", "no-such-case"]).status.code(), Some(4));
}

#[test]
fn a_polygon_that_is_none_fails_its_case_and_names_itself() {
    let mut cases = squares("0.2");
    cases[0]["geometry"]["polygon_2"] = json!([[0, 0, 1], [1, 0, 1], [2, 0, 1]]);
    let read = cases::read(&cases.to_string()).expect("a well-formed file");
    let Verdict::Fail(Some(reason)) = cases::run(&read[0]).verdict else { panic!("a line is no polygon") };
    assert!(reason.contains("polygon_2") && reason.contains("zero area"), "{reason}");
}

/// A case of one value set as the program is asked for it, at parameters that no file of cases holds.
fn fresh(kind: &str, fields: Value, values: Value) -> Value {
    let mut geometry = fields;
    geometry["type"] = kind.into();
    json!({ "id": kind, "group": "A", "family": "fresh", "digits_certain": 14, "geometry": geometry, "values": values })
}

/// Round shapes against textbook closed forms: within the estimate, which is at most 1e-6.
#[test]
fn round_shapes_of_other_sizes_have_their_closed_forms() {
    // Coaxial disks: Howell C-41.
    let disks = |r1: f64, r2: f64, h: f64| {
        let (a, b) = (r1 / h, r2 / h);
        let x = 1.0 + (1.0 + b * b) / (a * a);
        0.5 * (x - (x * x - 4.0 * (b / a).powi(2)).sqrt())
    };
    // A sphere over the middle of a disk: Howell C-127.
    let sphere = |disk: f64, h: f64| 0.5 * (1.0 - 1.0 / (1.0 + (disk / h).powi(2)).sqrt());
    // A cone on its base: all that leaves the base arrives.
    let cone = |radius: f64, height: f64| radius / radius.hypot(height);
    let cases = [
        fresh("coaxial_disks", json!({ "r1": 0.7, "r2": 1.3, "h": 0.45 }), json!({ "F_12": disks(0.7, 1.3, 0.45) })),
        fresh("coaxial_disks", json!({ "r1": 2.0, "r2": 1.5, "h": 0.03 }), json!({ "F_12": disks(2.0, 1.5, 0.03) })),
        fresh(
            "sphere_disk",
            json!({ "sphere_radius": 0.4, "disk_radius": 1.7, "h_center_to_disk": 0.9 }),
            json!({ "F_sphere_disk": sphere(1.7, 0.9) }),
        ),
        fresh(
            "cone_interior",
            json!({ "base_radius": 0.8, "height": 0.6 }),
            json!({ "F_lateral_base": cone(0.8, 0.6) }),
        ),
        fresh(
            "concentric_spheres",
            json!({ "r_inner": 0.7, "r_outer": 1.0 }),
            json!({ "F_12": 1.0, "F_21": 0.49, "F_22": 0.51 }),
        ),
        fresh(
            "concentric_spheres",
            json!({ "r_inner": 0.6, "r_outer": 1.0, "rho": [0.0, 0.5], "E": [1.0, 0.0] }),
            // H_2 = 0.36 B_1 + 0.64 B_2, so B_2 = 0.18 / (1 − 0.32).
            json!({ "B1": 1.0, "B2": 0.18 / 0.68, "q1": 1.0 - 0.18 / 0.68 }),
        ),
        // Between zones of one sphere the form factor is the share of area: (cos 20° − cos 75°) / 2.
        fresh(
            "sphere_zones",
            json!({ "radius": 0.3, "zone_1_deg": [100, 150], "zone_2_deg": [20, 75] }),
            json!({ "F_12": 0.5 * (20f64.to_radians().cos() - 75f64.to_radians().cos()) }),
        ),
    ];
    for (k, mut case) in cases.into_iter().enumerate() {
        case["id"] = format!("fresh-{k}").into();
        let read = cases::read(&json!([case]).to_string()).expect("a well-formed file");
        let outcome = cases::run(&read[0]);
        assert_eq!(outcome.verdict, Verdict::Pass, "{outcome:#?}");
        assert!(outcome.estimate.is_some_and(|estimate| estimate <= 1e-6), "{outcome:#?}");
    }
}
