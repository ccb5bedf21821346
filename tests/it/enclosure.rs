//! Proven bounds of the exchange of two polygons: they hold what is known, agree with each other, are narrow, and the fast path lies
//! between them.
//!
//! The last is tried on four thousand random pairs, and on a hundred thousand (25 s of processor time) if the environment variable
//! `ETENDUE_LARGE` is 1.

use super::form_factors::CLEAR;
use super::scenes::polygon;
use etendue::assembly::{Enclosure, enclose, exchange_of_pair};
use etendue::geometry::{Mat3, Polygon, Vec3};
use etendue::sampling::Stream;
use rayon::prelude::*;
use std::f64::consts::PI;

/// On μ = π A computed in f64, and on a reference rounded to f64: eight ulp.
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// By how much the fast path may leave the bounds, relative. It takes polygons of four turned corners for planar, which they are to an
/// ulp of their size; the bounds take their corners as they are: some 1e-16.
const AGREEMENT: f64 = 1e-13;
/// The same where one of the two is a sliver: its plane is only as good as its width.
const AGREEMENT_OF_SLIVERS: f64 = 1e-12;
/// Digits of a ball, in units of the pair's extent squared: what tiny exchanges of large polygons are lost in.
const DIGITS: f64 = 1e-28;
/// Longest edge over height from which on a triangle is a sliver.
const SLIVER: f64 = 100.0;
/// Pairs both of whose form factors are below this are not held to anything.
const SMALLEST: f64 = 1e-12;

#[test]
fn reference_form_factors_lie_between_the_bounds() {
    for pair in CLEAR {
        let [a, b] = [polygon(pair.first), polygon(pair.second)];
        let bounds = enclose(&a, &b);
        // The last digit that is certain, where those are few.
        let certain = ROUNDING.max(0.5 * 0.1f64.powi(pair.digits - 1));
        assert!(bounds.holds(pair.form_factor * PI * a.area(), certain), "{}: {bounds:?}", pair.id);
        assert!(bounds.relative_width() < 1e-15, "{}: {:e}", pair.id, bounds.relative_width());
    }
}

/// From inside a tetrahedron, every face exchanges π A with the other three. Integer corners: areas are exact to an ulp.
#[test]
fn what_the_faces_of_tetrahedra_exchange_is_their_etendue() {
    let mut stream = Stream::new(0x7465_7472, 0, 0);
    // Flat ones too: heights from a millionth of the size on.
    for trial in 0..200 {
        let flatness = 1i64 << (20 - trial % 20);
        let mut corner = |extent: i64| (stream.uniform() * extent as f64).floor() as i64;
        let corners: [[i64; 3]; 4] = std::array::from_fn(|_| [corner(1 << 20), corner(1 << 20), corner(flatness) + 1]);
        let faces = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
        let minus = |p: [i64; 3], q: [i64; 3]| [0, 1, 2].map(|k| i128::from(p[k] - q[k]));
        let cross = |p: [i128; 3], q: [i128; 3]| [1, 2, 0].map(|k| p[k] * q[(k + 1) % 3] - p[(k + 1) % 3] * q[k]);
        let area_vector = |f: [usize; 3]| {
            let [a, b, c] = f.map(|k| corners[k]);
            cross(minus(b, a), minus(c, a))
        };
        let volume: i128 = {
            let (n, d) = (area_vector(faces[0]), minus(corners[3], corners[0]));
            (0..3).map(|k| n[k] * d[k]).sum()
        };
        // Turn all faces inwards.
        let inward = faces.map(|[a, b, c]| if volume > 0 { [a, b, c] } else { [a, c, b] });
        let made = inward.map(|f| Polygon::new(f.map(|k| Vec3::from_array(corners[k].map(|x| x as f64))).to_vec()));
        let Ok(polygons): Result<Vec<Polygon>, _> = made.into_iter().collect() else { continue };
        for i in 0..4 {
            let square: i128 = area_vector(inward[i]).iter().map(|x| x * x).sum();
            let etendue = PI * 0.5 * (square as f64).sqrt();
            let others = (0..4).filter(|j| *j != i).map(|j| enclose(&polygons[i], &polygons[j]));
            let sum = others.fold(Enclosure { low: 0.0, high: 0.0 }, |sum, t| Enclosure {
                low: sum.low + t.low,
                high: sum.high + t.high,
            });
            assert!(sum.holds(etendue, ROUNDING), "trial {trial}, face {i}: {sum:?} for {etendue}");
            assert!(sum.relative_width() < 1e-13, "trial {trial}, face {i}: {:e}", sum.relative_width());
        }
    }
}

/// A cut adds nothing: bounds of the parts, added up, meet those of the whole. Corners on a grid, so that middles are exact.
#[test]
fn parts_exchange_what_the_whole_does() {
    let mut n_facing = 0;
    for class in CLASSES {
        for (k, [a, b]) in pairs(*class, 40, 1).iter().enumerate() {
            let snapped = [a, b].map(|p| Polygon::new(p.vertices().iter().map(|v| snap(*v)).collect()));
            let [Ok(a), Ok(b)] = snapped else { continue };
            // From the middle of the first edge to the last corner.
            let v = a.vertices();
            let (middle, last) = (0.5 * (v[0] + v[1]), v[v.len() - 1]);
            let first: Vec<Vec3> = std::iter::once(middle).chain(v[1..].iter().copied()).collect();
            let parts = [first, vec![v[0], middle, last]].map(Polygon::new);
            let [Ok(first), Ok(second)] = parts else { continue };
            let (whole, one, two) = (enclose(&a, &b), enclose(&first, &b), enclose(&second, &b));
            let (low, high) = (one.low + two.low, one.high + two.high);
            // Adding the bounds rounds them.
            let meet = low * (1.0 - ROUNDING) <= whole.high && whole.low <= high * (1.0 + ROUNDING);
            assert!(meet, "{class:?} {k}: {whole:?}, parts {one:?} and {two:?}");
            n_facing += usize::from(whole.low > 0.0);
        }
    }
    assert!(n_facing > 300, "{n_facing}");
}

fn snap(v: Vec3) -> Vec3 {
    let grid = f64::powi(2.0, 30);
    (v * grid).round() / grid
}

#[test]
fn polygons_in_one_plane_or_behind_each_other_exchange_exactly_nothing() {
    let nothing = Enclosure { low: 0.0, high: 0.0 };
    let square = |x: f64, z: f64| {
        let corner = |u, v| Vec3::new(x + u, v, z);
        Polygon::new(vec![corner(0.0, 0.0), corner(0.7, 0.0), corner(0.7, 0.7), corner(0.0, 0.7)]).unwrap()
    };
    assert_eq!(enclose(&square(0.0, 0.3), &square(0.7, 0.3)), nothing);
    assert_eq!(enclose(&square(0.0, 0.3), &square(0.2, 0.3).flipped()), nothing);
    assert_eq!(enclose(&square(0.0, 0.3), &square(0.0, -0.1)), nothing);
    assert_eq!(enclose(&square(0.0, 0.3), &square(0.0, 1.1)), nothing);
    assert!(enclose(&square(0.0, 0.3), &square(0.0, 1.1).flipped()).low > 0.0);
}

/// Any power of two scales coordinates exactly, and the bounds with them.
#[test]
fn scaling_by_powers_of_two_scales_the_bounds_to_the_bit() {
    for class in CLASSES {
        for [a, b] in &pairs(*class, 4, 2) {
            let bounds = enclose(a, b);
            for exponent in [-100, -3, 1, 100] {
                let scale = f64::powi(2.0, exponent);
                let scaled = [a, b].map(|p| Polygon::new(p.vertices().iter().map(|v| *v * scale).collect()).unwrap());
                let found = enclose(&scaled[0], &scaled[1]);
                let square = scale * scale;
                assert_eq!((found.low, found.high), (bounds.low * square, bounds.high * square), "{class:?}");
            }
        }
    }
}

#[test]
fn bounds_of_turned_order_meet() {
    for class in CLASSES {
        for [a, b] in &pairs(*class, 20, 3) {
            let (one, other) = (enclose(a, b), enclose(b, a));
            assert!(one.low <= other.high && other.low <= one.high, "{class:?}: {one:?} {other:?}");
        }
    }
}

/// How two polygons lie to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Class {
    Apart,
    Near,
    Crossing,
    SharedEdge,
    SharedCorner,
    TJunction,
    CornerOnEdge,
    SliverApart,
    SliverTouching,
    Rectangles,
    Sizes,
    FarFromOrigin,
}

const CLASSES: &[Class] = &[
    Class::Apart,
    Class::Near,
    Class::Crossing,
    Class::SharedEdge,
    Class::SharedCorner,
    Class::TJunction,
    Class::CornerOnEdge,
    Class::SliverApart,
    Class::SliverTouching,
    Class::Rectangles,
    Class::Sizes,
    Class::FarFromOrigin,
];

/// Twenty draws: a tenth touch, a tenth are slivers.
const MIX: [Class; 20] = {
    use Class::*;
    [
        Apart,
        Near,
        Crossing,
        SharedEdge,
        SliverApart,
        Rectangles,
        Sizes,
        FarFromOrigin,
        Apart,
        Near,
        Crossing,
        SharedCorner,
        SliverTouching,
        Rectangles,
        Sizes,
        FarFromOrigin,
        Apart,
        Near,
        Rectangles,
        Apart,
    ]
};

struct Draw(Stream);

impl Draw {
    fn point(&mut self, half: f64) -> Vec3 {
        Vec3::from_array(std::array::from_fn(|_| half * (2.0 * self.0.uniform() - 1.0)))
    }

    fn triangle(&mut self, centre: Vec3, half: f64) -> Vec<Vec3> {
        (0..3).map(|_| centre + self.point(half)).collect()
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.uniform()
    }

    /// On a grid of 1/256.
    fn coarse(&mut self, low: f64, high: f64) -> f64 {
        (self.between(low, high) * 256.0).round() / 256.0
    }

    fn turn(&mut self) -> Mat3 {
        let axis = self.point(1.0).normalize();
        if self.0.uniform() < 0.5 { Mat3::from_axis_angle(axis, self.between(0.0, PI)) } else { Mat3::IDENTITY }
    }

    /// From 1 down to a millionth.
    fn fraction(&mut self) -> f64 {
        10f64.powf(-6.0 * self.0.uniform())
    }

    /// [x₀, x₁] × [y₀, y₁] with corners on the grid.
    fn rectangle(&mut self, at: impl Fn(f64, f64) -> Vec3) -> Vec<Vec3> {
        let [x0, y0] = [(); 2].map(|()| self.coarse(0.0, 0.4));
        let [x1, y1] = [(); 2].map(|()| self.coarse(0.6, 1.0));
        [(x0, y0), (x1, y0), (x1, y1), (x0, y1)].map(|(x, y)| at(x, y)).to_vec()
    }

    fn corners(&mut self, class: Class) -> [Vec<Vec3>; 2] {
        let (p, q) = (self.point(1.0), self.point(1.0));
        match class {
            Class::Apart => {
                let distance = self.between(3.0, 10.0);
                [self.triangle(Vec3::ZERO, 1.0), self.triangle(distance * p.normalize(), 1.0)]
            }
            Class::Near => [self.triangle(Vec3::ZERO, 1.0), self.triangle(1.2 * p.normalize(), 1.0)],
            Class::Crossing => [self.triangle(Vec3::ZERO, 1.0), self.triangle(Vec3::ZERO, 1.0)],
            Class::SharedEdge => [vec![p, q, self.point(1.0)], vec![q, p, self.point(1.0)]],
            Class::SharedCorner => {
                let mut other = self.triangle(Vec3::ZERO, 1.0);
                other[0] = p;
                [vec![p, q, self.point(1.0)], other]
            }
            Class::TJunction => {
                let (from, to) = (self.coarse(0.0, 0.4), self.coarse(0.5, 1.5));
                let third = Vec3::new(self.coarse(-0.5, 1.5), self.coarse(0.3, 1.0), 0.0);
                let risen = Vec3::new(self.coarse(0.0, 1.0), self.coarse(-1.0, 1.0), self.coarse(0.2, 1.0));
                let turn = self.turn();
                [vec![Vec3::ZERO, Vec3::X, third], vec![to * Vec3::X, from * Vec3::X, risen]]
                    .map(|v| v.into_iter().map(|p| turn * p).collect())
            }
            Class::CornerOnEdge => {
                let on_edge = p + self.between(0.1, 0.9) * (q - p);
                [vec![p, q, self.point(1.0)], vec![on_edge, self.point(1.0), self.point(1.0)]]
            }
            Class::SliverApart | Class::SliverTouching => {
                let width = self.fraction();
                let third = p + self.between(0.1, 0.9) * (q - p) + width * self.point(1.0);
                let other = match class {
                    Class::SliverApart => {
                        let away = 2.5 * self.point(1.0).normalize();
                        self.triangle(p + away, 1.0)
                    }
                    _ if self.0.uniform() < 0.5 => vec![q, p, self.point(1.0)],
                    _ => vec![p, self.point(1.0), self.point(1.0)],
                };
                [vec![p, q, third], other]
            }
            Class::Rectangles => {
                let floor = self.rectangle(|x, y| Vec3::new(x, y, 0.0));
                let height = self.coarse(0.1, 1.0);
                let other = if self.0.uniform() < 0.5 {
                    self.rectangle(|y, z| Vec3::new(0.0, y, z))
                } else {
                    self.rectangle(|x, y| Vec3::new(y, x, height))
                };
                let turn = self.turn();
                [floor, other].map(|v| v.into_iter().map(|p| turn * p).collect())
            }
            Class::Sizes => {
                let size = self.fraction();
                [self.triangle(Vec3::ZERO, 1.0), self.triangle(1.5 * p, size)]
            }
            Class::FarFromOrigin => {
                let centre = 1e6 * q;
                [self.triangle(centre, 1.0), self.triangle(centre + 1.5 * p.normalize(), 1.0)]
            }
        }
    }
}

/// Random pairs that see something of each other.
fn pairs(class: Class, n: usize, key: u64) -> Vec<[Polygon; 2]> {
    let mut draw = Draw(Stream::new(0x656e_636c, class as u32, key << 32));
    let mut found = Vec::with_capacity(n);
    while found.len() < n {
        let [Ok(a), Ok(b)] = draw.corners(class).map(Polygon::new) else { continue };
        if let Some((exchange, _)) = exchange_of_pair(&a, &b, 1e-6)
            && exchange > SMALLEST * PI * a.area().min(b.area())
        {
            found.push([a, b]);
        }
    }
    found
}

fn is_sliver(polygon: &Polygon) -> bool {
    let v = polygon.vertices();
    let longest = (0..v.len()).map(|k| v[k].distance(v[(k + 1) % v.len()])).fold(0.0, f64::max);
    longest * longest > SLIVER * 2.0 * polygon.area()
}

#[test]
fn the_fast_path_lies_between_the_bounds() {
    let n = if std::env::var("ETENDUE_LARGE").is_ok_and(|v| v == "1") { 100_000 } else { 4_000 };
    let each: Vec<(Class, usize)> =
        CLASSES.iter().map(|class| (*class, n * MIX.iter().filter(|c| *c == class).count() / MIX.len())).collect();
    // Touching pairs of the kinds that are not in the mix take a few more.
    let each = each.into_iter().map(|(class, k)| (class, if k == 0 { n / 100 } else { k }));
    let drawn: Vec<(Class, [Polygon; 2])> =
        each.flat_map(|(class, k)| pairs(class, k, 0).into_iter().map(move |pair| (class, pair))).collect();
    let mut judged: Vec<(Class, f64, Option<String>)> = drawn
        .par_iter()
        .map(|(class, [a, b])| {
            let bounds = enclose(a, b);
            let value = exchange_of_pair(a, b, 1e-13).map_or(0.0, |(value, _)| value);
            let tolerance = if is_sliver(a) || is_sliver(b) { AGREEMENT_OF_SLIVERS } else { AGREEMENT };
            let off = (value / bounds.high - 1.0).max(1.0 - value / bounds.low);
            let fault = (!bounds.holds(value, tolerance)).then(|| {
                let corners = [a, b].map(|p| p.vertices().iter().map(|v| v.to_array()).collect::<Vec<_>>());
                format!("{class:?}: {value:e} for {bounds:?}, off by {off:e}: {corners:?}")
            });
            let corners = || a.vertices().iter().chain(b.vertices());
            let extent = corners().map(|v| v.distance(a.centroid())).fold(0.0, f64::max);
            let width = (bounds.high - bounds.low - DIGITS * extent * extent).max(0.0) / bounds.high;
            (*class, width, fault)
        })
        .collect();

    // The bounds are worth having: but for the digits of a ball, all are within 1e-12, and all but one in a hundred within 1e-15.
    judged.sort_by(|a, b| a.1.total_cmp(&b.1));
    let at = |share: f64| &judged[((judged.len() - 1) as f64 * share) as usize];
    assert!(at(0.99).1 < 1e-15, "{:e} ({:?})", at(0.99).1, at(0.99).0);
    assert!(at(1.0).1 < 1e-12, "{:e} ({:?})", at(1.0).1, at(1.0).0);

    let faults: Vec<&String> = judged.iter().filter_map(|(_, _, fault)| fault.as_ref()).collect();
    assert!(
        faults.is_empty(),
        "{} of {} pairs, such as {:#?}",
        faults.len(),
        judged.len(),
        &faults[..faults.len().min(20)]
    );
}
