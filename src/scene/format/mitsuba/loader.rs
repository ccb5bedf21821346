//! From files to a [`Document`]: parse, expand `$name`s, splice includes, register ids.

use super::definitions::{Definitions, Refusal};
use super::document::{Attribute, Document, Element, ROOT, Source, Span};
use super::guard;
use crate::scene::format::error::{locate, quoted};
use crate::scene::format::source::Budget;
use crate::scene::format::{Code, FormatError, Position};
use std::cell::RefCell;
use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A file may hold this many elements, comments and stretches of text.
const MAX_NODES: u32 = 1 << 20;
/// Files may include files this deep, as in Mitsuba 3.
const MAX_INCLUDE_DEPTH: usize = 15;
/// A scene may be made of this many files: includes that branch grow like powers.
const MAX_FILES: usize = 256;

/// Reads a scene file and everything it includes.
pub(super) fn load(path: &Path, definitions: &[(String, String)]) -> Result<Document, FormatError> {
    let outside = |refusal: Refusal| {
        let error = FormatError::new(refusal.code, path, Position::File, refusal.found);
        error.suggest(refusal.suggestion.as_deref()).note("definitions from outside are given as -D name=value")
    };
    let document = Document {
        sources: Vec::new(),
        elements: Vec::new(),
        ids: HashMap::new(),
        folders: Vec::new(),
        budget: RefCell::new(Budget::new()),
    };
    let mut loader =
        Loader { document, definitions: Definitions::new(definitions).map_err(outside)?, open: Vec::new() };
    loader.file(path, None)?;
    loader.definitions.check_used().map_err(outside)?;
    Ok(loader.document)
}

struct Loader {
    document: Document,
    definitions: Definitions,
    /// The files being read, outermost first, by their true paths.
    open: Vec<PathBuf>,
}

impl Loader {
    /// Reads one file: the scene itself, or what an `include` at `(parent, attribute)` names.
    fn file(&mut self, path: &Path, include: Option<(usize, &Attribute)>) -> Result<(), FormatError> {
        // Refuse what is missing, too much, or already open further out.
        let refuse = |document: &Document, code, found: String| match include {
            None => FormatError::new(code, path, Position::File, found),
            Some((_, attribute)) => document.error(code, &attribute.value_span, found),
        };
        let refused = |document: &Document, (code, found)| Err(refuse(document, code, found));
        let true_path = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
        if self.open.contains(&true_path) {
            return refused(&self.document, (Code::IncludeCycle, format!("`{}` includes itself", path.display())));
        }
        if self.open.len() > MAX_INCLUDE_DEPTH || self.document.sources.len() >= MAX_FILES {
            let found = format!("a scene has at most {MAX_FILES} files, included at most {MAX_INCLUDE_DEPTH} deep");
            return refused(&self.document, (Code::BeyondLimits, found));
        }
        let bytes = match self.document.budget.get_mut().read(path) {
            Ok(bytes) => bytes,
            Err(refusal) => return refused(&self.document, refusal),
        };

        // Move what it holds into the document.
        self.open.push(true_path);
        let held = self.text(path, bytes, include.map(|(parent, _)| parent));
        self.open.pop();
        match include {
            None => held,
            Some((_, name)) => {
                held.map_err(|error| error.note(format!("included at {}", self.document.place(&name.value_span))))
            }
        }
    }

    /// Takes the text of a file, and from it the elements.
    fn text(&mut self, path: &Path, bytes: Vec<u8>, parent: Option<usize>) -> Result<(), FormatError> {
        // Hold it to be text, without a byte order mark.
        let text = String::from_utf8(bytes).map_err(|e| {
            let at = e.utf8_error().valid_up_to();
            let found = format!("byte 0x{:02x} is not UTF-8", e.as_bytes()[at]);
            FormatError::new(Code::InvalidUtf8, path, locate(e.as_bytes(), at..at + 1), found)
        })?;
        let text: Arc<str> = text.strip_prefix('\u{feff}').unwrap_or(&text).into();

        // Parse it once it cannot cost more than its size.
        let fail = |code, range, found: String| FormatError::new(code, path, locate(text.as_bytes(), range), found);
        guard::check(&text).map_err(|(code, range, found)| fail(code, range, found))?;
        let options = roxmltree::ParsingOptions { allow_dtd: false, nodes_limit: MAX_NODES, ..Default::default() };
        let tree = roxmltree::Document::parse_with_options(&text, options).map_err(|e| malformed(path, &text, &e))?;
        self.document.sources.push(Source { path: path.to_path_buf(), text: text.clone() });
        self.root(tree.root_element(), parent)
    }

    /// Takes the root of a file. A `scene` that is included gives its children to the including element; anything
    /// else, itself.
    fn root(&mut self, node: roxmltree::Node, parent: Option<usize>) -> Result<(), FormatError> {
        let source = self.document.sources.len() - 1;
        let mut element = self.element(node, source)?;
        self.check_version(&element)?;
        let is_scene = element.tag == "scene";
        match parent {
            None if !is_scene => {
                let found = format!("{} is not a scene", quoted(&element.tag));
                let error = self.document.error(Code::MisplacedElement, &element.span, found);
                Err(error.expected_one_of(&element.tag, &["scene"]))
            }
            None => {
                self.document.elements.push(element);
                self.children(node, source, ROOT)
            }
            Some(parent) if is_scene => {
                self.document.check_attributes(&element, &["version"], &[])?;
                self.children(node, source, parent)
            }
            Some(parent) => {
                element.attributes.retain(|a| a.name != "version");
                self.add(element, node, source, parent)
            }
        }
    }

    fn children(&mut self, node: roxmltree::Node, source: usize, parent: usize) -> Result<(), FormatError> {
        for child in node.children() {
            let range = child.range();
            if child.is_element() {
                let element = self.element(child, source)?;
                self.add(element, child, source, parent)?;
            } else if let Some(text) = child.text().filter(|_| child.is_text())
                && !text.trim().is_empty()
            {
                let start = range.start + (text.len() - text.trim_start().len()).min(range.len());
                let span = Span { source, range: start..range.end.min(start + text.trim().len()).max(start) };
                return Err(self.document.error(Code::UnexpectedText, &span, "text between elements has no meaning"));
            } else if child.is_pi() {
                let span = Span { source, range };
                return Err(self.document.error(
                    Code::UnexpectedText,
                    &span,
                    "processing instructions have no meaning",
                ));
            }
        }
        Ok(())
    }

    /// Carries out what is meant for the loader, and keeps every other element.
    fn add(
        &mut self,
        element: Element,
        node: roxmltree::Node,
        source: usize,
        parent: usize,
    ) -> Result<(), FormatError> {
        let loader_only = match element.tag.as_str() {
            "default" => Some(Self::default as fn(&mut Self, &Element, usize) -> Result<(), FormatError>),
            "include" => Some(Self::include as _),
            "path" => Some(Self::folder as _),
            "alias" => Some(Self::alias as _),
            _ => None,
        };
        if let Some(carry_out) = loader_only {
            if let Some(child) = node.children().find(|c| c.is_element()) {
                let range = child.range().start + 1..child.range().start + 1 + child.tag_name().name().len();
                let found = format!("{} cannot stand inside <{}>", quoted(child.tag_name().name()), element.tag);
                return Err(self.document.error(Code::MisplacedElement, &Span { source, range }, found));
            }
            if parent != ROOT {
                let found = format!("<{}> cannot stand inside <{}>", element.tag, self.document.elements[parent].tag);
                let error = self.document.error(Code::MisplacedElement, &element.span, found);
                return Err(error.expected("it directly inside <scene>"));
            }
            return carry_out(self, &element, parent);
        }

        let number = self.document.elements.len();
        if let Some(id) = element.attribute("id").filter(|_| element.tag != "ref") {
            self.register(id, number)?;
        }
        self.document.elements.push(element);
        self.document.elements[parent].children.push(number);
        self.children(node, source, number)
    }

    fn default(&mut self, element: &Element, _: usize) -> Result<(), FormatError> {
        self.document.check_attributes(element, &["name", "value"], &[])?;
        let name = self.document.required(element, "name")?;
        let value = self.document.required(element, "value")?;
        self.definitions
            .default(&name.value, &value.value)
            .map_err(|refusal| refused(&self.document, &name.value_span, refusal))
    }

    fn include(&mut self, element: &Element, parent: usize) -> Result<(), FormatError> {
        self.document.check_attributes(element, &["filename"], &[])?;
        let name = self.document.required(element, "filename")?;
        let path = self.document.find_file(name);
        self.file(&path, Some((parent, name)))
    }

    fn folder(&mut self, element: &Element, _: usize) -> Result<(), FormatError> {
        self.document.check_attributes(element, &["value"], &[])?;
        let name = self.document.required(element, "value")?;
        let path = self.document.find_file(name);
        if !path.is_dir() {
            let found = format!("`{}` is not a folder", path.display());
            return Err(self.document.error(Code::UnreadableFile, &name.value_span, found));
        }
        self.document.folders.push(path);
        Ok(())
    }

    fn alias(&mut self, element: &Element, _: usize) -> Result<(), FormatError> {
        self.document.check_attributes(element, &["id", "as"], &[])?;
        let id = self.document.required(element, "id")?;
        self.document.referred(id)?;
        let number = self.document.ids[&id.value];
        let other = self.document.required(element, "as")?;
        self.register(other, number)
    }

    fn register(&mut self, id: &Attribute, number: usize) -> Result<(), FormatError> {
        if id.value.is_empty() {
            return Err(self.document.error(Code::MissingValue, &id.value_span, "the id is empty"));
        }
        if let Some(other) = self.document.ids.get(&id.value) {
            // Not yet pushed when the new element takes its own id: a known number is always another element.
            let place = self.document.place(&self.document.elements[*other].span);
            let found = format!("the id {} is given twice", quoted(&id.value));
            let error = self.document.error(Code::DuplicateId, &id.value_span, found);
            return Err(error.note(format!("first given at {place}")));
        }
        self.document.ids.insert(id.value.clone(), number);
        Ok(())
    }

    /// An element's tag and attributes, `$name`s expanded; not yet its children.
    fn element(&mut self, node: roxmltree::Node, source: usize) -> Result<Element, FormatError> {
        let tag = node.tag_name().name().to_string();
        let start = node.range().start + 1;
        let span = Span { source, range: start..start + tag.len() };
        let mut attributes = Vec::new();
        for attribute in node.attributes() {
            let name_span = Span { source, range: attribute.range_qname() };
            let value_span = Span { source, range: attribute.range_value() };
            if attribute.namespace().is_some() {
                let found = "XML namespaces have no meaning in scene files";
                return Err(self.document.error(Code::UnknownAttribute, &name_span, found));
            }
            let value = match attribute.value().contains('$') {
                true => self.definitions.expand(attribute.value()),
                false => Ok(attribute.value().to_string()),
            };
            let value = value.map_err(|refusal| refused(&self.document, &value_span, refusal))?;
            let raw = self.document.sources[source].text.get(value_span.range.clone());
            let literal = raw == Some(value.as_str());
            attributes.push(Attribute { name: attribute.name().to_string(), value, literal, name_span, value_span });
        }
        Ok(Element { tag, span, attributes, children: Vec::new() })
    }

    /// Checks that a file's root states a version this reader knows.
    fn check_version(&self, root: &Element) -> Result<(), FormatError> {
        let version = self.document.required(root, "version")?;
        let numbers: Result<Vec<u32>, _> = version.value.split('.').map(str::parse).collect();
        match numbers.as_deref() {
            Ok([2 | 3, _, _]) => Ok(()),
            _ => {
                let found = format!("version {} of the format is not read", quoted(&version.value));
                let error = self.document.error(Code::UnsupportedValue, &version.value_span, found);
                Err(error.expected("a version from 2.0.0 on and below 4, e.g. 3.0.0"))
            }
        }
    }
}

fn refused(document: &Document, span: &Span, refusal: Refusal) -> FormatError {
    document.error(refusal.code, span, refusal.found).suggest(refusal.suggestion.as_deref())
}

/// What the XML parser found, at the place where it found it.
fn malformed(path: &Path, text: &str, error: &roxmltree::Error) -> FormatError {
    // Turn the parser's line and column, in characters, into bytes.
    let position = error.pos();
    let is_whole = matches!(
        error,
        roxmltree::Error::NoRootNode | roxmltree::Error::UnclosedRootNode | roxmltree::Error::UnexpectedEndOfStream
    );
    let line_start = text.split_inclusive('\n').take(position.row as usize - 1).map(str::len).sum::<usize>();
    let column =
        text[line_start..].char_indices().nth(position.col as usize - 1).map_or(text.len() - line_start, |(i, _)| i);
    let at = if is_whole { text.trim_end().len() } else { line_start + column };

    // Take the parser's words, without its own position.
    let words = error.to_string();
    let words = words.split(" at ").next().unwrap_or(&words).trim().to_string();
    let code = match error {
        roxmltree::Error::NodesLimitReached => Code::BeyondLimits,
        roxmltree::Error::DtdDetected => Code::DocumentType,
        _ => Code::MalformedXml,
    };
    FormatError::new(code, path, locate(text.as_bytes(), at..at + 1), words)
}
