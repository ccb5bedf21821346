//! A refused file: what, where, what instead.

use super::Code;
use std::fmt::{self, Write};
use std::ops::{Deref, Range};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Source lines longer than this many characters are clipped around the caret.
const N_COLUMNS: usize = 100;
/// Characters kept before the caret where a line is clipped.
const N_COLUMNS_BEFORE: usize = 40;
/// Words quoted from a file are cut after this many characters.
const N_QUOTED: usize = 60;

/// A file that was refused. Shows itself in several lines, with the source line and a caret; the parts are in
/// [`Report`], to which it dereferences.
#[derive(Clone, Debug, Error, PartialEq)]
#[error("{}", .report.show())]
pub struct FormatError {
    report: Box<Report>,
}

/// The parts of a [`FormatError`].
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    pub code: Code,
    /// The file as the user, or the file that refers to it, named it.
    pub file: PathBuf,
    pub position: Position,
    /// What was found, in one line.
    pub found: String,
    /// What would have been accepted.
    pub expected: Option<String>,
    /// The accepted word within edit distance 2 of what was found.
    pub suggestion: Option<String>,
    /// How the reader got here, e.g. the shape that refers to a mesh file.
    pub notes: Vec<String>,
}

/// Where in a file.
#[derive(Clone, Debug, PartialEq)]
pub enum Position {
    /// The file as a whole.
    File,
    /// A place in a text file; line and column count from 1, columns in characters.
    Text {
        line: usize,
        column: usize,
        /// The line as shown: clipped around the place, tabs widened, control characters escaped.
        source_line: String,
        /// Characters of `source_line` before the caret, and how many it underlines.
        caret: (usize, usize),
    },
    /// A place in a binary file, bytes from its start.
    Byte { offset: usize },
}

impl FormatError {
    pub(super) fn new(code: Code, file: &Path, position: Position, found: impl Into<String>) -> Self {
        let found = found.into();
        let report = Report {
            code,
            file: file.to_path_buf(),
            position,
            found,
            expected: None,
            suggestion: None,
            notes: Vec::new(),
        };
        Self { report: Box::new(report) }
    }

    pub(super) fn expected(mut self, expected: impl Into<String>) -> Self {
        self.report.expected = Some(expected.into());
        self
    }

    /// States the accepted words, and which of them may have been meant.
    pub(super) fn expected_one_of(mut self, word: &str, accepted: &[&str]) -> Self {
        self.report.expected = Some(match accepted {
            [] => "nothing here".to_string(),
            [only] => only.to_string(),
            several => format!("one of {}", several.join(", ")),
        });
        self.suggest(closest(word, accepted))
    }

    pub(super) fn suggest(mut self, suggestion: Option<&str>) -> Self {
        self.report.suggestion = suggestion.map(str::to_string);
        self
    }

    pub(super) fn note(mut self, note: impl Into<String>) -> Self {
        self.report.notes.push(note.into());
        self
    }
}

impl Deref for FormatError {
    type Target = Report;

    fn deref(&self) -> &Report {
        &self.report
    }
}

impl Report {
    /// Line in the file, from 1, where the file is text.
    pub fn line(&self) -> Option<usize> {
        match self.position {
            Position::Text { line, .. } => Some(line),
            _ => None,
        }
    }

    /// Column in characters, from 1, where the file is text.
    pub fn column(&self) -> Option<usize> {
        match self.position {
            Position::Text { column, .. } => Some(column),
            _ => None,
        }
    }

    /// The source line as shown, where the file is text.
    pub fn source_line(&self) -> Option<&str> {
        match &self.position {
            Position::Text { source_line, .. } => Some(source_line),
            _ => None,
        }
    }

    fn show(&self) -> String {
        let mut text = String::new();
        // Writing into a string cannot fail.
        let _ = self.write(&mut text);
        text
    }

    fn write(&self, out: &mut String) -> fmt::Result {
        // Say what and where.
        write!(out, "error[{}]: {}", self.code.as_str(), printable(&self.found))?;
        let file = printable(&self.file.to_string_lossy());
        let margin = match &self.position {
            Position::Text { line, .. } => line.to_string().len(),
            _ => 1,
        };
        match &self.position {
            Position::File => write!(out, "\n{:margin$}--> {file}", "")?,
            Position::Byte { offset } => write!(out, "\n{:margin$}--> {file}: byte {offset}", "")?,
            Position::Text { line, column, source_line, caret: (before, width) } => {
                write!(out, "\n{:margin$}--> {file}:{line}:{column}", "")?;
                write!(out, "\n{:margin$} |", "")?;
                write!(out, "\n{line} | {source_line}")?;
                write!(out, "\n{:margin$} | {:before$}{}", "", "", "^".repeat(*width))?;
            }
        }

        // Say what instead.
        let remarks = [self.expected.as_ref().map(|e| format!("expected: {e}"))]
            .into_iter()
            .chain([self.suggestion.as_ref().map(|s| format!("did you mean {}?", quoted(s)))])
            .flatten()
            .chain(self.notes.iter().map(|n| format!("note: {n}")));
        for remark in remarks {
            write!(out, "\n{:margin$} = {}", "", printable(&remark))?;
        }
        Ok(())
    }
}

/// The place of a range of bytes in a text.
pub(super) fn locate(text: &[u8], range: Range<usize>) -> Position {
    // Find the line, without its ending.
    let start = range.start.min(text.len());
    let line = 1 + text[..start].iter().filter(|b| **b == b'\n').count();
    let line_start = text[..start].iter().rposition(|b| *b == b'\n').map_or(0, |p| p + 1);
    let line_end = text[start..].iter().position(|b| *b == b'\n').map_or(text.len(), |p| start + p);
    let line_end = if line_end > start && text[line_end - 1] == b'\r' { line_end - 1 } else { line_end };
    let n_characters = |bytes: &[u8]| bytes.iter().filter(|b| (**b & 0xC0) != 0x80).count();
    let column = 1 + n_characters(&text[line_start..start]);

    // Clip the line around the place, at characters' first bytes.
    let boundary = |mut at: usize| {
        while at > line_start && at < line_end && (text[at] & 0xC0) == 0x80 {
            at -= 1;
        }
        at
    };
    let fits = line_end - line_start <= N_COLUMNS;
    let from =
        if fits || start - line_start <= N_COLUMNS_BEFORE { line_start } else { boundary(start - N_COLUMNS_BEFORE) };
    let to = if line_end - from <= N_COLUMNS { line_end } else { boundary(from + N_COLUMNS) };
    let end = range.end.clamp(start, to.max(start));
    let show = |bytes: &[u8]| printable(&String::from_utf8_lossy(bytes));
    let head = if from > line_start { format!("…{}", show(&text[from..start])) } else { show(&text[from..start]) };
    let middle = show(&text[start..end]);
    let tail = if to > end { show(&text[end..to]) } else { String::new() };
    let ellipsis = if to < line_end { "…" } else { "" };
    let caret = (head.chars().count(), middle.chars().count().max(1));
    Position::Text { line, column, source_line: format!("{head}{middle}{tail}{ellipsis}"), caret }
}

/// Text that is safe to print: tabs as four spaces; control characters, and those that reorder text, escaped.
fn printable(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\t' => out.push_str("    "),
            '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}' => {
                out.extend(c.escape_unicode())
            }
            c if c.is_control() => out.extend(c.escape_unicode()),
            c => out.push(c),
        }
    }
    out
}

/// A word from a file between backticks, cut where it is long.
pub(super) fn quoted(word: &str) -> String {
    match word.char_indices().nth(N_QUOTED) {
        Some((end, _)) => format!("`{}…`", &word[..end]),
        None => format!("`{word}`"),
    }
}

/// The accepted word nearest to `word`, if within edit distance 2 and nearer than any word would be.
pub(super) fn closest<'a>(word: &str, accepted: &[&'a str]) -> Option<&'a str> {
    if word.len() > 4 * N_QUOTED {
        return None;
    }
    let distances = accepted.iter().map(|candidate| (strsim::damerau_levenshtein(word, candidate), *candidate));
    let (distance, nearest) = distances.min()?;
    (distance <= 2 && distance < nearest.chars().count()).then_some(nearest)
}
