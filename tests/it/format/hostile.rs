//! Input that means harm, and input that was cut short: an error with a position, never a panic.

use super::mesh::ply_of_tetrahedron;
use super::{Folder, LAMP, code, file, scene};
use etendue::scene::format::{self, Code, Position};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use std::fs;

/// A scene that uses most of the format.
const SAMPLE: &str = r#"<?xml version="1.0"?>
<scene version="3.0.0">
    <default name="a" value="0.5"/><!-- half -->
    <bsdf type="twosided" id="m"><bsdf type="diffuse"><rgb name="reflectance" value="$a, 0.25 1"/></bsdf></bsdf>
    <shape type="sphere" id="s"><point name="center" x="1" y="2" z="3"/><ref id="m"/>
        <emitter type="area"><spectrum name="radiance" value="2"/></emitter>
        <transform name="to_world"><rotate y="1" angle="30"/><scale value="2"/></transform></shape>
    <sensor type="perspective"><float name="fov" value="45"/>
        <transform name="to_world"><lookat origin="0,0,4" target="0,0,0" up="0,1,0"/></transform>
        <film type="hdrfilm"><integer name="width" value="8"/><rfilter type="tent"/></film></sensor>
</scene>
"#;

const SAMPLE_OBJ: &str = "o box\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\nf -4 -2 -1\n";

/// Scenes that read these bytes as XML, OBJ and PLY.
fn read_as(folder: &Folder, kind: &str, bytes: &[u8]) -> Result<(), format::FormatError> {
    if kind == "xml" {
        fs::write(folder.path("scene.xml"), bytes).unwrap();
        return folder.read("scene.xml").map(drop);
    }
    fs::write(folder.path(&format!("mesh.{kind}")), bytes).unwrap();
    folder.read(&format!("{kind}.xml")).map(drop)
}

fn readers() -> Folder {
    let scene = |kind: &str| {
        format!(
            r#"<scene version="3.0.0">{LAMP}<shape type="{kind}"><string name="filename" value="mesh.{kind}"/></shape></scene>"#
        )
    };
    Folder::new(&[("obj.xml", scene("obj").as_bytes()), ("ply.xml", scene("ply").as_bytes())])
}

#[test]
fn every_prefix_is_a_scene_or_an_error_with_a_position() {
    let folder = readers();
    let samples: [(&str, Vec<u8>); 5] = [
        ("xml", SAMPLE.into()),
        ("obj", SAMPLE_OBJ.into()),
        ("ply", ply_of_tetrahedron("ascii")),
        ("ply", ply_of_tetrahedron("binary_little_endian")),
        ("ply", ply_of_tetrahedron("binary_big_endian")),
    ];
    for (kind, bytes) in samples {
        assert_eq!(read_as(&folder, kind, &bytes).err(), None);
        for n in 0..bytes.len() {
            let Err(error) = read_as(&folder, kind, &bytes[..n]) else { continue };
            let has_place = error.position != Position::File || error.found.contains("has no faces");
            assert!(has_place, "{kind} {n}: {error}");
            assert!(error.to_string().starts_with("error[E0"), "{error}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 300,
        rng_seed: RngSeed::Fixed(0x6c69_6768_7465_6421),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn no_bytes_make_it_panic(
        kind in 0usize..5,
        edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0u8..3), 1..8),
    ) {
        let (kind, mut bytes) = match kind {
            0 => ("xml", SAMPLE.as_bytes().to_vec()),
            1 => ("obj", SAMPLE_OBJ.as_bytes().to_vec()),
            2 => ("ply", ply_of_tetrahedron("ascii")),
            3 => ("ply", ply_of_tetrahedron("binary_little_endian")),
            _ => ("ply", ply_of_tetrahedron("binary_big_endian")),
        };
        for (place, byte, how) in edits {
            let at = place.index(bytes.len());
            match how {
                0 => bytes[at] = byte,
                1 => bytes.insert(at, byte),
                _ => drop(bytes.remove(at)),
            }
        }
        if let Err(error) = read_as(&readers(), kind, &bytes) {
            let shown = error.to_string();
            prop_assert!(shown.chars().all(|c| c == '\n' || !c.is_control()), "{:?}", shown);
        }
    }

    #[test]
    fn no_text_makes_it_panic(text in "[<>/=\"' a-f$&;!?\\[\\]\n-]{0,120}") {
        let _ = scene(&text);
    }
}

#[test]
fn entities_and_namespaces_are_refused() {
    let bomb = r#"<?xml version="1.0"?>
<!DOCTYPE scene [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">]>
<scene version="3.0.0">&b;</scene>"#;
    let error = file(bomb).unwrap_err();
    assert_eq!((error.code, error.line(), error.column()), (Code::DocumentType, Some(2), Some(1)));
    assert_eq!(code(scene("&undefined;")), Some(Code::MalformedXml));
    assert_eq!(code(scene("<x:shape type='cube'/>")), Some(Code::MalformedXml));
    assert_eq!(code(scene("<xml:shape type='cube'/>")), Some(Code::MalformedXml));
    assert_eq!(code(scene("<shape xml:type='cube'/>")), Some(Code::UnknownAttribute));
    assert_eq!(code(scene("<shape xmlns='a' type='cube'/>")), Some(Code::UnknownAttribute));
}

#[test]
fn deep_and_crowded_documents_are_refused() {
    let n = 100_000;
    let deep = format!("{}{}", "<scene version='3.0.0'>".repeat(n), "</scene>".repeat(n));
    assert_eq!(code(file(&deep)), Some(Code::BeyondLimits));
    assert_eq!(code(file(&"<a>".repeat(n))), Some(Code::BeyondLimits));
    let crowded: String = (0..n).map(|i| format!(" a{i}=''")).collect();
    assert_eq!(code(file(&format!("<scene{crowded}/>"))), Some(Code::BeyondLimits));
    let spaced = format!("<shape é{}{}=\"cube\"/>", "é".repeat(70_000), " ".repeat(1000));
    assert_eq!(code(scene(&spaced)), Some(Code::UnknownAttribute));
    assert_eq!(code(scene(&"<a/>".repeat((1 << 20) + 1))), Some(Code::BeyondLimits));
}

#[test]
fn spheres_cannot_fill_the_memory() {
    let n = 1 + format::MAX_SCENE_POLYGONS / (format::N_MERIDIANS * format::N_PARALLELS);
    let folder = Folder::new(&[(
        "scene.xml",
        format!("<scene version='3.0.0'>{}</scene>", "<shape type='sphere'/>".repeat(n)).as_bytes(),
    )]);
    assert_eq!(code(folder.read("scene.xml")), Some(Code::BeyondLimits));
}

#[test]
fn expansions_cannot_grow_like_powers() {
    let doubling: String =
        (1..64).map(|i| format!("<default name=\"x{i:02}\" value=\"$x{:02}$x{:02}\"/>\n", i - 1, i - 1)).collect();
    let error = scene(&format!("<default name=\"x00\" value=\"0123456789\"/>\n{doubling}")).unwrap_err();
    assert_eq!(error.code, Code::InvalidDefinition, "{error}");
    let many: String = (0..2000).map(|i| format!("<default name=\"x{i}\" value=\"1\"/>")).collect();
    assert_eq!(code(scene(&many)), Some(Code::BeyondLimits));
}

#[test]
fn includes_end() {
    let including = |name: &str| format!(r#"<scene version="3.0.0"><include filename="{name}"/></scene>"#);
    let twice = |name: &str| {
        format!(r#"<scene version="3.0.0"><include filename="{name}"/><include filename="{name}"/></scene>"#)
    };
    let folder = Folder::new(&[
        ("self.xml", including("self.xml").as_bytes()),
        ("a.xml", including("sub/../b.xml").as_bytes()),
        ("b.xml", including("a.xml").as_bytes()),
        ("sub/empty.xml", b"<scene version='3.0.0'/>"),
        ("folder.xml", including("sub").as_bytes()),
        ("missing.xml", including("nowhere.xml").as_bytes()),
    ]);
    assert_eq!(code(folder.read("self.xml")), Some(Code::IncludeCycle));
    let error = folder.read("a.xml").unwrap_err();
    assert_eq!((error.code, error.notes.len()), (Code::IncludeCycle, 1));
    assert!(error.file.ends_with("b.xml") && error.notes[0].ends_with("a.xml:1:43"), "{error}");
    assert_eq!(code(folder.read("folder.xml")), Some(Code::UnreadableFile));
    assert_eq!(code(folder.read("missing.xml")), Some(Code::UnreadableFile));

    // Files that include the next one twice would be read 2^k times.
    for i in 0..12 {
        fs::write(folder.path(&format!("p{i}.xml")), twice(&format!("p{}.xml", i + 1))).unwrap();
    }
    fs::write(folder.path("p12.xml"), "<scene version='3.0.0'/>").unwrap();
    assert_eq!(code(folder.read("p0.xml")), Some(Code::BeyondLimits));

    // A chain too long.
    for i in 0..20 {
        fs::write(folder.path(&format!("c{i}.xml")), including(&format!("c{}.xml", i + 1))).unwrap();
    }
    assert_eq!(code(folder.read("c0.xml")), Some(Code::BeyondLimits));
}

#[cfg(unix)]
#[test]
fn only_regular_files_are_opened() {
    let folder = Folder::new(&[("sub/x", b"")]);
    std::os::unix::fs::symlink(folder.path("loop.xml"), folder.path("loop.xml")).unwrap();
    assert_eq!(code(folder.read("loop.xml")), Some(Code::UnreadableFile));
    assert_eq!(code(folder.read("sub/x/y.xml")), Some(Code::UnreadableFile));
    std::os::unix::fs::symlink("/dev/zero", folder.path("zero.xml")).unwrap();
    assert_eq!(code(folder.read("zero.xml")), Some(Code::UnreadableFile));
    fs::create_dir(folder.path("folder.xml")).unwrap();
    assert_eq!(code(folder.read("folder.xml")), Some(Code::UnreadableFile));

    // A sparse file of 1 TiB takes no room and claims much.
    let sparse = fs::File::create(folder.path("sparse.xml")).unwrap();
    sparse.set_len(1 << 40).unwrap();
    assert_eq!(code(folder.read("sparse.xml")), Some(Code::TooLarge));
}

#[test]
fn bytes_that_are_no_text_have_a_place() {
    let folder = Folder::new(&[
        ("scene.xml", b"<scene version='3.0.0'>\n  <shape \xff\xfe/></scene>"),
        ("nul.xml", b"<scene\0/>"),
    ]);
    let error = folder.read("scene.xml").unwrap_err();
    assert_eq!((error.code, error.line(), error.column()), (Code::InvalidUtf8, Some(2), Some(10)));
    assert_eq!(code(folder.read("nul.xml")), Some(Code::MalformedXml));
    let marked = format!("\u{feff}<scene version='3.0.0'>{LAMP}</scene>");
    assert!(file(&marked).is_ok());
}

#[test]
fn numbers_that_are_none_are_refused_where_they_stand() {
    for word in ["1e999", "nan", "inf", "-inf", "0x10", "", " ", "1 2", "1.5.2", "½"] {
        let element = format!(r#"<shape type="sphere"><float name="radius" value="{word}"/></shape>"#);
        let error = scene(&format!("{LAMP}\n{element}")).unwrap_err();
        assert!(matches!(error.code, Code::InvalidNumber | Code::WrongCount), "{error}");
        assert_eq!((error.line(), error.column()), (Some(3), Some(50)), "{error}");
    }
}
