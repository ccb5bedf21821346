//! Wavefront OBJ: the polygons of it.
//!
//! `v` and `f` make the mesh. `vn` and `vt` are checked and left aside: facets are flat and have one colour. `o`,
//! `g`, `s`, `usemtl` and `mtllib` are accepted and left aside: a file is one surface, whose material is named by the
//! scene. Anything else is refused.

use super::{Mesh, MeshFile};
use crate::geometry::Vec3;
use crate::scene::format::error::quoted;
use crate::scene::format::number::parse_number;
use crate::scene::format::{Code, FormatError};
use std::ops::Range;
use std::path::Path;

const KEYWORDS: [&str; 9] = ["v", "vn", "vt", "f", "o", "g", "s", "usemtl", "mtllib"];

/// Reads an OBJ file; indices of faces are checked against the whole file.
pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Mesh, FormatError> {
    let file = MeshFile { path, bytes, is_text: true };
    let text = std::str::from_utf8(bytes).map_err(|e| {
        let at = e.valid_up_to();
        file.error(Code::InvalidUtf8, at..at + 1, format!("byte 0x{:02x} is not UTF-8", bytes[at]))
    })?;
    let mut reader = Reader { file, mesh: Mesh::default(), n_texture_coordinates: 0, n_normals: 0 };
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        let content = line.split('#').next().unwrap_or("");
        reader.line(Words { text: content, start, at: 0 })?;
        start += line.len();
    }
    reader.check_indices()?;
    Ok(reader.mesh)
}

struct Reader<'a> {
    file: MeshFile<'a>,
    mesh: Mesh,
    n_texture_coordinates: usize,
    n_normals: usize,
}

/// The words of a line, with where they stand in the file.
struct Words<'a> {
    text: &'a str,
    start: usize,
    at: usize,
}

impl<'a> Iterator for Words<'a> {
    type Item = (&'a str, Range<usize>);

    fn next(&mut self) -> Option<Self::Item> {
        let rest = &self.text[self.at..];
        let from = self.at + rest.find(|c: char| !c.is_ascii_whitespace())?;
        let to = self.text[from..].find(|c: char| c.is_ascii_whitespace()).map_or(self.text.len(), |n| from + n);
        self.at = to;
        Some((&self.text[from..to], self.start + from..self.start + to))
    }
}

impl Reader<'_> {
    fn line(&mut self, mut words: Words) -> Result<(), FormatError> {
        let Some((keyword, range)) = words.next() else { return Ok(()) };
        match keyword {
            "v" => {
                let numbers = self.numbers(&range, words, 3..=4)?;
                if numbers.get(3).is_some_and(|w| *w != 1.0) {
                    return Err(self.file.error(
                        Code::MalformedMesh,
                        range,
                        "rational vertices, with w not 1, are not read",
                    ));
                }
                self.mesh.vertices.push(Vec3::from_slice(&numbers[..3]));
            }
            "vn" => {
                self.numbers(&range, words, 3..=3)?;
                self.n_normals += 1;
            }
            "vt" => {
                self.numbers(&range, words, 1..=3)?;
                self.n_texture_coordinates += 1;
            }
            "f" => self.face(range, words)?,
            "o" | "g" | "s" | "usemtl" | "mtllib" => {}
            other => {
                let error = self.file.error(Code::MalformedMesh, range, format!("{} is not read", quoted(other)));
                return Err(error.expected_one_of(other, &KEYWORDS));
            }
        }
        Ok(())
    }

    fn numbers(
        &self,
        keyword: &Range<usize>,
        words: Words,
        counts: std::ops::RangeInclusive<usize>,
    ) -> Result<Vec<f64>, FormatError> {
        let mut numbers = Vec::with_capacity(4);
        for (word, range) in words {
            numbers.push(parse_number(word).map_err(|(code, found)| self.file.error(code, range, found))?);
            if numbers.len() > *counts.end() {
                break;
            }
        }
        if counts.contains(&numbers.len()) {
            return Ok(numbers);
        }
        let counts = if counts.start() == counts.end() {
            counts.end().to_string()
        } else {
            format!("{} to {}", counts.start(), counts.end())
        };
        let n = if numbers.len() > 4 { "more".to_string() } else { numbers.len().to_string() };
        let error = self.file.error(Code::WrongCount, keyword.clone(), format!("the line has {n} numbers"));
        Err(error.expected(format!("{counts} numbers")))
    }

    fn face(&mut self, keyword: Range<usize>, words: Words) -> Result<(), FormatError> {
        let first = self.mesh.corners.len();
        for (word, range) in words {
            let corner = self.corner(word, &range)?;
            self.mesh.corners.push(corner);
        }
        let n_corners = self.mesh.corners.len() - first;
        if n_corners < 3 {
            let error = self.file.error(Code::WrongCount, keyword, format!("the face has {n_corners} vertices"));
            return Err(error.expected("at least 3 vertices"));
        }
        self.mesh.ends.push(self.mesh.corners.len());
        self.mesh.places.push(keyword.start);
        Ok(())
    }

    /// The vertex of `v`, `v/vt`, `v//vn` or `v/vt/vn`, counted from 0.
    fn corner(&self, word: &str, range: &Range<usize>) -> Result<u32, FormatError> {
        let fail = |code, found: String| self.file.error(code, range.clone(), found);
        let malformed = || fail(Code::MalformedMesh, format!("{} is not a corner", quoted(word)));
        let malformed = || malformed().expected("v, v/vt, v//vn or v/vt/vn");
        let mut indices = word.split('/');
        let vertex = indices.next().unwrap_or("");
        let texture = indices.next().filter(|t| !(t.is_empty() && word.contains("//")));
        let normal = indices.next();
        if indices.next().is_some() {
            return Err(malformed());
        }
        let index = |word: &str, n: usize| -> Result<i64, FormatError> {
            let index: i64 = word.parse().map_err(|_| malformed())?;
            match index {
                0 => Err(fail(Code::IndexOutOfRange, "indices count from 1, and -1 is the latest".to_string())),
                i if i < 0 && i.unsigned_abs() > n as u64 => {
                    Err(fail(Code::IndexOutOfRange, format!("{i} reaches before the first of {n} so far")))
                }
                i if i < 0 => Ok(n as i64 + i),
                i => Ok(i - 1),
            }
        };
        for (part, n) in [(texture, self.n_texture_coordinates), (normal, self.n_normals)] {
            if let Some(part) = part {
                let i = index(part, n)?;
                if i >= n as i64 {
                    return Err(fail(Code::IndexOutOfRange, format!("{} is beyond the {n} so far", i + 1)));
                }
            }
        }
        let vertex = index(vertex, self.mesh.vertices.len())?;
        u32::try_from(vertex).map_err(|_| fail(Code::IndexOutOfRange, format!("vertex {vertex} does not exist")))
    }

    /// Holds every corner to the vertices of the whole file, for a face may come before its vertices.
    fn check_indices(&self) -> Result<(), FormatError> {
        let n = self.mesh.vertices.len();
        let mut start = 0;
        for (end, place) in self.mesh.ends.iter().zip(&self.mesh.places) {
            if let Some(corner) = self.mesh.corners[start..*end].iter().find(|c| **c as usize >= n) {
                let found = format!("the face names vertex {} of {n}", *corner as usize + 1);
                return Err(self.file.error(Code::IndexOutOfRange, *place..*place + 1, found));
            }
            start = *end;
        }
        Ok(())
    }
}
