//! What a case states and what is computed for it: a number, words, or lists of them, nested as deep as the case likes.

use serde::{Serialize, Serializer};
use std::collections::BTreeMap;

/// A value of a case.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Number(f64),
    List(Vec<Value>),
    /// Values by name.
    Fields(BTreeMap<String, Value>),
    /// Words: not compared with anything.
    Text(String),
}

impl Value {
    /// Reads a JSON value. Strings that are finite decimals are numbers. `None` for what no case holds: null and booleans.
    pub(super) fn from_json(json: &serde_json::Value) -> Option<Self> {
        match json {
            serde_json::Value::Number(number) => number.as_f64().map(Self::Number),
            serde_json::Value::String(text) => Some(match text.parse::<f64>() {
                Ok(number) if number.is_finite() => Self::Number(number),
                _ => Self::Text(text.clone()),
            }),
            serde_json::Value::Array(items) => items.iter().map(Self::from_json).collect::<Option<_>>().map(Self::List),
            serde_json::Value::Object(fields) => {
                let field = |(name, json): (&String, _)| Some((name.clone(), Self::from_json(json)?));
                fields.iter().map(field).collect::<Option<_>>().map(Self::Fields)
            }
            serde_json::Value::Null | serde_json::Value::Bool(_) => None,
        }
    }

    /// A list of numbers.
    pub fn numbers(values: impl IntoIterator<Item = f64>) -> Self {
        Self::List(values.into_iter().map(Self::Number).collect())
    }

    /// A list of rows.
    pub fn rows(rows: impl IntoIterator<Item = Vec<f64>>) -> Self {
        Self::List(rows.into_iter().map(Self::numbers).collect())
    }

    /// Its number, if it is one.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(*number),
            _ => None,
        }
    }

    /// Its items, if it is a list.
    pub fn items(&self) -> Option<&[Value]> {
        match self {
            Self::List(items) => Some(items),
            _ => None,
        }
    }

    /// Every number in it with the number in the same place of `other`; `None` if the two differ in shape.
    pub(super) fn paired(&self, other: &Value) -> Option<Vec<(f64, f64)>> {
        match (self, other) {
            (Self::Number(a), Self::Number(b)) => Some(vec![(*a, *b)]),
            (Self::Text(a), Self::Text(b)) if a == b => Some(Vec::new()),
            (Self::List(a), Self::List(b)) if a.len() == b.len() => {
                let pairs: Option<Vec<_>> = a.iter().zip(b).map(|(a, b)| a.paired(b)).collect();
                pairs.map(|pairs| pairs.into_iter().flatten().collect())
            }
            _ => None,
        }
    }
}

impl Serialize for Value {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Number(number) => serializer.serialize_f64(*number),
            Self::List(items) => items.serialize(serializer),
            Self::Fields(fields) => fields.serialize(serializer),
            Self::Text(text) => serializer.serialize_str(text),
        }
    }
}
