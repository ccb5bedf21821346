//! Rooms with boxes in them at random: what is found of every pair of patches is as far from the truth as its estimate says, and no étendue is
//! lost.

use super::scenes::scene_of;
use super::shadows::n_trials;
use etendue::assembly::{Exchange, Occlusion, System, assemble};
use etendue::basis::{Bundles, Resolution};
use etendue::geometry::{Mat3, Polygon, Vec3};
use etendue::linalg::LinearOperator;
use etendue::sampling::Stream;

/// Asked of Tᵢⱼ / min(μᵢ, μⱼ), one after another.
const TOLERANCES: [f64; 3] = [1e-6, 1e-8, 1e-11];

/// Of a sum of some thousand terms, relative to the étendue of either end.
const ROUNDING: f64 = 1e-14;

/// What the last tolerance makes of a row of a hundred pairs, and the relative 1e-10 of unoccluded ones.
const CLOSED: f64 = 1e-9;

/// How the boxes of a room lie.
#[derive(Clone, Copy, Debug)]
enum Lie {
    /// On the floor, turned about the vertical.
    Standing,
    /// On the floor along the walls, corners on a grid: many edges in one plane.
    Aligned,
    /// Anywhere, turned about any axis.
    Floating,
}

/// The inside of a cube of 2, and the outside of two boxes in it, without what would lie on the floor.
fn room(lie: Lie, stream: &mut Stream) -> Vec<Polygon> {
    let corner = |k: usize, half: Vec3| {
        let sign = |bit: usize| if k >> bit & 1 == 0 { -1.0 } else { 1.0 };
        half * Vec3::new(sign(0), sign(1), sign(2))
    };
    let faces: [[usize; 4]; 6] = [[0, 1, 5, 4], [0, 2, 3, 1], [4, 5, 7, 6], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let polygon = |corners: Vec<Vec3>| Polygon::new(corners).unwrap();
    let mut all: Vec<Polygon> =
        faces.iter().map(|face| polygon(face.iter().rev().map(|k| corner(*k, Vec3::ONE)).collect())).collect();
    for _ in 0..2 {
        let mut uniform = || match lie {
            Lie::Aligned => (8.0 * stream.uniform()).floor() / 8.0,
            Lie::Standing | Lie::Floating => stream.uniform(),
        };
        let half = Vec3::new(0.1 + 0.3 * uniform(), 0.1 + 0.4 * uniform(), 0.1 + 0.3 * uniform());
        let at = Vec3::new(uniform() - 0.5, 0.6 * uniform() - 0.3, uniform() - 0.5);
        let stands = !matches!(lie, Lie::Floating);
        let centre = if stands { Vec3::new(at.x, half.y - 1.0, at.z) } else { at };
        let turn = match lie {
            Lie::Standing => Mat3::from_rotation_y(6.0 * uniform()),
            Lie::Aligned => Mat3::IDENTITY,
            Lie::Floating => {
                let axis = Vec3::new(uniform() - 0.5, uniform() - 0.5, uniform() - 0.5);
                Mat3::from_axis_angle(axis.normalize(), 6.0 * uniform())
            }
        };
        // What stands on the floor does so to the last bit.
        let place = |k: usize| {
            let point = centre + turn * corner(k, half);
            if stands && k >> 1 & 1 == 0 { Vec3::new(point.x, -1.0, point.z) } else { point }
        };
        let n_hidden = usize::from(stands);
        all.extend(faces[n_hidden..].iter().map(|face| polygon(face.iter().map(|k| place(*k)).collect())));
    }
    all
}

fn exchange(all: &[Polygon], tolerance: f64) -> System {
    let scene = scene_of(all, false);
    let bundles = Bundles::new(&scene, Resolution { patch_size: 0.7, n_directions: 1 }).unwrap();
    let occlusion = Occlusion::Exact { tolerance };
    assemble(&scene, &bundles, Exchange { occlusion, repair: false, ..Exchange::default() }).unwrap()
}

#[test]
fn estimates_contain_what_smaller_tolerances_find_and_rooms_close() {
    let mut n_partial = 0;
    for lie in [Lie::Standing, Lie::Aligned, Lie::Floating] {
        for trial in 0..n_trials(2, 20) {
            let all = room(lie, &mut Stream::new(0x726f_6f6d, lie as u32, trial as u64));
            let systems = TOLERANCES.map(|tolerance| exchange(&all, tolerance));
            for (pair, tolerance) in systems.windows(2).zip(TOLERANCES) {
                let [rough, fine] = [&pair[0], &pair[1]];
                let mu = rough.etendue();
                let n = mu.len();
                let row = |of: &dyn Fn(&System, usize, &mut [f64]), system: &System, i: usize| {
                    let mut row = vec![0.0; n];
                    of(system, i, &mut row);
                    row
                };
                let entries = |s: &System, i: usize, row: &mut [f64]| s.exchange().row(0, i, row);
                let errors = |s: &System, i: usize, row: &mut [f64]| s.exchange_error().row(0, i, row);
                for i in 0..n {
                    let [t, t_fine] = [rough, fine].map(|system| row(&entries, system, i));
                    let [e, e_fine] = [rough, fine].map(|system| row(&errors, system, i));
                    for j in 0..n {
                        let allowed = e[j] + e_fine[j] + ROUNDING * mu[i].min(mu[j]);
                        let change = (t[j] - t_fine[j]).abs();
                        assert!(
                            change <= allowed,
                            "{lie:?} {trial}, {i} to {j} at {tolerance:e}: off by {change:e}, estimated {allowed:e}"
                        );
                    }
                }
                n_partial += rough.report().n_integrated;
            }
            let found = systems[TOLERANCES.len() - 1].report().closure_before_repair;
            assert!(found < CLOSED, "{lie:?} {trial}: {found:e}");
        }
    }
    assert!(n_partial > 1000, "{n_partial}");
}
