//! Radiance's matrix format, as `rmtxop` and `dctimestep` read and write it.
//!
//! A text header, an empty line, then the components of every entry side by side, row by row. Source: Ward, the manual pages of Radiance.

use super::{LinearOperator, Matrix, MatrixFileCode, MatrixFileError, Source};
use std::fmt::Write;

/// The magic words of a Radiance header.
const MAGIC: &str = "#?RADIANCE";

/// Doubles in the order of this format's own machines: least byte first.
pub fn write(components: &[&Matrix]) -> Vec<u8> {
    let (n_rows, n_columns) = (components[0].n_rows(), components[0].n_columns());
    let mut header = String::new();
    // Writing into a string cannot fail.
    let _ = write!(
        header,
        "{MAGIC}\nSOFTWARE=etendue {}\nNROWS={n_rows}\nNCOLS={n_columns}\nNCOMP={}\nBigEndian=0\nFORMAT=double\n\n",
        env!("CARGO_PKG_VERSION"),
        components.len()
    );
    let mut bytes = header.into_bytes();
    let mut rows = vec![vec![0.0; n_columns]; components.len()];
    for r in 0..n_rows {
        components.iter().zip(&mut rows).for_each(|(matrix, row)| matrix.row(0, r, row));
        for c in 0..n_columns {
            rows.iter().for_each(|row| bytes.extend(row[c].to_le_bytes()));
        }
    }
    bytes
}

/// What the header says.
struct Header<'a> {
    n_rows: Option<usize>,
    n_columns: Option<usize>,
    n_components: usize,
    format: &'a str,
    is_big_endian: bool,
}

pub fn read(source: &Source<'_>, bytes: &[u8]) -> Result<Vec<Matrix>, MatrixFileError> {
    let (header, data) = split(source, bytes)?;
    let (Some(n_rows), Some(n_columns)) = (header.n_rows, header.n_columns) else {
        return Err(source.error(MatrixFileCode::Malformed, "a header without a size", "NROWS= and NCOLS="));
    };
    let n_components = header.n_components;
    let n_values = n_rows as u128 * n_columns as u128 * n_components as u128;
    let least = match header.format {
        "ascii" => n_values,
        "float" => 4 * n_values,
        "double" => 8 * n_values,
        other => {
            let found = format!("FORMAT={other}");
            return Err(source.error(MatrixFileCode::Malformed, found, "FORMAT= ascii, float or double"));
        }
    };
    if least > data.len() as u128 {
        let found = format!("{n_values} numbers announced, {} bytes of them there", data.len());
        return Err(source.error(MatrixFileCode::Truncated, found, "as many numbers as are announced"));
    }
    source.afford(16 * n_values)?;
    let values = match header.format {
        "ascii" => text_values(source, data)?,
        "float" => {
            let number = if header.is_big_endian { f32::from_be_bytes } else { f32::from_le_bytes };
            data.as_chunks::<4>().0.iter().map(|chunk| f64::from(number(*chunk))).collect()
        }
        _ => {
            let number = if header.is_big_endian { f64::from_be_bytes } else { f64::from_le_bytes };
            data.as_chunks::<8>().0.iter().map(|chunk| number(*chunk)).collect::<Vec<f64>>()
        }
    };
    if values.len() as u128 != n_values {
        let found = format!("{} numbers", values.len());
        return Err(source.error(MatrixFileCode::WrongShape, found, format!("{n_values} numbers, as announced")));
    }
    (0..n_components)
        .map(|k| {
            let component = values.iter().skip(k).step_by(n_components).copied().collect();
            source.dense(n_rows, n_columns, component)
        })
        .collect()
}

fn split<'a>(source: &Source<'_>, bytes: &'a [u8]) -> Result<(Header<'a>, &'a [u8]), MatrixFileError> {
    let mut header = Header { n_rows: None, n_columns: None, n_components: 3, format: "ascii", is_big_endian: false };
    let mut rest = bytes;
    let mut number = 0;
    loop {
        let end = rest.iter().position(|b| *b == b'\n').unwrap_or(rest.len());
        let line = std::str::from_utf8(&rest[..end]).unwrap_or_default().trim_end_matches('\r');
        number += 1;
        if number == 1 && line != MAGIC {
            return Err(source.error(MatrixFileCode::Malformed, "another file", MAGIC).at(1, 1));
        }
        if end == rest.len() {
            let found = "a header that never ends";
            return Err(source.error(MatrixFileCode::Truncated, found, "an empty line after the header"));
        }
        rest = &rest[end + 1..];
        if line.is_empty() {
            return Ok((header, rest));
        }
        let Some((name, value)) = line.split_once('=') else { continue };
        let value = value.trim();
        let count = || {
            value.parse::<usize>().ok().filter(|n| *n > 0).ok_or_else(|| {
                let shown: String = value.chars().take(40).collect();
                let found = format!("{name}={shown}");
                source.error(MatrixFileCode::InvalidNumber, found, "a number above zero").at(number, name.len() + 2)
            })
        };
        match name {
            "NROWS" => header.n_rows = Some(count()?),
            "NCOLS" => header.n_columns = Some(count()?),
            "NCOMP" => header.n_components = count()?,
            "FORMAT" => header.format = value,
            "BigEndian" => header.is_big_endian = value == "1",
            _ => {}
        }
    }
}

fn text_values(source: &Source<'_>, data: &[u8]) -> Result<Vec<f64>, MatrixFileError> {
    let text = String::from_utf8_lossy(data);
    let number = |(k, word): (usize, &str)| {
        word.parse().map_err(|_| {
            let shown: String = word.chars().take(40).collect();
            source.error(MatrixFileCode::InvalidNumber, format!("number {k} is `{shown}`"), "a number")
        })
    };
    text.split_whitespace().enumerate().map(number).collect()
}
