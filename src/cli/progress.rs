//! Progress bars, on a terminal only.

use super::arguments::Arguments;
use super::output;
use crate::study::Watch;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// One bar a stage; a line a stage where `--verbose` asks for it.
pub struct Bars {
    visible: bool,
    lines: bool,
    current: Mutex<Option<(String, ProgressBar, Instant)>>,
}

/// Steps of a bar.
const STEPS: u64 = 1000;

impl Bars {
    pub fn new(arguments: &Arguments) -> Self {
        let visible = !arguments.quiet && std::io::stderr().is_terminal();
        Self { visible, lines: arguments.verbose > 0, current: Mutex::new(None) }
    }

    fn bar(&self, stage: &str) -> ProgressBar {
        let target = if self.visible { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(Some(STEPS), target);
        let template = "{prefix:>16} {bar:32.cyan/black.bright} {percent:>3} %  {elapsed} of about {duration}";
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style.progress_chars("━━─"));
        }
        bar.set_prefix(stage.to_string());
        bar.enable_steady_tick(Duration::from_millis(250));
        bar
    }
}

impl Watch for Bars {
    fn progress(&self, stage: &str, done: f64) {
        let Ok(mut current) = self.current.lock() else { return };
        let changed = current.as_ref().is_none_or(|(name, ..)| name != stage);
        if changed {
            *current = Some((stage.to_string(), self.bar(stage), Instant::now()));
        }
        let Some((_, bar, start)) = current.as_ref() else { return };
        bar.set_position((done * STEPS as f64) as u64);
        if done >= 1.0 {
            bar.finish_and_clear();
            if self.lines && !changed {
                output::error(&format!("{stage:>16}  {:.2} s", start.elapsed().as_secs_f64()));
            }
            *current = None;
        }
    }
}
