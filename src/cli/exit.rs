//! How a run ends.

use super::output;
use crate::assembly::AssemblyError;
use crate::basis::BasisError;
use crate::estimator::EstimatorError;
use crate::report::ReportError;
use crate::solver::SolveError;
use crate::study::StudyError;
use std::error::Error;
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;

/// Exit codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    Check = 2,
    Input = 4,
    Memory = 5,
    NotConverged = 6,
    Usage = 64,
    Internal = 70,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}

/// Why a run ended, for the person who ran it.
#[derive(Debug)]
pub struct Failure {
    exit: Exit,
    message: String,
}

impl Failure {
    pub fn new(exit: Exit, message: impl Into<String>) -> Self {
        Self { exit, message: message.into() }
    }

    pub fn exit(&self) -> Exit {
        self.exit
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Errors of scene files bring their own heading and position.
        if self.message.starts_with("error[") {
            return f.write_str(&self.message);
        }
        write!(f, "error: {}", self.message)
    }
}

macro_rules! exits_with {
    ($exit:expr, $($error:ty),+) => {
        $(impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                Self::new($exit, error.to_string())
            }
        })+
    };
}

exits_with!(Exit::Input, BasisError, AssemblyError, EstimatorError);

/// What stands behind most equations that cannot be solved.
pub const NO_STEADY_STATE: &str =
    "light that nothing absorbs has no steady state: is the scene closed, and as good as white?";

impl From<SolveError> for Failure {
    fn from(error: SolveError) -> Self {
        let hint = match error {
            SolveError::Factor { .. } | SolveError::Diverged { .. } | SolveError::NotPositiveDefinite { .. } => {
                format!("\n  = {NO_STEADY_STATE}")
            }
            _ => String::new(),
        };
        Self::new(Exit::NotConverged, error.to_string() + &hint)
    }
}

impl From<ReportError> for Failure {
    fn from(error: ReportError) -> Self {
        let hint = match error {
            ReportError::NotAFolder { .. } | ReportError::NotAReport { .. } => {
                "\n  = choose another folder with -o, or move what is there out of the way"
            }
            _ => "",
        };
        Self::new(Exit::Input, with_sources(&error) + hint)
    }
}

/// What an error says, and what its causes say.
fn with_sources(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        text += &format!(": {error}");
        cause = error.source();
    }
    text
}

impl From<StudyError> for Failure {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::Solve(error) => error.into(),
            StudyError::NoSolver | StudyError::NoEstimator | StudyError::Merge(_) => {
                Self::new(Exit::Internal, error.to_string())
            }
            other => Self::new(Exit::Input, other.to_string()),
        }
    }
}

/// Prints what clap has to say: help and version are no errors.
pub fn usage(error: &clap::Error) -> ExitCode {
    let is_error = error.use_stderr();
    if error.print().is_err() || is_error { Exit::Usage.into() } else { ExitCode::SUCCESS }
}

/// Runs, and turns a panic into a message and the code for a defect of this program.
pub fn catch(run: impl FnOnce() -> Result<(), Failure>) -> Result<(), Failure> {
    let default = std::panic::take_hook();
    std::panic::set_hook(Box::new(|panic| {
        let place = panic.location().map(|l| format!("{}:{}", l.file(), l.line())).unwrap_or_default();
        let said = panic.payload().downcast_ref::<&str>().copied();
        let said = said.or_else(|| panic.payload().downcast_ref::<String>().map(String::as_str));
        output::error(&format!("internal error at {place}: {}", said.unwrap_or("unknown")));
    }));
    let result = catch_unwind(AssertUnwindSafe(run));
    std::panic::set_hook(default);
    let defect = "this is a defect of etendue, not of your input; please report it with the command line";
    result.unwrap_or_else(|_| Err(Failure::new(Exit::Internal, defect)))
}
