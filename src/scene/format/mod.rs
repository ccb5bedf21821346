//! Scenes from files: Mitsuba 3 XML, with Wavefront OBJ and PLY meshes.
//!
//! # What is read
//! The diffuse subset of Mitsuba 3:
//!
//! | element | plugins and parameters |
//! |---|---|
//! | `shape` | `rectangle`, `cube`, `sphere` (`center`, `radius`), `disk`, `cylinder` (`p0`, `p1`, `radius`), `obj` and `ply` (`filename`, `face_normals`, `flip_tex_coords`); each with `to_world`, `flip_normals`, a `bsdf` and an `emitter` |
//! | `bsdf` | `diffuse` (`reflectance`, default 0.5), `twosided` around one or two of them |
//! | `emitter` | `area` (`radiance`, default 1), inside a shape |
//! | `sensor` | `perspective` (`fov` and `fov_axis`, or `focal_length`; `near_clip`, `far_clip`, `to_world`) |
//! | `film` | `hdrfilm` (`width`, `height`), with an `rfilter`: `box`, `tent`, `gaussian`, `mitchell`, `catmullrom`, `lanczos` |
//! | values | `float`, `integer`, `boolean`, `string`, `rgb`, `spectrum` (one number), `point`, `vector`, `transform` |
//! | structure | `default` and `$name`, `ref`, `alias`, `include`, `path` |
//!
//! Whatever is not in this table is refused by name; no element, attribute or parameter is silently ignored. Some things
//! are read, checked and then left aside by design. The `integrator` (`path`, `direct`) and the `sampler` steer a renderer
//! and are no part of the scene; nor are the clipping and focus distances of a pinhole, or the formats and the border in
//! which a film is stored. Crops of the film and offsets of the principal point may be given where they change nothing.
//! Of meshes, normals, texture coordinates, groups and material names are left aside: facets are flat, their front is that
//! of their winding, and their material comes from the XML.
//!
//! # Conventions, as measured on Mitsuba 3.9
//!  * A `diffuse` surface reflects and emits on its front only and is black behind; `twosided` reflects on both.
//!  * The front of a rectangle, disk, cube or cylinder follows its transformed normal, also under mirroring
//!    transforms. That of a mesh follows the winding of the transformed vertices, so that mirroring turns it; so does
//!    that of a sphere.
//!  * Faces of meshes stay polygons where they are planar to rounding and convex; other convex ones become fans of
//!    triangles, and concave ones are refused. Vertices keep the digits of the file.
//!  * Curved shapes become polygons with vertices on the shape, see [`Tessellation`](super::Tessellation): a sphere
//!    [`N_MERIDIANS`] × [`N_PARALLELS`], a disk the image of a square grid of [`N_DISK_RINGS`] rings, a cylinder
//!    [`N_MERIDIANS`]. Spheres may be moved, turned and scaled alike in all directions; disks and cylinders take any
//!    transform.
//!  * A `spectrum` constant is the same power at every wavelength. As a reflectance it is that number in every band;
//!    as a radiance it has the colour of illuminant E in linear sRGB, (1.204794, 0.948291, 0.908916) times the
//!    number. `rgb` and `float` are taken as they are.
//!  * The first transform listed is applied first. The x axis of a sensor appears on the left of the picture.
//!
//! # Errors
//! Every refusal is a [`FormatError`] with a stable [`Code`], a position, what was expected and, within edit distance
//! 2, what may have been meant. Files may be hostile: all the files of a scene together are bounded by
//! [`MAX_SCENE_BYTES`], document types (entity bombs) are refused, nesting, includes, expansions and polygons
//! ([`MAX_SCENE_POLYGONS`]) are bounded, and memory is bounded by the bytes that are there and not by what a header
//! announces.

mod code;
mod error;
mod mesh;
mod mitsuba;
mod number;
mod source;

pub use code::Code;
pub use error::{FormatError, Position, Report};
pub use mesh::MAX_SCENE_POLYGONS;
pub use mitsuba::{N_DISK_RINGS, N_MERIDIANS, N_PARALLELS};
pub use source::MAX_SCENE_BYTES;

use super::Scene;
use error::quoted;
use std::path::Path;

/// Reads a scene file; `definitions` are the values of `$name`s given from outside, and win over the file's
/// `default`s.
///
/// The format is chosen by the extension: `.xml` is Mitsuba 3. Bands are linear sRGB; the scene has the name of the
/// file.
///
/// # Errors
/// Whatever the file holds that is not understood, with its position; see the [module's documentation](self).
pub fn read(path: &Path, definitions: &[(String, String)]) -> Result<Scene, FormatError> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some("xml") => mitsuba::read(path, definitions),
        other => {
            let found = match other {
                Some(extension) => format!("files ending in {} hold no scene", quoted(&format!(".{extension}"))),
                None => "the file's name does not say its format".to_string(),
            };
            let error = FormatError::new(Code::UnsupportedFormat, path, Position::File, found);
            Err(error.expected("a Mitsuba 3 scene, .xml (meshes, .obj and .ply, are read through it)"))
        }
    }
}
