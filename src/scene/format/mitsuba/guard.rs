//! What is refused before the XML parser sees it: whatever would cost more than the file's size.

use super::super::Code;

/// Elements may be nested this deep; the deepest scene needs 7.
pub const MAX_NESTING: usize = 64;
/// An element may have this many attributes; the most that any takes is 5.
const MAX_ATTRIBUTES: usize = 16;

/// Scans the markup once for document types, namespaces, deep nesting and crowded tags.
///
/// The parser compares each attribute of a tag with all before it, and copies the namespaces of a parent into its
/// children: both are quadratic in the file's size. Malformed markup passes; the parser refuses it.
///
/// # Errors
/// The code, the offending range of bytes, and what was found.
pub(super) fn check(text: &str) -> Result<(), (Code, std::ops::Range<usize>, String)> {
    let bytes = text.as_bytes();
    let find = |from: usize, end: &str| text[from..].find(end).map_or(bytes.len(), |p| from + p + end.len());
    let mut depth = 0usize;
    let mut at = 0;
    while let Some(start) = text[at..].find('<').map(|p| at + p) {
        let rest = &text[start..];
        at = if rest.starts_with("<!--") {
            find(start + 4, "-->")
        } else if rest.starts_with("<![CDATA[") {
            find(start, "]]>")
        } else if rest.starts_with("<?") {
            find(start, "?>")
        } else if rest.starts_with("<!") {
            let found = "document types and entities are refused".to_string();
            return Err((Code::DocumentType, start..start + 2 + name_length(&bytes[start + 2..]), found));
        } else if rest.starts_with("</") {
            depth = depth.saturating_sub(1);
            find(start, ">")
        } else {
            let (end, closed) = check_tag(text, start)?;
            depth += usize::from(!closed);
            if depth > MAX_NESTING {
                let found = format!("elements are nested more than {MAX_NESTING} deep");
                return Err((Code::BeyondLimits, start..start + 1 + name_length(&bytes[start + 1..]), found));
            }
            end
        };
    }
    Ok(())
}

/// The end of a start tag, and whether it closes itself.
fn check_tag(text: &str, start: usize) -> Result<(usize, bool), (Code, std::ops::Range<usize>, String)> {
    let bytes = text.as_bytes();
    let mut quote = None;
    let mut n_attributes = 0;
    for at in start + 1..bytes.len() {
        match (quote, bytes[at]) {
            (Some(open), b) if b == open => quote = None,
            (Some(_), _) => {}
            (None, b @ (b'"' | b'\'')) => quote = Some(b),
            (None, b'>') => return Ok((at + 1, bytes[at - 1] == b'/')),
            (None, b'=') => {
                n_attributes += 1;
                if n_attributes > MAX_ATTRIBUTES {
                    let found = format!("an element has more than {MAX_ATTRIBUTES} attributes");
                    return Err((Code::BeyondLimits, at..at + 1, found));
                }
            }
            (None, b'x') if bytes[at..].starts_with(b"xmlns") && bytes[at - 1].is_ascii_whitespace() => {
                let found = "XML namespaces have no meaning in scene files".to_string();
                return Err((Code::UnknownAttribute, at..at + name_length(&bytes[at..]), found));
            }
            _ => {}
        }
    }
    Ok((bytes.len(), false))
}

fn name_length(bytes: &[u8]) -> usize {
    bytes.iter().position(|b| !(b.is_ascii_alphanumeric() || b"_-:.".contains(b))).unwrap_or(bytes.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn code(text: &str) -> Option<Code> {
        check(text).err().map(|(code, ..)| code)
    }

    #[test]
    fn passes_what_only_looks_dangerous() {
        let comment = format!("<a><!-- {} <!DOCTYPE b> --><b c='<!DOCTYPE'/></a>", "<a>".repeat(2 * MAX_NESTING));
        assert_eq!(code(&comment), None);
        assert_eq!(code("<a b='x = y = z = x = y = z = x = y = z = x = y = z = x = y = z = x = y = z'/>"), None);
        assert_eq!(code(&"<a/>".repeat(2 * MAX_NESTING)), None);
        assert_eq!(code(&"<a></a>".repeat(2 * MAX_NESTING)), None);
    }

    #[test]
    fn refuses_each_costly_construction() {
        assert_eq!(code("<?xml version='1.0'?><!DOCTYPE bomb [<!ENTITY a 'b'>]><a/>"), Some(Code::DocumentType));
        assert_eq!(code(&"<a>".repeat(MAX_NESTING + 1)), Some(Code::BeyondLimits));
        assert_eq!(code(&"<a>".repeat(MAX_NESTING)), None);
        assert_eq!(code(&format!("<a {}/>", "b='c' ".repeat(MAX_ATTRIBUTES + 1))), Some(Code::BeyondLimits));
        assert_eq!(code("<a xmlns:b='c'/>"), Some(Code::UnknownAttribute));
    }
}
