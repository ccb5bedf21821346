//! How a scene file hangs together: definitions, references, includes; and a whole scene.

use super::{Folder, LAMP, ROUNDING, code, file, scene};
use etendue::geometry::Vec3;
use etendue::scene::format::{self, Code};
use std::path::Path;

#[test]
fn the_box_is_read_whole() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/data/cornell.xml");
    let scene = format::read(&path, &[]).unwrap();
    let names: Vec<&str> = scene.surfaces().iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["light", "floor", "ceiling", "back", "green-wall", "red-wall", "small-box", "large-box"]);
    assert_eq!((scene.name(), scene.facets().len(), scene.n_bands()), ("cornell", 18, 3));

    // Hold fronts, areas and emission to the geometry: walls face the middle, boxes their outside, the lamp the floor.
    let centre = Vec3::new(0.0, 0.0, 0.0);
    for surface in &scene.surfaces()[1..6] {
        let polygon = &surface.polygons[0];
        assert!((centre - polygon.centroid()).dot(polygon.normal()) > 0.9, "{}", surface.name);
        assert!((surface.area() - 4.0).abs() < 10.0 * ROUNDING, "{}", surface.name);
    }
    let light = &scene.surfaces()[0];
    assert!((light.polygons[0].normal() + Vec3::Y).length() < ROUNDING);
    assert!((light.polygons[0].centroid() - Vec3::new(0.0, 0.99, 0.01)).length() < ROUNDING);
    assert!((light.area() - 4.0 * 0.23 * 0.19).abs() < ROUNDING);
    assert_eq!(light.emission, [18.387, 13.9873, 6.75357]);
    for (surface, half_height, base) in [(6, 0.3, 0.286891f64.hypot(0.0877115)), (7, 0.61, 0.28491f64.hypot(0.0939491))]
    {
        let volume = super::volume(&scene.surfaces()[surface]);
        assert!((volume - 8.0 * half_height * base * base).abs() < 10.0 * ROUNDING, "{volume}");
    }

    // Red stands on the left of the picture, green on the right.
    let camera = scene.camera().unwrap();
    assert_eq!((camera.right, camera.up, camera.film.width), (Vec3::X, Vec3::Y, 256));
    assert!((camera.tangent_half_width - (0.5 * 39.3077f64).to_radians().tan()).abs() < ROUNDING);

    // A definition from outside wins over the file's.
    let smaller = format::read(&path, &[("resolution".into(), "64".into())]).unwrap();
    assert_eq!(smaller.camera().unwrap().film.height, 64);
}

#[test]
fn references_reach_forward_and_through_aliases() {
    let red = r#"<bsdf type="diffuse" id="red"><rgb name="reflectance" value="1 0 0"/></bsdf>"#;
    let shape = |id: &str| format!(r#"<shape type="cube"><ref id="{id}" name="bsdf"/></shape>"#);
    let albedo = |elements: String| scene(&elements).map(|s| s.surfaces()[1].front.lambertian().map(<[f64]>::to_vec));
    let expected = Ok(Some(vec![1.0, 0.0, 0.0]));
    assert_eq!(albedo(format!("{LAMP}{}{red}", shape("red"))), expected);
    assert_eq!(albedo(format!("{LAMP}{red}<alias id=\"red\" as=\"rouge\"/>{}", shape("rouge"))), expected);
    let inside = format!(r#"{LAMP}<shape type="disk">{red}</shape>{}"#, shape("red"));
    assert_eq!(scene(&inside).unwrap().surfaces()[2].front.lambertian(), Some(&[1.0, 0.0, 0.0][..]));
    let twosided = format!(r#"{LAMP}{red}<shape type="cube"><bsdf type="twosided"><ref id="red"/></bsdf></shape>"#);
    assert_eq!(scene(&twosided).unwrap().surfaces()[1].back.as_ref().unwrap().lambertian(), Some(&[1.0, 0.0, 0.0][..]));

    assert_eq!(code(scene(&format!("{LAMP}{}", shape("red")))), Some(Code::UnknownReference));
    assert_eq!(code(scene(&format!("{LAMP}{red}{red}"))), Some(Code::DuplicateId));
    assert_eq!(code(scene(&format!("{LAMP}{}", shape("lamp")))), Some(Code::MisplacedElement));
    assert_eq!(code(scene(&format!("{LAMP}<alias id=\"red\" as=\"lamp\"/>{red}"))), Some(Code::UnknownReference));
    assert_eq!(code(scene(&format!("{LAMP}{red}<alias id=\"red\" as=\"lamp\"/>"))), Some(Code::DuplicateId));
    let itself = r#"<bsdf type="twosided" id="a"><ref id="a"/></bsdf>"#;
    assert_eq!(code(scene(&format!("{LAMP}{itself}"))), Some(Code::MisplacedElement));
}

#[test]
fn definitions_expand_and_must_be_used() {
    let text = format!(
        r#"<scene version="3.0.0"><default name="a" value="0.25"/><default name="a" value="0.75"/><default name="b" value="$a 0 0"/>
           {LAMP}<shape type="cube"><bsdf type="diffuse"><rgb name="reflectance" value="$b"/></bsdf></shape></scene>"#
    );
    let folder = Folder::new(&[("scene.xml", text.as_bytes())]);
    let read = |definitions: &[(&str, &str)]| {
        let given: Vec<_> = definitions.iter().map(|(n, v)| (n.to_string(), v.to_string())).collect();
        format::read(&folder.path("scene.xml"), &given).map(|s| s.surfaces()[1].front.lambertian().unwrap()[0])
    };
    assert_eq!(read(&[]), Ok(0.25));
    assert_eq!(read(&[("a", "0.5")]), Ok(0.5));
    assert_eq!(read(&[("b", "1 1 1")]), Ok(1.0));
    assert_eq!(code(read(&[("c", "1")])), Some(Code::UnusedDefinition));
    assert_eq!(code(read(&[("a", "1"), ("a", "1")])), Some(Code::InvalidDefinition));
    assert_eq!(code(read(&[("a", "x")])), Some(Code::InvalidNumber));
    let error =
        file(r#"<scene version="3.0.0"><default name="albedo" value="1"/><bsdf type="$albed"/></scene>"#).unwrap_err();
    assert_eq!((error.code, error.suggestion.as_deref()), (Code::UndefinedName, Some("$albedo")));
}

#[test]
fn includes_are_found_beside_their_file_and_in_named_folders() {
    let root = r#"<scene version="3.0.0"><path value="library"/><include filename="parts/lamp.xml"/><include filename="cube.xml"/>
           <shape type="disk"><ref id="grey"/></shape></scene>"#;
    let lamp = format!(r#"<scene version="3.0.0"><include filename="grey.xml"/>{LAMP}</scene>"#);
    let folder = Folder::new(&[
        ("scene.xml", root.as_bytes()),
        ("parts/lamp.xml", lamp.as_bytes()),
        ("parts/grey.xml", br#"<bsdf version="3.0.0" type="diffuse" id="grey"/>"#),
        ("library/cube.xml", br#"<shape version="3.0.0" type="cube" id="cube"/>"#),
    ]);
    let scene = folder.read("scene.xml").unwrap();
    let names: Vec<&str> = scene.surfaces().iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["lamp", "cube", "disk-1"]);
}

#[test]
fn scenes_that_are_none_are_refused_at_their_place() {
    let empty = scene("").unwrap_err();
    assert_eq!((empty.code, empty.line(), empty.column()), (Code::InvalidScene, Some(1), Some(2)));
    assert_eq!(code(scene(r#"<shape type="cube"/>"#)), Some(Code::InvalidScene));
    let dark = r#"<shape type="cube"><emitter type="area"><float name="radiance" value="0"/></emitter></shape>"#;
    assert_eq!(code(scene(dark)), Some(Code::InvalidScene));
    assert!(scene(&format!("{LAMP}{dark}")).is_ok());
}

#[test]
fn what_steers_a_renderer_is_checked_and_left_aside() {
    let accepted = [
        r#"<integrator type="path"><integer name="max_depth" value="-1"/><boolean name="hide_emitters" value="TRUE"/></integrator>"#,
        r#"<integrator type="direct"><integer name="emitter_samples" value="4"/></integrator>"#,
        r#"<sensor type="perspective"><sampler type="multijitter"><integer name="sample_count" value="16"/></sampler></sensor>"#,
    ];
    for element in accepted {
        assert!(scene(&format!("{LAMP}{element}")).is_ok(), "{element}");
    }
    let refused = [
        (r#"<integrator type="path"><integer name="max_dept" value="3"/></integrator>"#, Code::UnknownParameter),
        (r#"<integrator type="path"><integer name="max_depth" value="three"/></integrator>"#, Code::InvalidNumber),
        (r#"<integrator type="volpath"/>"#, Code::UnsupportedPlugin),
        (r#"<integrator type="path"/><integrator type="path"/>"#, Code::RepeatedValue),
        (r#"<sensor type="perspective"><sampler type="sobol"/></sensor>"#, Code::UnsupportedPlugin),
        (r#"<sampler type="independent"/>"#, Code::MisplacedElement),
        (r#"<emitter type="constant"/>"#, Code::MisplacedElement),
    ];
    for (element, expected) in refused {
        assert_eq!(code(scene(&format!("{LAMP}{element}"))), Some(expected), "{element}");
    }
}
