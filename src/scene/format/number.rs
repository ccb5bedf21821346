//! Finite decimal numbers.

use super::Code;
use super::error::quoted;

/// A finite number, or what is wrong with the word.
pub(super) fn parse_number(word: &str) -> Result<f64, (Code, String)> {
    match word.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) => Err((Code::InvalidNumber, format!("{} is not a finite number", quoted(word)))),
        Err(_) => Err((Code::InvalidNumber, format!("{} is not a number", quoted(word)))),
    }
}
