//! Meshes from files: vertices, faces, and where in the file each face stands.

mod obj;
mod ply;
mod ply_header;

use super::error::locate;
use super::{Code, FormatError, Position};
use crate::geometry::{Affine3, Polygon, PolygonError, Vec3};
use std::path::Path;

/// A scene may have this many polygons, however small its files: a mesh may be used many times.
pub const MAX_SCENE_POLYGONS: usize = 1 << 20;

/// Vertices and faces in one block each; face f visits `corners[ends[f − 1]..ends[f]]`.
#[derive(Debug, Default)]
pub(super) struct Mesh {
    vertices: Vec<Vec3>,
    corners: Vec<u32>,
    ends: Vec<usize>,
    /// Bytes from the start of the file to each face.
    places: Vec<usize>,
}

/// A mesh file in memory, for as long as errors in it may need to be shown.
#[derive(Clone, Copy)]
pub(super) struct MeshFile<'a> {
    pub path: &'a Path,
    pub bytes: &'a [u8],
    /// Places are lines and columns, not bytes.
    pub is_text: bool,
}

impl MeshFile<'_> {
    fn error(&self, code: Code, range: std::ops::Range<usize>, found: impl Into<String>) -> FormatError {
        let position = match self.is_text {
            true => locate(self.bytes, range),
            false => Position::Byte { offset: range.start },
        };
        FormatError::new(code, self.path, position, found)
    }
}

/// Reads a mesh file, moves it by `to_world` and makes polygons; `reversed` turns every face.
///
/// The front of a face is the side from which its transformed vertices run counter-clockwise. Faces that are not
/// planar to rounding are cut into triangles.
///
/// # Errors
/// Whatever the format's reader refuses; a face without area, one that visits a vertex twice, one that is not convex.
pub(super) fn read(
    path: &Path,
    bytes: &[u8],
    is_ply: bool,
    to_world: &Affine3,
    reversed: bool,
) -> Result<Vec<Polygon>, FormatError> {
    let (mesh, is_text) = if is_ply { ply::read(path, bytes)? } else { (obj::read(path, bytes)?, true) };
    let file = MeshFile { path, bytes, is_text };
    if mesh.ends.is_empty() {
        let position = if is_text { Position::File } else { Position::Byte { offset: bytes.len() } };
        return Err(FormatError::new(Code::MalformedMesh, path, position, "the mesh has no faces"));
    }
    if mesh.ends.len() > MAX_SCENE_POLYGONS {
        let found = format!("the mesh has {} faces, a scene may have {MAX_SCENE_POLYGONS}", mesh.ends.len());
        return Err(FormatError::new(Code::BeyondLimits, path, Position::File, found));
    }
    let mut polygons = Vec::with_capacity(mesh.ends.len());
    let mut start = 0;
    for (face, (end, place)) in mesh.ends.iter().zip(&mesh.places).enumerate() {
        let corners = &mesh.corners[start..*end];
        start = *end;
        let refuse = |code, found: String| Err(file.error(code, *place..*place + 1, format!("face {face}: {found}")));
        if let Some(corner) = repeated(corners) {
            return refuse(Code::DegenerateFace, format!("vertex {corner} is visited twice"));
        }
        let mut vertices: Vec<Vec3> =
            corners.iter().map(|c| to_world.transform_point3(mesh.vertices[*c as usize])).collect();
        if reversed {
            vertices.reverse();
        }
        match split(vertices) {
            Ok(pieces) => polygons.extend(pieces),
            Err(error @ PolygonError::NotConvex { .. }) => return refuse(Code::ConcaveFace, error.to_string()),
            Err(error) => return refuse(Code::DegenerateFace, error.to_string()),
        }
    }
    Ok(polygons)
}

/// The first corner that a face visits twice.
fn repeated(corners: &[u32]) -> Option<u32> {
    if let [a, b, c] = corners {
        return (a == b || a == c).then_some(*a).or((b == c).then_some(*b));
    }
    let mut sorted = corners.to_vec();
    sorted.sort_unstable();
    sorted.windows(2).find(|pair| pair[0] == pair[1]).map(|pair| pair[0])
}

/// One polygon where the vertices lie in a plane, else a fan of triangles. Edges without length are left out.
pub(super) fn split(mut vertices: Vec<Vec3>) -> Result<Vec<Polygon>, PolygonError> {
    if vertices.len() > 3 {
        vertices.dedup();
        if vertices.len() > 1 && vertices.first() == vertices.last() {
            vertices.pop();
        }
    }
    if vertices.len() <= 3 {
        return Polygon::new(vertices).map(|p| vec![p]);
    }

    // Hold every triangle of the fan to the side of the whole: what winds twice or is concave has one that turns back.
    let origin = vertices[0];
    let fan = || vertices[1..].windows(2).map(|pair| (pair[0] - origin).cross(pair[1] - origin));
    let whole: Vec3 = fan().sum();
    let scale = whole.length();
    if let Some(vertex) = fan().position(|part| part.dot(whole) < -FAN_TOLERANCE * scale * scale) {
        return Err(PolygonError::NotConvex { vertex: vertex + 1 });
    }
    match Polygon::new(vertices.clone()) {
        Ok(polygon) => Ok(vec![polygon]),
        Err(PolygonError::NotPlanar { .. }) => fan_of(&vertices, whole),
        Err(error) => Err(error),
    }
}

/// A triangle of a fan may turn back by this part of the face's area: the rounding of a cross product, with a margin.
const FAN_TOLERANCE: f64 = 1e-12;

/// Triangles around the first vertex from which all of them have area; the corners must all turn left seen along
/// `whole`.
fn fan_of(vertices: &[Vec3], whole: Vec3) -> Result<Vec<Polygon>, PolygonError> {
    let n = vertices.len();
    for vertex in 0..n {
        let before = vertices[vertex] - vertices[(vertex + n - 1) % n];
        let after = vertices[(vertex + 1) % n] - vertices[vertex];
        if before.cross(after).dot(whole) < -FAN_TOLERANCE * before.length() * after.length() * whole.length() {
            return Err(PolygonError::NotConvex { vertex });
        }
    }
    let fan = |first: usize| {
        let triangle = |k: usize| [0, k, k + 1].map(|step| vertices[(first + step) % n]).to_vec();
        (1..n - 1).map(|k| Polygon::new(triangle(k))).collect::<Result<Vec<_>, _>>()
    };
    (0..n.min(MAX_FANS)).map(fan).find(Result::is_ok).unwrap_or_else(|| fan(0))
}

/// A fan is tried from this many vertices before the face is refused.
const MAX_FANS: usize = 8;
