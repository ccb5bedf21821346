//! Files of cases: a JSON list, one object a case.

use super::error::{CaseError, CasesError};
use super::value::Value;
use crate::geometry::{Polygon, Vec3};
use serde_json::{Map, Value as Json};
use std::collections::{BTreeMap, HashSet};

/// One reference case.
#[derive(Clone, Debug)]
pub struct Case {
    pub id: String,
    /// "A" to "G".
    pub group: String,
    pub family: String,
    pub title: String,
    pub geometry: Geometry,
    /// The known answers, by name.
    pub values: BTreeMap<String, Value>,
    /// Significant digits of the values that are certain; 0 marks an identity.
    pub digits_certain: u32,
    /// Where stated: the absolute error of the values themselves.
    pub absolute_tolerance: f64,
    pub source: String,
}

/// The geometry of a case: a type, and the fields that it has.
#[derive(Clone, Debug)]
pub struct Geometry {
    pub kind: String,
    fields: Map<String, Json>,
}

/// Reads the text of a file of cases.
///
/// # Errors
/// Text that is not JSON, with line and column; a file that is not a list; a case that lacks a field or has one of the wrong kind, with its
/// number and name; two cases of one name.
pub fn read(text: &str) -> Result<Vec<Case>, CasesError> {
    let json: Json = serde_json::from_str(text).map_err(|error| CasesError::Syntax {
        line: error.line(),
        column: error.column(),
        message: error.to_string(),
    })?;
    let Json::Array(items) = json else { return Err(CasesError::NotAList) };
    let cases: Vec<Case> = items.iter().enumerate().map(|(index, item)| case(index, item)).collect::<Result<_, _>>()?;
    let mut ids = HashSet::new();
    match cases.iter().find(|case| !ids.insert(case.id.as_str())) {
        Some(case) => Err(CasesError::DuplicateId { id: case.id.clone() }),
        None => Ok(cases),
    }
}

fn case(index: usize, item: &Json) -> Result<Case, CasesError> {
    let id = item.get("id").and_then(Json::as_str).map(str::to_string);
    let wrong = |field, problem| CasesError::Field { index, id: id.clone(), field, problem };
    let text = |field: &'static str| {
        item.get(field).and_then(Json::as_str).map(str::to_string).ok_or_else(|| wrong(field, "must be a string"))
    };
    let optional = |field| item.get(field).and_then(Json::as_str).unwrap_or_default().to_string();

    let fields =
        item.get("geometry").and_then(Json::as_object).ok_or_else(|| wrong("geometry", "must be an object"))?;
    let kind = fields.get("type").and_then(Json::as_str).ok_or_else(|| wrong("geometry", "must have a 'type'"))?;
    let values = item.get("values").and_then(Json::as_object).ok_or_else(|| wrong("values", "must be an object"))?;
    let values = values
        .iter()
        .map(|(name, json)| Value::from_json(json).map(|value| (name.clone(), value)))
        .collect::<Option<_>>()
        .ok_or_else(|| wrong("values", "must hold numbers, decimal strings and lists of them"))?;
    let digits = item.get("digits_certain").and_then(Json::as_u64).and_then(|digits| u32::try_from(digits).ok());
    let absolute_tolerance = match item.get("absolute_tolerance") {
        None => Some(0.0),
        Some(json) => number(json).filter(|tolerance| *tolerance >= 0.0),
    };
    Ok(Case {
        id: text("id")?,
        group: text("group")?,
        family: text("family")?,
        title: optional("title"),
        geometry: Geometry { kind: kind.to_string(), fields: fields.clone() },
        values,
        digits_certain: digits.ok_or_else(|| wrong("digits_certain", "must be a count"))?,
        absolute_tolerance: absolute_tolerance
            .ok_or_else(|| wrong("absolute_tolerance", "must be a number, not below 0"))?,
        source: optional("source"),
    })
}

/// A finite number, written as one or as a decimal string.
fn number(json: &Json) -> Option<f64> {
    match json {
        Json::Number(number) => number.as_f64(),
        Json::String(text) => text.parse().ok(),
        _ => None,
    }
    .filter(|number: &f64| number.is_finite())
}

fn numbers(json: &Json) -> Option<Vec<f64>> {
    json.as_array()?.iter().map(number).collect()
}

fn point(json: &Json) -> Option<Vec3> {
    match numbers(json)?[..] {
        [x, y, z] => Some(Vec3::new(x, y, z)),
        _ => None,
    }
}

impl Geometry {
    pub(super) fn has(&self, field: &str) -> bool {
        self.fields.contains_key(field)
    }

    fn get<T>(&self, field: &str, problem: &'static str, convert: impl Fn(&Json) -> Option<T>) -> Result<T, CaseError> {
        let wrong = || CaseError::Geometry { field: field.to_string(), problem };
        self.fields.get(field).and_then(convert).ok_or_else(wrong)
    }

    pub(super) fn number(&self, field: &str) -> Result<f64, CaseError> {
        self.get(field, "must be a number", number)
    }

    /// A length: a number above zero.
    pub(super) fn length(&self, field: &str) -> Result<f64, CaseError> {
        self.get(field, "must be a number above 0", |json| number(json).filter(|length| *length > 0.0))
    }

    pub(super) fn count(&self, field: &str, most: usize) -> Result<usize, CaseError> {
        let convert = |json: &Json| json.as_u64().and_then(|n| usize::try_from(n).ok());
        self.get(field, "must be a count above 0, and not too large", |json| {
            convert(json).filter(|n| (1..=most).contains(n))
        })
    }

    pub(super) fn text(&self, field: &str) -> Result<String, CaseError> {
        self.get(field, "must be a string", |json| json.as_str().map(str::to_string))
    }

    pub(super) fn numbers(&self, field: &str) -> Result<Vec<f64>, CaseError> {
        self.get(field, "must be a list of numbers", numbers)
    }

    /// The two numbers of an interval, rising.
    pub(super) fn interval(&self, field: &str) -> Result<[f64; 2], CaseError> {
        self.get(field, "must be two rising numbers", |json| match numbers(json)?[..] {
            [low, high] if low < high => Some([low, high]),
            _ => None,
        })
    }

    pub(super) fn point(&self, field: &str) -> Result<Vec3, CaseError> {
        self.get(field, "must be three numbers", point)
    }

    /// A direction of any length, made one.
    pub(super) fn direction(&self, field: &str) -> Result<Vec3, CaseError> {
        self.get(field, "must be a direction", |json| point(json)?.try_normalize())
    }

    pub(super) fn polygon(&self, field: &str) -> Result<Polygon, CaseError> {
        let corners = |json: &Json| json.as_array()?.iter().map(point).collect::<Option<Vec<_>>>();
        let corners = self.get(field, "must be a list of points", corners)?;
        Polygon::new(corners).map_err(|source| CaseError::Polygon { what: field.to_string(), source })
    }

    /// A list of polygons; none where the field is missing.
    pub(super) fn polygons(&self, field: &str) -> Result<Vec<Polygon>, CaseError> {
        if !self.has(field) {
            return Ok(Vec::new());
        }
        let corners = |json: &Json| json.as_array()?.iter().map(point).collect::<Option<Vec<_>>>();
        let all = |json: &Json| json.as_array()?.iter().map(corners).collect::<Option<Vec<_>>>();
        let all = self.get(field, "must be a list of polygons", all)?;
        let named = |(k, corners)| {
            Polygon::new(corners).map_err(|source| CaseError::Polygon { what: format!("{field}[{k}]"), source })
        };
        all.into_iter().enumerate().map(named).collect()
    }

    /// The geometry in another field, e.g. a disk among polygons.
    pub(super) fn part(&self, field: &str) -> Result<Geometry, CaseError> {
        let fields = self.get(field, "must be an object", |json| json.as_object().cloned())?;
        Ok(Geometry { kind: field.to_string(), fields })
    }

    /// The objects in a list.
    pub(super) fn parts(&self, field: &str) -> Result<Vec<Geometry>, CaseError> {
        self.get(field, "must be a list of objects", |json| {
            let part = |json: &Json| Some(Geometry { kind: field.to_string(), fields: json.as_object()?.clone() });
            json.as_array()?.iter().map(part).collect()
        })
    }
}
