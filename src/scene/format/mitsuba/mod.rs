//! Mitsuba 3 XML, the diffuse subset.
//!
//! A file becomes a [`Document`](document::Document), whose elements are read as plugins, each by the table of what
//! it takes.

mod definitions;
mod document;
mod guard;
mod loader;
mod material;
mod object;
mod renderer;
mod sensor;
mod shape;
mod tessellation;
mod transform;
mod value;

pub use tessellation::{N_DISK_RINGS, N_MERIDIANS, N_PARALLELS};

use super::{Code, FormatError, MAX_SCENE_POLYGONS};
use crate::scene::{Camera, Scene, SceneDescription, SceneError, Surface, rgb_bands};
use document::{ROOT, Span};
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// Elements that may stand in a scene.
const PARTS: [&str; 8] = ["shape", "bsdf", "sensor", "integrator", "default", "include", "path", "alias"];

/// Reads a scene file.
pub(super) fn read(path: &Path, definitions: &[(String, String)]) -> Result<Scene, FormatError> {
    let document = loader::load(path, definitions)?;
    let root = &document.elements[ROOT];
    document.check_attributes(root, &["version"], &[])?;

    // Read every element of the scene, those that nothing refers to included.
    let mut shapes: Vec<(Surface, &str, &Span)> = Vec::new();
    let mut camera: Option<(Camera, &Span)> = None;
    let mut integrator = None;
    let mut n_polygons = 0;
    for element in root.children.iter().map(|c| &document.elements[*c]) {
        let once = |first: Option<&Span>| match first {
            None => Ok(()),
            Some(first) => {
                let found = format!("the scene has a second <{}>", element.tag);
                let error = document.error(Code::RepeatedValue, &element.span, found);
                Err(error.note(format!("first given at {}", document.place(first))))
            }
        };
        match element.tag.as_str() {
            "shape" => {
                let (surface, plugin) = shape::surface(&document, element)?;
                n_polygons += surface.polygons.len();
                if n_polygons > MAX_SCENE_POLYGONS {
                    let found = format!("the scene has more than {MAX_SCENE_POLYGONS} polygons");
                    return Err(document.error(Code::BeyondLimits, &element.span, found));
                }
                shapes.push((surface, plugin, &element.span));
            }
            "bsdf" => drop(material::material(&document, element)?),
            "sensor" => {
                once(camera.as_ref().map(|(_, span)| *span))?;
                camera = Some((sensor::camera(&document, element)?, &element.span));
            }
            "integrator" => {
                once(integrator)?;
                renderer::check_integrator(&document, element)?;
                integrator = Some(&element.span);
            }
            tag => return Err(object::misplaced(&document, element, element, "<scene>").expected_one_of(tag, &PARTS)),
        }
    }

    // Name what has no name, and check the whole.
    name_surfaces(&mut shapes);
    let spans: HashMap<String, &Span> = shapes.iter().map(|(s, _, span)| (s.name.clone(), *span)).collect();
    let sensor = camera.as_ref().map(|(_, span)| *span);
    let description = SceneDescription {
        name: path.file_stem().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default(),
        bands: rgb_bands(),
        surfaces: shapes.into_iter().map(|(surface, ..)| surface).collect(),
        camera: camera.map(|(camera, _)| camera),
    };
    Scene::new(description).map_err(|error| {
        let span = match &error {
            SceneError::Camera { .. } => sensor,
            SceneError::NoPolygons { surface }
            | SceneError::Polygon { surface, .. }
            | SceneError::OutOfRange { surface, .. }
            | SceneError::BandCount { surface, .. }
            | SceneError::DuplicateName { surface } => spans.get(surface).copied(),
            _ => None,
        };
        document.error(Code::InvalidScene, span.unwrap_or(&root.span), error.to_string())
    })
}

/// Gives each surface without an id the name of its plugin and a running number, apart from every id.
fn name_surfaces(shapes: &mut [(Surface, &str, &Span)]) {
    let mut taken: HashSet<String> = shapes.iter().map(|(s, ..)| s.name.clone()).collect();
    let mut counts: HashMap<&str, usize> = HashMap::new();
    for (surface, plugin, _) in shapes.iter_mut() {
        let count = counts.entry(plugin).or_default();
        *count += 1;
        if surface.name.is_empty() {
            let name = format!("{plugin}-{count}");
            let with_suffix = |k: usize| if k == 1 { name.clone() } else { format!("{name}-{k}") };
            surface.name = (1..).map(with_suffix).find(|n| !taken.contains(n)).unwrap_or(name.clone());
            taken.insert(surface.name.clone());
        }
    }
}
