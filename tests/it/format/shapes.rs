//! Shapes, their fronts under transforms, and what they are made of.

use super::{LAMP, ROUNDING, area_vector, code, scene, shape, volume};
use etendue::geometry::Vec3;
use etendue::scene::Side;
use etendue::scene::format::{Code, N_DISK_RINGS, N_MERIDIANS, N_PARALLELS};
use std::collections::HashMap;
use std::f64::consts::PI;

fn placed(kind: &str, steps: &str, flip: bool) -> String {
    let flip = if flip { r#"<boolean name="flip_normals" value="true"/>"# } else { "" };
    format!(r#"<shape type="{kind}">{flip}<transform name="to_world">{steps}</transform></shape>"#)
}

#[test]
fn flat_shapes_have_their_exact_polygons() {
    let rectangle = shape(r#"<shape type="rectangle"/>"#).unwrap();
    let corners: Vec<[f64; 3]> = rectangle.polygons[0].vertices().iter().map(|v| v.to_array()).collect();
    assert_eq!(corners, [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]]);
    assert_eq!(rectangle.polygons[0].normal(), Vec3::Z);
    assert!(rectangle.tessellation.is_none());

    let cube = shape(r#"<shape type="cube"/>"#).unwrap();
    assert_eq!((cube.polygons.len(), cube.area(), volume(&cube)), (6, 24.0, 8.0));
    assert_eq!(area_vector(&cube.polygons), Vec3::ZERO);
}

/// Fronts as Mitsuba 3.9.1 has them, measured with rays from outside: whether the front is the side that faces the
/// ray.
#[test]
fn fronts_follow_mirrors_as_in_mitsuba() {
    let mirrors =
        [("", false), (r#"<scale x="-1"/>"#, true), (r#"<scale z="-1"/>"#, true), (r#"<scale value="-1"/>"#, true)];
    for flip in [false, true] {
        let sign = if flip { -1.0 } else { 1.0 };
        for (steps, mirrored) in mirrors {
            for kind in ["rectangle", "disk"] {
                let up = if steps.contains("value") || steps.contains('z') { -1.0 } else { 1.0 };
                let surface = shape(&placed(kind, steps, flip)).unwrap();
                for polygon in &surface.polygons {
                    assert_eq!(polygon.normal(), sign * up * Vec3::Z, "{kind} {steps}");
                }
            }
            assert_eq!(volume(&shape(&placed("cube", steps, flip)).unwrap()), sign * 8.0, "cube {steps}");
            let sphere = volume(&shape(&placed("sphere", steps, flip)).unwrap());
            assert_eq!(sphere > 0.0, mirrored == flip, "sphere {steps}");
            let cylinder = shape(&placed("cylinder", steps, flip)).unwrap();
            for polygon in &cylinder.polygons {
                let outward = Vec3::new(polygon.centroid().x, polygon.centroid().y, 0.0);
                assert!(sign * polygon.normal().dot(outward) > 0.9, "cylinder {steps}");
            }
        }
    }
}

#[test]
fn transforms_apply_in_the_order_listed() {
    let normal = |steps: &str| {
        let surface = shape(&placed("rectangle", steps, false)).unwrap();
        (surface.polygons[0].centroid(), surface.polygons[0].normal())
    };
    let turned_first = normal(r#"<rotate y="1" angle="90"/><translate x="2"/>"#);
    let moved_first = normal(r#"<translate x="2"/><rotate y="1" angle="90"/>"#);
    assert_eq!(turned_first, (Vec3::new(2.0, 0.0, 0.0), Vec3::X));
    assert_eq!(moved_first, (Vec3::new(0.0, 0.0, -2.0), Vec3::X));
    let nine = normal(r#"<matrix value="0 0 1  0 1 0  -1 0 0"/>"#);
    let sixteen = normal(r#"<matrix value="0,0,1,2, 0,1,0,0, -1,0,0,0, 0,0,0,1"/>"#);
    assert_eq!((nine.1, sixteen), (Vec3::X, turned_first));
    let looking = normal(r#"<lookat origin="2,0,0" target="5,0,0" up="0,1,0"/>"#);
    assert_eq!(looking, turned_first);
    let third = normal(r#"<rotate value="1,1,1" angle="120"/>"#);
    assert!((third.1 - Vec3::X).length() < ROUNDING, "{third:?}");
    let scaled =
        shape(&placed("rectangle", r#"<scale value="2"/><scale x="3"/><scale value="1, 5, 1"/>"#, false)).unwrap();
    assert_eq!(scaled.area(), 4.0 * (2.0 * 3.0) * (2.0 * 5.0));
}

/// Every edge of a closed surface is met once in each direction, by the same two vertices bit for bit.
fn n_unmatched_edges(surface: &etendue::scene::Surface) -> usize {
    let bits = |v: &Vec3| v.to_array().map(f64::to_bits);
    let mut edges: HashMap<_, i32> = HashMap::new();
    for polygon in &surface.polygons {
        let corners = polygon.vertices();
        for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            *edges.entry((bits(a), bits(b))).or_default() += 1;
            *edges.entry((bits(b), bits(a))).or_default() -= 1;
        }
    }
    edges.values().filter(|n| **n > 0).count()
}

#[test]
fn a_sphere_is_watertight_with_vertices_on_it() {
    let sphere = shape(
        r#"<shape type="sphere"><point name="center" x="1" y="2" z="3"/><float name="radius" value="2"/>
           <transform name="to_world"><rotate x="1" y="2" z="3" angle="77"/><scale value="1.5"/></transform></shape>"#,
    )
    .unwrap();
    let centre: Vec3 = sphere.polygons.iter().map(|p| p.area() * p.centroid()).sum::<Vec3>() / sphere.area();
    assert_eq!(sphere.polygons.len(), N_MERIDIANS * N_PARALLELS);
    assert_eq!(sphere.polygons.len(), 512);
    assert_eq!(n_unmatched_edges(&sphere), 0);
    for vertex in sphere.polygons.iter().flat_map(|p| p.vertices()) {
        assert!((vertex.distance(centre) - 3.0).abs() < 100.0 * ROUNDING, "{vertex}");
    }

    // The deviation is that of the facets at the equator: half a facet's angles away, around and along the meridian.
    let tessellation = sphere.tessellation.as_ref().unwrap();
    let steepest = (PI / 32.0).cos() * (PI / 32.0).cos();
    assert_eq!((tessellation.shape, tessellation.n_polygons), ("sphere", 512));
    assert!(tessellation.deviation > 0.9 * 3.0 * (1.0 - steepest), "{tessellation:?}");
    assert!(tessellation.deviation < 1.1 * 3.0 * (1.0 - steepest), "{tessellation:?}");
    let missing = 1.0 - volume(&sphere) / (4.0 / 3.0 * PI * 27.0);
    assert!(missing > 0.0 && missing < 3.0 * tessellation.deviation / 3.0, "{missing}");
}

#[test]
fn a_cylinder_stands_between_its_points_without_caps() {
    let cylinder = shape(
        r#"<shape type="cylinder"><point name="p0" value="1,0,0"/><point name="p1" value="1,0,3"/>
           <float name="radius" value="0.5"/></shape>"#,
    )
    .unwrap();
    let tessellation = cylinder.tessellation.as_ref().unwrap();
    assert_eq!((cylinder.polygons.len(), tessellation.shape), (N_MERIDIANS, "cylinder"));
    assert_eq!(n_unmatched_edges(&cylinder), 2 * N_MERIDIANS);
    let n = N_MERIDIANS as f64;
    assert!((cylinder.area() - 3.0 * n * (PI / n).sin()).abs() < 100.0 * ROUNDING);
    assert!((tessellation.deviation - 0.5 * (1.0 - (PI / n).cos())).abs() < ROUNDING);
    for polygon in &cylinder.polygons {
        let outward = polygon.centroid() - Vec3::new(1.0, 0.0, polygon.centroid().z);
        assert!(polygon.normal().dot(outward) > 0.0);
    }

    // An ellipse's arcs rise furthest over their chords where the curve is tightest or the chord longest.
    let stretched = shape(&placed("cylinder", r#"<scale x="2"/>"#, false)).unwrap();
    let rise = stretched.tessellation.unwrap().deviation;
    assert!(rise > 1.0 - (PI / n).cos() && rise <= 2.0 * (1.0 - (PI / n).cos()) + ROUNDING, "{rise}");
}

#[test]
fn a_disk_is_a_grid_of_quadrilaterals() {
    let disk = shape(r#"<shape type="disk"/>"#).unwrap();
    let n_rim = 8 * N_DISK_RINGS;
    assert_eq!(disk.polygons.len(), 4 * N_DISK_RINGS * N_DISK_RINGS);
    assert_eq!(disk.polygons.len(), 64);
    assert_eq!(n_unmatched_edges(&disk), n_rim);
    let n = n_rim as f64;
    assert!((disk.area() - 0.5 * n * (2.0 * PI / n).sin()).abs() < 100.0 * ROUNDING);
    assert!((disk.tessellation.unwrap().deviation - (1.0 - (PI / n).cos())).abs() < ROUNDING);
}

#[test]
fn a_transform_that_no_shape_survives_is_refused() {
    let sphere = |steps| code(shape(&placed("sphere", steps, false)));
    assert_eq!(sphere(r#"<scale x="2"/>"#), Some(Code::InvalidTransform));
    assert_eq!(sphere(r#"<matrix value="1 0.1 0 0 1 0 0 0 1"/>"#), Some(Code::InvalidTransform));
    assert_eq!(code(shape(&placed("rectangle", r#"<scale z="0"/>"#, false))), Some(Code::InvalidTransform));
    assert_eq!(code(shape(&placed("rectangle", r#"<rotate angle="3"/>"#, false))), Some(Code::InvalidTransform));
    assert_eq!(
        code(shape(&placed("rectangle", r#"<scale value="1e300"/><scale value="1e300"/>"#, false))),
        Some(Code::InvalidTransform)
    );
    let projective = r#"<matrix value="1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1"/>"#;
    assert_eq!(code(shape(&placed("rectangle", projective, false))), Some(Code::InvalidTransform));
    let blind = r#"<lookat origin="0,0,0" target="0,1,0" up="0,2,0"/>"#;
    assert_eq!(code(shape(&placed("rectangle", blind, false))), Some(Code::InvalidTransform));
}

#[test]
fn sides_and_defaults_of_materials() {
    let albedo = |element: &str| {
        let surface = shape(&format!(r#"<shape type="rectangle">{element}</shape>"#)).unwrap();
        let of = |side| surface.brdf(side).map(|b| b.lambertian().unwrap().to_vec());
        (of(Side::Front), of(Side::Back))
    };
    let grey = |a: f64| Some(vec![a; 3]);
    assert_eq!(albedo(""), (grey(0.5), None));
    assert_eq!(albedo(r#"<bsdf type="diffuse"/>"#), (grey(0.5), None));
    let diffuse = |value: &str| format!(r#"<bsdf type="diffuse">{value}</bsdf>"#);
    let coloured = r#"<rgb name="reflectance" value="0.1, 0.2 0.3"/>"#;
    assert_eq!(albedo(&diffuse(coloured)), (Some(vec![0.1, 0.2, 0.3]), None));
    assert_eq!(albedo(&diffuse(r#"<rgb name="reflectance" value="0.25"/>"#)), (grey(0.25), None));
    assert_eq!(albedo(&diffuse(r#"<spectrum name="reflectance" value="0.25"/>"#)), (grey(0.25), None));
    assert_eq!(albedo(&diffuse(r#"<float name="reflectance" value="1"/>"#)), (grey(1.0), None));
    let both = format!(r#"<bsdf type="twosided">{}</bsdf>"#, diffuse(""));
    assert_eq!(albedo(&both), (grey(0.5), grey(0.5)));
    let two = format!(r#"<bsdf type="twosided">{}{}</bsdf>"#, diffuse(""), diffuse(coloured));
    assert_eq!(albedo(&two), (grey(0.5), Some(vec![0.1, 0.2, 0.3])));
}

#[test]
fn emitters_emit_from_the_front_in_linear_srgb() {
    let radiance = |value: &str| {
        let surface =
            shape(&format!(r#"<shape type="rectangle"><emitter type="area">{value}</emitter></shape>"#)).unwrap();
        assert_eq!(surface.emitted(Side::Back, 0), 0.0);
        surface.emission
    };
    assert_eq!(radiance(""), [1.0; 3]);
    assert_eq!(radiance(r#"<rgb name="radiance" value="18.387, 13.9873, 6.75357"/>"#), [18.387, 13.9873, 6.75357]);
    assert_eq!(radiance(r#"<float name="radiance" value="2"/>"#), [2.0; 3]);

    // As rendered by Mitsuba 3.9.1 in its rgb mode, which computes in single precision.
    let single = 4.0 * f64::from(f32::EPSILON);
    let uniform = radiance(r#"<spectrum name="radiance" value="2"/>"#);
    for (band, measured) in uniform.iter().zip([2.4095879, 1.8965819, 1.8178324]) {
        assert!((band / measured - 1.0).abs() < single, "{band} {measured}");
    }
}

#[test]
fn names_are_ids_or_kind_and_number() {
    let names = |elements: &str| -> Vec<String> {
        scene(elements).unwrap().surfaces().iter().map(|s| s.name.clone()).collect()
    };
    let rectangle = r#"<shape type="rectangle"/>"#;
    let plain = format!(r#"{LAMP}{rectangle}<shape type="cube"/>{rectangle}"#);
    assert_eq!(names(&plain), ["lamp", "rectangle-2", "cube-1", "rectangle-3"]);
    let taken = format!(r#"{LAMP}{rectangle}<shape type="cube" id="rectangle-2"/>"#);
    assert_eq!(names(&taken), ["lamp", "rectangle-2-2", "rectangle-2"]);
}
