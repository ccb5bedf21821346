//! Matrix Market exchange format.

use super::{LinearOperator, Matrix, MatrixFileCode, MatrixFileError, Source, sparse_bytes};
use std::fmt::Write;
use std::str::FromStr;

const BANNER: &str = "%%MatrixMarket matrix coordinate|array real|integer|pattern general|symmetric|skew-symmetric";

/// The file's text. Numbers are written so that they read back to the same bits.
pub fn write(matrix: &Matrix) -> Vec<u8> {
    let (n_rows, n_columns) = (matrix.n_rows(), matrix.n_columns());
    let mut text = String::new();
    // Writing into a string cannot fail.
    let _ = match matrix {
        Matrix::Dense(dense) => {
            let _ = writeln!(text, "%%MatrixMarket matrix array real general\n{n_rows} {n_columns}");
            // Arrays go column by column.
            (0..n_columns).try_for_each(|c| (0..n_rows).try_for_each(|r| writeln!(text, "{:e}", dense.get(r, c))))
        }
        Matrix::Sparse(sparse) => {
            let n_entries = sparse.n_entries();
            let _ = writeln!(text, "%%MatrixMarket matrix coordinate real general\n{n_rows} {n_columns} {n_entries}");
            (0..n_rows).try_for_each(|r| {
                let (columns, values) = sparse.row_entries(r);
                columns.iter().zip(values).try_for_each(|(c, v)| writeln!(text, "{} {} {v:e}", r + 1, c + 1))
            })
        }
    };
    text.into_bytes()
}

#[derive(Clone, Copy, PartialEq)]
enum Symmetry {
    General,
    Symmetric,
    Skew,
}

pub fn read(source: &Source<'_>, bytes: &[u8]) -> Result<Matrix, MatrixFileError> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let found = format!("byte {} is no UTF-8", error.valid_up_to());
        source.error(MatrixFileCode::Malformed, found, "a text file that begins with %%MatrixMarket")
    })?;
    let mut lines = Lines { source, lines: text.lines(), number: 0 };

    // The banner says what follows.
    let banner = text.lines().next().unwrap_or_default();
    let words: Vec<String> = banner.split_whitespace().map(str::to_ascii_lowercase).collect();
    let unknown = || {
        let start: String = banner.chars().take(80).collect();
        source.error(MatrixFileCode::Malformed, format!("`{start}`"), BANNER).at(1, 1)
    };
    let [start, object, layout, field, symmetry] = &words[..] else { return Err(unknown()) };
    let is_coordinate = layout == "coordinate";
    let has_values = field != "pattern";
    let symmetry = match symmetry.as_str() {
        "general" => Symmetry::General,
        "symmetric" => Symmetry::Symmetric,
        "skew-symmetric" => Symmetry::Skew,
        _ => return Err(unknown()),
    };
    let is_known = start == "%%matrixmarket"
        && object == "matrix"
        && (is_coordinate || (layout == "array" && has_values))
        && ["real", "integer", "pattern"].contains(&field.as_str());
    if !is_known {
        return Err(unknown());
    }

    // The sizes bound what is held, and the file's length bounds the sizes.
    let mut sizes = lines.next("the sizes of the matrix")?;
    let (n_rows, n_columns): (usize, usize) =
        (sizes.number("the number of rows")?, sizes.number("the number of columns")?);
    let n_entries: usize = if is_coordinate { sizes.number("the number of entries")? } else { 0 };
    sizes.end()?;
    if symmetry != Symmetry::General && n_rows != n_columns {
        let found = format!("a symmetric matrix of {n_rows} × {n_columns}");
        return Err(source.error(MatrixFileCode::WrongShape, found, "a square matrix"));
    }
    let (rows, columns) = (n_rows as u128, n_columns as u128);
    if columns > u128::from(u32::MAX) {
        let found = format!("{n_columns} columns");
        return Err(source.error(MatrixFileCode::TooLarge, found, format!("at most {} columns", u32::MAX)));
    }
    let announced = match (is_coordinate, symmetry) {
        (true, _) => n_entries as u128,
        (false, Symmetry::General) => rows * columns,
        (false, Symmetry::Symmetric) => rows * (rows + 1) / 2,
        (false, Symmetry::Skew) => rows * rows.saturating_sub(1) / 2,
    };
    if announced > bytes.len() as u128 / 2 {
        let found = format!("{announced} entries announced in a file of {} bytes", bytes.len());
        return Err(source.error(MatrixFileCode::Truncated, found, "as many entries as are announced"));
    }
    if is_coordinate {
        source.afford(sparse_bytes(rows, 2 * announced))?;
        let mut entries = vec![Vec::new(); n_rows];
        for _ in 0..n_entries {
            let mut line = lines.next("an entry")?;
            let r: usize = line.index("a row", n_rows)?;
            let c: usize = line.index("a column", n_columns)?;
            let value: f64 = if has_values { line.number("a number")? } else { 1.0 };
            line.end()?;
            entries[r].push((c as u32, value));
            match symmetry {
                _ if r == c => {}
                Symmetry::General => {}
                Symmetry::Symmetric => entries[c].push((r as u32, value)),
                Symmetry::Skew => entries[c].push((r as u32, -value)),
            }
        }
        lines.finish()?;
        return source.sparse(n_columns, entries);
    }
    source.afford(8 * rows * columns)?;
    let mut values = vec![0.0; n_rows * n_columns];
    for c in 0..n_columns {
        let first = match symmetry {
            Symmetry::General => 0,
            Symmetry::Symmetric => c,
            Symmetry::Skew => c + 1,
        };
        for r in first..n_rows {
            let mut line = lines.next("an entry")?;
            let value: f64 = line.number("a number")?;
            line.end()?;
            values[r * n_columns + c] = value;
            match symmetry {
                Symmetry::General => {}
                Symmetry::Symmetric => values[c * n_columns + r] = value,
                Symmetry::Skew => values[c * n_columns + r] = -value,
            }
        }
    }
    lines.finish()?;
    source.dense(n_rows, n_columns, values)
}

/// The lines that are no comments.
struct Lines<'a> {
    source: &'a Source<'a>,
    lines: std::str::Lines<'a>,
    number: usize,
}

impl<'a> Lines<'a> {
    fn next(&mut self, wanted: &str) -> Result<Line<'a>, MatrixFileError> {
        let source = self.source;
        self.skip().map(|(number, text)| Line { source, number, text, at: 0 }).ok_or_else(|| {
            source.error(MatrixFileCode::Truncated, "the end of the file", wanted).at(self.number + 1, 1)
        })
    }

    fn finish(&mut self) -> Result<(), MatrixFileError> {
        match self.skip() {
            None => Ok(()),
            Some((number, _)) => {
                Err(self.source.error(MatrixFileCode::Malformed, "another entry", "the end of the file").at(number, 1))
            }
        }
    }

    fn skip(&mut self) -> Option<(usize, &'a str)> {
        loop {
            let line = self.lines.next()?;
            self.number += 1;
            if !line.trim().is_empty() && !line.starts_with('%') {
                return Some((self.number, line));
            }
        }
    }
}

struct Line<'a> {
    source: &'a Source<'a>,
    number: usize,
    text: &'a str,
    /// Bytes read.
    at: usize,
}

impl<'a> Line<'a> {
    fn word(&mut self) -> Option<(usize, &'a str)> {
        let rest = &self.text[self.at..];
        let start = self.at + (rest.len() - rest.trim_start().len());
        let word = self.text[start..].split_whitespace().next()?;
        self.at = start + word.len();
        Some((start, word))
    }

    fn number<N: FromStr>(&mut self, wanted: &str) -> Result<N, MatrixFileError> {
        let (start, word) = self.word().unwrap_or((self.text.len(), ""));
        word.parse().map_err(|_| self.refuse(MatrixFileCode::InvalidNumber, start, word, wanted))
    }

    /// A number from 1 to `n`, less one.
    fn index(&mut self, wanted: &str, n: usize) -> Result<usize, MatrixFileError> {
        let (start, word) = self.word().unwrap_or((self.text.len(), ""));
        match word.parse::<usize>() {
            Ok(index) if (1..=n).contains(&index) => Ok(index - 1),
            Ok(_) => Err(self.refuse(MatrixFileCode::OutOfRange, start, word, &format!("{wanted} from 1 to {n}"))),
            Err(_) => Err(self.refuse(MatrixFileCode::InvalidNumber, start, word, wanted)),
        }
    }

    fn end(&mut self) -> Result<(), MatrixFileError> {
        match self.word() {
            None => Ok(()),
            Some((start, word)) => Err(self.refuse(MatrixFileCode::Malformed, start, word, "the end of the line")),
        }
    }

    fn refuse(&self, code: MatrixFileCode, start: usize, word: &str, wanted: &str) -> MatrixFileError {
        let shown: String = word.chars().take(40).collect();
        let found = if word.is_empty() { "the end of the line".to_string() } else { format!("`{shown}`") };
        let column = 1 + self.text[..start].chars().count();
        self.source.error(code, found, wanted).at(self.number, column)
    }
}
