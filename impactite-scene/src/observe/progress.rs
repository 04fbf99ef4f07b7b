//! Progress bar on the terminal, progress lines in a log.

use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use super::{ObserveError, Observer, Pace, RunView};
use crate::archive::{Archive, CheckpointError};
use crate::finding::Warning;
use impactite_output as output;

/// Kind of a line of a [`Progress`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LineKind {
    /// Progress of the run.
    Progress,
    /// Warning of the run.
    Warning,
}

/// Receiver of lines.
type Sink = Box<dyn FnMut(LineKind, &str)>;

/// Observer that shows the progress of a run: a bar on a terminal, else a line every minute (time, steps, rate, expected end, energy
/// error). Each warning of the run is a line. Lines are written to the standard error stream, or [elsewhere](Progress::with_lines).
pub struct Progress {
    pace: Pace,
    bar: output::Progress,
    lines: Option<Sink>,
    every: Duration,
    /// Wall-clock time and simulated time (s) at the first observation.
    start: Option<(Instant, f64)>,
    last: Instant,
}

impl Progress {
    /// Create a bar titled `name`, or a line every minute.
    #[must_use]
    pub fn new(name: impl Into<String>) -> Self {
        Progress {
            pace: Pace::every_step(),
            bar: output::Progress::new(name),
            lines: None,
            every: Duration::from_secs(60),
            start: None,
            last: Instant::now(),
        }
    }

    /// Pass lines to `line`, for custom logs; the bar stays on the terminal.
    #[must_use]
    pub fn with_lines(self, line: impl FnMut(LineKind, &str) + 'static) -> Self {
        Progress { lines: Some(Box::new(line)), ..self }
    }

    /// Set the interval of lines where there is no bar.
    #[must_use]
    pub fn with_a_line_every(self, every: Duration) -> Self {
        Progress { every, ..self }
    }

    fn line(&mut self, kind: LineKind, text: &str) {
        match &mut self.lines {
            Some(line) => self.bar.suspend(|| line(kind, text)),
            None => self.bar.line(text),
        }
    }
}

/// Return the progress of a run as a line for a log.
fn message(now: &RunView<'_>, (start, from): (Instant, f64)) -> String {
    let (time, end) = (now.time(), now.end());
    let part = (time - from) / (end - from);
    let left = start.elapsed().as_secs_f64() * (1.0 - part) / part;
    let expected = if left.is_finite() { clock_at(left) } else { "not known yet".into() };
    let account = now.account();
    let error = match account.moves() || account.rest == 0.0 {
        true => format!("energy error {:+.2} %", 100.0 * account.energy_error()),
        false => "nothing moves".into(),
    };
    format!(
        "t = {time:.4e} of {end:.4e} s ({:.0} %), step {}, {:.1} M updates/s, end expected {expected}, {error}",
        100.0 * (time / end).clamp(0.0, 1.0),
        now.step(),
        1e-6 * now.rate(),
    )
}

/// Return the time of day (UTC) so many seconds from now and, after a day, the number of days.
fn clock_at(seconds: f64) -> String {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0.0, |t| t.as_secs_f64());
    let (today, then) = ((now / 86_400.0).floor(), now + seconds);
    let (days, minutes) = ((then / 86_400.0).floor() - today, (then / 60.0) as u64 % 1440);
    let day = if days >= 1.0 { format!(" in {days:.0} days") } else { String::new() };
    format!("{:02}:{:02} UTC{day}", minutes / 60, minutes % 60)
}

impl Observer for Progress {
    fn pace(&mut self) -> &mut Pace {
        &mut self.pace
    }
    fn observe(&mut self, now: &RunView<'_>) -> Result<(), ObserveError> {
        let start = *self.start.get_or_insert_with(|| (Instant::now(), now.time()));
        self.bar.update(now.time(), now.end(), now.step(), now.rate());
        if self.bar.is_hidden() && self.last.elapsed() >= self.every {
            self.last = Instant::now();
            self.line(LineKind::Progress, &message(now, start));
        }
        Ok(())
    }
    fn archive(&mut self, _: &mut Archive) -> Result<(), CheckpointError> {
        Ok(())
    }
    fn warned(&mut self, warning: &Warning) {
        self.line(LineKind::Warning, &format!("warning: {warning}"));
    }
    fn finish(&mut self) -> Result<(), ObserveError> {
        self.bar.finish();
        Ok(())
    }
}
