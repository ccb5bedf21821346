//! Shafts: what is called clear is clear, what is called blocked is blocked, for every part of both ends.

use super::tracing::{MARGIN, mapped, meeting, pick, point, polygons_of, random_polygon};
use etendue::geometry::{Mat3, Polygon, Ray, Shaft, Tracer, Vec3};
use etendue::sampling::Stream;

/// Whether something crosses the segment; `None` where f64 cannot tell.
fn is_crossed(soup: &[Polygon], ends: [usize; 2], from: Vec3, to: Vec3) -> Option<bool> {
    let ray = Ray { origin: from, direction: to - from };
    let mut doubtful = false;
    for (k, polygon) in soup.iter().enumerate().filter(|(k, _)| !ends.contains(k)) {
        let (t, depth) = meeting(&ray, polygon);
        if depth > MARGIN && t > MARGIN && t < 1.0 - MARGIN {
            return Some(true);
        }
        doubtful |= depth > -MARGIN && t > -MARGIN && t < 1.0 + MARGIN;
        assert!(k < soup.len());
    }
    (!doubtful).then_some(false)
}

/// Light goes from the front of one to the front of the other.
fn exchanges(a: &Polygon, b: &Polygon, x: Vec3, y: Vec3) -> bool {
    a.normal().dot(y - x) > 0.0 && b.normal().dot(x - y) > 0.0
}

#[test]
fn shafts_are_never_wrong() {
    let mut stream = Stream::new(0x7368_6166, 0, 0);
    let (mut clear, mut blocked, mut undecided, mut crossed) = (0, 0, 0, 0);
    for round in 0..1_500 {
        // Two patches and a few occluders: small ones, and in every third round one as large as a wall.
        let mut soup: Vec<Polygon> = (0..2).map(|_| random_polygon(&mut stream, 1.0, 0.3)).collect();
        soup.extend((0..round % 4).map(|_| random_polygon(&mut stream, 1.0, 0.4)));
        if round % 3 == 0 {
            soup.push(random_polygon(&mut stream, 0.2, 4.0));
        }
        let all: Vec<&Polygon> = soup.iter().collect();
        let (tracer, occluders) = (Tracer::new(&all), Tracer::occluders(&all));
        let (a, b) = (&soup[0], &soup[1]);
        let shaft = Shaft::between(&occluders, (a, 0), (b, 1));
        for _ in 0..24 {
            let (x, y) = (a.sample(stream.uniform2()), b.sample(stream.uniform2()));
            if !exchanges(a, b, x, y) {
                continue;
            }
            let Some(truth) = is_crossed(&soup, [0, 1], x, y) else { continue };
            crossed += usize::from(truth);
            assert_eq!(tracer.occluded(x, y, [0, 1]), truth, "round {round}");
            assert_eq!(occluders.occluded(x, y, [0, 1]), truth, "round {round}: an occluder was left out");
            match &shaft {
                Shaft::Clear => assert!(!truth, "round {round}: called clear, {x} to {y} is blocked"),
                Shaft::Blocked => assert!(truth, "round {round}: called blocked, {x} sees {y}"),
                Shaft::Undecided(handles) => assert_eq!(occluders.blocked_by(handles, x, y), truth, "round {round}"),
            }
        }
        match shaft {
            Shaft::Clear => clear += 1,
            Shaft::Blocked => blocked += 1,
            Shaft::Undecided(_) => undecided += 1,
        }
    }
    // Every answer was put to the test, and often.
    assert!(clear > 100 && blocked > 50 && undecided > 100 && crossed > 500, "{clear} {blocked} {undecided} {crossed}");
}

/// Pieces of the scene's own polygons, as exchange asks about them: nothing that a shaft calls clear or blocked is the other.
#[test]
fn shafts_are_never_wrong_in_the_gallery() {
    for (s, name) in ["cornell-box", "corner-box", "two-rooms", "spherical-crater"].iter().enumerate() {
        let polygons = polygons_of(name);
        let all: Vec<&Polygon> = polygons.iter().collect();
        let (tracer, occluders) = (Tracer::new(&all), Tracer::occluders(&all));
        let mut stream = Stream::new(0x6761_6c6c, s as u32, 0);
        let mut decided = 0;
        for _ in 0..1_500 {
            let ids = [pick(&mut stream, polygons.len()), pick(&mut stream, polygons.len())];
            if tracer.coplanar(ids[0], ids[1]) {
                continue;
            }
            let piece = ids.map(|id| shrunk(&polygons[id], &mut stream));
            let shaft = Shaft::between(&occluders, (&piece[0], ids[0]), (&piece[1], ids[1]));
            decided += usize::from(!matches!(shaft, Shaft::Undecided(_)));
            for _ in 0..12 {
                let (x, y) = (piece[0].sample(stream.uniform2()), piece[1].sample(stream.uniform2()));
                if !exchanges(&piece[0], &piece[1], x, y) {
                    continue;
                }
                let truth = tracer.occluded(x, y, ids);
                match &shaft {
                    Shaft::Clear => assert!(!truth, "{name}: called clear, {x} to {y} is blocked"),
                    Shaft::Blocked => assert!(truth, "{name}: called blocked, {x} sees {y}"),
                    Shaft::Undecided(handles) => assert_eq!(occluders.blocked_by(handles, x, y), truth, "{name}"),
                }
            }
        }
        assert!(decided > 100, "{name}: {decided}");
    }
}

/// The polygon shrunk towards one of its points.
fn shrunk(whole: &Polygon, stream: &mut Stream) -> Polygon {
    let (towards, factor) = (whole.sample(stream.uniform2()), 0.1 + 0.4 * stream.uniform());
    Polygon::new(whole.vertices().iter().map(|v| towards + factor * (*v - towards)).collect()).unwrap()
}

/// A parallelogram cut into n × n.
fn cut(whole: &Polygon, n: usize) -> Vec<Polygon> {
    let v = whole.vertices();
    let at = |i: usize, j: usize| {
        let (u, w) = (i as f64 / n as f64, j as f64 / n as f64);
        (1.0 - u) * ((1.0 - w) * v[0] + w * v[3]) + u * ((1.0 - w) * v[1] + w * v[2])
    };
    let piece = |i, j| Polygon::new(vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]).unwrap();
    (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).map(|(i, j)| piece(i, j)).collect()
}

/// A wall with a window, cut into as many pieces as there are ways around it, touching each other, the patches and the floor; two
/// more occluders anywhere. Shafts between whole facets, and among what those leave undecided between all pairs of their pieces, are
/// held against dense rays.
#[test]
fn no_part_of_a_shaft_is_other_than_the_whole() {
    let mut stream = Stream::new(0x7061_7274, 0, 0);
    let (mut clear, mut blocked, mut undecided, mut by_union) = (0, 0, 0, 0);
    for round in 0..160 {
        let turn =
            Mat3::from_axis_angle(point(&mut stream, 1.0).normalize(), f64::from(round % 2) * 2.0 * stream.uniform());
        let offset = f64::from(round % 3) * point(&mut stream, 10.0);
        let quad = |x: [f64; 2], y: [f64; 2], z: f64| {
            [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]].map(|[x, y]| Vec3::new(x, y, z)).to_vec()
        };
        let side = |stream: &mut Stream, from: f64| {
            let low = from + (0.5 - from) * stream.uniform();
            [low, low + 0.1 + 0.4 * stream.uniform()]
        };
        // Two facets that face each other, now and then touching the wall; on the low one the front is up.
        let (x, y) = (side(&mut stream, -0.5), side(&mut stream, -0.5));
        let low = quad(x, y, if round % 5 == 0 { 0.0 } else { -0.6 });
        let (x, y) = (side(&mut stream, -0.5), side(&mut stream, -0.5));
        let mut high = quad(x, y, 0.7);
        high.reverse();
        if round % 7 == 0 {
            // Stand it on the wall.
            high = [[x[0], 0.0], [x[1], 0.0], [x[1], 0.5], [x[0], 0.5]].map(|[x, z]| Vec3::new(x, y[0], z)).to_vec();
        }
        // The wall at z = 0, its window shut in every second round.
        let (u, w) = (side(&mut stream, -0.9), side(&mut stream, -0.9));
        let mut outlines = vec![low, high];
        outlines.extend([
            quad([-1.5, u[0]], [-1.5, 1.5], 0.0),
            quad([u[1], 1.5], [-1.5, 1.5], 0.0),
            quad(u, [-1.5, w[0]], 0.0),
            quad(u, [w[1], 1.5], 0.0),
        ]);
        if round % 2 == 0 {
            outlines.push(quad(u, w, 0.0));
            outlines.last_mut().unwrap().reverse();
        }
        let mut soup: Vec<Polygon> = outlines
            .into_iter()
            .map(|outline| Polygon::new(outline.into_iter().map(|v| turn * v + offset).collect()).unwrap())
            .collect();
        soup.extend(
            (0..round % 3)
                .map(|_| random_polygon(&mut stream, 0.5, 0.2))
                .map(|p| mapped(&[p], |v| v + offset).remove(0)),
        );
        let all: Vec<&Polygon> = soup.iter().collect();
        let (tracer, occluders) = (Tracer::new(&all), Tracer::occluders(&all));

        let whole = Shaft::between(&occluders, (&soup[0], 0), (&soup[1], 1));
        for a in cut(&soup[0], 4) {
            for b in cut(&soup[1], 4) {
                let alone = Shaft::between(&occluders, (&a, 0), (&b, 1));
                let shaft = match &whole {
                    Shaft::Undecided(handles) => Shaft::among(&occluders, handles, (&a, 0), (&b, 1)),
                    decided => decided.clone(),
                };
                match &shaft {
                    Shaft::Clear => clear += 1,
                    Shaft::Undecided(_) => undecided += 1,
                    Shaft::Blocked => {
                        blocked += 1;
                        let lines = || a.vertices().iter().flat_map(|v| b.vertices().iter().map(move |w| (*v, *w)));
                        let cuts = |handle| lines().all(|(v, w)| occluders.blocked_by(&[handle], v, w));
                        by_union += usize::from(!(0..occluders.n_polygons() as u32).any(cuts));
                    }
                }
                for _ in 0..6 {
                    let (x, y) = (a.sample(stream.uniform2()), b.sample(stream.uniform2()));
                    if !exchanges(&a, &b, x, y) {
                        continue;
                    }
                    let truth = tracer.occluded(x, y, [0, 1]);
                    for shaft in [&shaft, &alone] {
                        match shaft {
                            Shaft::Clear => assert!(!truth, "round {round}: called clear, {x} to {y} is blocked"),
                            Shaft::Blocked => assert!(truth, "round {round}: called blocked, {x} sees {y}"),
                            Shaft::Undecided(handles) => assert_eq!(occluders.blocked_by(handles, x, y), truth),
                        }
                    }
                }
            }
        }
    }
    assert!(
        clear > 3_000 && blocked > 5_000 && undecided > 500 && by_union > 1_000,
        "{clear} {blocked} {undecided} {by_union}"
    );
}

/// Rectangles on a lattice, where whatever can touch, align or pass through each other does: exactly, and turned, within rounding. Shafts of
/// whole pairs, and of the quarters of what those leave undecided, are held against rays; handles must block what the scene does.
#[test]
fn shafts_on_a_lattice_are_never_wrong() {
    let mut stream = Stream::new(0x6c61_7474, 0, 0);
    let (mut clear, mut blocked, mut undecided) = (0, 0, 0);
    for round in 0..12_000 {
        let turn = match round % 2 {
            0 => Mat3::IDENTITY,
            _ => Mat3::from_axis_angle(Vec3::new(0.36, 0.48, 0.8), 2.0 * stream.uniform()),
        };
        let soup: Vec<Polygon> = (0..3 + round % 8).map(|_| rectangle(&mut stream)).collect();
        let soup = mapped(&soup, |v| turn * v);
        let all: Vec<&Polygon> = soup.iter().collect();
        let (tracer, occluders) = (Tracer::new(&all), Tracer::occluders(&all));
        if tracer.coplanar(0, 1) {
            continue;
        }
        let mut check = |a: &Polygon, b: &Polygon, shaft: &Shaft| {
            for _ in 0..6 {
                let (x, y) = (a.sample(stream.uniform2()), b.sample(stream.uniform2()));
                if exchanges(a, b, x, y) {
                    let truth = tracer.occluded(x, y, [0, 1]);
                    match shaft {
                        Shaft::Clear => assert!(!truth, "round {round}: called clear, {x} to {y} is blocked"),
                        Shaft::Blocked => assert!(truth, "round {round}: called blocked, {x} sees {y}"),
                        Shaft::Undecided(handles) => {
                            assert_eq!(occluders.blocked_by(handles, x, y), truth, "round {round}: {x} to {y}");
                        }
                    }
                }
            }
        };
        let whole = Shaft::between(&occluders, (&soup[0], 0), (&soup[1], 1));
        check(&soup[0], &soup[1], &whole);
        match &whole {
            Shaft::Clear => clear += 1,
            Shaft::Blocked => blocked += 1,
            Shaft::Undecided(handles) => {
                undecided += 1;
                for (a, b) in cut(&soup[0], 2).iter().flat_map(|a| cut(&soup[1], 2).into_iter().map(move |b| (a, b))) {
                    check(a, &b, &Shaft::among(&occluders, handles, (a, 0), (&b, 1)));
                }
            }
        }
    }
    assert!(clear > 500 && blocked > 100 && undecided > 500, "{clear} {blocked} {undecided}");
}

/// A rectangle along two axes with corners at whole numbers from 0 to 4, facing either way.
fn rectangle(stream: &mut Stream) -> Polygon {
    let mut side = || {
        let (from, length) = (pick(stream, 4), 1 + pick(stream, 3));
        [from as f64, (from + length).min(4) as f64]
    };
    let ([x, other_x], [y, other_y]) = (side(), side());
    let (axis, height) = (pick(stream, 3), pick(stream, 5) as f64);
    let corner = |x: f64, y: f64| {
        let mut corner = [height; 3];
        (corner[(axis + 1) % 3], corner[(axis + 2) % 3]) = (x, y);
        Vec3::from_array(corner)
    };
    let outline = vec![corner(x, y), corner(other_x, y), corner(other_x, other_y), corner(x, other_y)];
    let rectangle = Polygon::new(outline).unwrap();
    if pick(stream, 2) == 0 { rectangle } else { rectangle.flipped() }
}

/// Pairs hidden exactly along an edge stay hidden when rounding moves the edge: as many pairs of the two rooms are settled after
/// a rotation as before.
#[test]
fn turning_a_scene_settles_as_many_pairs() {
    let rooms = polygons_of("two-rooms");
    let turn = Mat3::from_axis_angle(Vec3::new(0.36, 0.48, 0.8), 1.1);
    let settled = [Mat3::IDENTITY, turn].map(|turn| {
        let facets = mapped(&rooms, |v| turn * v);
        let occluders = Tracer::occluders(&facets.iter().collect::<Vec<_>>());
        let patches: Vec<(Polygon, usize)> = facets
            .iter()
            .enumerate()
            .flat_map(|(id, facet)| cut(facet, 3).into_iter().map(move |piece| (piece, id)))
            .collect();
        let (mut clear, mut blocked, mut undecided) = (0, 0, 0);
        for (k, (a, a_id)) in patches.iter().enumerate() {
            for (b, b_id) in &patches[k + 1..] {
                if occluders.coplanar(*a_id, *b_id) || !faces(a, b) || !faces(b, a) {
                    continue;
                }
                match Shaft::between(&occluders, (a, *a_id), (b, *b_id)) {
                    Shaft::Clear => clear += 1,
                    Shaft::Blocked => blocked += 1,
                    Shaft::Undecided(_) => undecided += 1,
                }
            }
        }
        (clear, blocked, undecided)
    });
    assert_eq!(settled[0], settled[1]);
    assert!(settled[0].1 > 1_000, "{settled:?}");
}

/// Something of b is well in front of a.
fn faces(a: &Polygon, b: &Polygon) -> bool {
    b.vertices().iter().any(|v| a.normal().dot(*v - a.centroid()) > MARGIN)
}
