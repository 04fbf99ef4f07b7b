//! Scenes, schemes in them, and what comes of each.

use std::time::Instant;

/// What is expected of a scheme in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expect {
    /// The criterion holds.
    Holds,
    /// It does not: the failure is known.
    Fails,
}

/// When the criterion holds. What is not a number never does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// Up to this.
    AtMost(f64),
    /// From this on.
    AtLeast(f64),
}

impl Limit {
    /// Does it hold?
    pub fn holds(self, value: f64) -> bool {
        match self {
            Limit::AtMost(most) => value <= most,
            Limit::AtLeast(least) => value >= least,
        }
    }
    /// In words.
    pub fn text(self) -> String {
        match self {
            Limit::AtMost(most) => format!("<= {}", short(most)),
            Limit::AtLeast(least) => format!(">= {}", short(least)),
        }
    }
    /// How far a value is from the limit on the side where it fails: 1 at the limit, above it beyond.
    pub fn share(self, value: f64) -> f64 {
        match self {
            Limit::AtMost(most) => value / most,
            Limit::AtLeast(least) => least / value,
        }
    }
}

/// A number with three figures.
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

/// What stopped a run, and where.
#[derive(Clone, Debug, PartialEq)]
pub struct Stop {
    /// The step.
    pub step: u64,
    /// The message.
    pub what: String,
}

/// What came of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measured {
    /// The scene's measure; not a number where the run stopped and that is not what was asked for.
    pub value: f64,
    /// Steps made.
    pub steps: u64,
    /// What stopped it.
    pub stopped: Option<Stop>,
    /// When the criterion was first not met, where the scene follows it: in words.
    pub since: Option<String>,
}

impl Measured {
    /// A value after some steps.
    pub fn new(value: f64, steps: u64) -> Self {
        Measured { value, steps, ..Measured::default() }
    }
    /// With what stopped the run, which leaves no value.
    pub fn stopped(mut self, stop: Option<Stop>) -> Self {
        if stop.is_some() {
            self.value = f64::NAN;
            self.stopped = stop;
        }
        self
    }
    /// With when the criterion was first not met.
    pub fn since(mut self, text: Option<String>) -> Self {
        self.since = text;
        self
    }
}

/// How much of a scene is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// Within a second or two a scene, for tests.
    Fast,
    /// As long as the scene asks for.
    Full,
}

/// Runs a scheme in a scene.
pub type Trial = Box<dyn Fn(Size) -> Result<Measured, String>>;

/// A scheme in a scene.
pub struct Row {
    /// Scheme, kernel, particles a cell: what is tried.
    pub scheme: String,
    /// What is expected of it.
    pub expect: Expect,
    /// Where the expectation is from.
    pub source: &'static str,
    /// Why it is not as expected, if that is known; then it must not be.
    pub noted: Option<&'static str>,
    /// Does the note hold for the full set alone, whose runs are longer?
    pub long: bool,
    /// A limit of its own.
    pub limit: Option<Limit>,
    /// Left out of the fast set: takes more than a few seconds.
    pub slow: bool,
    /// Runs it.
    pub trial: Trial,
}

impl Row {
    /// Left out of the fast set.
    pub fn slow(mut self) -> Self {
        self.slow = true;
        self
    }
    /// What was found is not as expected, and known: why. A test then fails when it becomes as expected.
    pub fn noted(mut self, why: &'static str) -> Self {
        self.noted = Some(why);
        self
    }
    /// The same of the full set alone: shorter runs are as expected.
    pub fn noted_when_long(mut self, why: &'static str) -> Self {
        self.long = true;
        self.noted(why)
    }
    /// With a limit of its own.
    pub fn limit(mut self, limit: Limit) -> Self {
        self.limit = Some(limit);
        self
    }
}

/// A scene in which methods are known to fail.
pub struct Scene {
    /// Its number in the list of scenes.
    pub id: &'static str,
    /// Its name.
    pub name: &'static str,
    /// What goes wrong, and why.
    pub fails: &'static str,
    /// What is measured.
    pub metric: &'static str,
    /// When the criterion holds.
    pub limit: Limit,
    /// The schemes.
    pub rows: Vec<Row>,
}

impl Scene {
    /// With a scheme that is expected to hold.
    pub fn holds(
        self,
        scheme: impl Into<String>,
        source: &'static str,
        trial: impl Fn(Size) -> Result<Measured, String> + 'static,
    ) -> Self {
        self.row(scheme.into(), Expect::Holds, source, Box::new(trial))
    }
    /// With a scheme that is expected to fail.
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
    /// Change the last row.
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

/// What is said of a scheme in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Holds, as expected.
    Pass,
    /// Fails, as expected.
    FailExpected,
    /// Fails where it should hold.
    Regression,
    /// Holds where it should fail: the scene may be too weak.
    UnexpectedPass,
}

impl Verdict {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Pass => "PASS",
            Verdict::FailExpected => "FAIL-EXPECTED",
            Verdict::Regression => "REGRESSION",
            Verdict::UnexpectedPass => "UNEXPECTED-PASS",
        }
    }
}

/// How a verdict is shown: its name, class of style, sign and meaning, gravest last.
pub const SIGNS: [(&str, &str, &str, &str); 4] = [
    ("PASS", "good", "●", "holds, as expected"),
    ("FAIL-EXPECTED", "fair", "×", "fails, and that is known"),
    ("UNEXPECTED-PASS", "odd", "▲", "holds, and should fail: see its note"),
    ("REGRESSION", "bad", "■", "fails, and should hold: see its note"),
];

/// The place of the verdict of this name among [`SIGNS`].
pub fn rank(verdict: &str) -> usize {
    SIGNS.iter().position(|s| s.0 == verdict).unwrap_or(SIGNS.len() - 1)
}

/// Which of these schemes a row's name begins with; the rest of it, behind a comma, is what else was tried.
pub fn scheme_of(row: &str, names: &[String]) -> Option<usize> {
    names.iter().position(|n| {
        row.strip_prefix(n.as_str()).is_some_and(|rest| rest.is_empty() || rest.starts_with(','))
    })
}

/// Text that may stand in markup.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// A row, run and judged.
pub struct Judged<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The row.
    pub row: &'a Row,
    /// What came of it.
    pub measured: Measured,
    /// The limit that was asked.
    pub limit: Limit,
    /// What is said of it.
    pub verdict: Verdict,
    /// Why it is not as expected, if it is known that it is not.
    pub noted: Option<&'static str>,
    /// Seconds it took.
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

    /// Is it as expected?
    pub fn expected(&self) -> bool {
        matches!(self.verdict, Verdict::Pass | Verdict::FailExpected)
    }

    /// Is it as known: as expected, or not and noted? A scene that could not be set up is never known.
    pub fn known(&self) -> bool {
        let set_up = self.measured.stopped.as_ref().is_none_or(|s| s.step > 0);
        set_up && self.expected() != self.noted.is_some()
    }

    /// A line about it.
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
