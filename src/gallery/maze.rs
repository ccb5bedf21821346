//! `maze`: six closed rooms in two rows, joined by small doors into one winding way, a lamp in the first of them. Light takes many
//! bounces to the last room, and so do solvers.
//!
//! # Geometry
//! Rooms of 2 × 2 × 2 stand at 0 ≤ x ≤ 6 in two rows, 0 ≤ z ≤ 2 and 2 ≤ z ≤ 4:
//!
//! ```text
//!   z  4 ┌───────┬───────┬───────┐
//!        │ sixth . fifth . fourth│      . a door
//!      2 ├───────┼───────┼───.───┤
//!        │ first . second. third │
//!      0 └───────┴───────┴───────┘
//!        0       2       4       6  x
//! ```
//!
//! Partitions without thickness that reflect on both sides part them; every way from a room to the next is a door of 0.5 × 1 that
//! touches the floor, and no two doors face each other. The lamp is the square 0.75 ≤ x, z ≤ 1.25 cut out of the first room's
//! ceiling; the last room shares a wall with it. All coordinates are dyadic and all polygons rectangles, floors and ceilings one a
//! room, so that abutting edges lie on each other.
//!
//! # Exact answer
//! The energy balance of every closed scene, Σ (1 − a) H A = Σ π e A = Φ; see [the corner box](mod@super::corner_box).
//!
//! # Why it is hard
//! Were each room well mixed, a fraction p = ½/24 of its light would leave it through each door at every bounce, and K would act on
//! the six rooms as a (1 − p) on the diagonal and a p beside it: a chain whose eigenvalues are a (1 − 2 p (1 − cos kπ/6)), k = 0 … 5,
//! the two largest within 0.6 % of each other and all six within 8 %.

use super::matte::{film, matte, scene};
use super::shape::{Outline, reversed};
use super::{Exact, emitted_power};
use crate::geometry::Vec3;
use crate::scattering::Lambert;
use crate::scene::{Camera, Scene, SceneError, Surface};
use std::sync::Arc;

/// Edge of a room.
const SIZE: f64 = 2.0;
/// Rooms along x, and rows of them along z.
const N_ROOMS: [usize; 2] = [3, 2];
const DOOR_HEIGHT: f64 = 1.0;
/// The lamp spans this range of x and z.
const LAMP: [f64; 2] = [0.75, 1.25];

const WALL: [f64; 3] = [0.875, 0.85, 0.8];
const FLOOR: [f64; 3] = [0.85, 0.825, 0.8];
const CEILING: [f64; 3] = [0.9, 0.9, 0.9];
const DARK: [f64; 3] = [0.0; 3];

/// What a wall runs along.
#[derive(Clone, Copy)]
enum Along {
    X,
    Z,
}

/// Six rooms and five doors. Surfaces `lamp`, `partitions` (reflecting on both sides), and `floor-k`, `ceiling-k`, `walls-k` of the
/// rooms k = 1 … 6 in the order of the way.
pub fn maze() -> Scene {
    build().expect("the maze's own numbers are valid")
}

fn build() -> Result<Scene, SceneError> {
    let [n_x, n_z] = N_ROOMS;
    let (x_end, z_end) = (n_x as f64 * SIZE, n_z as f64 * SIZE);

    // Stand the partitions: four between the rooms of a row, and three between the rows, of which the last has the door.
    let rows = [[0.0, SIZE], [SIZE, z_end]];
    let doors_of_rows = [[[0.25, 0.75], [1.25, 1.75]], [[2.25, 2.75], [3.25, 3.75]]];
    let across = rows.iter().zip(doors_of_rows).flat_map(|(row, doors)| {
        let at = |k: usize| (k + 1) as f64 * SIZE;
        doors.into_iter().enumerate().flat_map(move |(k, door)| with_door(Along::Z, at(k), *row, door))
    });
    let between = (0..n_x - 1).map(|k| wall(Along::X, SIZE, [0.0, SIZE], [k as f64 * SIZE, (k + 1) as f64 * SIZE]));
    let last = with_door(Along::X, SIZE, [x_end - SIZE, x_end], [4.75, 5.25]);
    let partitions: Vec<Outline> = across.chain(between).chain(last).collect();
    let back: Arc<Lambert> = Arc::new(Lambert::new(WALL.to_vec()));
    let partitions = Surface { back: Some(back), ..matte("partitions", partitions, &WALL, &DARK)? };
    let lamp = matte("lamp", [level(SIZE, LAMP, LAMP)], &CEILING, &[50.0, 45.0, 40.0])?;
    let mut surfaces = vec![lamp, partitions];

    // Give every room of the way its floor, its ceiling and the walls that the partitions leave.
    let way = (0..n_x).map(|k| (k, 0)).chain((0..n_x).rev().map(|k| (k, 1)));
    for (number, (column, row)) in way.enumerate() {
        let (x, z) = (span(column), span(row));
        let ceiling = if number == 0 { around(LAMP, x, z) } else { vec![level(SIZE, x, z)] };
        let mut walls = vec![if row == 0 {
            reversed(wall(Along::X, 0.0, [0.0, SIZE], x))
        } else {
            wall(Along::X, z_end, [0.0, SIZE], x)
        }];
        if column == 0 {
            walls.push(reversed(wall(Along::Z, 0.0, [0.0, SIZE], z)));
        }
        if column + 1 == n_x {
            walls.push(wall(Along::Z, x_end, [0.0, SIZE], z));
        }
        let name = |part: &str| format!("{part}-{}", number + 1);
        surfaces.push(matte(&name("floor"), [reversed(level(0.0, x, z))], &FLOOR, &DARK)?);
        surfaces.push(matte(&name("ceiling"), ceiling, &CEILING, &DARK)?);
        surfaces.push(matte(&name("walls"), walls, &WALL, &DARK)?);
    }

    let camera =
        Camera::look_at(Vec3::new(0.25, 1.5, 3.75), Vec3::new(2.0, 0.75, 2.5), Vec3::Y, 75_f64.to_radians(), film());
    scene("maze", 3, surfaces, camera)
}

/// Where the room of this column or row begins and ends.
fn span(k: usize) -> [f64; 2] {
    [k as f64 * SIZE, (k + 1) as f64 * SIZE]
}

/// A rectangle of constant height, facing down.
fn level(y: f64, [x0, x1]: [f64; 2], [z0, z1]: [f64; 2]) -> Outline {
    [(x0, z0), (x1, z0), (x1, z1), (x0, z1)].map(|(x, z)| Vec3::new(x, y, z)).to_vec()
}

/// What a square hole over this range of x and z leaves of a ceiling: four strips.
fn around(hole: [f64; 2], x: [f64; 2], z: [f64; 2]) -> Vec<Outline> {
    let [near, far] = hole;
    vec![
        level(SIZE, [x[0], near], z),
        level(SIZE, [far, x[1]], z),
        level(SIZE, hole, [z[0], near]),
        level(SIZE, hole, [far, z[1]]),
    ]
}

/// An upright rectangle at `at`, facing the low end of the other axis.
fn wall(along: Along, at: f64, [y0, y1]: [f64; 2], [a, b]: [f64; 2]) -> Outline {
    match along {
        Along::Z => [(y0, a), (y0, b), (y1, b), (y1, a)].map(|(y, z)| Vec3::new(at, y, z)).to_vec(),
        Along::X => [(y0, a), (y1, a), (y1, b), (y0, b)].map(|(y, x)| Vec3::new(x, y, at)).to_vec(),
    }
}

/// A partition with a door in it: a jamb on either side, and the wall above.
fn with_door(along: Along, at: f64, [a, b]: [f64; 2], door: [f64; 2]) -> [Outline; 3] {
    [
        wall(along, at, [0.0, SIZE], [a, door[0]]),
        wall(along, at, [0.0, SIZE], [door[1], b]),
        wall(along, at, [DOOR_HEIGHT, SIZE], door),
    ]
}

/// The energy balance: what the rooms absorb is what the lamp emits.
pub(super) fn maze_exact() -> Exact {
    Exact::AbsorbedPower { power: emitted_power(&maze()) }
}
