//! Progress of long work on standard error.

use std::{
    fmt::Display,
    io::{IsTerminal, stderr},
    sync::{Mutex, PoisonError},
    time::{Duration, Instant},
};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressFinish, ProgressStyle};

use super::message;

/// Time until the first line if there is no terminal. The time to the next line doubles.
const FIRST: Duration = Duration::from_millis(500);
/// Longest time between two lines.
const LONGEST: Duration = Duration::from_secs(60);

/// Progress of long work: a bar on a terminal, otherwise occasional lines; nothing for a quiet program. It disappears
/// when it is dropped.
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
    /// State of the lines if there is no terminal.
    lines: Option<Mutex<Lines>>,
}

/// Schedule of the lines.
#[derive(Debug)]
struct Lines {
    started: Instant,
    due: Duration,
    pause: Duration,
}

impl Progress {
    pub(super) fn new(what: &str, length: Option<u64>, is_quiet: bool) -> Self {
        let (loud, terminal) = (!is_quiet, stderr().is_terminal());
        let target = if loud && terminal {
            ProgressDrawTarget::stderr()
        } else {
            ProgressDrawTarget::hidden()
        };
        let bar = ProgressBar::with_draw_target(length, target)
            .with_style(style(length.is_some()))
            .with_message(what.to_owned())
            .with_finish(ProgressFinish::AndClear);
        let lines = Lines { started: Instant::now(), due: FIRST, pause: FIRST };
        Self { bar, lines: (loud && !terminal).then(|| Mutex::new(lines)) }
    }

    /// Sets the number of steps, if it becomes known later.
    pub fn set_length(&self, length: u64) {
        if self.bar.length().is_none() {
            self.bar.set_style(style(true));
        }
        self.bar.set_length(length);
    }

    /// Sets the number of finished steps.
    pub fn set(&self, done: u64) {
        self.bar.set_position(done);
        let Some(lines) = &self.lines else { return };
        let mut lines = lines.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(elapsed) = lines.due() {
            message::line(self.line(done, elapsed));
        }
    }

    /// Prints a message on standard error during the work.
    pub fn note(&self, text: impl Display) {
        self.bar.suspend(|| message::line(text));
    }

    /// Clears the bar while `print` writes, for example to standard output.
    pub fn suspend<T>(&self, print: impl FnOnce() -> T) -> T {
        self.bar.suspend(print)
    }

    /// Removes the bar after the work.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }

    fn line(&self, done: u64, elapsed: Duration) -> String {
        let (what, elapsed) = (self.bar.message(), elapsed.as_secs_f64());
        // Whole seconds would say nothing about work that has just begun.
        let digits = usize::from(elapsed < 10.0);
        match self.bar.length() {
            Some(length) if length > 0 => {
                let share = done as f64 / length as f64;
                let left = elapsed * (1.0 / share.max(1e-9) - 1.0).max(0.0);
                format!(
                    "{what}: {:.0} % after {elapsed:.digits$} s, {left:.0} s left",
                    100.0 * share
                )
            }
            _ => format!("{what}: {done} after {elapsed:.digits$} s"),
        }
    }
}

/// The style of a bar; without a length there is only a count.
fn style(with_length: bool) -> ProgressStyle {
    let template = if with_length {
        "{msg} {wide_bar} {percent:>3} %  {elapsed}, {eta} left"
    } else {
        "{msg}: {pos}  {elapsed}"
    };
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}

impl Lines {
    /// The time since the beginning, if a line is due.
    fn due(&mut self) -> Option<Duration> {
        let elapsed = self.started.elapsed();
        if elapsed < self.due {
            return None;
        }
        self.due = elapsed + self.pause;
        self.pause = (2 * self.pause).min(LONGEST);
        Some(elapsed)
    }
}
