use etendue::{gallery, geometry::*, sampling::*};
use std::time::Instant;
fn main() {
    let scene = gallery::cornell_box();
    let polygons: Vec<&Polygon> = (0..scene.facets().len()).map(|f| scene.polygon(f)).collect();
    let tracer = Tracer::new(&polygons);
    let k = Kronecker::<4>::new(1);
    let n = 2_000_000;
    let rays: Vec<Ray> = (0..n)
        .map(|i| {
            let [a, b, c, d] = k.point(i);
            Ray {
                origin: Vec3::new(2.0 * a - 1.0, 2.0 * b - 1.0, -0.9),
                direction: Vec3::from(warp::uniform_sphere([c, d])),
            }
        })
        .collect();
    let t = Instant::now();
    let mut h = 0;
    for r in &rays {
        h += tracer.closest(r, None).is_some() as usize;
    }
    println!("{:.2} M closest/s {h}", n as f64 / t.elapsed().as_secs_f64() / 1e6);
    let t = Instant::now();
    let mut h = 0;
    for r in &rays {
        h += tracer.occluded(r.origin, r.at(1.0), [0, 1]) as usize;
    }
    println!("{:.2} M occluded/s {h}", n as f64 / t.elapsed().as_secs_f64() / 1e6);
}
