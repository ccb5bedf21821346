//! Numbers and words from attributes.

use super::document::{Attribute, Document, Element, Span};
use crate::geometry::Vec3;
use crate::scene::format::error::quoted;
use crate::scene::format::number::parse_number;
use crate::scene::format::{Code, FormatError};

/// The numbers of an attribute, between commas and white space; `counts` are how many there may be.
///
/// # Errors
/// A word that is no finite number, another count.
pub(super) fn numbers(document: &Document, attribute: &Attribute, counts: &[usize]) -> Result<Vec<f64>, FormatError> {
    let separates = |c: char| c == ',' || c.is_ascii_whitespace();
    let words = attribute.value.split(separates).filter(|word| !word.is_empty());
    let mut numbers = Vec::new();
    for word in words {
        let fail = |code, found: String| document.error(code, &span_of(attribute, word), found);
        let number =
            parse_number(word).map_err(|(code, found)| fail(code, found).expected("a finite decimal number"))?;
        numbers.push(number);
    }
    if !counts.contains(&numbers.len()) {
        let counts: Vec<String> = counts.iter().map(usize::to_string).collect();
        let found = format!("`{}` has {} numbers", attribute.name, numbers.len());
        let error = document.error(Code::WrongCount, &attribute.value_span, found);
        return Err(error.expected(format!("{} numbers", counts.join(" or "))));
    }
    Ok(numbers)
}

pub(super) fn number(document: &Document, attribute: &Attribute) -> Result<f64, FormatError> {
    Ok(numbers(document, attribute, &[1])?[0])
}

pub(super) fn integer(document: &Document, attribute: &Attribute) -> Result<i64, FormatError> {
    attribute.value.trim().parse().map_err(|_| {
        let found = format!("{} is not an integer", quoted(&attribute.value));
        document.error(Code::InvalidNumber, &attribute.value_span, found)
    })
}

/// The place in `words` that an attribute names.
pub(super) fn word(document: &Document, attribute: &Attribute, words: &[&str]) -> Result<usize, FormatError> {
    let lower = attribute.value.to_ascii_lowercase();
    words.iter().position(|w| *w == lower).ok_or_else(|| {
        let found = format!("{} is not understood", quoted(&attribute.value));
        document.error(Code::InvalidWord, &attribute.value_span, found).expected_one_of(&lower, words)
    })
}

pub(super) fn boolean(document: &Document, attribute: &Attribute) -> Result<bool, FormatError> {
    Ok(word(document, attribute, &["false", "true"])? == 1)
}

/// A vector given as `value`, with three numbers or one for all, or as `x`, `y`, `z`; `other` are further attributes
/// that the element must have, and `missing` what stands for a coordinate that is not given, where that is allowed.
pub(super) fn vector(
    document: &Document,
    element: &Element,
    other: &[&str],
    missing: Option<f64>,
) -> Result<Vec3, FormatError> {
    let axes = ["x", "y", "z"];
    if let Some(value) = element.attribute("value") {
        if let Some(axis) = element.attributes.iter().find(|a| axes.contains(&a.name.as_str())) {
            let found = format!("`{}` is given beside `value`", axis.name);
            let error = document.error(Code::RepeatedValue, &axis.name_span, found);
            return Err(error.expected("either `value` or `x`, `y`, `z`"));
        }
        document.check_attributes(element, &[other, &["value"]].concat(), &[])?;
        let numbers = numbers(document, value, &[1, 3])?;
        return Ok(if numbers.len() == 1 { Vec3::splat(numbers[0]) } else { Vec3::from_slice(&numbers) });
    }
    match missing {
        Some(_) => document.check_attributes(element, other, &[&axes[..], &["value"]].concat())?,
        None => document.check_attributes(element, &[other, &axes].concat(), &["value"])?,
    }
    let coordinate = |axis| match element.attribute(axis) {
        Some(attribute) => number(document, attribute),
        None => Ok(missing.unwrap_or(0.0)),
    };
    Ok(Vec3::new(coordinate("x")?, coordinate("y")?, coordinate("z")?))
}

/// Where a word of an attribute's value stands: the word itself, unless something was expanded.
fn span_of(attribute: &Attribute, word: &str) -> Span {
    if !attribute.literal {
        return attribute.value_span.clone();
    }
    let start = attribute.value_span.range.start + (word.as_ptr() as usize - attribute.value.as_ptr() as usize);
    Span { source: attribute.value_span.source, range: start..start + word.len() }
}
