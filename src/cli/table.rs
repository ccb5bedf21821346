//! A solved light field as a table to read: means by surface.

use super::record::spoken;
use crate::assembly::System;
use crate::basis::Bundles;
use crate::linalg::Block;
use crate::scene::Scene;
use crate::solver::Solution;
use crate::study::surface_means;

/// Characters of a number with the gap before it.
const COLUMN: usize = 12;

/// Significant digits of the largest and of the smallest number of a block, where that many decimals fit.
const DIGITS: (i32, i32) = (5, 3);

/// Mean radiance and irradiance by surface, and how they were come by.
pub fn table(scene: &Scene, bundles: &Bundles, system: &System, solution: &Solution, seconds: f64) -> String {
    let (radiance, _) = surface_means(scene, bundles, &solution.radiance, None);
    let (irradiance, _) = surface_means(scene, bundles, &system.irradiance(&solution.radiance), None);
    let blocks =
        [Column::new("mean radiance, W m⁻² sr⁻¹", radiance), Column::new("mean irradiance, W m⁻²", irradiance)];
    let names = scene.surfaces().iter().map(|surface| surface.name.as_str());
    let width = names.clone().chain(["surface"]).map(|name| name.chars().count()).max().unwrap_or(0);

    // Head the columns with quantity and band.
    let mut lines = vec![format!("{:width$}", ""), format!("{:width$}", "surface")];
    for block in &blocks {
        let columns = block.width(scene.bands());
        lines[0] += &format!("  {:>columns$}", block.title);
        lines[1] += &format!("  {:>columns$}", scene.bands().iter().map(|b| pad(b)).collect::<String>().trim_end());
    }

    // One line a surface.
    for (s, name) in names.enumerate() {
        let mut line = format!("{name:width$}");
        for block in &blocks {
            let numbers: String = block.values.row(s).map(|value| pad(&block.number(value))).collect();
            line += &format!("  {numbers:>0$}", block.width(scene.bands()));
        }
        lines.push(line);
    }

    // Say how good it is, and what it cost.
    let (report, laws) = (&solution.report, system.laws());
    lines.push(String::new());
    lines.push(format!(
        "{}: {}, {} products with K, {seconds:.3} s",
        report.method,
        spoken(report.stop),
        report.products
    ));
    let bound = report.bracket.as_ref().map(|bracket| bracket.relative_width());
    let bound =
        bound.map_or(String::new(), |bound| format!(", error at most {} of the largest radiance", short(bound)));
    lines.push(format!("true residual {}{bound}", short(report.true_residual)));
    lines.push(format!(
        "laws (worst relative violation): reciprocity {}, closure {}, positivity {}, conservation {}",
        short(laws.reciprocity),
        short(laws.closure),
        short(laws.positivity),
        short(laws.conservation)
    ));
    let exchange = system.report();
    lines.push(format!(
        "exchange before repair: closure {}, visibility {}, quadrature {} ({} of {} pairs integrated, {} sampled)",
        short(exchange.closure_before_repair),
        short(exchange.visibility_error),
        short(exchange.quadrature_error),
        exchange.n_integrated,
        exchange.n_pairs,
        exchange.n_sampled
    ));
    lines.iter().map(|line| format!("{}\n", line.trim_end())).collect()
}

/// One quantity: surfaces × bands, all with the same number of decimals.
struct Column {
    title: &'static str,
    values: Block,
    /// None where decimals cannot show both the largest and the smallest number.
    decimals: Option<usize>,
}

impl Column {
    fn new(title: &'static str, values: Block) -> Self {
        let sizes = values.values().iter().map(|v| v.abs()).filter(|v| *v > 0.0);
        let (least, most) =
            sizes.fold((f64::INFINITY, 0.0), |(least, most): (f64, f64), v| (least.min(v), most.max(v)));
        let exponent = |v: f64| v.log10().floor() as i32;
        let decimals = if most > 0.0 {
            let wanted = (DIGITS.0 - 1 - exponent(most)).max(DIGITS.1 - 1 - exponent(least)).max(0);
            (wanted <= 7 && exponent(most) <= 6).then_some(wanted as usize)
        } else {
            Some(0)
        };
        // Decimals and digits before the point must fit into the column together.
        let fits = |decimals: &usize| most <= 0.0 || exponent(most).max(0) as usize + decimals + 4 <= COLUMN;
        Self { title, values, decimals: decimals.filter(fits) }
    }

    fn number(&self, value: f64) -> String {
        match self.decimals {
            Some(decimals) => format!("{value:.decimals$}"),
            None => format!("{value:.3e}"),
        }
    }

    fn width(&self, bands: &[String]) -> usize {
        (COLUMN * bands.len()).max(self.title.chars().count())
    }
}

fn pad(text: &str) -> String {
    format!("{text:>COLUMN$}")
}

/// A small number; zero as such.
fn short(value: f64) -> String {
    if value == 0.0 { "0".to_string() } else { format!("{value:.1e}") }
}
