//! The command line.

use super::memory::Bytes;
use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

/// Light transport as linear algebra: L = E + K L, assembled, solved, estimated and compared.
#[derive(Debug, Parser)]
#[command(version, about, long_about = None, max_term_width = 100, after_help = EXIT_CODES)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,

    /// One JSON object on standard output, everything else on standard error
    #[arg(long, global = true)]
    pub json: bool,

    /// Threads to use; results do not depend on it [default: all cores]
    #[arg(long, global = true, value_name = "N", value_parser = threads)]
    pub threads: Option<usize>,

    /// Say more on standard error; twice for everything
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    pub verbose: u8,

    /// Say nothing but errors
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub quiet: bool,
}

const EXIT_CODES: &str = "Exit codes: 0 ok, 4 input, 5 refused for memory, 6 not converged, 64 usage, 70 internal";

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Solve a scene by every method, estimate it by every estimator, and write a report
    Study(Study),
    /// Solve a scene and print its light field
    Solve(Solve),
    /// List the built-in scenes
    Gallery,
}

/// Which scene, and how finely it is cut.
#[derive(Debug, Args)]
pub struct SceneArguments {
    /// Name of a gallery scene, or path of a Mitsuba 3 XML file
    pub scene: String,

    /// Set a parameter of a scene file
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = definition)]
    pub definitions: Vec<(String, String)>,

    /// Longest edge of a patch, metres [default: the scene's preset]
    #[arg(long, value_name = "LENGTH", value_parser = positive)]
    pub patch_size: Option<f64>,

    /// Memory that matrices may take, e.g. 8GiB
    #[arg(long, value_name = "BYTES", default_value = "8GiB")]
    pub memory: Bytes,

    /// Seed of every random stream
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

#[derive(Debug, Args)]
pub struct Study {
    #[command(flatten)]
    pub scene: SceneArguments,

    /// Folder to write [default: out/SCENE]
    #[arg(short, long, value_name = "FOLDER")]
    pub output: Option<PathBuf>,

    /// Stop iterative solvers at this relative residual
    #[arg(long, default_value_t = 1e-12, value_parser = positive)]
    pub tolerance: f64,

    /// Most samples a bundle for the walks on the matrix
    #[arg(long, value_name = "N", default_value_t = 4096, value_parser = clap::value_parser!(u64).range(4..))]
    pub walk_samples: u64,

    /// Most samples a bundle for the path tracer
    #[arg(long, value_name = "N", default_value_t = 1024, value_parser = clap::value_parser!(u64).range(4..))]
    pub path_samples: u64,
}

#[derive(Debug, Args)]
pub struct Solve {
    #[command(flatten)]
    pub scene: SceneArguments,

    /// File to write the JSON object to, instead of standard output
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,

    /// Method
    #[arg(long, default_value = "cg", value_parser = clap::builder::PossibleValuesParser::new(solver_names()))]
    pub solver: String,

    /// Stop iterative solvers at this relative residual
    #[arg(long, default_value_t = 1e-12, value_parser = positive)]
    pub tolerance: f64,

    /// End iterative solvers after this many products with K, converged or not
    #[arg(long, value_name = "N")]
    pub max_products: Option<u64>,
}

fn solver_names() -> Vec<&'static str> {
    crate::solver::all(1.0).iter().map(|solver| solver.name()).collect()
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        Ok(value) => Err(format!("{value} is not finite and above zero")),
        Err(error) => Err(error.to_string()),
    }
}

fn threads(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(n @ 1..=1024) => Ok(n),
        Ok(n) => Err(format!("{n} is not between 1 and 1024")),
        Err(error) => Err(error.to_string()),
    }
}

fn definition(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.is_empty() => Ok((name.to_string(), value.to_string())),
        _ => Err("must have the form NAME=VALUE".to_string()),
    }
}
