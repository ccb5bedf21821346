//! Progress bars, on a terminal only.

use super::arguments::Arguments;
use super::output;
use crate::study::Watch;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// One bar a stage; lines beside it where `--verbose` asks for them.
pub struct Bars {
    visible: bool,
    verbosity: u8,
    current: Mutex<Option<Stage>>,
}

/// The stage at work.
struct Stage {
    name: String,
    start: Instant,
    /// None off the terminal, and while nothing is left to do.
    bar: Option<ProgressBar>,
    finished: Option<Duration>,
}

/// Steps of a bar.
const STEPS: u64 = 1000;

impl Bars {
    pub fn new(arguments: &Arguments) -> Self {
        let visible = !arguments.quiet && std::io::stderr().is_terminal();
        Self { visible, verbosity: arguments.verbose, current: Mutex::new(None) }
    }

    fn begin(&self, name: &str) -> Stage {
        if self.verbosity > 1 {
            output::error(&format!("{name:>16}  …"));
        }
        Stage { name: name.to_string(), start: Instant::now(), bar: None, finished: None }
    }

    fn end(&self, stage: Stage) {
        if let Some(bar) = &stage.bar {
            bar.finish_and_clear();
        }
        if let (Some(took), true) = (stage.finished, self.verbosity > 0) {
            output::error(&format!("{:>16}  {:.2} s", stage.name, took.as_secs_f64()));
        }
    }
}

fn bar(stage: &str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::stderr());
    let template = "{prefix:>16} {bar:32.cyan/black.bright} {percent:>3} %  {elapsed} of about {duration}";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style.progress_chars("━━─"));
    }
    bar.set_prefix(stage.to_string());
    bar.enable_steady_tick(Duration::from_millis(250));
    bar
}

impl Watch for Bars {
    fn progress(&self, name: &str, done: f64) {
        let Ok(mut current) = self.current.lock() else { return };

        // A new name ends the stage before; one stage may reach its end several times, once a part.
        if current.as_ref().is_none_or(|stage| stage.name != name) {
            if let Some(before) = current.take() {
                self.end(before);
            }
            *current = Some(self.begin(name));
        }
        let Some(stage) = current.as_mut() else { return };
        if done >= 1.0 {
            stage.finished = Some(stage.start.elapsed());
            if let Some(bar) = stage.bar.take() {
                bar.finish_and_clear();
            }
        } else if self.visible {
            stage.bar.get_or_insert_with(|| bar(name)).set_position((done * STEPS as f64) as u64);
        }
    }
}

impl Drop for Bars {
    fn drop(&mut self) {
        let last = self.current.lock().ok().and_then(|mut current| current.take());
        if let Some(last) = last {
            self.end(last);
        }
    }
}
