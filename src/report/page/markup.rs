//! Pieces of HTML. Text enters a page through [`escape`] and no other way.

use std::borrow::Cow;

/// Text as HTML shows it, in elements and in quoted attributes.
pub fn escape(text: &str) -> Cow<'_, str> {
    if !text.contains(['&', '<', '>', '"', '\'']) {
        return Cow::Borrowed(text);
    }
    let mut safe = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            other => safe.push(other),
        }
    }
    Cow::Owned(safe)
}

/// What a column of a table holds.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Column {
    Words,
    Numbers,
}

/// A table whose cells are given as text.
pub struct Table {
    columns: Vec<(String, Column)>,
    rows: String,
}

impl Table {
    pub fn new(columns: &[(&str, Column)]) -> Self {
        let columns = columns.iter().map(|(name, column)| ((*name).to_owned(), *column)).collect();
        Self { columns, rows: String::new() }
    }

    /// Appends a row; its first cell is its heading.
    pub fn row(&mut self, cells: &[&str]) {
        self.rows += "<tr>";
        for (i, (cell, (_, column))) in cells.iter().zip(&self.columns).enumerate() {
            let class = if *column == Column::Numbers { " class=\"number\"" } else { "" };
            let (tag, scope) = if i == 0 { ("th", " scope=\"row\"") } else { ("td", "") };
            self.rows += &format!("<{tag}{scope}{class}>{}</{tag}>", escape(cell));
        }
        self.rows += "</tr>\n";
    }

    /// The table, which scrolls by itself where the page is too narrow for it.
    pub fn html(&self, caption: &str) -> String {
        let head = self.columns.iter().map(|(name, column)| {
            let class = if *column == Column::Numbers { " class=\"number\"" } else { "" };
            format!("<th scope=\"col\"{class}>{}</th>", escape(name))
        });
        format!(
            "<div class=\"scroll\"><table>\n<caption>{}</caption>\n<thead><tr>{}</tr></thead>\n<tbody>\n{}</tbody>\n</table></div>\n",
            escape(caption),
            head.collect::<String>(),
            self.rows
        )
    }
}

/// Names and what they stand for.
pub fn definitions(pairs: &[(&str, String)]) -> String {
    let pairs =
        pairs.iter().map(|(name, value)| format!("<div><dt>{}</dt><dd>{}</dd></div>\n", escape(name), escape(value)));
    format!("<dl>\n{}</dl>\n", pairs.collect::<String>())
}

/// A section with a heading and a first paragraph; `body` is HTML.
pub fn section(id: &str, heading: &str, lead: &str, body: &str) -> String {
    format!("<section id=\"{id}\">\n<h2>{}</h2>\n<p>{}</p>\n{body}</section>\n", escape(heading), escape(lead))
}
