//! A progress bar on the terminal.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Progress bar of a run: simulated time, step, particle updates per second and remaining time. It draws
/// to the standard error stream, at most ten times a second, and is hidden if that is no terminal, so that
/// logs stay clean.
///
/// ```
/// use impactite_output::Progress;
/// let mut progress = Progress::new("Taylor bar");
/// progress.update(2.0e-5, 8.0e-5, 310, 2.7e7);
/// progress.finish();
/// ```
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
    last: Option<Instant>,
}

const TICKS: u64 = 1000;

impl Progress {
    /// Create a bar titled `name`, hidden if the standard error stream is no terminal.
    #[must_use]
    pub fn new(name: impl Into<String>) -> Self {
        if std::io::stderr().is_terminal() {
            Self::on(ProgressDrawTarget::stderr_with_hz(10), name)
        } else {
            Self::hidden()
        }
    }

    /// Create a hidden bar.
    #[must_use]
    pub fn hidden() -> Self {
        Self::on(ProgressDrawTarget::hidden(), "")
    }

    fn on(target: ProgressDrawTarget, name: impl Into<String>) -> Self {
        let bar = ProgressBar::with_draw_target(Some(TICKS), target).with_prefix(name.into());
        if let Ok(style) = ProgressStyle::with_template("{prefix} {wide_bar:.cyan/238} {percent:>3} %  {msg}")
        {
            bar.set_style(style.progress_chars("━╸─"));
        }
        Self { bar, last: None }
    }

    /// True if nothing is drawn.
    #[must_use]
    pub fn is_hidden(&self) -> bool {
        self.bar.is_hidden()
    }

    /// Update the bar: simulated `time` of `end` (s), `step` steps, `rate` particle updates per second. Cheap enough
    /// for a call every step.
    pub fn update(&mut self, time: f64, end: f64, step: u64, rate: f64) {
        if self.is_hidden() || self.last.is_some_and(|last| last.elapsed() < Duration::from_millis(100)) {
            return;
        }
        self.last = Some(Instant::now());
        let part = fraction(time, end);
        self.bar.set_position((part * TICKS as f64) as u64);
        self.bar.set_message(message(time, end, step, rate, self.bar.elapsed()));
    }

    /// Write a line to the standard error stream, above a visible bar.
    pub fn line(&self, text: &str) {
        self.bar.suspend(|| eprintln!("{text}"));
    }

    /// Hide the bar during `write`.
    pub fn suspend<R>(&self, write: impl FnOnce() -> R) -> R {
        self.bar.suspend(write)
    }

    /// Leave the bar in its current state and start a new line.
    pub fn finish(&mut self) {
        self.bar.abandon();
    }
}

/// Completed fraction of the run, 0 to 1.
fn fraction(time: f64, end: f64) -> f64 {
    let part = time / end;
    if part.is_finite() { part.clamp(0.0, 1.0) } else { 0.0 }
}

/// Format the text to the right of the bar.
fn message(time: f64, end: f64, step: u64, rate: f64, elapsed: Duration) -> String {
    let part = fraction(time, end);
    let left = if part > 0.0 {
        let seconds = elapsed.as_secs_f64() * (1.0 - part) / part;
        match seconds {
            s if s < 100.0 => format!("{s:.0} s left"),
            s if s < 6000.0 => format!("{:.0} min left", s / 60.0),
            s => format!("{:.1} h left", s / 3600.0),
        }
    } else {
        "starting".to_string()
    };
    let (unit, scale) = super::picture::time_unit(end);
    format!(
        "{:.4} of {:.4} {unit}, step {step}, {:.1} M updates/s, {left}",
        time * scale,
        end * scale,
        rate * 1e-6
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_message_names_time_step_and_rate() {
        let text = message(2.0e-5, 8.0e-5, 310, 2.71e7, Duration::from_secs(10));
        assert_eq!(text, "20.0000 of 80.0000 µs, step 310, 27.1 M updates/s, 30 s left");
    }

    #[test]
    fn a_run_without_an_end_is_at_its_beginning() {
        assert_eq!(fraction(1.0, 0.0), 0.0);
        assert_eq!(fraction(f64::NAN, 1.0), 0.0);
        assert_eq!(fraction(3.0, 1.0), 1.0);
    }
}
