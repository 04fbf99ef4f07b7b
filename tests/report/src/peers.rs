//! Peers in the charts: V3 in the plane by programs of ours for packages that anybody can install, which share no line with
//! the library. Same scheme, same grid, same step: the same error, if both are right.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use examples::CaseError;
use examples::peers::Peer;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use verification::{Case, Kernel, Outcome, Problem, Scheme, Velocity};

use crate::chart::{escape, percent};
use crate::job::{Job, Key};
use crate::record::Record;
use crate::sweep::{self, Chart};

/// A package and its version, if the machine has it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Package {
    /// Which.
    pub peer: Peer,
    /// Version; none where it is absent.
    pub version: Option<String>,
}

impl Package {
    /// All, as this Python has them. Says on standard error what is absent.
    pub fn all(python: &Path) -> Vec<Package> {
        Peer::ALL.into_iter().map(|peer| Package { peer, version: peer.version(python) }).collect()
    }
}

/// Schemes that the programs have.
pub const SCHEMES: [Scheme; 2] = [
    Scheme::moving(Kernel::Linear, Velocity::FlipMusl),
    Scheme::moving(Kernel::Quadratic, Velocity::ApicUsl),
];

/// Measures that the programs print, by their names in our runs.
const MEASURES: [&str; 4] = ["u", "u largest", "v", "stress"];

/// The name of a series: peer and scheme.
pub fn series(peer: Peer, scheme: &str) -> String {
    format!("{}: {scheme}", peer.name())
}

/// Peer and scheme of the name of a series; no peer of one of ours.
pub fn split(name: &str) -> (Option<Peer>, &str) {
    let of = |peer: Peer| Some((Some(peer), name.strip_prefix(peer.name())?.strip_prefix(": ")?));
    Peer::ALL.into_iter().find_map(of).unwrap_or((None, name))
}

/// The cases of the sweep that the programs have.
pub fn cases(quick: bool) -> Vec<Case> {
    let of_case = |job: Job| match job {
        Job::Case(case) if SCHEMES.contains(&case.scheme) => Some(case),
        _ => None,
    };
    sweep::jobs(Problem::Axes.name(), quick).into_iter().filter_map(of_case).collect()
}

/// What a peer's run of a case is called.
pub fn key(peer: Peer, case: &Case) -> Key {
    Key { scheme: series(peer, &case.scheme.name()), ..Job::Case(*case).key() }
}

/// Is there still such a run?
pub fn is_known(key: &Key) -> bool {
    let (peer, scheme) = split(&key.scheme);
    peer.is_some() && SCHEMES.iter().any(|s| s.name() == scheme)
}

/// A line of a program.
#[derive(Deserialize)]
struct Line {
    scheme: String,
    per_axis: usize,
    cells: usize,
    courant: f64,
    particles: u64,
    steps: u64,
    core_seconds: f64,
    errors: BTreeMap<String, Option<f64>>,
}

/// The run that a program's line tells of.
///
/// # Errors
/// A line of other contents, or of a scheme that no program was asked for.
pub fn record(peer: Peer, line: Value, commit: &str) -> Result<Record, CaseError> {
    let Line { scheme, per_axis, cells, courant, particles, steps, core_seconds, errors } =
        serde_json::from_value(line).map_err(|e| CaseError::Other(format!("{}: {e}", peer.name())))?;
    let unknown = || CaseError::Other(format!("{}: there is no scheme {scheme}", peer.name()));
    let found = SCHEMES.into_iter().find(|s| s.name() == scheme).ok_or_else(unknown)?;
    let case = Case { problem: Problem::Axes, scheme: found, per_axis, cells, courant };
    let mut outcome = Outcome::default();
    outcome.work.particles = particles;
    outcome.work.steps = steps;
    outcome.work.nodes = found.kernel.nodes(2);
    outcome.work.seconds = core_seconds;
    let size = |name: &str| errors.get(name).copied().flatten().unwrap_or(f64::NAN);
    outcome.measures = MEASURES.map(|name| (name, size(name))).into();
    Ok(Record::new(key(peer, &case), outcome, commit))
}

/// Run these cases and hand over every run when it is made. Each is repeated up to so many times while it is brief (s), and
/// the least time is kept.
///
/// # Errors
/// A program that fails, and the first error of `each`.
pub fn run(
    peer: Peer,
    python: &Path,
    cases: &[Case],
    (repeats, brief): (u32, f64),
    commit: &str,
    each: &mut dyn FnMut(Record) -> Result<(), CaseError>,
) -> Result<(), CaseError> {
    let mut arguments = vec![format!("--repeat={repeats}"), format!("--brief={brief}")];
    arguments.extend(cases.iter().map(|case| {
        let Case { scheme, per_axis, cells, courant, .. } = case;
        format!("{}/{per_axis}/{cells}/{courant}", scheme.name())
    }));
    peer.run(python, "axes", &arguments, &mut |line| each(record(peer, line, commit)?))
}

/// Our run of the same scheme, grid and step.
fn twin<'a>(theirs: &Record, ours: &[&'a Record]) -> Option<&'a Record> {
    let (_, scheme) = split(theirs.scheme());
    let key = Key { scheme: scheme.into(), ..theirs.key.clone() };
    ours.iter().copied().find(|r| r.key == key)
}

/// How far a peer's series is from ours.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Agreement {
    /// Runs of both that have the error.
    pub runs: usize,
    /// The largest difference of the errors, in parts of ours.
    pub difference: f64,
    /// Their core-seconds over ours, the geometric mean.
    pub time: f64,
}

/// Of one series and error; none if no run of ours is the same.
pub fn agreement(name: &str, theirs: &[&Record], ours: &[&Record], error: &str) -> Option<Agreement> {
    let own = theirs.iter().filter(|r| r.scheme() == name);
    let pairs = own.filter_map(|r| {
        let twin = twin(r, ours)?;
        Some((r.error(error)?, twin.error(error)?, r.core_seconds / twin.core_seconds))
    });
    let (mut found, mut logarithms) = (Agreement::default(), 0.0);
    for (e, of_ours, time) in pairs {
        found.runs += 1;
        found.difference = found.difference.max((e / of_ours - 1.0).abs());
        logarithms += time.ln();
    }
    found.time = (logarithms / found.runs as f64).exp();
    (found.runs > 0).then_some(found)
}

/// What the peers' runs in a chart say.
pub fn reading(out: &mut String, chart: &Chart, theirs: &[&Record], ours: &[&Record]) {
    if theirs.is_empty() {
        return;
    }
    out.push_str(
        "<p><b>Peers.</b> Squares and diamonds are programs of ours for packages of Python (<code>benchmarks/peers</code>) on one thread; they \
         share no line with the library and solve the same equations on the same grid with the same particles and steps. ",
    );
    let mut names: Vec<&str> = theirs.iter().map(|r| r.scheme()).collect();
    names.sort_unstable();
    names.dedup();
    for name in names {
        let Some(Agreement { runs, difference, time }) = agreement(name, theirs, ours, chart.error) else {
            continue;
        };
        let _ = write!(
            out,
            "{}: in {runs} runs that both made the {} differs from ours by at most {} of it; core-seconds are {time:.2} times ours (geometric mean). ",
            escape(name),
            chart.label.split(" / ").next().unwrap_or(chart.label),
            percent(difference),
        );
    }
    out.push_str(
        "Each of them ran with no other run beside it, and has neither lists of blocks nor books nor checks of failures. They are not in the grey line \
         nor in the choices.</p>",
    );
}

/// What is absent, in a sentence; nothing if none is.
pub fn absent(packages: &[Package]) -> String {
    let gone = packages.iter().filter(|p| p.version.is_none());
    let list: Vec<String> =
        gone.map(|p| format!("{} (<code>{}</code>)", p.peer.name(), p.peer.remedy())).collect();
    if list.is_empty() {
        String::new()
    } else {
        format!(
            "Absent on the machine that made this page, so that none of its runs is new: {}.",
            list.join(", ")
        )
    }
}

/// What is there, with versions.
pub fn present(packages: &[Package]) -> String {
    let with = |p: &Package| Some(format!("{} {}", p.peer.name(), escape(p.version.as_deref()?)));
    packages.iter().filter_map(with).collect::<Vec<_>>().join(", ")
}
