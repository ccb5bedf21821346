//! Tables as comma-separated values (RFC 4180), numbers with as many digits as bring the same f64 back.

/// A table under construction.
pub struct Csv {
    text: String,
    n_columns: usize,
}

/// One field.
pub enum Field<'a> {
    Text(&'a str),
    Number(f64),
    Count(u64),
}

impl Csv {
    pub fn new(header: &[&str]) -> Self {
        Self { text: header.join(",") + "\n", n_columns: header.len() }
    }

    /// Appends a row, one field a column.
    pub fn row(&mut self, fields: &[Field]) {
        debug_assert_eq!(fields.len(), self.n_columns, "a row has one field a column");
        let fields: Vec<String> = fields.iter().map(Field::encode).collect();
        self.text += &fields.join(",");
        self.text.push('\n');
    }

    pub fn into_bytes(self) -> Vec<u8> {
        self.text.into_bytes()
    }
}

impl Field<'_> {
    fn encode(&self) -> String {
        match self {
            Field::Text(text) if text.contains([',', '"', '\n', '\r']) => format!("\"{}\"", text.replace('"', "\"\"")),
            Field::Text(text) => (*text).to_owned(),
            Field::Number(value) => format!("{value:e}"),
            Field::Count(value) => value.to_string(),
        }
    }
}
