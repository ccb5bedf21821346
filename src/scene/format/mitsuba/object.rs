//! A plugin with its parameters and the plugins nested in it, checked by name.

use super::document::{Attribute, Document, Element};
use super::{transform, value};
use crate::geometry::{Affine3, Vec3};
use crate::scene::format::error::quoted;
use crate::scene::format::{Code, FormatError};

/// What a plugin takes.
pub(super) struct Plugin {
    pub name: &'static str,
    pub parameters: &'static [(&'static str, Kind)],
    /// Elements that may be nested in it, and how many of each.
    pub parts: &'static [(&'static str, usize)],
}

/// What a parameter is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Float,
    Integer,
    Boolean,
    Text,
    Point,
    Transform,
    Colour,
}

impl Kind {
    /// The elements that may carry it.
    fn tags(self) -> &'static [&'static str] {
        match self {
            Kind::Float => &["float", "integer"],
            Kind::Integer => &["integer"],
            Kind::Boolean => &["boolean"],
            Kind::Text => &["string"],
            Kind::Point => &["point", "vector"],
            Kind::Transform => &["transform"],
            Kind::Colour => &["rgb", "spectrum", "float"],
        }
    }
}

/// Elements that carry parameters.
const VALUES: [&str; 9] = ["float", "integer", "boolean", "string", "point", "vector", "transform", "rgb", "spectrum"];
/// Elements that carry plugins.
const OBJECTS: [&str; 8] = ["shape", "bsdf", "emitter", "sensor", "film", "sampler", "rfilter", "integrator"];
/// Further elements, which stand in places of their own.
const OTHERS: [&str; 11] =
    ["scene", "ref", "alias", "default", "include", "path", "translate", "rotate", "scale", "matrix", "lookat"];

/// One plugin of a document, its parameters and parts known by name.
pub(super) struct Object<'a> {
    pub document: &'a Document,
    pub element: &'a Element,
    pub plugin: &'static Plugin,
    values: Vec<(&'static str, &'a Element)>,
    parts: Vec<(&'static str, &'a Element)>,
}

impl<'a> Object<'a> {
    /// Checks an element against the plugins of its kind: its type, every parameter's name and value, every nested
    /// element.
    pub(super) fn open(
        document: &'a Document,
        element: &'a Element,
        plugins: &'static [Plugin],
    ) -> Result<Self, FormatError> {
        document.check_attributes(element, &["type"], &["id", "name"])?;
        let kind = document.required(element, "type")?;
        let Some(plugin) = plugins.iter().find(|p| p.name == kind.value) else {
            let found = format!("{} is not a supported {}", quoted(&kind.value), element.tag);
            let names: Vec<&str> = plugins.iter().map(|p| p.name).collect();
            let error = document.error(Code::UnsupportedPlugin, &kind.value_span, found);
            return Err(error.expected_one_of(&kind.value, &names));
        };
        let mut object = Self { document, element, plugin, values: Vec::new(), parts: Vec::new() };
        for child in element.children.iter().map(|c| &document.elements[*c]) {
            match VALUES.contains(&child.tag.as_str()) {
                true => object.take_value(child)?,
                false => object.take_part(child)?,
            }
        }
        Ok(object)
    }

    fn take_value(&mut self, child: &'a Element) -> Result<(), FormatError> {
        // Know the parameter, once, by the right kind of element.
        let document = self.document;
        let name = document.required(child, "name")?;
        let Some((known, kind)) = self.plugin.parameters.iter().find(|(n, _)| *n == name.value) else {
            let found = format!("{} is not a parameter of {}", quoted(&name.value), self.label());
            let names: Vec<&str> = self.plugin.parameters.iter().map(|(n, _)| *n).collect();
            let error = document.error(Code::UnknownParameter, &name.value_span, found);
            return Err(error.expected_one_of(&name.value, &names));
        };
        if let Some((_, first)) = self.values.iter().find(|(n, _)| n == known) {
            let error = document.error(Code::RepeatedValue, &name.value_span, format!("`{known}` is given twice"));
            return Err(error.note(format!("first given at {}", document.place(&first.span))));
        }
        if !kind.tags().contains(&child.tag.as_str()) {
            let found = format!("`{known}` of {} is not given by <{}>", self.label(), child.tag);
            let tags: Vec<String> = kind.tags().iter().map(|t| format!("<{t}>")).collect();
            return Err(document.error(Code::WrongType, &child.span, found).expected(tags.join(" or ")));
        }

        // Check its value even where nothing will use it.
        match kind {
            Kind::Transform => {
                document.check_attributes(child, &["name"], &[])?;
                transform::read(document, child)?;
            }
            Kind::Point => {
                document.check_no_children(child)?;
                value::vector(document, child, &["name"], None)?;
            }
            _ => {
                document.check_no_children(child)?;
                document.check_attributes(child, &["name", "value"], &[])?;
                let attribute = document.required(child, "value")?;
                match kind {
                    Kind::Float => value::number(document, attribute).map(drop)?,
                    Kind::Integer => value::integer(document, attribute).map(drop)?,
                    Kind::Boolean => value::boolean(document, attribute).map(drop)?,
                    _ => {}
                }
            }
        }
        self.values.push((known, child));
        Ok(())
    }

    fn take_part(&mut self, child: &'a Element) -> Result<(), FormatError> {
        let document = self.document;
        let part = document.resolve(child)?;
        let Some((known, n_allowed)) = self.plugin.parts.iter().find(|(tag, _)| *tag == part.tag) else {
            let error = misplaced(document, child, part, &self.label());
            let names: Vec<&str> = self.plugin.parts.iter().map(|(tag, _)| *tag).chain(["a parameter"]).collect();
            return Err(error.expected_one_of(&part.tag, &names));
        };
        if self.parts.iter().filter(|(tag, _)| tag == known).count() == *n_allowed {
            let found = format!("{} takes at most {n_allowed} <{known}>", self.label());
            return Err(document.error(Code::RepeatedValue, &child.span, found));
        }
        self.parts.push((known, part));
        Ok(())
    }

    /// What the object is called in messages.
    pub(super) fn label(&self) -> String {
        format!("{} `{}`", self.element.tag, self.plugin.name)
    }

    /// The nested elements of one kind, references resolved.
    pub(super) fn parts(&self, tag: &str) -> impl Iterator<Item = &'a Element> {
        self.parts.iter().filter(move |(t, _)| *t == tag).map(|(_, element)| *element)
    }

    /// The element that gives a parameter.
    pub(super) fn given(&self, name: &str) -> Option<&'a Element> {
        self.values.iter().find(|(n, _)| *n == name).map(|(_, element)| *element)
    }

    /// The `value` that gives a parameter.
    pub(super) fn value(&self, name: &str) -> Option<&'a Attribute> {
        self.given(name).and_then(|element| element.attribute("value"))
    }

    pub(super) fn number(&self, name: &str) -> Result<Option<f64>, FormatError> {
        self.value(name).map(|a| value::number(self.document, a)).transpose()
    }

    pub(super) fn integer(&self, name: &str) -> Result<Option<i64>, FormatError> {
        self.value(name).map(|a| value::integer(self.document, a)).transpose()
    }

    pub(super) fn boolean(&self, name: &str) -> Result<Option<bool>, FormatError> {
        self.value(name).map(|a| value::boolean(self.document, a)).transpose()
    }

    pub(super) fn point(&self, name: &str) -> Result<Option<Vec3>, FormatError> {
        self.given(name).map(|e| value::vector(self.document, e, &["name"], None)).transpose()
    }

    pub(super) fn transform(&self, name: &str) -> Result<Affine3, FormatError> {
        self.given(name).map_or(Ok(Affine3::IDENTITY), |e| transform::read(self.document, e))
    }

    /// An error at the value of a parameter that is given, else at the object.
    pub(super) fn error(&self, code: Code, parameter: &str, found: impl Into<String>) -> FormatError {
        let span = match (self.value(parameter), self.given(parameter)) {
            (Some(attribute), _) => &attribute.value_span,
            (None, Some(element)) => &element.span,
            (None, None) => &self.element.span,
        };
        self.document.error(code, span, found)
    }
}

/// An element where it does not belong: one of another place, or one that does not exist.
pub(super) fn misplaced(document: &Document, child: &Element, meant: &Element, parent: &str) -> FormatError {
    let known: Vec<&str> = VALUES.iter().chain(&OBJECTS).chain(&OTHERS).copied().collect();
    if known.contains(&meant.tag.as_str()) {
        let found = format!("<{}> cannot stand inside {parent}", meant.tag);
        return document.error(Code::MisplacedElement, &child.span, found);
    }
    let found = format!("{} is not an element that is read here", quoted(&meant.tag));
    document.error(Code::UnknownElement, &child.span, found)
}
