//! Exchange of two polygons with nothing between them, on random pairs of every position: additive, symmetric, and within its own error
//! estimate.
//!
//! Coordinates are multiples of 2⁻²⁰, so that halving edges rounds nothing and parts make up the whole exactly.

use etendue::assembly::{Ladder, Nodes, unoccluded};
use etendue::geometry::{Polygon, Vec3};
use etendue::sampling::Stream;
use std::f64::consts::PI;
use std::sync::LazyLock;

/// Asked of every pair.
const TOLERANCE: f64 = 1e-13;
/// Below this form factor the tolerance is not promised.
const FAINT: f64 = 1e-12;
/// Of a sum of a few numbers, and of the reference itself.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// As fine as it gets: everything goes through contours in double-double.
const FINEST: f64 = 0.0;

static LADDER: LazyLock<Ladder> = LazyLock::new(Ladder::new);

/// A polygon with its nodes.
struct Patch {
    polygon: Polygon,
    nodes: Nodes,
}

impl Patch {
    fn new(vertices: Vec<Vec3>) -> Option<Self> {
        let polygon = Polygon::new(vertices).ok()?;
        let nodes = LADDER.nodes(&polygon);
        Some(Self { polygon, nodes })
    }

    /// Quarters, by halving edges: exact for corners on the grid.
    fn quarters(&self) -> Vec<Patch> {
        let half = |p: Vec3, q: Vec3| 0.5 * p + 0.5 * q;
        let parts = match *self.polygon.vertices() {
            [a, b, c] => {
                let (ab, bc, ca) = (half(a, b), half(b, c), half(c, a));
                vec![vec![a, ab, ca], vec![ab, b, bc], vec![ca, bc, c], vec![ab, bc, ca]]
            }
            [a, b, c, d] => {
                let (ab, bc, cd, da, middle) = (half(a, b), half(b, c), half(c, d), half(d, a), half(a, c));
                vec![vec![a, ab, middle, da], vec![ab, b, bc, middle], vec![middle, bc, c, cd], vec![da, middle, cd, d]]
            }
            _ => unreachable!("pairs are made of triangles and parallelograms"),
        };
        parts.into_iter().map(|part| Patch::new(part).expect("a quarter is a polygon")).collect()
    }
}

fn exchange(a: &Patch, b: &Patch, tolerance: f64) -> Option<(f64, f64)> {
    unoccluded(&LADDER, (&a.polygon, &a.nodes), (&b.polygon, &b.nodes), tolerance)
}

/// Positions of two polygons to each other.
const FAMILIES: [&str; 12] = [
    "apart",
    "sharing a corner",
    "sharing an edge",
    "corner on the inside of an edge",
    "standing on the other",
    "any, mostly cutting each other's plane",
    "almost touching along an edge",
    "facing at a gap of 1/1024",
    "almost coplanar along an edge",
    "sliver along an edge",
    "tiny beside huge",
    "a million away from the origin, sharing an edge or a corner",
];

/// On the grid of 2⁻²⁰.
fn on_grid(v: Vec3) -> Vec3 {
    (v * 1048576.0).round() / 1048576.0
}

fn pair_of(family: usize, stream: &mut Stream) -> Option<[Patch; 2]> {
    let mut point = || on_grid(Vec3::from_array(std::array::from_fn(|_| 2.0 * stream.uniform() - 1.0)));
    let [a, b, c, d, e, f, r] = [(); 7].map(|()| point());
    let shape = |p: Vec3, q: Vec3, s: Vec3, four: bool| if four { vec![p, q, q + (s - p), s] } else { vec![p, q, s] };
    let (first, second) = (shape(a, b, c, r.y > 0.0), |p, q, s| shape(p, q, s, r.z > 0.0));
    let choice = 0.5 * (r.x + 1.0);
    let tiny = f64::powi(2.0, -20);
    let gap = f64::powi(2.0, -1 - (16.0 * choice) as i32);
    let moved = |shape: Vec<Vec3>, by: Vec3| shape.into_iter().map(|v| v + by).collect::<Vec<_>>();
    let (first, second) = match family {
        0 => {
            let by = on_grid(r.normalize_or_zero() * (3.0 + 27.0 * choice));
            (first, moved(second(d, e, f), by))
        }
        1 => (first, second(a, e, f)),
        2 => (first, second(b, a, f)),
        3 => (first, second(0.5 * (a + b), e, f)),
        4 => {
            let from = a + 0.25 * (b - a) + 0.25 * (c - a);
            let to = a + 0.5 * (b - a) + (0.25 + if r.x > 0.0 { 0.125 } else { 0.5 }) * (c - a);
            (first, second(from, to, f))
        }
        5 => (first, second(d, e, f)),
        6 => {
            let by = on_grid(d * gap);
            (first, second(b + by, a + by, f))
        }
        7 => {
            let by = on_grid((b - a).cross(c - a).normalize_or_zero() / 1024.0);
            let across = if r.x > 0.0 { Vec3::ZERO } else { 0.25 * (b - a) };
            let facing = first.iter().rev().map(|v| *v + by + across).collect();
            (first, facing)
        }
        8 => {
            let up = on_grid((b - a).cross(c - a) * gap);
            (first, second(b, a, a + b - c + up))
        }
        9 => {
            let thin = a + tiny * (c - b);
            (shape(a, b, thin, r.y > 0.0), second(b, a, f))
        }
        10 => (shape(a, a + tiny * (b - a), a + tiny * (c - a), r.y > 0.0), second(a, e, f)),
        _ => {
            let by = Vec3::new(1048576.0, -1048576.0, 1048576.0);
            let second = if r.x > 0.0 { second(b, a, f) } else { second(a, e, f) };
            (moved(first, by), moved(second, by))
        }
    };
    Some([Patch::new(first)?, Patch::new(second)?])
}

/// Pairs of a family that see each other, and their form factor is not faint.
fn for_each_pair(n_pairs: usize, seed: u64, mut check: impl FnMut(&str, &[Patch; 2])) {
    for (family, name) in FAMILIES.iter().enumerate() {
        let mut stream = Stream::new(seed, family as u32, 0);
        let (mut n_seen, mut n_tried) = (0, 0);
        while n_seen < n_pairs && n_tried < 100 * n_pairs {
            n_tried += 1;
            let Some(pair) = pair_of(family, &mut stream) else { continue };
            let least = PI * FAINT * pair[0].polygon.area().min(pair[1].polygon.area());
            if exchange(&pair[0], &pair[1], 1e-4).is_some_and(|(value, _)| value > least) {
                n_seen += 1;
                check(name, &pair);
            }
        }
        assert_eq!(n_seen, n_pairs, "{name}");
    }
}

#[test]
fn ten_thousand_pairs_are_within_the_tolerance_and_their_estimate() {
    for_each_pair(900, 0x686f_6e65_7374, |name, [a, b]| {
        let (exact, left) = exchange(a, b, FINEST).unwrap();
        assert!(left <= 0.1 * TOLERANCE * exact, "{name}: {a:?} {b:?}: {:e}", left / exact);
        for tolerance in [TOLERANCE, 1e-10, 1e-7, 1e-4] {
            let (value, estimate) = exchange(a, b, tolerance).unwrap();
            let error = (value - exact).abs();
            assert!(estimate <= tolerance * value, "{name} at {tolerance:e}: {a:?} {b:?}: {:e}", estimate / value);
            assert!(error <= estimate + left, "{name} at {tolerance:e}: {a:?} {b:?}: {error:e} > {estimate:e}");
        }
    });
}

#[test]
fn exchange_is_the_sum_over_parts() {
    for_each_pair(60, 0x0070_6172_7473, |name, [a, b]| {
        let (whole, error) = exchange(a, b, TOLERANCE).unwrap();
        let (of_a, of_b) = (a.quarters(), b.quarters());
        let (mut sum, mut allowed) = (0.0, error + ROUNDING * whole);
        for (p, q) in of_a.iter().flat_map(|p| of_b.iter().map(move |q| (p, q))) {
            let Some((value, error)) = exchange(p, q, TOLERANCE) else { continue };
            sum += value;
            allowed += error;
        }
        assert!((sum - whole).abs() <= allowed, "{name}: {a:?} {b:?}: {sum} for {whole}");
        assert!(allowed <= 3.0 * TOLERANCE * whole, "{name}: {a:?} {b:?}: {:e}", allowed / whole);
    });
}

#[test]
fn swapping_the_two_changes_no_bit() {
    for_each_pair(100, 0x7377_6170, |name, [a, b]| {
        for tolerance in [TOLERANCE, 1e-6] {
            assert_eq!(exchange(a, b, tolerance), exchange(b, a, tolerance), "{name}: {a:?} {b:?}");
        }
    });
}

#[test]
fn scaling_by_powers_of_two_rounds_nothing() {
    for_each_pair(20, 0x0073_6361_6c65, |name, pair| {
        let (value, error) = exchange(&pair[0], &pair[1], TOLERANCE).unwrap();
        for exponent in [-40, -1, 40] {
            let scale = f64::powi(2.0, exponent);
            let scaled = |p: &Patch| Patch::new(p.polygon.vertices().iter().map(|v| *v * scale).collect()).unwrap();
            let [a, b] = pair.each_ref().map(scaled);
            let found = exchange(&a, &b, TOLERANCE).unwrap();
            assert_eq!(found, (value * scale * scale, error * scale * scale), "{name}: {a:?} {b:?}");
        }
    });
}

#[test]
fn what_does_not_face_exchanges_nothing() {
    let patch = |v: &[[f64; 3]]| Patch::new(v.iter().map(|v| Vec3::from_array(*v)).collect()).unwrap();
    let floor = patch(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
    let beside = patch(&[[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0]]);
    let above = patch(&[[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0]]);
    let below = patch(&[[0.0, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 1.0, -1.0]]);
    for other in [&floor, &beside, &above, &below] {
        assert_eq!(exchange(&floor, other, TOLERANCE), None);
    }
}

impl std::fmt::Debug for Patch {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "{:?}", self.polygon.vertices())
    }
}
