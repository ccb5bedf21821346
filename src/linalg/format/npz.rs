//! NumPy's archives: arrays in a zip file, full or as `scipy.sparse.save_npz` lays out CSR.

use super::npy::{self, Array, Values};
use super::{LinearOperator, Matrix, MatrixFileCode, MatrixFileError, Source, sparse_bytes};
use std::io::{Cursor, Read, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

/// What a matrix file may be made of.
const EXPECTED: &str = "an array `data` of two dimensions, or SciPy's CSR: data, indices, indptr, shape and format";

/// The archive: `data` alone for a full matrix, all of CSR for a sparse one.
pub fn write(matrix: &Matrix) -> Vec<u8> {
    let shape = [matrix.n_rows(), matrix.n_columns()];
    let arrays = match matrix {
        Matrix::Dense(dense) => vec![("data", npy::numbers(&shape, dense.values().iter().copied()))],
        Matrix::Sparse(sparse) => {
            let rows = || (0..shape[0]).map(|r| sparse.row_entries(r));
            let n_entries = sparse.n_entries() as usize;
            let starts = rows().scan(0, |end, (columns, _)| {
                *end += columns.len() as i64;
                Some(*end)
            });
            let columns = rows().flat_map(|(columns, _)| columns).map(|c| i64::from(*c));
            vec![
                ("data", npy::numbers(&[n_entries], rows().flat_map(|(_, values)| values).copied())),
                ("indices", npy::integers(&[n_entries], columns)),
                ("indptr", npy::integers(&[shape[0] + 1], std::iter::once(0).chain(starts))),
                ("shape", npy::integers(&[2], shape.iter().map(|n| *n as i64))),
                ("format", npy::word("csr")),
            ]
        }
    };
    // Entries of a matrix do not compress; a date would make files differ that are the same.
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .last_modified_time(zip::DateTime::default())
        .large_file(true);
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let written = arrays.iter().try_for_each(|(name, bytes)| {
        archive.start_file(format!("{name}.npy"), options)?;
        archive.write_all(bytes).map_err(zip::result::ZipError::from)
    });
    let finished = written.and_then(|()| archive.finish());
    finished.map(Cursor::into_inner).expect("a vector takes all that is written to it")
}

pub fn read(source: &Source<'_>, bytes: Vec<u8>) -> Result<Matrix, MatrixFileError> {
    let malformed = |found: String| source.error(MatrixFileCode::Malformed, found, EXPECTED);
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|_| malformed("no zip archive".to_string()))?;
    let mut left = source.limit;
    let mut array = |name: &str| -> Result<Option<Array>, MatrixFileError> {
        let Ok(mut member) = archive.by_name(&format!("{name}.npy")) else { return Ok(None) };
        // A member may claim any length, and hold any other.
        source.afford(2 * u128::from(member.size()))?;
        let mut bytes = Vec::new();
        let read = (&mut member).take(left / 2 + 1).read_to_end(&mut bytes);
        read.map_err(|_| malformed(format!("array `{name}` cannot be unpacked")))?;
        source.afford(2 * bytes.len() as u128)?;
        left = left.saturating_sub(2 * bytes.len() as u64);
        npy::read(source, name, &bytes).map(Some)
    };

    let missing = || malformed("an archive without it".to_string());
    let Array { shape, values } = array("data")?.ok_or_else(missing)?;
    let values = match values {
        Values::Numbers(values) => values,
        Values::Integers(values) => values.iter().map(|v| *v as f64).collect(),
        Values::Word(_) => return Err(malformed("array `data` is a word".to_string())),
    };
    match (array("format")?, &shape[..]) {
        (None, [n_rows, n_columns]) => source.dense(*n_rows, *n_columns, values),
        (None, [n_rows]) => source.dense(*n_rows, 1, values),
        (Some(Array { values: Values::Word(format), .. }), [_]) if format == "csr" => {
            let mut integers = |name: &str| match array(name)? {
                Some(Array { values: Values::Integers(values), .. }) => Ok(values),
                _ => Err(malformed(format!("an archive of CSR without integers `{name}`"))),
            };
            csr(source, &integers("shape")?, &integers("indptr")?, &integers("indices")?, &values)
        }
        (Some(_), _) => Err(malformed("a sparse matrix that is not CSR".to_string())),
        (None, _) => Err(malformed(format!("an array of {} dimensions", shape.len()))),
    }
}

fn csr(
    source: &Source<'_>,
    shape: &[i64],
    starts: &[i64],
    columns: &[i64],
    values: &[f64],
) -> Result<Matrix, MatrixFileError> {
    let wrong = |found: &str| source.error(MatrixFileCode::WrongShape, found, "CSR whose parts fit together");
    let [n_rows, n_columns] = shape else { return Err(wrong("a shape of other than two numbers")) };
    let (Ok(n_rows), Ok(n_columns)) = (usize::try_from(*n_rows), u32::try_from(*n_columns)) else {
        return Err(wrong("a shape out of range"));
    };
    let ends_well = starts.first() == Some(&0) && starts.last() == Some(&(values.len() as i64));
    let ascends = starts.windows(2).all(|pair| pair[0] <= pair[1]);
    if starts.len() != n_rows + 1 || columns.len() != values.len() || !ends_well || !ascends {
        return Err(wrong("rows that do not partition the entries"));
    }
    if columns.iter().any(|c| !(0..i64::from(n_columns)).contains(c)) {
        return Err(source.error(
            MatrixFileCode::OutOfRange,
            "a column that does not exist",
            "columns below the shape's",
        ));
    }
    source.afford(sparse_bytes(n_rows as u128, values.len() as u128))?;
    let row = |pair: &[i64]| (pair[0] as usize..pair[1] as usize).map(|k| (columns[k] as u32, values[k])).collect();
    source.sparse(n_columns as usize, starts.windows(2).map(row).collect())
}
