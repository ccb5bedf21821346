//! Numbers as people read them.

/// `value` to `digits` significant digits: plain from 10⁻³ to 10⁵, as 1.2×10⁻¹³ beyond.
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return not_a_number(value);
    }
    if value == 0.0 {
        return "0".into();
    }
    let (mantissa, exponent) = split(value, digits);
    if !(-3..5).contains(&exponent) {
        return format!("{mantissa}×10{}", superscript(exponent));
    }
    let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
    minus(format!("{value:.decimals$}"))
}

/// `value` as 1.2×10⁻¹³, whatever its size: for columns whose numbers span many magnitudes.
pub fn scientific(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return not_a_number(value);
    }
    if value == 0.0 {
        return "0".into();
    }
    let (mantissa, exponent) = split(value, digits);
    format!("{mantissa}×10{}", superscript(exponent))
}

/// As [`significant`], without zeros at the end: 0.05, 0.1, 12, 2×10⁻⁶, and 10⁻⁶ for 1×10⁻⁶.
pub fn trimmed(value: f64, digits: usize) -> String {
    let text = significant(value, digits);
    let (mantissa, power) = text.split_once('×').map_or((&text[..], ""), |(mantissa, power)| (mantissa, power));
    let mantissa = if mantissa.contains('.') { mantissa.trim_end_matches('0').trim_end_matches('.') } else { mantissa };
    match (mantissa, power) {
        (mantissa, "") => mantissa.to_owned(),
        ("1", power) => power.to_owned(),
        (mantissa, power) => format!("{mantissa}×{power}"),
    }
}

/// Work in products with K: whole where it is whole or large.
pub fn products(value: f64) -> String {
    let whole = value.fract() == 0.0 || value >= 100.0;
    if whole && (0.0..1e9).contains(&value) { count(value.round() as u64) } else { trimmed(value, 3) }
}

/// 10ᵏ, the label of a decade.
pub fn power_of_ten(exponent: i32) -> String {
    if exponent == 0 { "1".into() } else { format!("10{}", superscript(exponent)) }
}

/// A count with thin spaces between thousands.
pub fn count(value: u64) -> String {
    let digits = value.to_string();
    let mut grouped = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            grouped.push('\u{202f}');
        }
        grouped.push(digit);
    }
    grouped
}

/// A duration: 3.1 ms, 0.42 s, 12 s.
pub fn seconds(value: f64) -> String {
    match value {
        v if !v.is_finite() => not_a_number(v),
        0.0 => "0 s".into(),
        v if v < 1e-3 => format!("{} µs", significant(v * 1e6, 2)),
        v if v < 1.0 => format!("{} ms", significant(v * 1e3, 2)),
        v if v < 100.0 => format!("{} s", significant(v, 3)),
        v => format!("{v:.0} s"),
    }
}

/// A mean and its standard error in the shared notation 0.43128 ± 0.00014: two digits of error, the mean to the same place.
pub fn with_error(mean: f64, standard_error: f64) -> String {
    if !(standard_error.is_finite() && standard_error > 0.0 && mean.is_finite()) {
        return format!("{}\u{a0}±\u{a0}{}", significant(mean, 5), significant(standard_error, 2));
    }
    let (_, exponent) = split(standard_error, 2);
    if !(-9..5).contains(&exponent) {
        return format!("{}\u{a0}±\u{a0}{}", significant(mean, 5), significant(standard_error, 2));
    }
    let decimals = (1 - exponent).max(0) as usize;
    minus(format!("{mean:.decimals$}\u{a0}±\u{a0}{standard_error:.decimals$}"))
}

/// Mantissa text and decimal exponent after rounding to `digits` significant digits.
fn split(value: f64, digits: usize) -> (String, i32) {
    let text = format!("{value:.*e}", digits.saturating_sub(1));
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    (minus(mantissa.to_owned()), exponent.parse().unwrap_or(0))
}

fn not_a_number(value: f64) -> String {
    match value {
        f64::INFINITY => "∞".into(),
        f64::NEG_INFINITY => "−∞".into(),
        _ => "—".into(),
    }
}

fn minus(text: String) -> String {
    text.replace('-', "−")
}

fn superscript(exponent: i32) -> String {
    exponent
        .to_string()
        .chars()
        .map(|c| match c {
            '-' => '⁻',
            digit => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][digit.to_digit(10).unwrap_or(0) as usize],
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_as_in_a_paper() {
        assert_eq!(significant(1.234e-13, 2), "1.2×10⁻¹³");
        assert_eq!(significant(-0.012_345, 3), "−0.0123");
        assert_eq!(significant(99_999.6, 3), "1.00×10⁵");
        assert_eq!(significant(12_345.0, 3), "12345");
        assert_eq!(significant(0.0, 3), "0");
        assert_eq!(significant(f64::NAN, 3), "—");
        assert_eq!(significant(f64::NEG_INFINITY, 3), "−∞");
        assert_eq!(trimmed(0.05, 3), "0.05");
        assert_eq!(trimmed(100.0, 3), "100");
        assert_eq!(trimmed(1e-6, 3), "10⁻⁶");
        assert_eq!(trimmed(2.5e-6, 3), "2.5×10⁻⁶");
        assert_eq!(products(12_345.0), "12\u{202f}345");
        assert_eq!(products(22.875), "22.9");
        assert_eq!(products(1376.4), "1\u{202f}376");
        assert_eq!(scientific(1.0, 2), "1.0×10⁰");
        assert_eq!(power_of_ten(-12), "10⁻¹²");
        assert_eq!(count(1_234_567), "1\u{202f}234\u{202f}567");
        assert_eq!(count(999), "999");
        assert_eq!(seconds(0.003_14), "3.1 ms");
        assert_eq!(seconds(12.345), "12.3 s");
        assert_eq!(with_error(0.431_284_3, 0.000_142), "0.43128\u{a0}±\u{a0}0.00014");
        assert_eq!(with_error(1.0, 0.0), "1.0000\u{a0}±\u{a0}0");
    }
}
