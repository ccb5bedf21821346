//! What a person reads: golden messages, and what each says of where and what instead.

use super::{Folder, LAMP, scene};
use etendue::scene::format::{self, Code};
use std::collections::HashSet;
use std::path::Path;

/// The message for a scene file, with the folder's name cut out.
fn message(text: &str) -> String {
    message_with(text, &[])
}

fn message_with(text: &str, others: &[(&str, &[u8])]) -> String {
    let files: Vec<(&str, &[u8])> =
        [("scene.xml", text.as_bytes())].into_iter().chain(others.iter().copied()).collect();
    let folder = Folder::new(&files);
    let prefix = folder.path("").display().to_string();
    folder.read("scene.xml").unwrap_err().to_string().replace(&prefix, "")
}

#[test]
fn messages_are_these() {
    let parameter = "<scene version=\"3.0.0\">\n\t<shape type=\"rectangle\">\n\t\t<float name=\"radius\" value=\"1\"/>\n\t</shape>\n</scene>";
    assert_eq!(
        message(parameter),
        "\
error[E0103-unknown-parameter]: `radius` is not a parameter of shape `rectangle`
 --> scene.xml:3:16
  |
3 |         <float name=\"radius\" value=\"1\"/>
  |                      ^^^^^^
  = expected: one of flip_normals, to_world"
    );

    let misspelt =
        "<scene version=\"3.0.0\">\n<shape type=\"sphere\"><float name=\"raduis\" value=\"1\"/></shape></scene>";
    assert_eq!(
        message(misspelt),
        "\
error[E0103-unknown-parameter]: `raduis` is not a parameter of shape `sphere`
 --> scene.xml:2:35
  |
2 | <shape type=\"sphere\"><float name=\"raduis\" value=\"1\"/></shape></scene>
  |                                   ^^^^^^
  = expected: one of center, radius, flip_normals, to_world
  = did you mean `radius`?"
    );

    let plugin = "<scene version=\"3.0.0\">\n<shape type=\"cube\">\n<bsdf type=\"difuse\"/></shape></scene>";
    assert_eq!(
        message(plugin),
        "\
error[E0104-unsupported-plugin]: `difuse` is not a supported bsdf
 --> scene.xml:3:13
  |
3 | <bsdf type=\"difuse\"/></shape></scene>
  |             ^^^^^^
  = expected: one of diffuse, twosided
  = did you mean `diffuse`?"
    );

    let albedo = "<scene version=\"3.0.0\">\n<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0.5 1.5 0\"/></bsdf></scene>";
    assert_eq!(
        message(albedo),
        "\
error[E0203-out-of-range]: `reflectance` is 1.5
 --> scene.xml:2:53
  |
2 | <bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0.5 1.5 0\"/></bsdf></scene>
  |                                                     ^^^^^^^^^
  = expected: within [0, 1]"
    );

    assert_eq!(
        message("<scene version=\"3.0.0\">\n<shape type=\"cube\">\n</scene>"),
        "\
error[E0005-malformed-xml]: expected 'shape' tag, not 'scene'
 --> scene.xml:3:1
  |
3 | </scene>
  | ^"
    );

    let mesh =
        "<scene version=\"3.0.0\">\n<shape type=\"obj\"><string name=\"filename\" value=\"a.obj\"/></shape></scene>";
    assert_eq!(
        message_with(mesh, &[("a.obj", b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")]),
        "\
error[E0404-degenerate-face]: face 0: the polygon has zero area (area 0e0 at diameter 2e0)
 --> a.obj:4:1
  |
4 | f 1 2 3
  | ^
  = note: read for shape `obj` at scene.xml:2:2"
    );
    let ply = b"ply\nformat binary_little_endian 1.0\nelement vertex 1000000000\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    assert_eq!(
        message_with(&mesh.replace("obj", "ply"), &[("a.ply", ply)]),
        "\
error[E0402-truncated-mesh]: 1000000000 elements `vertex` are announced
 --> a.ply:3:1
  |
3 | element vertex 1000000000
  | ^^^^^^^^^^^^^^^^^^^^^^^^^
  = expected: no more than the 0 bytes after the header can hold
  = note: read for shape `ply` at scene.xml:2:2"
    );
}

#[test]
fn files_without_a_scene_in_them() {
    let error = |name: &str| format::read(Path::new(name), &[]).unwrap_err().to_string();
    assert_eq!(
        error("scene.blend"),
        "\
error[E0003-unsupported-format]: files ending in `.blend` hold no scene
 --> scene.blend
  = expected: a Mitsuba 3 scene, .xml (meshes, .obj and .ply, are read through it)"
    );
    assert!(error("scene").starts_with("error[E0003-unsupported-format]"));
    assert!(error("no-such-file.xml").starts_with("error[E0001-unreadable-file]: `no-such-file.xml` cannot be read: "));
    assert_eq!(
        format::read(Path::new("no.xml"), &[("a=b".into(), "1".into())]).unwrap_err().code,
        Code::InvalidDefinition
    );
}

#[test]
fn long_lines_and_control_characters_are_shown_safely() {
    let long = format!("<!-- {} --><shape type=\"cone\"/><!-- {} -->", "x".repeat(5000), "é".repeat(5000));
    let error = scene(&long).unwrap_err();
    assert_eq!((error.line(), error.column()), (Some(2), Some(5000 + 9 + 14)));
    let source = error.source_line().unwrap();
    assert!(source.starts_with('…') && source.ends_with('…') && source.chars().count() < 110, "{source}");
    let lines: Vec<String> = error.to_string().lines().map(String::from).collect();
    let caret = lines[4].find('^').unwrap();
    let shown: String = lines[3].chars().skip(lines[4][..caret].chars().count()).take(4).collect();
    assert_eq!(shown, "cone");

    let escape = scene("<shape type=\"\u{202e}cube\"/>").unwrap_err().to_string();
    assert!(!escape.contains('\u{202e}') && escape.contains("\\u{202e}"), "{escape}");
    let name = "n".repeat(100_000);
    let shown = scene(&format!("<shape type=\"{name}\"/>")).unwrap_err().to_string();
    assert!(shown.len() < 1000, "{}", shown.len());
}

#[test]
fn nothing_is_silently_ignored() {
    let cases = [
        ("<shpae type='cube'/>", Code::UnknownElement, Some("shape")),
        ("<medium type='homogeneous'/>", Code::UnknownElement, None),
        ("<shape type='cube' colour='red'/>", Code::UnknownAttribute, None),
        ("<shape type='cube' idd='red'/>", Code::UnknownAttribute, Some("id")),
        ("<shape/>", Code::MissingValue, None),
        ("<shape type='cubes'/>", Code::UnsupportedPlugin, Some("cube")),
        ("<shape type='cube'>text</shape>", Code::UnexpectedText, None),
        ("<shape type='cube'><![CDATA[text]]></shape>", Code::UnexpectedText, None),
        ("<shape type='cube'><?php ?></shape>", Code::UnexpectedText, None),
        ("<shape type='cube'><shape type='cube'/></shape>", Code::MisplacedElement, None),
        ("<shape type='cube'><float value='1'/></shape>", Code::MissingValue, None),
        ("<shape type='cube'><transform name='toWorld'/></shape>", Code::UnknownParameter, Some("to_world")),
        ("<shape type='cube'><string name='to_world' value='1'/></shape>", Code::WrongType, None),
        ("<shape type='cube'><transform name='to_world' value='1'/></shape>", Code::UnknownAttribute, None),
        (
            "<shape type='cube'><transform name='to_world'><lookAt/></transform></shape>",
            Code::UnknownElement,
            Some("lookat"),
        ),
        (
            "<shape type='cube'><transform name='to_world'><scale x='1' value='1'/></transform></shape>",
            Code::RepeatedValue,
            None,
        ),
        (
            "<shape type='cube'><transform name='to_world'><scale w='1'/></transform></shape>",
            Code::UnknownAttribute,
            None,
        ),
        (
            "<shape type='cube'><transform name='to_world'><matrix value='1 2 3'/></transform></shape>",
            Code::WrongCount,
            None,
        ),
        (
            "<shape type='cube'><transform name='to_world'><lookat origin='0 0 0' target='1 1 1'/></transform></shape>",
            Code::MissingValue,
            None,
        ),
        (
            "<shape type='cube'><transform name='to_world'/><transform name='to_world'/></shape>",
            Code::RepeatedValue,
            None,
        ),
        ("<shape type='cube'><bsdf type='diffuse'/><bsdf type='diffuse'/></shape>", Code::RepeatedValue, None),
        ("<shape type='cube'><boolean name='flip_normals' value='ture'/></shape>", Code::InvalidWord, Some("true")),
        ("<shape type='sphere'><float name='radius' value='-1'/></shape>", Code::OutOfRange, None),
        ("<shape type='sphere'><float name='radius' value='1'><float/></float></shape>", Code::MisplacedElement, None),
        ("<shape type='sphere'><point name='center' x='1' y='2'/></shape>", Code::MissingValue, None),
        ("<shape type='cylinder'><point name='p1' value='0'/></shape>", Code::OutOfRange, None),
        ("<shape type='cube'><bsdf type='twosided'/></shape>", Code::MissingValue, None),
        ("<bsdf type='diffuse'><rgb name='reflectance' value='#ff8000'/></bsdf>", Code::InvalidNumber, None),
        ("<bsdf type='diffuse'><rgb name='reflectance' value='1 2'/></bsdf>", Code::WrongCount, None),
        (
            "<bsdf type='diffuse'><spectrum name='reflectance' value='400:0.1, 700:0.2'/></bsdf>",
            Code::UnsupportedValue,
            None,
        ),
        ("<bsdf type='diffuse'><spectrum name='reflectance' filename='a.spd'/></bsdf>", Code::UnknownAttribute, None),
        ("<bsdf type='diffuse'><texture name='reflectance' type='bitmap'/></bsdf>", Code::UnknownElement, None),
        ("<bsdf type='conductor'/>", Code::UnsupportedPlugin, None),
        ("<shape type='cube'><emitter type='point'/></shape>", Code::UnsupportedPlugin, None),
        (
            "<shape type='cube'><emitter type='area'><float name='radiance' value='-1'/></emitter></shape>",
            Code::OutOfRange,
            None,
        ),
        ("<shape type='cube'><include filename='a.xml'/></shape>", Code::MisplacedElement, None),
        ("<default name='a' value='1'><float/></default>", Code::MisplacedElement, None),
        ("<default name='' value='1'/>", Code::InvalidDefinition, None),
        ("<path value='nowhere'/>", Code::UnreadableFile, None),
        ("<ref id='lamp'/>", Code::MisplacedElement, None),
        ("<float name='a' value='1'/>", Code::MisplacedElement, None),
    ];
    for (element, expected, suggestion) in cases {
        let error = scene(&format!("{LAMP}\n{element}")).unwrap_err();
        assert_eq!((error.code, error.suggestion.as_deref()), (expected, suggestion), "{element}\n{error}");
        assert_eq!(error.line(), Some(3), "{element}\n{error}");
    }
    for (version, expected) in
        [("0.6.0", Code::UnsupportedValue), ("4.0.0", Code::UnsupportedValue), ("3.0", Code::UnsupportedValue)]
    {
        let text = format!("<scene version=\"{version}\">{LAMP}</scene>");
        assert_eq!(super::file(&text).unwrap_err().code, expected);
    }
    assert_eq!(super::file("<scene/>").unwrap_err().code, Code::MissingValue);
    assert_eq!(super::file("<shape version='3.0.0' type='cube'/>").unwrap_err().code, Code::MisplacedElement);
}

#[test]
fn every_code_has_a_name_and_an_explanation_of_its_own() {
    let names: HashSet<&str> = Code::ALL.iter().map(|c| c.as_str()).collect();
    let explanations: HashSet<&str> = Code::ALL.iter().map(|c| c.explain()).collect();
    assert_eq!((names.len(), explanations.len()), (Code::ALL.len(), Code::ALL.len()));
    assert!(Code::ALL.is_sorted_by_key(|c| c.as_str()));
}
