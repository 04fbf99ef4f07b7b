//! Scenes, schemes in scenes, and their verdicts.

use std::time::Instant;

/// Expected result of a scheme in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expect {
    /// Criterion met.
    Holds,
    /// Criterion not met: a known failure.
    Fails,
}

/// Limit of a criterion; NaN never meets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// Upper limit.
    AtMost(f64),
    /// Lower limit.
    AtLeast(f64),
}

impl Limit {
    /// Return true if the value meets the criterion.
    pub fn holds(self, value: f64) -> bool {
        match self {
            Limit::AtMost(most) => value <= most,
            Limit::AtLeast(least) => value >= least,
        }
    }
    /// Describe the limit.
    pub fn text(self) -> String {
        match self {
            Limit::AtMost(most) => format!("<= {}", short(most)),
            Limit::AtLeast(least) => format!(">= {}", short(least)),
        }
    }
    /// Ratio of a value to its limit: 1 at the limit, above 1 for failure.
    pub fn share(self, value: f64) -> f64 {
        match self {
            Limit::AtMost(most) => value / most,
            Limit::AtLeast(least) => least / value,
        }
    }
}

/// Format a number with three significant figures.
pub fn short(x: f64) -> String {
    match x.abs() {
        0.0 => "0".into(),
        a if (1e-3..1e5).contains(&a) => {
            let digits = (2 - a.log10().floor() as i32).max(0) as usize;
            format!("{x:.digits$}")
        }
        _ => format!("{x:.2e}"),
    }
}

/// Stop of a run: step and message.
#[derive(Clone, Debug, PartialEq)]
pub struct Stop {
    /// Step number.
    pub step: u64,
    /// Error message.
    pub what: String,
}

/// Result of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measured {
    /// Measured value; NaN for a run that stopped, unless stopping is the measure.
    pub value: f64,
    /// Number of steps.
    pub steps: u64,
    /// Stop of the run, if any.
    pub stopped: Option<Stop>,
    /// Description of the first failure of the criterion, in scenes that monitor it, or a remark.
    pub since: Option<String>,
}

impl Measured {
    /// Create a result with a value after some steps.
    pub fn new(value: f64, steps: u64) -> Self {
        Measured { value, steps, ..Measured::default() }
    }
    /// Add a stop of the run; it sets the value to NaN.
    pub fn stopped(mut self, stop: Option<Stop>) -> Self {
        if stop.is_some() {
            self.value = f64::NAN;
            self.stopped = stop;
        }
        self
    }
    /// Add the first failure of the criterion, or a remark.
    pub fn since(mut self, text: Option<String>) -> Self {
        self.since = text;
        self
    }
}

/// Size of the set of runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// Fast set for tests: a second or two per scene.
    Fast,
    /// Full set: complete duration of every scene.
    Full,
}

/// Run of a scheme in a scene.
pub type Trial = Box<dyn Fn(Size) -> Result<Measured, String>>;

/// Scheme in a scene.
pub struct Row {
    /// Scheme, kernel, particles per cell.
    pub scheme: String,
    /// Expected result.
    pub expect: Expect,
    /// Source of the expectation.
    pub source: &'static str,
    /// Known cause of an unexpected result; the result must then be unexpected.
    pub noted: Option<&'static str>,
    /// True if the note applies to the full set only, whose runs are longer.
    pub long: bool,
    /// Limit of the row, instead of that of the scene.
    pub limit: Option<Limit>,
    /// True if excluded from the fast set: takes more than a few seconds.
    pub slow: bool,
    /// Function that runs it.
    pub trial: Trial,
}

impl Row {
    /// Exclude the row from the fast set.
    pub fn slow(mut self) -> Self {
        self.slow = true;
        self
    }
    /// Note a known cause of an unexpected result. A test then fails if the result becomes as expected.
    pub fn noted(mut self, why: &'static str) -> Self {
        self.noted = Some(why);
        self
    }
    /// Note a known cause for the full set only: shorter runs are as expected.
    pub fn noted_when_long(mut self, why: &'static str) -> Self {
        self.long = true;
        self.noted(why)
    }
    /// Set a limit of the row.
    pub fn limit(mut self, limit: Limit) -> Self {
        self.limit = Some(limit);
        self
    }
}

/// Scene with known failures of methods.
pub struct Scene {
    /// Number in the list of scenes.
    pub id: &'static str,
    /// Name of the scene.
    pub name: &'static str,
    /// Description of the failure and its cause.
    pub fails: &'static str,
    /// Measured quantity.
    pub metric: &'static str,
    /// Limit of the criterion.
    pub limit: Limit,
    /// Schemes with their expectations.
    pub rows: Vec<Row>,
}

impl Scene {
    /// Add a scheme that is expected to meet the criterion.
    pub fn holds(
        self,
        scheme: impl Into<String>,
        source: &'static str,
        trial: impl Fn(Size) -> Result<Measured, String> + 'static,
    ) -> Self {
        self.row(scheme.into(), Expect::Holds, source, Box::new(trial))
    }
    /// Add a scheme that is expected to fail.
    pub fn fails(
        self,
        scheme: impl Into<String>,
        source: &'static str,
        trial: impl Fn(Size) -> Result<Measured, String> + 'static,
    ) -> Self {
        self.row(scheme.into(), Expect::Fails, source, Box::new(trial))
    }
    fn row(mut self, scheme: String, expect: Expect, source: &'static str, trial: Trial) -> Self {
        self.rows.push(Row {
            scheme,
            expect,
            source,
            noted: None,
            long: false,
            limit: None,
            slow: false,
            trial,
        });
        self
    }
    /// Modify the last row.
    pub fn but(mut self, change: impl Fn(Row) -> Row) -> Self {
        if let Some(row) = self.rows.pop() {
            self.rows.push(change(row));
        }
        self
    }
    /// Run the schemes of a set.
    pub fn run(&self, size: Size) -> Vec<Judged<'_>> {
        let rows = self.rows.iter().filter(|row| size == Size::Full || !row.slow);
        rows.map(|row| Judged::of(self, row, size)).collect()
    }
}

/// Verdict on a scheme in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Criterion met, as expected.
    Pass,
    /// Criterion not met, as expected.
    FailExpected,
    /// Criterion not met, but should be.
    Regression,
    /// Criterion met, but should not be: the scene may be too weak.
    UnexpectedPass,
}

impl Verdict {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Pass => "PASS",
            Verdict::FailExpected => "FAIL-EXPECTED",
            Verdict::Regression => "REGRESSION",
            Verdict::UnexpectedPass => "UNEXPECTED-PASS",
        }
    }
}

/// Display of verdicts: name, style class, sign and meaning, worst last.
pub const SIGNS: [(&str, &str, &str, &str); 4] = [
    ("PASS", "good", "●", "holds, as expected"),
    ("FAIL-EXPECTED", "fair", "×", "fails, and that is known"),
    ("UNEXPECTED-PASS", "odd", "▲", "holds, and should fail: see its note"),
    ("REGRESSION", "bad", "■", "fails, and should hold: see its note"),
];

/// Index of the verdict of this name in [`SIGNS`].
pub fn rank(verdict: &str) -> usize {
    SIGNS.iter().position(|s| s.0 == verdict).unwrap_or(SIGNS.len() - 1)
}

/// Index of the scheme at the beginning of a row's name; the rest, after a comma, is further settings.
pub fn scheme_of(row: &str, names: &[String]) -> Option<usize> {
    names.iter().position(|n| {
        row.strip_prefix(n.as_str()).is_some_and(|rest| rest.is_empty() || rest.starts_with(','))
    })
}

/// Escape text for markup.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Row with its result and verdict.
pub struct Judged<'a> {
    /// Scene of the row.
    pub scene: &'a Scene,
    /// Row that was run.
    pub row: &'a Row,
    /// Result of the run.
    pub measured: Measured,
    /// Limit of the criterion.
    pub limit: Limit,
    /// Verdict on the row.
    pub verdict: Verdict,
    /// Known cause of an unexpected result, if noted.
    pub noted: Option<&'static str>,
    /// Run time, s.
    pub seconds: f64,
}

impl<'a> Judged<'a> {
    fn of(scene: &'a Scene, row: &'a Row, size: Size) -> Self {
        let start = Instant::now();
        let measured = (row.trial)(size).unwrap_or_else(|why| {
            Measured::default().stopped(Some(Stop { step: 0, what: format!("not set up: {why}") }))
        });
        let limit = row.limit.unwrap_or(scene.limit);
        let verdict = match (row.expect, limit.holds(measured.value)) {
            (Expect::Holds, true) => Verdict::Pass,
            (Expect::Holds, false) => Verdict::Regression,
            (Expect::Fails, false) => Verdict::FailExpected,
            (Expect::Fails, true) => Verdict::UnexpectedPass,
        };
        let noted = row.noted.filter(|_| size == Size::Full || !row.long);
        Judged { scene, row, measured, limit, verdict, noted, seconds: start.elapsed().as_secs_f64() }
    }

    /// Return true if the result is as expected.
    pub fn expected(&self) -> bool {
        matches!(self.verdict, Verdict::Pass | Verdict::FailExpected)
    }

    /// Return true if the result is as expected, or unexpected and noted. A failed setup never counts.
    pub fn known(&self) -> bool {
        let set_up = self.measured.stopped.as_ref().is_none_or(|s| s.step > 0);
        set_up && self.expected() != self.noted.is_some()
    }

    /// Format a line about the row.
    pub fn line(&self) -> String {
        let stop = self.measured.stopped.as_ref();
        let stop = stop.map_or(String::new(), |s| format!("; stopped: {}", s.what));
        let since = self.measured.since.as_ref().map_or(String::new(), |s| format!("; {s}"));
        format!(
            "{:16} {:4} {:34} {} ({}), {} steps, {:.2} s{since}{stop}",
            self.verdict.name(),
            self.scene.id,
            self.row.scheme,
            short(self.measured.value),
            self.limit.text(),
            self.measured.steps,
            self.seconds
        )
    }
}
