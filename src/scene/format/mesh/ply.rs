//! PLY, the polygon file format: ascii, binary little and big endian.
//!
//! `x`, `y`, `z` of `vertex` and `vertex_indices` (or `vertex_index`) of `face` make the mesh. Other properties and
//! elements are skipped by their announced types. Memory is bounded by the bytes that are there, not by what the
//! header announces.

use super::ply_header::{self, Encoding, Header, PlyElement, Scalar};
use super::{Mesh, MeshFile};
use crate::geometry::Vec3;
use crate::scene::format::error::quoted;
use crate::scene::format::{Code, FormatError};
use std::path::Path;

/// Reads a PLY file; the second value tells whether the places of faces are places in text.
pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<(Mesh, bool), FormatError> {
    let header = ply_header::read(MeshFile { path, bytes, is_text: true })?;
    let is_text = header.encoding == Encoding::Ascii;
    let file = MeshFile { path, bytes, is_text };
    check_announced(MeshFile { path, bytes, is_text: true }, &header)?;
    let mut body = Body { file, encoding: header.encoding, at: header.end };
    let mut mesh = Mesh::default();
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => read_vertices(&mut body, element, &mut mesh)?,
            "face" => read_faces(&mut body, element, &mut mesh)?,
            _ if element.properties.is_empty() => {}
            _ => {
                for _ in 0..element.n {
                    skip(&mut body, element)?;
                }
            }
        }
    }
    body.check_end()?;
    Ok((mesh, is_text))
}

/// Checks, before anything is read, that the elements are of the right kind and that the file is long enough for
/// them.
fn check_announced(file: MeshFile, header: &Header) -> Result<(), FormatError> {
    let mut n_needed = 0u64;
    for element in &header.elements {
        let fail = |found: String| Err(file.error(Code::MalformedMesh, element.range.clone(), found));
        let is = |name: &str| element.properties.iter().find(|p| p.name == name);
        match element.name.as_str() {
            "vertex" => {
                for axis in ["x", "y", "z"] {
                    match is(axis) {
                        Some(p) if p.count.is_none() && !p.scalar.is_integer() => {}
                        _ => return fail(format!("vertices need `{axis}` as float or double")),
                    }
                }
            }
            "face" => {
                let lists = element.properties.iter().filter(|p| INDICES.contains(&p.name.as_str()));
                if lists.clone().count() != 1 || !lists.clone().all(|p| p.count.is_some() && p.scalar.is_integer()) {
                    return fail("faces need one list of integers `vertex_indices` or `vertex_index`".into());
                }
            }
            _ => {}
        }

        // A number takes its size, or a digit and what separates it from the next.
        let size = |p: &ply_header::Property| p.count.unwrap_or(p.scalar).size() as u64;
        let each: u64 = match header.encoding {
            Encoding::Ascii => 2 * element.properties.len() as u64,
            _ => element.properties.iter().map(size).sum(),
        };
        n_needed = n_needed.saturating_add(each.saturating_mul(element.n));
        let n_left = (file.bytes.len() - header.end) as u64 + u64::from(header.encoding == Encoding::Ascii);
        if n_needed > n_left {
            let found = format!("{} elements {} are announced", element.n, quoted(&element.name));
            let error = file.error(Code::TruncatedMesh, element.range.clone(), found);
            return Err(error.expected(format!("no more than the {n_left} bytes after the header can hold")));
        }
    }
    for name in ["vertex", "face"] {
        if !header.elements.iter().any(|e| e.name == name) {
            let found = format!("the header announces no element `{name}`");
            return Err(file.error(Code::MalformedMesh, header.end - 1..header.end - 1, found));
        }
    }
    Ok(())
}

const INDICES: [&str; 2] = ["vertex_indices", "vertex_index"];

fn read_vertices(body: &mut Body, element: &PlyElement, mesh: &mut Mesh) -> Result<(), FormatError> {
    let axes = ["x", "y", "z"];
    for vertex in 0..element.n {
        let mut position = Vec3::ZERO;
        for property in &element.properties {
            let at = body.next_place();
            match axes.iter().position(|axis| *axis == property.name) {
                Some(axis) => {
                    let number = body.number(property.scalar)?;
                    if !number.is_finite() {
                        let found = format!("`{}` of vertex {vertex} is {number}", axes[axis]);
                        let error = body.file.error(Code::InvalidNumber, at..at + 1, found);
                        return Err(error.expected("a finite number"));
                    }
                    position[axis] = number;
                }
                None => body.skip_property(property)?,
            }
        }
        mesh.vertices.push(position);
    }
    Ok(())
}

fn read_faces(body: &mut Body, element: &PlyElement, mesh: &mut Mesh) -> Result<(), FormatError> {
    // Faces may stand before the vertices: hold indices to those only where they are known.
    for face in 0..element.n {
        let place = body.next_place();
        for property in &element.properties {
            let Some(count) = property.count.filter(|_| INDICES.contains(&property.name.as_str())) else {
                body.skip_property(property)?;
                continue;
            };
            let n_corners = body.count(count)?;
            if n_corners < 3 {
                let found = format!("face {face} has {n_corners} vertices");
                return Err(body.file.error(Code::WrongCount, place..place + 1, found).expected("at least 3 vertices"));
            }
            for _ in 0..n_corners {
                let at = body.next_place();
                let index = body.number(property.scalar)?;
                let known = index >= 0.0 && index < mesh.vertices.len() as f64;
                if !known {
                    let found = format!("face {face} names vertex {index} of {}", mesh.vertices.len());
                    let error = body.file.error(Code::IndexOutOfRange, at..at + 1, found);
                    return Err(error.expected("the number of a vertex that stands before the faces, from 0"));
                }
                mesh.corners.push(index as u32);
            }
        }
        mesh.ends.push(mesh.corners.len());
        mesh.places.push(place);
    }
    Ok(())
}

fn skip(body: &mut Body, element: &PlyElement) -> Result<(), FormatError> {
    element.properties.iter().try_for_each(|property| body.skip_property(property))
}

/// What follows the header, number by number.
struct Body<'a> {
    file: MeshFile<'a>,
    encoding: Encoding,
    at: usize,
}

impl Body<'_> {
    /// Where the next number begins.
    fn next_place(&self) -> usize {
        match self.encoding {
            Encoding::Ascii => {
                let rest = &self.file.bytes[self.at..];
                self.at + rest.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(rest.len())
            }
            _ => self.at,
        }
    }

    fn number(&mut self, scalar: Scalar) -> Result<f64, FormatError> {
        let start = self.next_place();
        let truncated =
            |file: &MeshFile| file.error(Code::TruncatedMesh, start..start, "the file ends within the mesh");
        if self.encoding == Encoding::Ascii {
            return self.ascii(start, scalar);
        }
        let end = start + scalar.size();
        let bytes = self.file.bytes.get(start..end).ok_or_else(|| truncated(&self.file))?;
        self.at = end;

        // Put the bytes in the order of the types' little-endian readers.
        let mut ordered = [0u8; 8];
        ordered[..bytes.len()].copy_from_slice(bytes);
        if self.encoding == Encoding::BigEndian {
            ordered[..bytes.len()].reverse();
        }
        let [a, b, c, d, ..] = ordered;
        Ok(match scalar {
            Scalar::I8 => i8::from_le_bytes([a]).into(),
            Scalar::U8 => a.into(),
            Scalar::I16 => i16::from_le_bytes([a, b]).into(),
            Scalar::U16 => u16::from_le_bytes([a, b]).into(),
            Scalar::I32 => i32::from_le_bytes([a, b, c, d]).into(),
            Scalar::U32 => u32::from_le_bytes([a, b, c, d]).into(),
            Scalar::F32 => f32::from_le_bytes([a, b, c, d]).into(),
            Scalar::F64 => f64::from_le_bytes(ordered),
        })
    }

    fn ascii(&mut self, start: usize, scalar: Scalar) -> Result<f64, FormatError> {
        let rest = &self.file.bytes[start..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        if length == 0 {
            return Err(self.file.error(Code::TruncatedMesh, start..start, "the file ends within the mesh"));
        }
        let fail = |found: String| self.file.error(Code::InvalidNumber, start..start + length, found);
        let word = String::from_utf8_lossy(&rest[..length]);
        let number: f64 = word.parse().map_err(|_| fail(format!("{} is not a number", quoted(&word))))?;
        let (low, high) = scalar.limits();
        if scalar.is_integer() && !(number.fract() == 0.0 && (low..=high).contains(&number)) {
            return Err(fail(format!("{} is not an integer from {low} to {high}", quoted(&word))));
        }
        self.at = start + length;
        Ok(number)
    }

    fn count(&mut self, scalar: Scalar) -> Result<u64, FormatError> {
        let at = self.next_place();
        let count = self.number(scalar)?;
        if count < 0.0 {
            return Err(self.file.error(Code::InvalidNumber, at..at + 1, format!("a list has {count} entries")));
        }
        Ok(count as u64)
    }

    fn skip_property(&mut self, property: &ply_header::Property) -> Result<(), FormatError> {
        let n = match property.count {
            Some(count) => self.count(count)?,
            None => 1,
        };
        for _ in 0..n {
            self.number(property.scalar)?;
        }
        Ok(())
    }

    /// Refuses what follows the last element, other than white space.
    fn check_end(&self) -> Result<(), FormatError> {
        match self.file.bytes[self.at..].iter().position(|b| !b.is_ascii_whitespace()) {
            None => Ok(()),
            Some(n) => {
                let at = self.at + n;
                Err(self.file.error(Code::MalformedMesh, at..at + 1, "the file goes on after the last element"))
            }
        }
    }
}
