use etendue::{
    assembly::*,
    basis::*,
    gallery,
    linalg::*,
    solver::{self, Solver},
};
use std::time::Instant;
fn main() {
    let name = std::env::args().nth(1).unwrap();
    let size: f64 = std::env::args().nth(2).unwrap().parse().unwrap();
    let scene = (gallery::find(&name).unwrap().build)();
    let bundles = Bundles::new(&scene, Resolution { patch_size: size, n_directions: 1 }).unwrap();
    println!("n = {}", bundles.n_bundles());
    let t = Instant::now();
    let system = assemble(&scene, &bundles, Exchange::default()).unwrap();
    println!("assemble {:.2}s {:#?}", t.elapsed().as_secs_f64(), system.report());
    let t = Instant::now();
    println!("{:?} {:.2}s", system.laws(), t.elapsed().as_secs_f64());
    let mut reference: Option<Block> = None;
    for s in solver::all(1e-13) {
        let t = Instant::now();
        match s.solve(system.equation(), &mut ()) {
            Ok(sol) => {
                let e = reference.as_ref().map_or(0.0, |r| {
                    let mut d = r.clone();
                    d.add_scaled(-1.0, &sol.radiance);
                    d.max_abs() / r.max_abs()
                });
                println!(
                    "{:14} {:9} it {:5} products {:8.1} {:.2}s true {:.1e} err {:.1e} bracket {:?} mean {:?}",
                    s.name(),
                    sol.report.stop.to_string(),
                    sol.report.n_iterations,
                    sol.report.products,
                    t.elapsed().as_secs_f64(),
                    sol.report.true_residual,
                    e,
                    sol.report.bracket.as_ref().map(|b| b.relative_width(&sol.radiance)),
                    sol.radiance.row(0).collect::<Vec<_>>()
                );
                reference.get_or_insert(sol.radiance);
            }
            Err(e) => println!("{} {e}", s.name()),
        }
    }
}
