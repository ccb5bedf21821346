//! The elements of a scene file and of the files it includes, with where each word stands.

use super::super::error::{closest, locate, quoted};
use super::super::source::Budget;
use super::super::{Code, FormatError, Position};
use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Elements by number, files by number; `$name`s expanded, includes in place.
#[derive(Debug)]
pub(super) struct Document {
    pub sources: Vec<Source>,
    pub elements: Vec<Element>,
    /// Elements by id and alias.
    pub ids: HashMap<String, usize>,
    /// Folders named by `path`, in which files are looked for.
    pub folders: Vec<PathBuf>,
    /// How much may still be read: mesh files draw on it too.
    pub budget: RefCell<Budget>,
}

/// The text of one file.
#[derive(Debug)]
pub(super) struct Source {
    pub path: PathBuf,
    pub text: Arc<str>,
}

/// A range of bytes of one source.
#[derive(Clone, Debug)]
pub(super) struct Span {
    pub source: usize,
    pub range: Range<usize>,
}

#[derive(Debug)]
pub(super) struct Element {
    pub tag: String,
    /// The tag's name in the start tag.
    pub span: Span,
    pub attributes: Vec<Attribute>,
    pub children: Vec<usize>,
}

#[derive(Debug)]
pub(super) struct Attribute {
    pub name: String,
    pub value: String,
    /// The value stands in the file as it is: no `$name` or entity was expanded.
    pub literal: bool,
    pub name_span: Span,
    pub value_span: Span,
}

/// The number of the root element.
pub(super) const ROOT: usize = 0;

impl Element {
    pub(super) fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|a| a.name == name)
    }
}

impl Document {
    pub(super) fn error(&self, code: Code, span: &Span, found: impl Into<String>) -> FormatError {
        let source = &self.sources[span.source];
        FormatError::new(code, &source.path, locate(source.text.as_bytes(), span.range.clone()), found)
    }

    /// "file:line:column" of a place.
    pub(super) fn place(&self, span: &Span) -> String {
        let source = &self.sources[span.source];
        match locate(source.text.as_bytes(), span.range.clone()) {
            Position::Text { line, column, .. } => format!("{}:{line}:{column}", source.path.display()),
            _ => source.path.display().to_string(),
        }
    }

    /// Checks that an element has the required attributes, and no others than the required and optional ones.
    pub(super) fn check_attributes(
        &self,
        element: &Element,
        required: &[&str],
        optional: &[&str],
    ) -> Result<(), FormatError> {
        let accepted: Vec<&str> = required.iter().chain(optional).copied().collect();
        for attribute in &element.attributes {
            if !accepted.contains(&attribute.name.as_str()) {
                let found = format!("{} is not an attribute of <{}>", quoted(&attribute.name), element.tag);
                let error = self.error(Code::UnknownAttribute, &attribute.name_span, found);
                return Err(error.expected_one_of(&attribute.name, &accepted));
            }
        }
        for name in required {
            if element.attribute(name).is_none() {
                return Err(self.error(Code::MissingValue, &element.span, format!("<{}> needs `{name}`", element.tag)));
            }
        }
        Ok(())
    }

    /// The attribute of an element that must have it.
    pub(super) fn required<'a>(&self, element: &'a Element, name: &str) -> Result<&'a Attribute, FormatError> {
        let missing = || self.error(Code::MissingValue, &element.span, format!("<{}> needs `{name}`", element.tag));
        element.attribute(name).ok_or_else(missing)
    }

    /// Checks that nothing is nested in an element.
    pub(super) fn check_no_children(&self, element: &Element) -> Result<(), FormatError> {
        let Some(child) = element.children.first().map(|c| &self.elements[*c]) else { return Ok(()) };
        let found = format!("{} cannot stand inside <{}>", quoted(&child.tag), element.tag);
        Err(self.error(Code::MisplacedElement, &child.span, found))
    }

    /// The element that a `ref` means; any other element means itself.
    pub(super) fn resolve<'a>(&'a self, element: &'a Element) -> Result<&'a Element, FormatError> {
        if element.tag != "ref" {
            return Ok(element);
        }
        self.check_attributes(element, &["id"], &["name"])?;
        self.check_no_children(element)?;
        let id = self.required(element, "id")?;
        self.referred(id)
    }

    /// The element with the id that an attribute names.
    pub(super) fn referred(&self, id: &Attribute) -> Result<&Element, FormatError> {
        if let Some(number) = self.ids.get(&id.value) {
            return Ok(&self.elements[*number]);
        }
        let known: Vec<&str> = self.ids.keys().map(String::as_str).collect();
        let found = format!("no element has the id {}", quoted(&id.value));
        let error = self.error(Code::UnknownReference, &id.value_span, found);
        Err(error.expected("the id of an element of this scene").suggest(closest(&id.value, &known)))
    }

    /// The file that an attribute names: beside the file it is named in, beside the scene, or in a folder named by
    /// `path`.
    pub(super) fn find_file(&self, name: &Attribute) -> PathBuf {
        let beside = |source: usize| self.sources[source].path.parent().unwrap_or(Path::new(""));
        let folders = [beside(name.value_span.source), beside(0)].into_iter();
        let mut candidates =
            folders.chain(self.folders.iter().rev().map(PathBuf::as_path)).map(|f| f.join(&name.value));
        let first = beside(name.value_span.source).join(&name.value);
        candidates.find(|c| c.exists()).unwrap_or(first)
    }
}
