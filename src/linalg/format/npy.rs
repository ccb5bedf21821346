//! NumPy's array format: a header that is a Python dictionary, then numbers.
//!
//! Source: "NEP 1 — A simple file format for NumPy arrays".

use super::{MatrixFileCode, MatrixFileError, Source};

const MAGIC: &[u8] = b"\x93NUMPY";

/// An array of at most two dimensions, row by row.
pub struct Array {
    pub shape: Vec<usize>,
    pub values: Values,
}

pub enum Values {
    Numbers(Vec<f64>),
    Integers(Vec<i64>),
    /// A word, as bytes or as text.
    Word(String),
}

/// The file's bytes of numbers of this shape, row by row.
pub fn numbers(shape: &[usize], values: impl Iterator<Item = f64>) -> Vec<u8> {
    array("<f8", shape, values.flat_map(f64::to_le_bytes))
}

/// The same of integers.
pub fn integers<const N: usize>(shape: &[usize; N], values: impl Iterator<Item = i64>) -> Vec<u8> {
    array("<i8", shape, values.flat_map(i64::to_le_bytes))
}

/// The same of one word.
pub fn word(word: &str) -> Vec<u8> {
    array(&format!("|S{}", word.len()), &[], word.bytes())
}

fn array(kind: &str, shape: &[usize], data: impl Iterator<Item = u8>) -> Vec<u8> {
    let shape = match shape {
        [only] => format!("({only},)"),
        several => format!("({})", several.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
    };
    let header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}");
    // The numbers begin at a multiple of 64 bytes.
    let length = (MAGIC.len() + 4 + header.len() + 1).next_multiple_of(64) - MAGIC.len() - 4;
    let mut bytes = MAGIC.to_vec();
    bytes.extend([1, 0]);
    bytes.extend((length as u16).to_le_bytes());
    bytes.extend(format!("{header:<width$}\n", width = length - 1).bytes());
    bytes.extend(data);
    bytes
}

/// Reads an array named so in errors. What it holds was paid for by its bytes.
pub fn read(source: &Source<'_>, name: &str, bytes: &[u8]) -> Result<Array, MatrixFileError> {
    let malformed = |found: String| {
        source.error(MatrixFileCode::Malformed, format!("array `{name}`: {found}"), "a NumPy array of numbers")
    };
    let rest = bytes.strip_prefix(MAGIC).ok_or_else(|| malformed("no NumPy array".to_string()))?;
    let short = || malformed("the header is cut off".to_string());
    let (version, rest) = rest.split_at_checked(2).ok_or_else(short)?;
    let (length, rest) = match version[0] {
        1 => rest.split_first_chunk::<2>().map(|(length, rest)| (usize::from(u16::from_le_bytes(*length)), rest)),
        _ => rest.split_first_chunk::<4>().map(|(length, rest)| (u32::from_le_bytes(*length) as usize, rest)),
    }
    .ok_or_else(short)?;
    let (header, data) = rest.split_at_checked(length).ok_or_else(short)?;
    let header = String::from_utf8_lossy(header);

    // Look up the three entries of the dictionary.
    let entry = |key: &str| {
        let after = header.split(&format!("'{key}'")).nth(1)?;
        after.trim_start().strip_prefix(':').map(str::trim_start)
    };
    let missing = |key: &str| malformed(format!("its header has no {key}"));
    let kind = entry("descr").ok_or_else(|| missing("descr"))?;
    let kind = kind.split('\'').nth(1).ok_or_else(|| malformed("it has fields".to_string()))?;
    let is_by_columns = entry("fortran_order").ok_or_else(|| missing("fortran_order"))?.starts_with("True");
    let shape = entry("shape").ok_or_else(|| missing("shape"))?;
    let shape = shape.strip_prefix('(').and_then(|shape| shape.split(')').next()).ok_or_else(|| missing("shape"))?;
    let shape: Result<Vec<usize>, _> =
        shape.split(',').map(str::trim).filter(|n| !n.is_empty()).map(str::parse).collect();
    let shape = shape.map_err(|_| malformed("its shape is no list of numbers".to_string()))?;
    let n_values = shape.iter().try_fold(1usize, |n, extent| n.checked_mul(*extent));
    let n_values = n_values.ok_or_else(|| malformed("its shape is too large".to_string()))?;

    // Read as many as are announced, no more and no less.
    let (order, kind) = kind.split_at_checked(1).ok_or_else(|| malformed("its type is empty".to_string()))?;
    if let Some(size) = kind.strip_prefix('S').and_then(|size| size.parse::<usize>().ok()) {
        let text = data.get(..size.min(data.len())).unwrap_or_default();
        let word = String::from_utf8_lossy(text).trim_end_matches('\0').to_string();
        return Ok(Array { shape, values: Values::Word(word) });
    }
    if let Some(size) = kind.strip_prefix('U').and_then(|size| size.parse::<usize>().ok()) {
        let letters = data.as_chunks::<4>().0.iter().take(size);
        let word = letters.filter_map(|c| char::from_u32(u32::from_le_bytes(*c))).filter(|c| *c != '\0').collect();
        return Ok(Array { shape, values: Values::Word(word) });
    }
    let size = match kind {
        "f8" | "i8" | "u8" => 8,
        "f4" | "i4" | "u4" => 4,
        other => return Err(malformed(format!("its type is {order}{other}, not f4, f8, i4, i8, u4 or u8"))),
    };
    if n_values.checked_mul(size) != Some(data.len()) {
        return Err(malformed(format!("{n_values} numbers of {size} bytes announced, {} bytes there", data.len())));
    }
    let is_reversed = order == ">";
    let word = |chunk: &[u8]| {
        let mut bytes = [0; 8];
        bytes[..size].copy_from_slice(chunk);
        if is_reversed {
            bytes[..size].reverse();
        }
        u64::from_le_bytes(bytes)
    };
    let words = data.chunks_exact(size).map(word);
    let values = match kind {
        "f8" => Values::Numbers(by_rows(words.map(f64::from_bits).collect(), &shape, is_by_columns)),
        "f4" => {
            let number = |bits: u64| f64::from(f32::from_bits(bits as u32));
            Values::Numbers(by_rows(words.map(number).collect(), &shape, is_by_columns))
        }
        "i4" => Values::Integers(by_rows(words.map(|w| i64::from(w as u32 as i32)).collect(), &shape, is_by_columns)),
        _ => Values::Integers(by_rows(words.map(|w| w as i64).collect(), &shape, is_by_columns)),
    };
    Ok(Array { shape, values })
}

fn by_rows<T: Copy>(values: Vec<T>, shape: &[usize], is_by_columns: bool) -> Vec<T> {
    let (true, [n_rows, n_columns]) = (is_by_columns, shape) else { return values };
    (0..n_rows * n_columns).map(|k| values[(k % n_columns) * n_rows + k / n_columns]).collect()
}
