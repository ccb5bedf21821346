use etendue::{assembly::*, basis::*, compare::*, estimator::*, gallery, solver::*};
fn main() {
    let scene = gallery::cornell_box();
    let bundles = Bundles::new(&scene, Resolution { patch_size: 0.2, n_directions: 1 }).unwrap();
    let system = assemble(&scene, &bundles, Exchange::default()).unwrap();
    let truth = Lu.solve(system.equation(), &mut ()).unwrap().radiance;
    let walk = MatrixWalk::collision(&system).unwrap();
    let e = estimate(&walk, 4096, 1);
    let v = compare_blocks(&truth, &e.mean, &e.variance_of_mean, 1e-6);
    println!("{v:?}");
    for i in 0..truth.n_rows() {
        for b in 0..3 {
            let (t, m, s) = (truth.get(i, b), e.mean.get(i, b), e.variance_of_mean.get(i, b).sqrt());
            if s == 0.0 && (t - m).abs() > 1e-12 || (t - m).abs() > 4.5 * s {
                let p = bundles.patch(i).unwrap();
                println!("{i} {b} {t} {m} {s} {} {:?}", scene.surface_of(p.facet).name, p.polygon.centroid());
            }
        }
    }
}
