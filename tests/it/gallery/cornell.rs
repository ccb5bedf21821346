//! The Cornell box against the numbers it was specified by.

use super::seen_from;
use etendue::gallery;
use etendue::geometry::Vec3;
use etendue::scene::{PixelFilter, Scene, Surface};
use std::f64::consts::PI;

/// A few roundings of numbers of order one.
const ROUNDING: f64 = 1e-14;

fn surface<'a>(scene: &'a Scene, name: &str) -> &'a Surface {
    scene.surfaces().iter().find(|s| s.name == name).unwrap_or_else(|| panic!("no surface '{name}'"))
}

/// Σ x·n A / 3: the volume that a closed outward-facing surface encloses.
fn signed_volume(surface: &Surface) -> f64 {
    surface.polygons.iter().map(|p| p.centroid().dot(p.normal()) * p.area() / 3.0).sum()
}

#[test]
fn walls_face_the_interior_and_have_their_places() {
    let scene = gallery::cornell_box();
    let walls = [
        ("floor", -Vec3::Y, [0.885809, 0.698859, 0.666422]),
        ("ceiling", Vec3::Y, [0.885809, 0.698859, 0.666422]),
        ("back", -Vec3::Z, [0.885809, 0.698859, 0.666422]),
        ("green-wall", Vec3::X, [0.105421, 0.37798, 0.076425]),
        ("red-wall", -Vec3::X, [0.570068, 0.0430135, 0.0443706]),
    ];
    for (name, place, albedo) in walls {
        let wall = surface(&scene, name);
        assert_eq!(wall.front.lambertian(), Some(&albedo[..]), "{name}");
        assert!(wall.back.is_none() && wall.emission == [0.0; 3], "{name}");
        let [polygon] = &wall.polygons[..] else { panic!("{name}") };
        assert_eq!((polygon.normal(), polygon.area(), polygon.centroid()), (-place, 4.0, place), "{name}");
    }
    assert_eq!(scene.surfaces().len(), 8);
}

#[test]
fn the_lamp_hangs_under_the_ceiling_and_shines_down() {
    let scene = gallery::cornell_box();
    let light = surface(&scene, "light");
    let [polygon] = &light.polygons[..] else { panic!("the light is one rectangle") };
    assert_eq!(polygon.normal(), -Vec3::Y);
    assert!(polygon.centroid().distance(Vec3::new(0.0, 0.99, 0.01)) < ROUNDING);
    assert!((polygon.area() - 0.46 * 0.38).abs() < ROUNDING);
    assert_eq!(light.front.lambertian(), Some(&[0.885809, 0.698859, 0.666422][..]));
    assert_eq!(light.emission, [18.387, 13.9873, 6.75357]);
    for (power, radiance) in gallery::emitted_power(&scene).iter().zip([18.387, 13.9873, 6.75357]) {
        assert!((power - PI * radiance * 0.1748).abs() < ROUNDING * power);
    }
}

#[test]
fn boxes_face_outward_and_enclose_their_volume() {
    let scene = gallery::cornell_box();
    let boxes = [
        ("small-box", Vec3::new(0.335, -0.7, 0.38), [0.3, 0.3, 0.3], -1.0, -0.4),
        ("large-box", Vec3::new(-0.33, -0.4, -0.28), [0.3, 0.61, 0.3], -1.01, 0.21),
    ];
    for (name, centre, half, low, high) in boxes {
        let solid = surface(&scene, name);
        assert_eq!(solid.polygons.len(), 6);
        for p in &solid.polygons {
            assert!(
                (p.centroid() - centre).cross(p.normal()).length() < ROUNDING
                    && (p.centroid() - centre).dot(p.normal()) > 0.0
            );
        }

        // The linear maps are printed to six digits: volume and area agree with the half-sizes to a few of 1e-6.
        let volume = 8.0 * half[0] * half[1] * half[2];
        assert!((signed_volume(solid) / volume - 1.0).abs() < 1e-5, "{name}");
        let area = 8.0 * (half[0] * half[1] + half[1] * half[2] + half[2] * half[0]);
        assert!((solid.area() / area - 1.0).abs() < 1e-5, "{name}");
        assert!((seen_from(&scene, centre, |s| s == name) + 4.0 * PI).abs() < 1e3 * ROUNDING);

        let heights = || solid.polygons.iter().flat_map(|p| p.vertices()).map(|v| v.y);
        assert!((heights().fold(f64::MAX, f64::min) - low).abs() < ROUNDING, "{name}");
        assert!((heights().fold(f64::MIN, f64::max) - high).abs() < ROUNDING, "{name}");

        // Nothing pokes through the walls.
        assert!(solid.polygons.iter().flat_map(|p| p.vertices()).all(|v| v.x.abs() < 0.95 && v.z.abs() < 0.95));
    }
}

#[test]
fn red_is_left_and_green_is_right_in_the_picture() {
    let scene = gallery::cornell_box();
    let camera = scene.camera().unwrap();
    assert_eq!((camera.origin, camera.forward), (Vec3::new(0.0, 0.0, 3.9), -Vec3::Z));
    assert_eq!((camera.right, camera.up), (Vec3::X, Vec3::Y));
    assert_eq!((camera.film.width, camera.film.height), (256, 256));
    assert_eq!(camera.film.filter, PixelFilter::Gaussian { standard_deviation: 0.5 });
    let tangent = (0.5 * 39.3077 * PI / 180.0).tan();
    assert!(
        (camera.tangent_half_width - tangent).abs() < ROUNDING
            && camera.tangent_half_width == camera.tangent_half_height
    );

    // Project the walls' centres to camera coordinates.
    let across = |name| (surface(&scene, name).polygons[0].centroid() - camera.origin).dot(camera.right);
    assert!(across("red-wall") < 0.0 && across("green-wall") > 0.0);

    // The front opening, 2.9 away, spans 2 of the 2.07 that the picture shows there: the whole box is in view.
    let shown = camera.ray(256.0, 128.0).at(2.9).x;
    assert!((1.0..1.05).contains(&shown), "{shown}");
}
