//! Scenes and meshes from files.

mod camera;
mod hostile;
mod mesh;
mod messages;
mod shapes;
mod structure;

use etendue::geometry::{Polygon, Vec3};
use etendue::scene::format::{self, Code, FormatError};
use etendue::scene::{Scene, Surface};
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;

/// Coordinates near 1 after a few rotations and products: some ten roundings.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// A folder with files in it, gone at the end of the test.
struct Folder(TempDir);

impl Folder {
    fn new(files: &[(&str, &[u8])]) -> Self {
        let folder = Self(TempDir::new().expect("the temporary folder can be written"));
        for (name, bytes) in files {
            let path = folder.path(name);
            fs::create_dir_all(path.parent().expect("a file has a folder")).expect("folders can be made");
            fs::write(path, bytes).expect("files can be written");
        }
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn read(&self, name: &str) -> Result<Scene, FormatError> {
        format::read(&self.path(name), &[])
    }
}

/// Reads the elements of a scene.
fn scene(elements: &str) -> Result<Scene, FormatError> {
    file(&format!("<scene version=\"3.0.0\">\n{elements}\n</scene>\n"))
}

/// Reads a whole scene file.
fn file(text: &str) -> Result<Scene, FormatError> {
    Folder::new(&[("scene.xml", text.as_bytes())]).read("scene.xml")
}

/// A lamp, so that a scene is one.
const LAMP: &str = r#"<shape type="rectangle" id="lamp"><emitter type="area"/></shape>"#;

/// Reads a scene of one shape, beside a lamp.
fn shape(element: &str) -> Result<Surface, FormatError> {
    scene(&format!("{LAMP}\n{element}")).map(|scene| scene.surfaces()[1].clone())
}

fn code<T>(result: Result<T, FormatError>) -> Option<Code> {
    result.err().map(|error| error.code)
}

/// Sum of area times normal.
fn area_vector<'a>(polygons: impl IntoIterator<Item = &'a Polygon>) -> Vec3 {
    polygons.into_iter().map(|p| p.area() * p.normal()).sum()
}

/// Volume inside a closed surface that faces outward, by the divergence theorem.
fn volume(surface: &Surface) -> f64 {
    surface.polygons.iter().map(|p| p.centroid().dot(p.normal()) * p.area()).sum::<f64>() / 3.0
}
