//! The header of a PLY file: which elements follow, in what order, and of what they are made.

use super::MeshFile;
use crate::scene::format::error::quoted;
use crate::scene::format::{Code, FormatError};
use std::ops::Range;

/// How the elements after the header are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// The type of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

#[derive(Clone, Debug)]
pub(super) struct Property {
    pub name: String,
    pub scalar: Scalar,
    /// The type of the count before the numbers, where the property is a list.
    pub count: Option<Scalar>,
}

#[derive(Clone, Debug)]
pub(super) struct PlyElement {
    pub name: String,
    pub n: u64,
    pub properties: Vec<Property>,
    /// The line that announces it.
    pub range: Range<usize>,
}

#[derive(Debug)]
pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<PlyElement>,
    /// Where the first element begins.
    pub end: usize,
}

impl Scalar {
    /// The type of this name, in either of the two spellings in use.
    fn parse(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Scalar::I8,
            "uchar" | "uint8" => Scalar::U8,
            "short" | "int16" => Scalar::I16,
            "ushort" | "uint16" => Scalar::U16,
            "int" | "int32" => Scalar::I32,
            "uint" | "uint32" => Scalar::U32,
            "float" | "float32" => Scalar::F32,
            "double" | "float64" => Scalar::F64,
            _ => return None,
        })
    }

    pub(super) fn size(self) -> usize {
        match self {
            Scalar::I8 | Scalar::U8 => 1,
            Scalar::I16 | Scalar::U16 => 2,
            Scalar::I32 | Scalar::U32 | Scalar::F32 => 4,
            Scalar::F64 => 8,
        }
    }

    pub(super) fn is_integer(self) -> bool {
        !matches!(self, Scalar::F32 | Scalar::F64)
    }

    /// The integers that the type holds.
    pub(super) fn limits(self) -> (f64, f64) {
        match self {
            Scalar::I8 => (i8::MIN.into(), i8::MAX.into()),
            Scalar::U8 => (0.0, u8::MAX.into()),
            Scalar::I16 => (i16::MIN.into(), i16::MAX.into()),
            Scalar::U16 => (0.0, u16::MAX.into()),
            Scalar::I32 => (i32::MIN.into(), i32::MAX.into()),
            Scalar::U32 => (0.0, u32::MAX.into()),
            Scalar::F32 | Scalar::F64 => (f64::NEG_INFINITY, f64::INFINITY),
        }
    }
}

/// Elements, and properties of an element, that a header may announce.
const MAX_ENTRIES: usize = 256;

/// Reads the header; `file` shows errors in it by line and column.
pub(super) fn read(file: MeshFile) -> Result<Header, FormatError> {
    let mut encoding = None;
    let mut elements: Vec<PlyElement> = Vec::new();
    let mut start = 0;
    let mut number = 0usize;
    loop {
        // Take a line; the header is ASCII, whatever follows it.
        let Some(length) = file.bytes[start..].iter().position(|b| *b == b'\n') else {
            let at = file.bytes.len();
            return Err(file.error(Code::TruncatedMesh, at..at, "the file ends before `end_header`"));
        };
        let range = start..start + length;
        start += length + 1;
        let fail = |found: String| file.error(Code::MalformedMesh, range.clone(), found);
        let line =
            std::str::from_utf8(&file.bytes[range.clone()]).map_err(|_| fail("the header is not text".into()))?;
        let words: Vec<&str> = line.split_ascii_whitespace().take(MAX_ENTRIES).collect();

        // Take the first two lines by place, all others by their first word.
        match (number, &words[..]) {
            (0, ["ply"]) => {}
            (0, _) => return Err(fail("the file does not begin with `ply`".into())),
            (_, ["comment" | "obj_info", ..]) => {}
            (_, ["format", name, "1.0"]) if encoding.is_none() => {
                encoding = Some(match *name {
                    "ascii" => Encoding::Ascii,
                    "binary_little_endian" => Encoding::LittleEndian,
                    "binary_big_endian" => Encoding::BigEndian,
                    other => {
                        let names = ["ascii", "binary_little_endian", "binary_big_endian"];
                        return Err(fail(format!("{} is not a format", quoted(other))).expected_one_of(other, &names));
                    }
                });
            }
            (_, ["element", name, n]) if encoding.is_some() && elements.len() < MAX_ENTRIES => {
                if elements.iter().any(|e| e.name == *name) {
                    return Err(fail(format!("element {} is announced twice", quoted(name))));
                }
                let n = n.parse().map_err(|_| fail(format!("{} is not a count", quoted(n))))?;
                elements.push(PlyElement { name: name.to_string(), n, properties: Vec::new(), range: range.clone() });
            }
            (_, ["property", types @ .., name]) if !elements.is_empty() => {
                let property = property(types, name).map_err(&fail)?;
                let element = elements.last_mut().map(|e| &mut e.properties);
                let Some(properties) = element.filter(|p| p.len() < MAX_ENTRIES && p.iter().all(|p| p.name != *name))
                else {
                    return Err(fail(format!("property {} is announced twice, or is one too many", quoted(name))));
                };
                properties.push(property);
            }
            (_, ["end_header"]) => {
                let missing = || fail("the header has no `format` line".into());
                return Ok(Header { encoding: encoding.ok_or_else(missing)?, elements, end: start });
            }
            _ => {
                let error = fail(format!("{} is not a line of a header here", quoted(line.trim())));
                return Err(error.expected("format, comment, obj_info, element, property or end_header"));
            }
        }
        number += 1;
    }
}

fn property(types: &[&str], name: &str) -> Result<Property, String> {
    let scalar = |word: &str| Scalar::parse(word).ok_or_else(|| format!("{} is not a type", quoted(word)));
    match types {
        ["list", count, value] => {
            let count = scalar(count)?;
            if !count.is_integer() {
                return Err("the count of a list must be an integer".to_string());
            }
            Ok(Property { name: name.to_string(), scalar: scalar(value)?, count: Some(count) })
        }
        [value] => Ok(Property { name: name.to_string(), scalar: scalar(value)?, count: None }),
        _ => Err(format!("property {} needs a type", quoted(name))),
    }
}
