//! The catalogue: every scene with its parameters filled in, by name.

use super::{
    Exact, cornell_box, corner_box, floating_block, furnace_cube, furnace_exact, furnace_sphere, maze, parallel_plates,
    spherical_crater, two_rooms,
};
use crate::scene::Scene;

/// A scene of the gallery, ready to build.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    pub name: &'static str,
    /// One line.
    pub summary: &'static str,
    pub build: fn() -> Scene,
    /// What is known about the answer, if anything is.
    pub exact: fn() -> Option<Exact>,
    /// Longest edge of a patch for a quick look, in metres: a few hundred to two thousand patches in all.
    pub patch_size: f64,
    /// True where every ray from a front meets a front: nothing escapes to the environment.
    pub closed: bool,
}

/// Further than this many edits away, a name is not what was meant.
const FURTHEST_SUGGESTION: usize = 2;

static ENTRIES: [Entry; 9] = [
    Entry {
        name: "furnace-cube",
        summary: "closed unit cube of one albedo and emission; L = e/(1 - a) everywhere",
        build: || {
            furnace_cube::furnace_cube(&furnace_cube::ALBEDO, &furnace_cube::EMISSION).expect("defaults are valid")
        },
        exact: || Some(furnace_exact(&furnace_cube::ALBEDO, &furnace_cube::EMISSION)),
        patch_size: 0.125,
        closed: true,
    },
    Entry {
        name: "furnace-sphere",
        summary: "closed sphere of triangles of one albedo and emission; L = e/(1 - a) everywhere",
        build: || furnace_sphere(2, &furnace_cube::ALBEDO, &furnace_cube::EMISSION).expect("defaults are valid"),
        exact: || Some(furnace_exact(&furnace_cube::ALBEDO, &furnace_cube::EMISSION)),
        patch_size: 0.4,
        closed: true,
    },
    Entry {
        name: "cornell-box",
        summary: "the Cornell box built into Mitsuba 3: open front, two boxes, a lamp under the ceiling",
        build: cornell_box,
        exact: || None,
        patch_size: 0.125,
        closed: false,
    },
    Entry {
        name: "parallel-plates",
        summary: "two facing unit squares in the open, one emits; continuous values to 12 digits",
        build: parallel_plates::parallel_plates,
        exact: || Some(parallel_plates::parallel_plates_exact()),
        patch_size: 0.0625,
        closed: false,
    },
    Entry {
        name: "corner-box",
        summary: "closed box under a glowing ceiling with a turned block in it; exact energy balance",
        build: corner_box::corner_box,
        exact: || Some(corner_box::corner_box_exact()),
        patch_size: 0.1,
        closed: true,
    },
    Entry {
        name: "floating-block",
        summary: "closed cube under a glowing ceiling with a turned block hanging in it; exact energy balance",
        build: || floating_block::floating_block(1).expect("one facet a face is valid"),
        exact: || Some(floating_block::floating_block_exact()),
        patch_size: 0.1,
        closed: true,
    },
    Entry {
        name: "two-rooms",
        summary: "two bright closed rooms joined by a small door, a lamp in one: mixes slowly; exact energy balance",
        build: two_rooms::two_rooms,
        exact: || Some(two_rooms::two_rooms_exact()),
        patch_size: 0.5,
        closed: true,
    },
    Entry {
        name: "maze",
        summary: "six bright closed rooms joined by small doors, a lamp in the first: mixes slowest; energy balance",
        build: maze::maze,
        exact: || Some(maze::maze_exact()),
        patch_size: 0.5,
        closed: true,
    },
    Entry {
        name: "spherical-crater",
        summary: "bowl under a low sun (Ingersoll): partly in shadow, interreflection the same everywhere, exact",
        build: || {
            spherical_crater::spherical_crater(&spherical_crater::ALBEDO, spherical_crater::N_RINGS)
                .expect("defaults are valid")
        },
        exact: || Some(spherical_crater::spherical_crater_exact(&spherical_crater::ALBEDO, spherical_crater::N_RINGS)),
        patch_size: 0.2,
        closed: false,
    },
];

/// Every scene of the gallery, in reading order.
pub fn list() -> &'static [Entry] {
    &ENTRIES
}

/// The scene of this exact name.
pub fn find(name: &str) -> Option<&'static Entry> {
    ENTRIES.iter().find(|entry| entry.name == name)
}

/// The scene whose name is nearest to this one, if it is within two insertions, deletions, substitutions or swaps
/// of neighbours.
pub fn closest(name: &str) -> Option<&'static Entry> {
    let distance = |entry: &Entry| strsim::osa_distance(entry.name, name);
    ENTRIES.iter().min_by_key(|entry| distance(entry)).filter(|entry| distance(entry) <= FURTHEST_SUGGESTION)
}
