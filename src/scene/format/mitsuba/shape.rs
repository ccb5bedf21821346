//! `shape`: from a plugin to a surface.

use super::document::{Document, Element};
use super::material::{self, Material};
use super::object::{Kind, Object, Plugin};
use super::tessellation::Outline;
use crate::geometry::{Affine3, Polygon, Vec3};
use crate::scene::format::{Code, FormatError, mesh};
use crate::scene::{Surface, Tessellation};

const FLIP: (&str, Kind) = ("flip_normals", Kind::Boolean);
const PLACE: (&str, Kind) = ("to_world", Kind::Transform);
const PARTS: &[(&str, usize)] = &[("bsdf", 1), ("emitter", 1)];
const MESH: &[(&str, Kind)] =
    &[("filename", Kind::Text), ("face_normals", Kind::Boolean), ("flip_tex_coords", Kind::Boolean), FLIP, PLACE];

static SHAPES: [Plugin; 7] = [
    Plugin { name: "rectangle", parameters: &[FLIP, PLACE], parts: PARTS },
    Plugin { name: "cube", parameters: &[FLIP, PLACE], parts: PARTS },
    Plugin {
        name: "sphere",
        parameters: &[("center", Kind::Point), ("radius", Kind::Float), FLIP, PLACE],
        parts: PARTS,
    },
    Plugin { name: "disk", parameters: &[FLIP, PLACE], parts: PARTS },
    Plugin {
        name: "cylinder",
        parameters: &[("p0", Kind::Point), ("p1", Kind::Point), ("radius", Kind::Float), FLIP, PLACE],
        parts: PARTS,
    },
    Plugin { name: "obj", parameters: MESH, parts: PARTS },
    Plugin { name: "ply", parameters: MESH, parts: PARTS },
];

/// Columns of a similarity agree in length, and their angles with 90°, to this; spheres take nothing else.
const SIMILARITY_TOLERANCE: f64 = 1e-9;

/// Reads a `shape`; the surface's name is its id, empty where it has none. Also the plugin's name.
pub(super) fn surface(document: &Document, element: &Element) -> Result<(Surface, &'static str), FormatError> {
    // Read what it is made of.
    let object = Object::open(document, element, &SHAPES)?;
    let material = match object.parts("bsdf").next() {
        Some(element) => material::material(document, element)?,
        None => Material::default(),
    };
    let emission = match object.parts("emitter").next() {
        Some(element) => material::radiance(document, element)?,
        None => vec![0.0; 3],
    };

    // Read where it is.
    let to_world = object.transform("to_world")?;
    let determinant = to_world.matrix3.determinant();
    if determinant == 0.0 || !determinant.is_finite() {
        let found = format!("the transform flattens space: its determinant is {determinant}");
        return Err(object.error(Code::InvalidTransform, "to_world", found));
    }
    let flipped = object.boolean("flip_normals")?.unwrap_or(false);
    let (polygons, tessellation) = match object.plugin.name {
        "obj" | "ply" => (mesh_polygons(&object, &to_world, flipped)?, None),
        _ => outline_polygons(&object, &to_world, determinant < 0.0, flipped)?,
    };
    let name = element.attribute("id").map_or(String::new(), |id| id.value.clone());
    let Material { front, back } = material;
    Ok((Surface { name, polygons, front, back, emission, tessellation }, object.plugin.name))
}

type Polygons = (Vec<Polygon>, Option<Tessellation>);

fn outline_polygons(
    object: &Object,
    to_world: &Affine3,
    mirrored: bool,
    flipped: bool,
) -> Result<Polygons, FormatError> {
    let outline = match object.plugin.name {
        "rectangle" => Outline::rectangle(),
        "cube" => Outline::cube(),
        "disk" => Outline::disk(),
        "sphere" => {
            check_similarity(object, to_world)?;
            Outline::sphere(object.point("center")?.unwrap_or(Vec3::ZERO), radius(object)?)
        }
        _ => {
            let p0 = object.point("p0")?.unwrap_or(Vec3::ZERO);
            let p1 = object.point("p1")?.unwrap_or(Vec3::Z);
            if (p1 - p0).try_normalize().is_none() {
                return Err(object.error(Code::OutOfRange, "p1", "`p0` and `p1` are the same point"));
            }
            Outline::cylinder(p0, p1, radius(object)?)
        }
    };

    // Turn the polygons where a mirroring transform turned their winding but not the shape's normals: all shapes but
    // the sphere.
    let reversed = flipped ^ (mirrored && outline.curved != Some("sphere"));
    let mut polygons = Vec::with_capacity(outline.polygons.len());
    for corners in &outline.polygons {
        let mut vertices: Vec<Vec3> = corners.iter().map(|v| to_world.transform_point3(*v)).collect();
        if reversed {
            vertices.reverse();
        }
        let pieces =
            mesh::split(vertices).map_err(|e| object.error(Code::DegenerateFace, "to_world", e.to_string()))?;
        polygons.extend(pieces);
    }
    let tessellation = outline.curved.map(|shape| Tessellation {
        shape,
        n_polygons: polygons.len(),
        deviation: outline.deviation(to_world, &polygons),
    });
    Ok((polygons, tessellation))
}

fn radius(object: &Object) -> Result<f64, FormatError> {
    let radius = object.number("radius")?.unwrap_or(1.0);
    if radius > 0.0 {
        return Ok(radius);
    }
    Err(object.error(Code::OutOfRange, "radius", format!("`radius` is {radius}")).expected("a number above zero"))
}

/// Mitsuba 3 makes a sphere of every transformed sphere, whatever the transform; an ellipsoid is refused here.
fn check_similarity(object: &Object, to_world: &Affine3) -> Result<(), FormatError> {
    let axes = [to_world.matrix3.x_axis, to_world.matrix3.y_axis, to_world.matrix3.z_axis];
    let scale = axes[0].length_squared();
    let skewed = |i: usize| axes[i].dot(axes[(i + 1) % 3]).abs() > SIMILARITY_TOLERANCE * scale;
    let stretched = |i: usize| (axes[i].length_squared() - scale).abs() > SIMILARITY_TOLERANCE * scale;
    if (0..3).any(|i| skewed(i) || stretched(i)) {
        let error = object.error(Code::InvalidTransform, "to_world", "the transform makes an ellipsoid of the sphere");
        return Err(error.expected("rotations, translations and the same scale in all directions"));
    }
    Ok(())
}

fn mesh_polygons(object: &Object, to_world: &Affine3, flipped: bool) -> Result<Vec<Polygon>, FormatError> {
    let document = object.document;
    let Some(name) = object.value("filename") else {
        return Err(object.error(Code::MissingValue, "", format!("{} needs `filename`", object.label())));
    };
    let path = document.find_file(name);
    let bytes = document.budget.borrow_mut().read(&path);
    let bytes = bytes.map_err(|(code, found)| document.error(code, &name.value_span, found))?;
    let place = document.place(&object.element.span);
    mesh::read(&path, &bytes, object.plugin.name == "ply", to_world, flipped)
        .map_err(|error| error.note(format!("read for {} at {place}", object.label())))
}
