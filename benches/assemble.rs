//! Assembly of T: what one pair costs by its position and its tolerance, and what all pairs of the Cornell box do.
//!
//! A printed table; of every number the best of some turns, on one thread for pairs and on all for scenes.

use etendue::assembly::{Exchange, Ladder, Nodes, Occlusion, assemble, unoccluded};
use etendue::basis::{Bundles, Resolution};
use etendue::gallery;
use etendue::geometry::{Polygon, Vec3};
use etendue::sampling::Stream;
use std::hint::black_box;
use std::time::Instant;

const N_TURNS: usize = 15;
const TOLERANCES: [f64; 3] = [1e-13, 1e-10, 1e-7];

fn main() {
    // Cargo's test runner compiles benches and calls them with --test: nothing to do then.
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    single_pairs();
    scenes();
}

/// Seconds of the shortest of some turns: what interrupts one only makes it longer.
fn shortest(n_turns: usize, mut turn: impl FnMut()) -> f64 {
    let seconds = (0..n_turns).map(|_| {
        let start = Instant::now();
        turn();
        start.elapsed().as_secs_f64()
    });
    seconds.fold(f64::INFINITY, f64::min)
}

fn scenes() {
    let scene = gallery::cornell_box();
    let rays = Exchange { occlusion: Occlusion::by_rays(64), ..Exchange::default() };
    println!("\n{:>24} {:>9} {:>9} {:>11}", "cornell-box, patches", "seconds", "facing", "ns a pair");
    for patch_size in [0.5, 0.25, 0.125] {
        let bundles = Bundles::new(&scene, Resolution { patch_size, n_directions: 1 }).expect("a resolution");
        let mut n_pairs = 0;
        let seconds = shortest(3, || {
            let system = assemble(&scene, &bundles, rays).expect("a diffuse scene");
            n_pairs = system.report().n_pairs;
        });
        println!("{:>24} {seconds:>9.3} {n_pairs:>9} {:>11.0}", bundles.n_bundles(), 1e9 * seconds / n_pairs as f64);
    }
}

/// A rectangle with a corner, an edge, and the side on which the rest is.
fn rectangle(corner: Vec3, next: Vec3, side: Vec3) -> Vec<Vec3> {
    let along = next - corner;
    let across = (side - corner) - along * (along.dot(side - corner) / along.length_squared());
    vec![corner, next, next + across, corner + across]
}

/// Random pairs of rectangles no thinner than one to ten that face each other, and their nodes.
fn pairs(ladder: &Ladder, place: impl Fn([Vec3; 6], f64) -> [Vec<Vec3>; 2]) -> Vec<[(Polygon, Nodes); 2]> {
    let mut stream = Stream::new(0x7061_6972_7370, 0, 0);
    let mut found = Vec::new();
    while found.len() < 1000 {
        let points = [(); 6].map(|()| Vec3::from_array(std::array::from_fn(|_| 2.0 * stream.uniform() - 1.0)));
        let [Ok(a), Ok(b)] = place(points, stream.uniform()).map(Polygon::new) else { continue };
        let is_thin = |p: &Polygon| p.area() < 0.1 * p.vertices()[0].distance_squared(p.vertices()[2]);
        if is_thin(&a) || is_thin(&b) {
            continue;
        }
        let pair = [a, b].map(|p| {
            let nodes = ladder.nodes(&p);
            (p, nodes)
        });
        if unoccluded(ladder, (&pair[0].0, &pair[0].1), (&pair[1].0, &pair[1].1), 1e-3).is_some() {
            found.push(pair);
        }
    }
    found
}

fn single_pairs() {
    let ladder = Ladder::new();
    let apart = |least: f64, most: f64| {
        move |[a, b, c, d, e, f]: [Vec3; 6], u: f64| {
            let (first, second) = (rectangle(a, b, c), rectangle(d, e, f));
            let diameter = first[0].distance(first[2]).max(second[0].distance(second[2]));
            let by = 0.5 * (first[0] + first[2]) - 0.5 * (second[0] + second[2]);
            let by = by + (a - f).normalize_or_zero() * diameter * (least + (most - least) * u);
            let second = second.into_iter().map(|v| v + by).collect();
            [first, second]
        }
    };
    // Distances of centres in diameters: at two, a diameter is between the circumscribed circles.
    let families = [
        ("2 to 11 diameters", pairs(&ladder, apart(2.0, 11.0))),
        ("1 to 10 diameters", pairs(&ladder, apart(1.0, 10.0))),
        ("1 to 2 diameters", pairs(&ladder, apart(1.0, 2.0))),
        ("sharing an edge", pairs(&ladder, |[a, b, c, _, _, f], _| [rectangle(a, b, c), rectangle(b, a, f)])),
        ("sharing a corner", pairs(&ladder, |[a, b, c, _, e, f], _| [rectangle(a, b, c), rectangle(a, e, f)])),
    ];
    print!("{:24}", "rectangles, ns a pair");
    TOLERANCES.iter().for_each(|tolerance| print!(" {:>20}", format!("to {tolerance:e}")));
    println!();
    for (name, pairs) in &families {
        print!("{name:24}");
        for tolerance in TOLERANCES {
            let seconds = shortest(N_TURNS, || {
                for [(a, of_a), (b, of_b)] in pairs {
                    black_box(unoccluded(&ladder, (a, of_a), (b, of_b), tolerance));
                }
            });
            let each = seconds / pairs.len() as f64;
            print!(" {:>8.0} {:>9.1e}/s", 1e9 * each, 1.0 / each);
        }
        println!();
    }
}
