//! OBJ and PLY.

use super::{Folder, LAMP, code};
use etendue::geometry::Vec3;
use etendue::scene::Surface;
use etendue::scene::format::{Code, FormatError, Position};

/// A tetrahedron facing outward: vertices and faces.
const VERTICES: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const FACES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

/// Reads a scene whose second surface is a mesh from a file with these bytes.
fn mesh_with(extension: &str, bytes: &[u8], parameters: &str) -> Result<Surface, FormatError> {
    let text = format!(
        r#"<scene version="3.0.0">{LAMP}
<shape type="{extension}"><string name="filename" value="mesh.{extension}"/>{parameters}</shape></scene>"#
    );
    let folder = Folder::new(&[("scene.xml", text.as_bytes()), (&format!("mesh.{extension}"), bytes)]);
    folder.read("scene.xml").map(|scene| scene.surfaces()[1].clone())
}

fn obj(text: &str) -> Result<Surface, FormatError> {
    mesh_with("obj", text.as_bytes(), "")
}

fn ply(bytes: &[u8]) -> Result<Surface, FormatError> {
    mesh_with("ply", bytes, "")
}

fn obj_of_tetrahedron() -> String {
    let vertices = VERTICES.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n"));
    let faces = FACES.iter().map(|[a, b, c]| format!("f {} {} {}\n", a + 1, b + 1, c + 1));
    vertices.chain(faces).collect()
}

/// The tetrahedron with properties to skip: one of each vertex, a list and a number of each face, and an element of
/// its own.
pub(super) fn ply_of_tetrahedron(format: &str) -> Vec<u8> {
    let mut bytes = format!(
        "ply\nformat {format} 1.0\ncomment a tetrahedron\nelement vertex 4\nproperty uchar red\nproperty float x\nproperty float y\n\
         property float z\nelement material 2\nproperty list uchar short values\nproperty double gloss\nelement face 4\n\
         property list uchar int8 tags\nproperty list ushort uint vertex_indices\nproperty int group\nend_header\n"
    )
    .into_bytes();
    if format == "ascii" {
        let vertices = VERTICES.iter().map(|[x, y, z]| format!("200 {x} {y} {z}\n"));
        let materials = ["3 1 -2 3 0.5\n", "0 1e-3\n"].map(String::from);
        let faces = FACES.iter().map(|[a, b, c]| format!("2 -1 1 3 {a} {b} {c} -7\n"));
        bytes.extend(vertices.chain(materials).chain(faces).collect::<String>().into_bytes());
        return bytes;
    }
    let mut push = |number: &[u8]| match format {
        "binary_big_endian" => bytes.extend(number.iter().rev()),
        _ => bytes.extend(number),
    };
    for vertex in VERTICES {
        push(&[200]);
        vertex.iter().for_each(|x| push(&x.to_le_bytes()));
    }
    push(&[3]);
    [1i16, -2, 3].iter().for_each(|v| push(&v.to_le_bytes()));
    push(&0.5f64.to_le_bytes());
    push(&[0]);
    push(&1e-3f64.to_le_bytes());
    for face in FACES {
        push(&[2]);
        push(&(-1i8).to_le_bytes());
        push(&1i8.to_le_bytes());
        push(&3u16.to_le_bytes());
        face.iter().for_each(|i| push(&i.to_le_bytes()));
        push(&(-7i32).to_le_bytes());
    }
    bytes
}

fn corners(surface: &Surface) -> Vec<Vec<Vec3>> {
    surface.polygons.iter().map(|p| p.vertices().to_vec()).collect()
}

#[test]
fn every_format_gives_the_same_mesh() {
    let expected: Vec<Vec<Vec3>> = FACES
        .iter()
        .map(|face| face.iter().map(|i| Vec3::from_array(VERTICES[*i as usize].map(f64::from))).collect())
        .collect();
    assert_eq!(corners(&obj(&obj_of_tetrahedron()).unwrap()), expected);
    for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
        assert_eq!(corners(&ply(&ply_of_tetrahedron(format)).unwrap()), expected, "{format}");
    }
}

#[test]
fn winding_is_that_of_the_transformed_vertices() {
    let sixth = |parameters: &str| {
        let surface = mesh_with("obj", obj_of_tetrahedron().as_bytes(), parameters).unwrap();
        (6.0 * super::volume(&surface)).round()
    };
    let mirror = r#"<transform name="to_world"><scale x="-1"/></transform>"#;
    let flip = r#"<boolean name="flip_normals" value="true"/>"#;
    assert_eq!([sixth(""), sixth(mirror), sixth(flip), sixth(&format!("{flip}{mirror}"))], [1.0, -1.0, -1.0, 1.0]);
}

#[test]
fn obj_takes_every_form_of_a_corner() {
    let vertices =
        "# a comment\r\nmtllib none.mtl\no square\nv 0 0 0 # trailing\nv 1 0 0 1\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n";
    let expected = corners(&obj(&format!("{vertices}f 1 2 3 4\n")).unwrap());
    assert_eq!(expected.len(), 1);
    for face in [
        "f 1/1 2/1 3/1 4/1",
        "f 1//1 2//1 3//1 4//1",
        "f 1/1/1 2/1/1 3/1/1 4/1/1",
        "f -4 -3 -2 -1",
        "f -4/-1/-1 2//1 3 4/1",
    ] {
        let text = format!("{vertices}g a b\ns off\nusemtl red\n{face}");
        assert_eq!(corners(&obj(&text).unwrap()), expected, "{face}");
    }
    let forward = format!("f 1 2 3 4\n{vertices}");
    assert_eq!(corners(&obj(&forward).unwrap()), expected);
}

#[test]
fn obj_refuses_by_line_and_column() {
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    let cases = [
        ("v 0 nan 0\n", Code::InvalidNumber, (1, 5)),
        ("v 0 1e999 0\n", Code::InvalidNumber, (1, 5)),
        ("v 0 0\n", Code::WrongCount, (1, 1)),
        ("v 0 0 0 1 1 1\n", Code::WrongCount, (1, 1)),
        ("v 0 0 0 2\n", Code::MalformedMesh, (1, 1)),
        (&format!("{square}f 1 2\n"), Code::WrongCount, (5, 1)),
        (&format!("{square}f 1 2 5\n"), Code::IndexOutOfRange, (5, 1)),
        (&format!("{square}f 1 2 0\n"), Code::IndexOutOfRange, (5, 7)),
        (&format!("{square}f 1 2 -5\n"), Code::IndexOutOfRange, (5, 7)),
        (&format!("{square}f 1 2 99999999999999999999\n"), Code::MalformedMesh, (5, 7)),
        (&format!("{square}f 1 2 3/1\n"), Code::IndexOutOfRange, (5, 7)),
        (&format!("{square}f 1 2 3/\n"), Code::MalformedMesh, (5, 7)),
        (&format!("{square}f 1 2 3/1/1/1\n"), Code::MalformedMesh, (5, 7)),
        (&format!("{square}  f 1 2 2\n"), Code::DegenerateFace, (5, 3)),
        (&format!("{square}v 2 0 0\nf 1 2 5\n"), Code::DegenerateFace, (6, 1)),
        (&format!("{square}v 0.9 0.1 0\nf 1 2 5 3\nf 1 2 3\n"), Code::ConcaveFace, (6, 1)),
        (&format!("{square}l 1 2\n"), Code::MalformedMesh, (5, 1)),
        (&format!("{square}curv 1 2\n"), Code::MalformedMesh, (5, 1)),
    ];
    for (text, expected, place) in cases {
        let error = obj(text).unwrap_err();
        let found = (error.code, error.line().unwrap_or(0), error.column().unwrap_or(0));
        assert_eq!(found, (expected, place.0, place.1), "{text}{error}");
        assert!(error.notes[0].starts_with("read for shape `obj` at "), "{error}");
    }
    assert_eq!(code(obj("")), Some(Code::MalformedMesh));
    assert_eq!(code(obj(square)), Some(Code::MalformedMesh));
    assert_eq!(code(mesh_with("obj", b"v 0 0 \xff\n", "")), Some(Code::InvalidUtf8));
}

#[test]
fn faces_off_their_plane_become_triangles() {
    // Single-precision corners of a turned square: planar to 1e-8, and no better.
    let turned = "v 0.1 0.2 0.70710678\nv 1.1 0.2 0.70710677\nv 1.1 0.90710678 1.41421357\nv 0.1 0.90710679 1.41421356\nf 1 2 3 4\n";
    let surface = obj(turned).unwrap();
    assert_eq!(surface.polygons.len(), 2);
    assert!((surface.area() - 1.0).abs() < 1e-7);

    // A quadrilateral with two corners in one place, as at the pole of a globe, is a triangle.
    let pole = "v 0 0 1\nv 0 0 1\nv 1 0 0\nv 0 1 0\nf 1 2 3 4\n";
    assert_eq!(obj(pole).unwrap().polygons[0].vertices().len(), 3);

    // A pentagram turns left at every corner, and twice around.
    let point = |k: usize| (0.8 * std::f64::consts::PI * k as f64).sin_cos();
    let star: String = (0..5).map(|k| format!("v {} {} 0\n", point(k).1, point(k).0)).collect();
    assert_eq!(code(obj(&format!("{star}f 1 2 3 4 5\n"))), Some(Code::ConcaveFace));
    assert_eq!(obj(&format!("{star}f 1 4 2 5 3\n")).unwrap().polygons.len(), 1);
}

#[test]
fn ply_refuses_by_line_or_byte() {
    let ascii = String::from_utf8(ply_of_tetrahedron("ascii")).unwrap();
    let swapped = |from: &str, to: &str| ply(ascii.replacen(from, to, 1).as_bytes()).unwrap_err();
    let cases = [
        ("format ascii 1.0", "format ascii 2.0", Code::MalformedMesh, 2),
        ("format ascii 1.0", "format asci 1.0", Code::MalformedMesh, 2),
        ("ply\n", "plyy\n", Code::MalformedMesh, 1),
        ("element vertex 4", "element vertex four", Code::MalformedMesh, 4),
        ("element vertex 4", "element vertex -4", Code::MalformedMesh, 4),
        ("property float x", "property int x", Code::MalformedMesh, 4),
        ("property float x", "property half x", Code::MalformedMesh, 6),
        ("property float y", "property float x", Code::MalformedMesh, 7),
        ("list ushort uint vertex_indices", "list float uint vertex_indices", Code::MalformedMesh, 14),
        ("vertex_indices", "corners", Code::MalformedMesh, 12),
        ("element face", "element faces", Code::MalformedMesh, 16),
        ("200 0 0 0", "200 0 nan 0", Code::InvalidNumber, 17),
        ("200 0 0 0", "200 0 1e999 0", Code::InvalidNumber, 17),
        ("200 0 0 0", "256 0 0 0", Code::InvalidNumber, 17),
        ("200 0 0 0", "200 zero 0 0", Code::InvalidNumber, 17),
        ("3 0 2 1", "3 0 2 4", Code::IndexOutOfRange, 23),
        ("3 0 2 1", "2 0 2", Code::WrongCount, 23),
        ("3 0 2 1", "3 0 2 2", Code::DegenerateFace, 23),
        ("3 1 2 3 -7\n", "3 1 2 3 -7 8\n", Code::MalformedMesh, 26),
        ("3 1 2 3 -7\n", "3 1 2 3\n", Code::TruncatedMesh, 27),
    ];
    for (from, to, expected, line) in cases {
        let error = swapped(from, to);
        assert_eq!((error.code, error.line()), (expected, Some(line)), "{from} → {to}: {error}");
    }

    // Binary files have bytes for places.
    let mut binary = ply_of_tetrahedron("binary_little_endian");
    let body = binary.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    binary[body + 1..body + 5].copy_from_slice(&f32::NAN.to_le_bytes());
    let error = ply(&binary).unwrap_err();
    assert_eq!((error.code, &error.position), (Code::InvalidNumber, &Position::Byte { offset: body + 1 }));
    let mut longer = ply_of_tetrahedron("binary_big_endian");
    longer.push(1);
    assert_eq!(code(ply(&longer)), Some(Code::MalformedMesh));
}

#[test]
fn a_header_that_announces_too_much_is_refused_before_anything_is_kept() {
    for n in ["1000000000", "18446744073709551615"] {
        for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
            let bytes = ply_of_tetrahedron(format);
            for element in ["vertex 4", "material 2", "face 4"] {
                let at = bytes.windows(element.len()).position(|w| w == element.as_bytes()).unwrap();
                let announced = format!("{} {n}", &element[..element.len() - 2]);
                let more = [&bytes[..at], announced.as_bytes(), &bytes[at + element.len()..]].concat();
                assert_eq!(code(ply(&more)), Some(Code::TruncatedMesh), "{format} {announced}");
            }

            // A list that claims more than the file holds ends where the file does.
            if format == "binary_little_endian" {
                let mut list = bytes.clone();
                let n = list.len();
                list[n - 18..n - 16].copy_from_slice(&u16::MAX.to_le_bytes());
                assert_eq!(code(ply(&list)), Some(Code::IndexOutOfRange));
            }
        }
        let nothing = format!(
            "ply\nformat ascii 1.0\nelement nothing {n}\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nelement face 0\nproperty list uchar int vertex_index\nend_header\n"
        );
        assert_eq!(code(ply(nothing.as_bytes())), Some(Code::MalformedMesh));
    }
}

#[test]
fn a_mesh_needs_its_file() {
    let missing = Folder::new(&[(
        "scene.xml",
        br#"<scene version="3.0.0"><shape type="obj"><string name="filename" value="no.obj"/></shape></scene>"#,
    )]);
    let error = missing.read("scene.xml").unwrap_err();
    assert_eq!((error.code, error.line(), error.column()), (Code::UnreadableFile, Some(1), Some(73)));
    assert_eq!(code(super::shape(r#"<shape type="ply"/>"#)), Some(Code::MissingValue));
    assert_eq!(
        code(super::shape(r#"<shape type="obj"><string name="filename" value="."/></shape>"#)),
        Some(Code::UnreadableFile)
    );
}
