//! Scenes that are not there, broken or hostile, places that cannot be written, and what is too large.

use super::{AT_ONCE, CORNELL, Desk, FURNACE, etendue};
use std::fs;

#[test]
fn unknown_scenes_are_refused_with_a_suggestion() {
    etendue(&["solve", "cornel-box"]).assert_refused(4, &["cornel-box", "did you mean 'cornell-box'?", "gallery"]);
    etendue(&["study", "furnace-cubes"]).assert_refused(4, &["did you mean 'furnace-cube'?"]);
    let far = etendue(&["solve", "teapot"]);
    far.assert_refused(4, &["teapot", "etendue gallery"]);
    assert!(!far.stderr.contains("did you mean"), "{}", far.stderr);
    etendue(&["solve", ""]).assert_refused(4, &["etendue gallery"]);
    etendue(&["solve", "missing.xml"]).assert_refused(4, &["missing.xml", "cannot be read"]);
    Desk::new(&[("scene.gltf", b"{}")]).run(&["solve", "scene.gltf"]).assert_refused(4, &["scene.gltf", ".xml"]);
}

/// A scene around one shape that reads a mesh.
fn reading(file: &str) -> String {
    let kind = file.rsplit('.').next().unwrap_or_default();
    format!(
        "<scene version=\"3.0.0\">\n<shape type=\"{kind}\"><string name=\"filename\" value=\"{file}\"/>\
         <emitter type=\"area\"/></shape></scene>"
    )
}

#[test]
fn broken_and_hostile_files_end_in_4_with_a_place() {
    let bomb = "<!DOCTYPE s [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;&a;\">]>\n\
                <scene version=\"3.0.0\">&b;</scene>";
    let deep = format!("<scene version=\"3.0.0\">{}", "<bsdf type=\"twosided\">".repeat(100_000));
    let huge = "ply\nformat ascii 1.0\nelement vertex 1000000000\nproperty float x\nproperty float y\nproperty float z\n\
                element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n";
    let nan = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
               element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n";
    let obj_nan = "v 0 0 0\nv 1 NaN 0\nv 0 1 0\nf 1 2 3\n";
    let short_of_faces = nan.replace("nan", "0").replace("3 0 1 2\n", "3 0 1");
    let misspelt = FURNACE.replace("type=\"cube\"", "type=\"cubes\"");
    let white = FURNACE.replace("value=\"0.5\"", "value=\"1.5\"");
    let (by_huge, by_nan, by_obj, by_short) =
        (reading("huge.ply"), reading("nan.ply"), reading("nan.obj"), reading("cut.ply"));
    let desk = Desk::new(&[
        ("malformed.xml", b"<scene version=\"3.0.0\">\n  <shape type=\"cube\"></shade>\n</scene>"),
        ("cut.xml", &FURNACE.as_bytes()[..FURNACE.len() - 20]),
        ("empty.xml", b""),
        ("misspelt.xml", misspelt.as_bytes()),
        ("white.xml", white.as_bytes()),
        ("bomb.xml", bomb.as_bytes()),
        ("deep.xml", deep.as_bytes()),
        ("huge.xml", by_huge.as_bytes()),
        ("huge.ply", huge.as_bytes()),
        ("nan-ply.xml", by_nan.as_bytes()),
        ("nan.ply", nan.as_bytes()),
        ("nan-obj.xml", by_obj.as_bytes()),
        ("nan.obj", obj_nan.as_bytes()),
        ("cut-ply.xml", by_short.as_bytes()),
        ("cut.ply", short_of_faces.as_bytes()),
    ]);
    let cases: [(&str, &[&str]); 11] = [
        ("malformed.xml", &["malformed.xml:2:22"]),
        ("cut.xml", &["cut.xml:6:"]),
        ("empty.xml", &["empty.xml:1:1"]),
        ("misspelt.xml", &["misspelt.xml:3:", "did you mean `cube`?"]),
        ("white.xml", &["white.xml:5:", "1.5"]),
        ("bomb.xml", &["bomb.xml:1:1"]),
        ("deep.xml", &["deep.xml:1:"]),
        ("huge.xml", &["huge.ply:3:", "1000000000"]),
        ("nan-ply.xml", &["nan.ply:11:3", "nan"]),
        ("nan-obj.xml", &["nan.obj:2:5", "NaN"]),
        ("cut-ply.xml", &["cut.ply:13:"]),
    ];
    for (name, words) in cases {
        let run = desk.run(&["solve", name, "--json"]);
        run.assert_refused(4, words);
        assert!(run.stderr.starts_with("error[E") && run.took < AT_ONCE, "{name}: {}", run.stderr);
    }
}

#[test]
fn definitions_reach_the_scene_or_are_refused() {
    let desk = Desk::new(&[("room.xml", FURNACE.as_bytes())]);
    let radiance = |definitions: &[&str]| {
        let object = desk.json(&[&["solve", "room.xml", "--patch-size", "2", "--json"], definitions].concat());
        object["bundles"][0]["radiance"][0].as_f64().unwrap()
    };
    // L = e / (1 − a), within the solver's tolerance.
    for (definitions, expected) in [(&[][..], 2.0), (&["-D", "albedo=0.75"], 4.0)] {
        assert!((radiance(definitions) / expected - 1.0).abs() < 1e-11, "{definitions:?}");
    }
    let refused = |definitions: &[&str], words: &[&str]| {
        desk.run(&[&["solve", "room.xml"], definitions].concat()).assert_refused(4, words);
    };
    refused(&["-D", "albedos=0.5"], &["albedos", "did you mean `albedo`?"]);
    refused(&["-D", "albedo=0.5", "-D", "albedo=0.6"], &["defined twice"]);
    refused(&["-D", "albedo=much"], &["room.xml:5:", "albedo"]);
    refused(&["-D", "albedo=1.5"], &["room.xml:5:", "1.5"]);
    etendue(&["solve", "cornell-box", "-D", "albedo=1"]).assert_refused(4, &["-D albedo", "scene files"]);
}

#[test]
fn what_cannot_be_written_is_refused_before_the_work() {
    let desk = Desk::new(&[("file", b"mine")]);
    fs::create_dir(desk.path("folder")).unwrap();
    fs::write(desk.path("folder/notes.txt"), "mine").unwrap();
    let cases: [(&[&str], &[&str]); 7] = [
        (
            &["solve", "two-rooms", "--patch-size", "0.2", "-o", "missing/x.json"],
            &["missing/x.json", "no folder 'missing'"],
        ),
        (&["solve", "two-rooms", "--patch-size", "0.2", "-o", "folder"], &["'folder'", "it is a folder"]),
        (&["solve", "two-rooms", "--patch-size", "0.2", "-o", "file/x.json"], &["file/x.json", "no folder 'file'"]),
        (&["study", "cornell-box", "-o", "folder"], &["folder is not a report", "choose another"]),
        (&["study", "cornell-box", "-o", "file"], &["file is a file, not a folder", "choose another"]),
        (&["study", "cornell-box", "-o", "file/deeper/out"], &["file/deeper/out", "'file' is a file"]),
        (&["study", "cornell-box", "-o", "."], &["not a report"]),
    ];
    for (arguments, words) in cases {
        let run = desk.run(arguments);
        run.assert_refused(4, words);
        assert!(run.took < AT_ONCE, "{arguments:?} took {:?}", run.took);
    }
    // Nothing was touched.
    assert_eq!(
        (desk.names("."), desk.names("folder")),
        (vec!["file".into(), "folder".into()], vec!["notes.txt".into()])
    );
    assert_eq!(fs::read_to_string(desk.path("file")).unwrap(), "mine");
    assert_eq!(fs::read_to_string(desk.path("folder/notes.txt")).unwrap(), "mine");
}

#[test]
fn what_is_too_large_is_refused_with_its_estimate_and_a_remedy() {
    let cases: [(&[&str], &[&str]); 5] = [
        (
            &["solve", "cornell-box", "--patch-size", "0.2", "--memory", "20MiB"],
            &["704 bundles at patch size 0.2", "MiB of memory", "20.0 MiB", "would fit"],
        ),
        (&["solve", "cornell-box", "--patch-size", "1e-3"], &["25990082 bundles", "PiB", "--patch-size", "would fit"]),
        (&["solve", "cornell-box", "--patch-size", "1e-4", "--solver", "lu"], &["2598352802 bundles", "16 EiB"]),
        (&["study", "cornell-box", "--patch-size", "1e-9"], &["more than 16 EiB", "would fit"]),
        // 4·10⁹ pixels need more than the matrices do, and no patch size helps.
        (&["study", CORNELL, "-D", "resolution=65536"], &["TiB", "no --patch-size would fit"]),
    ];
    for (arguments, words) in cases {
        let run = etendue(arguments);
        run.assert_refused(5, words);
        assert!(run.took < AT_ONCE, "{arguments:?} took {:?}", run.took);
    }

    // The patch size that was said to fit does.
    let refusal = etendue(&["solve", "furnace-cube", "--memory", "17MiB"]).stderr;
    let fits =
        refusal.split("--patch-size ").nth(1).and_then(|rest| rest.split(' ').next()).expect("there is a remedy");
    let run = etendue(&["solve", "furnace-cube", "--memory", "17MiB", "--patch-size", fits]);
    assert_eq!(run.code, Some(0), "{fits}: {}", run.stderr);
}
