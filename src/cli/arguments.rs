//! The command line.

use super::exit::{Exit, Failure};
use super::export;
use super::memory::Bytes;
use crate::assembly::{Exchange, Letter, Occlusion};
use crate::linalg::format::MatrixFormat;
use crate::solver::{self, Solver};
use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

/// Light transport as linear algebra: L = E + K L, assembled, solved, estimated and compared.
#[derive(Debug, Parser)]
#[command(version, about, long_about = None, max_term_width = 100, after_help = EXIT_CODES)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Command,

    /// Print one JSON object on standard output; everything else goes to standard error
    #[arg(long, global = true)]
    pub json: bool,

    /// Threads to use; results do not depend on it [default: all cores]
    #[arg(long, global = true, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,

    /// Say on standard error how long each stage took; twice: iterations and starting stages too
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    pub verbose: u8,

    /// Say nothing but errors
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub quiet: bool,
}

const EXIT_CODES: &str = "Exit codes: 0 ok, 2 check failed, 4 input, 5 memory, 6 not converged, 64 usage, 70 internal";

const SOLVE_EXAMPLES: &str = "\
Examples:
  etendue solve cornell-box                         a table of means by surface
  etendue solve cornell-box --json -q | jq .laws    one JSON object, and nothing else
  etendue solve room.xml -D albedo=0.5 -o room.json a scene file, one of its parameters set
  etendue solve --matrix K.mtx --emission E.mtx     an equation that something else made";

const SENSITIVITY_EXAMPLES: &str = "\
Examples:
  etendue sensitivity cornell-box --sensor irradiance:floor         mean irradiance of a surface
  etendue sensitivity cornell-box --sensor radiance:back --json     mean radiance leaving one, as JSON
  etendue sensitivity cornell-box --sensor irradiance:floor --what-if light.emission=9 --what-if back.albedo=0.3,0.2,0.1
                                                                    the reading after each change";

const EXPORT_EXAMPLES: &str = "\
Examples:
  etendue export cornell-box                           K and E as Matrix Market files in out/cornell-box-matrices
  etendue export room.xml --what T,E --format npz      what NumPy and SciPy read
  etendue export room.xml --what F --format radiance   what Radiance's rmtxop and dctimestep read

  K one bounce, K = S G    T exchange, m² sr    F form factors (G)    S scattering    E emission

  Of what differs from band to band there is a file a band; in Radiance's format, one with a component a band.";

/// A method of every kind.
/// What `study` estimates with unless told otherwise.
const STUDY_ESTIMATORS: &str = "collision-walk,absorption-walk,path-tracer,light-tracer,bidirectional";

const STUDY_SOLVERS: &str = "lu,gth,cholesky,neumann,gauss-seidel,southwell,chebyshev,cg,deflated-cg,gmres";

const STUDY_EXAMPLES: &str = "\
Examples:
  etendue study cornell-box                         writes out/cornell-box/report.html and its files
  etendue study room.xml --patch-size 0.1 -o room   a scene file, cut as finely as you say
  etendue study two-rooms --solvers all             every method there is
  etendue study corner-box --estimators all         every random method there is
  etendue study maze --albedo 0.5,0.9,0.99,0.999    products against albedo, too";

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Solve a scene by every method, estimate it by every estimator, and write a report
    #[command(after_help = STUDY_EXAMPLES)]
    Study(Study),
    /// Solve a scene by one method and print its light field
    #[command(after_help = SOLVE_EXAMPLES)]
    Solve(Solve),
    /// Spectral radius, eigenvalues and singular values of K, and the bounces they ask for
    Spectrum(Spectrum),
    /// Derivatives of a sensor's reading with respect to every albedo and emission, from one adjoint solution
    #[command(after_help = SENSITIVITY_EXAMPLES)]
    Sensitivity(Sensitivity),
    /// Write the matrices of a scene to files, with what their rows stand for
    #[command(after_help = EXPORT_EXAMPLES)]
    Export(Export),
    /// Answer reference cases and judge the answers
    Check(Check),
    /// List the built-in scenes
    Gallery,
}

/// Which scene, and how finely it is cut.
#[derive(Debug, Args)]
pub struct SceneArguments {
    /// Name of a gallery scene (`etendue gallery` lists them), or path of a Mitsuba 3 XML file
    #[arg(required = true)]
    pub scene: Option<String>,

    /// Set a parameter of a scene file, a `$name` in it; may be given several times
    #[arg(short = 'D', value_name = "NAME=VALUE", value_parser = definition)]
    pub definitions: Vec<(String, String)>,

    /// Longest edge of a patch [default: the scene's preset]
    #[arg(long, value_name = "METRES", value_parser = positive, allow_negative_numbers = true)]
    pub patch_size: Option<f64>,

    /// Integrate partly visible pairs to this error of their exchange, as a share of the smaller étendue
    #[arg(long, value_name = "ERROR", default_value = "1e-7", value_parser = positive, allow_negative_numbers = true)]
    #[arg(conflicts_with = "visibility_rays")]
    pub visibility_error: f64,

    /// Sample partly visible pairs by so many rays each, instead of integrating them
    #[arg(long, value_name = "N", value_parser = rays, allow_negative_numbers = true)]
    pub visibility_rays: Option<usize>,

    /// Memory that a run may take: what would take more is refused before it starts
    #[arg(long, value_name = "SIZE", default_value = "8GiB", allow_negative_numbers = true)]
    pub memory: Bytes,

    /// Seed of every random stream; equal seeds give equal numbers
    #[arg(long, value_name = "N", default_value_t = 1, allow_negative_numbers = true)]
    pub seed: u64,
}

impl SceneArguments {
    /// How exchange is to be computed.
    pub fn exchange(&self) -> Exchange {
        let settings = Exchange { seed: self.seed, ..Exchange::default() };
        match self.visibility_rays {
            Some(rays) => Exchange { occlusion: Occlusion::by_rays(rays), ..settings },
            None => Exchange { occlusion: Occlusion::Exact { tolerance: self.visibility_error }, ..settings },
        }
    }
}

/// Which solver, and how far it goes.
#[derive(Debug, Args)]
pub struct Method {
    /// Method: direct ones first, then those that iterate
    #[arg(long, default_value = "cg", value_parser = clap::builder::PossibleValuesParser::new(solver_names()))]
    pub solver: String,

    /// Stop iterative solvers at this relative residual
    #[arg(long, value_name = "RESIDUAL", default_value = "1e-12", value_parser = positive, allow_negative_numbers = true)]
    pub tolerance: f64,
}

impl Method {
    /// The solver.
    pub fn solver(&self) -> Result<Box<dyn Solver>, Failure> {
        let found = solver::named(&self.solver, self.tolerance);
        found.ok_or_else(|| Failure::new(Exit::Usage, format!("no solver '{}'", self.solver)))
    }
}

#[derive(Debug, Args)]
pub struct Study {
    #[command(flatten)]
    pub scene: SceneArguments,

    /// Folder to write, whole or not at all; an older report there is replaced [default: out/SCENE]
    #[arg(short, long, value_name = "FOLDER")]
    pub output: Option<PathBuf>,

    /// Methods to compare, or all; what one refuses is reported
    #[arg(long, value_name = "NAMES", value_delimiter = ',', default_value = STUDY_SOLVERS)]
    #[arg(value_parser = clap::builder::PossibleValuesParser::new([solver_names(), vec!["all"]].concat()))]
    pub solvers: Vec<String>,

    /// Random methods to compare, or all; the path tracer is always among them, and what one refuses is reported
    #[arg(long, value_name = "NAMES", value_delimiter = ',', default_value = STUDY_ESTIMATORS)]
    pub estimators: Vec<String>,

    /// Stop iterative solvers at this relative residual
    #[arg(long, value_name = "RESIDUAL", default_value = "1e-12", value_parser = positive, allow_negative_numbers = true)]
    pub tolerance: f64,

    /// Look at the scene with all that reflects at these albedos as well, each at least 0 and below 1
    #[arg(long, value_name = "ALBEDOS", value_delimiter = ',', allow_negative_numbers = true)]
    pub albedo: Vec<f64>,

    /// Stop a method at an albedo after this many products with K
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = products, allow_negative_numbers = true)]
    #[arg(requires = "albedo")]
    pub max_products: u64,

    /// Most samples a bundle for the walks on the matrix
    #[arg(long, value_name = "N", default_value_t = 4096, value_parser = samples, allow_negative_numbers = true)]
    pub walk_samples: u64,

    /// Most samples a bundle for the path tracer
    #[arg(long, value_name = "N", default_value_t = 1024, value_parser = samples, allow_negative_numbers = true)]
    pub path_samples: u64,
}

#[derive(Debug, Args)]
#[command(mut_arg("scene", |scene| scene.required(false).required_unless_present("matrix")))]
pub struct Solve {
    #[command(flatten)]
    pub scene: SceneArguments,

    /// Solve L = E + K L for a K of someone else's: a file ending in .mtx, .npz or .rmx; its rows are the unknowns
    #[arg(long, value_name = "FILE", conflicts_with = "scene", requires = "emission")]
    pub matrix: Option<PathBuf>,

    /// E for --matrix, a column a band
    #[arg(long, value_name = "FILE", requires = "matrix")]
    pub emission: Option<PathBuf>,

    /// Write the JSON object to this file too, whole or not at all
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,

    #[command(flatten)]
    pub method: Method,

    /// End iterative solvers after this many products with K, converged or not
    #[arg(long, value_name = "N", value_parser = products, allow_negative_numbers = true)]
    pub max_products: Option<u64>,
}

#[derive(Debug, Args)]
pub struct Spectrum {
    #[command(flatten)]
    pub scene: SceneArguments,

    /// Leading eigenvalues and singular values to find
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = pairs, allow_negative_numbers = true)]
    pub pairs: usize,

    /// Stop at this relative residual of each
    #[arg(long, value_name = "RESIDUAL", default_value = "1e-10", value_parser = positive, allow_negative_numbers = true)]
    pub tolerance: f64,

    /// Folder to write, whole or not at all [default: out/SCENE-spectrum]
    #[arg(short, long, value_name = "FOLDER")]
    pub output: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub struct Sensitivity {
    #[command(flatten)]
    pub scene: SceneArguments,

    /// What is read: irradiance:SURFACE or radiance:SURFACE, the mean over that surface
    #[arg(long, value_name = "SENSOR")]
    pub sensor: String,

    /// The reading if a surface were another, such as floor.albedo=0.3 or lamp.emission=9,8,5 (a number, or one a band); may be
    /// given several times
    #[arg(long, value_name = "CHANGE")]
    pub what_if: Vec<String>,

    /// Write the JSON object to this file too, whole or not at all
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,

    #[command(flatten)]
    pub method: Method,
}

#[derive(Debug, Args)]
pub struct Export {
    #[command(flatten)]
    pub scene: SceneArguments,

    /// Which matrices, of K, T, F, S, E
    #[arg(long, value_name = "LETTERS", value_delimiter = ',', default_value = "K,E")]
    pub what: Vec<Letter>,

    /// mtx (Matrix Market), npz (NumPy, SciPy) or radiance
    #[arg(long, default_value = "mtx", value_parser = export::format)]
    pub format: MatrixFormat,

    /// Folder to write, whole or not at all [default: out/SCENE-matrices]
    #[arg(short, long, value_name = "FOLDER")]
    pub output: Option<PathBuf>,
}

/// Which cases.
#[derive(Debug, Args)]
pub struct Check {
    /// JSON file of cases [default: those built into the gallery]
    pub file: Option<PathBuf>,

    /// Only cases of these groups
    #[arg(long, value_name = "GROUP", value_delimiter = ',')]
    pub group: Vec<String>,

    /// Only these cases
    #[arg(long, value_name = "ID", value_delimiter = ',')]
    pub id: Vec<String>,
}

fn solver_names() -> Vec<&'static str> {
    solver::all(1.0).iter().map(|solver| solver.name()).collect()
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("expected a finite number above zero, such as 0.1 or 1e-6".to_string()),
    }
}

fn threads(text: &str) -> Result<usize, String> {
    whole(text, 1, 1024).map(|n| n as usize)
}

fn rays(text: &str) -> Result<usize, String> {
    whole(text, 1, 1 << 30).map(|n| n as usize)
}

fn pairs(text: &str) -> Result<usize, String> {
    whole(text, 1, 256).map(|n| n as usize)
}

fn samples(text: &str) -> Result<u64, String> {
    whole(text, 4, 1 << 40)
}

fn products(text: &str) -> Result<u64, String> {
    whole(text, 1, 1 << 40)
}

fn whole(text: &str, least: u64, most: u64) -> Result<u64, String> {
    match text.parse::<u64>() {
        Ok(n) if (least..=most).contains(&n) => Ok(n),
        _ => Err(format!("expected a whole number from {least} to {most}")),
    }
}

fn definition(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.is_empty() => Ok((name.to_string(), value.to_string())),
        _ => Err("expected NAME=VALUE, such as albedo=0.5".to_string()),
    }
}
