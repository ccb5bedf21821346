//! Assembly of T: the cost of one pair, and of all of them against the number of bundles on the Cornell box.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use etendue::assembly::{Exchange, Ladder, Nodes, assemble, unoccluded};
use etendue::basis::{Bundles, Resolution};
use etendue::gallery;
use etendue::geometry::{Polygon, Vec3};
use etendue::sampling::Stream;
use std::hint::black_box;

fn scenes(criterion: &mut Criterion) {
    let scene = gallery::cornell_box();
    let mut group = criterion.benchmark_group("assemble");
    group.sample_size(10);
    for patch_size in [0.5, 0.25, 0.125] {
        let bundles = Bundles::new(&scene, Resolution { patch_size, n_directions: 1 }).expect("a resolution");
        let n = bundles.n_bundles();
        group.throughput(Throughput::Elements((n * (n - 1) / 2) as u64));
        group.bench_with_input(BenchmarkId::new("pairs", n), &bundles, |b, bundles| {
            b.iter(|| assemble(&scene, black_box(bundles), Exchange::default()).expect("a diffuse scene"));
        });
    }
    group.finish();
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

fn single_pairs(criterion: &mut Criterion) {
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
        ("1 to 2 diameters", pairs(&ladder, apart(1.0, 2.0))),
        ("sharing an edge", pairs(&ladder, |[a, b, c, _, _, f], _| [rectangle(a, b, c), rectangle(b, a, f)])),
        ("sharing a corner", pairs(&ladder, |[a, b, c, _, e, f], _| [rectangle(a, b, c), rectangle(a, e, f)])),
    ];
    let mut group = criterion.benchmark_group("pairs");
    for (name, pairs) in &families {
        group.throughput(Throughput::Elements(pairs.len() as u64));
        for tolerance in [1e-13, 1e-10, 1e-7] {
            group.bench_with_input(BenchmarkId::new(*name, format!("{tolerance:e}")), pairs, |bencher, pairs| {
                bencher.iter(|| {
                    for [(a, of_a), (b, of_b)] in pairs {
                        black_box(unoccluded(&ladder, (a, of_a), (b, of_b), tolerance));
                    }
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, scenes, single_pairs);
criterion_main!(benches);
