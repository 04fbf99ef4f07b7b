//! Peers in the charts: V3 in two dimensions by independent programs for public packages, which share no code with the
//! library. With the same scheme, grid and step, both must have the same error.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use examples::CaseError;
use examples::peers::Peer;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use verification::{Case, Kernel, Outcome, Problem, Scheme, Velocity};

use crate::chart::{escape, percent};
use crate::front::schemes;
use crate::job::{Job, Key};
use crate::record::Record;
use crate::sweep::{self, Chart};

/// Package of a peer and its version, if installed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Package {
    /// Peer of the package.
    pub peer: Peer,
    /// Version; none if not installed.
    pub version: Option<String>,
}

impl Package {
    /// Query all packages of this Python. Reports missing ones on standard error.
    pub fn all(python: &Path) -> Vec<Package> {
        Peer::ALL.into_iter().map(|peer| Package { peer, version: peer.version(python) }).collect()
    }
}

/// Schemes of the peer programs.
pub const SCHEMES: [Scheme; 2] = [
    Scheme::moving(Kernel::Linear, Velocity::FlipMusl),
    Scheme::moving(Kernel::Quadratic, Velocity::ApicUsl),
];

/// Measures printed by the programs, by their names in runs of this library.
const MEASURES: [&str; 4] = ["u", "u largest", "v", "stress"];

/// Series name: peer and scheme.
pub fn series(peer: Peer, scheme: &str) -> String {
    format!("{}: {scheme}", peer.name())
}

/// Split a series name into peer and scheme; no peer for series of this library.
pub fn split(name: &str) -> (Option<Peer>, &str) {
    let of = |peer: Peer| Some((Some(peer), name.strip_prefix(peer.name())?.strip_prefix(": ")?));
    Peer::ALL.into_iter().find_map(of).unwrap_or((None, name))
}

/// Cases of the sweep that the programs support.
pub fn cases(quick: bool) -> Vec<Case> {
    let of_case = |job: Job| match job {
        Job::Case(case) if SCHEMES.contains(&case.scheme) => Some(case),
        _ => None,
    };
    sweep::jobs(Problem::Axes.name(), quick).into_iter().filter_map(of_case).collect()
}

/// Key of a peer's run of a case.
pub fn key(peer: Peer, case: &Case) -> Key {
    Key { scheme: series(peer, &case.scheme.name()), ..Job::Case(*case).key() }
}

/// Return true if the run still exists.
pub fn is_known(key: &Key) -> bool {
    let (peer, scheme) = split(&key.scheme);
    peer.is_some() && SCHEMES.iter().any(|s| s.name() == scheme)
}

/// Output line of a program.
#[derive(Deserialize)]
struct Line {
    scheme: String,
    per_axis: usize,
    cells: usize,
    courant: f64,
    particles: u64,
    steps: u64,
    core_seconds: f64,
    failure: Option<String>,
    errors: BTreeMap<String, Option<f64>>,
}

/// Convert a program's output line to a run.
///
/// # Errors
/// The line is invalid or of a scheme that was not requested.
pub fn record(peer: Peer, line: Value, commit: &str) -> Result<Record, CaseError> {
    let Line { scheme, per_axis, cells, courant, particles, steps, core_seconds, failure, errors } =
        serde_json::from_value(line).map_err(|e| CaseError::Other(format!("{}: {e}", peer.name())))?;
    let unknown = || CaseError::Other(format!("{}: there is no scheme {scheme}", peer.name()));
    let found = SCHEMES.into_iter().find(|s| s.name() == scheme).ok_or_else(unknown)?;
    let case = Case { problem: Problem::Axes, scheme: found, per_axis, cells, courant };
    let mut outcome = Outcome::default();
    outcome.work.particles = particles;
    outcome.work.steps = steps;
    outcome.work.nodes = found.kernel.nodes(2);
    outcome.work.seconds = core_seconds;
    outcome.failure = failure;
    let size = |name: &str| errors.get(name).copied().flatten().unwrap_or(f64::NAN);
    outcome.measures = MEASURES.map(|name| (name, size(name))).into();
    Ok(Record::new(key(peer, &case), outcome, commit))
}

/// Run these cases and pass every completed run to `each`. Runs shorter than `brief`, s, are repeated up to `repeats`
/// times, and the minimum time is kept.
///
/// # Errors
/// The program fails, or `each` returns an error.
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

/// Find the run of this library with the same scheme, grid and step.
fn twin<'a>(theirs: &Record, ours: &[&'a Record]) -> Option<&'a Record> {
    let (_, scheme) = split(theirs.scheme());
    let key = Key { scheme: scheme.into(), ..theirs.key.clone() };
    ours.iter().copied().find(|r| r.key == key)
}

/// Agreement of a peer's series with this library.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Agreement {
    /// Number of runs of both with the error.
    pub runs: usize,
    /// Largest relative difference of the errors.
    pub difference: f64,
    /// Ratio of their core-seconds to ours, minimum and maximum.
    pub time: [f64; 2],
    /// Ratio of core-seconds for the run with most particle-steps.
    pub longest: f64,
}

/// Compare one series and error; none if there is no common run.
pub fn agreement(name: &str, theirs: &[&Record], ours: &[&Record], error: &str) -> Option<Agreement> {
    let own = theirs.iter().filter(|r| r.scheme() == name);
    let mut pairs: Vec<(u64, f64, f64)> = own
        .filter_map(|r| {
            let twin = twin(r, ours)?;
            let difference = (r.error(error)? / twin.error(error)? - 1.0).abs();
            Some((r.particles * r.steps, difference, r.core_seconds / twin.core_seconds))
        })
        .collect();
    pairs.sort_by_key(|p| p.0);
    let (_, _, longest) = *pairs.last()?;
    Some(Agreement {
        runs: pairs.len(),
        difference: pairs.iter().map(|p| p.1).fold(0.0, f64::max),
        time: [
            pairs.iter().map(|p| p.2).fold(f64::INFINITY, f64::min),
            pairs.iter().map(|p| p.2).fold(0.0, f64::max),
        ],
        longest,
    })
}

/// Round-off threshold: below it, errors differ only by the order of summation, grown over the steps of a run.
const ROUNDING: f64 = 1e-9;

/// Write the interpretation of the peers' runs in a chart.
pub fn reading(out: &mut String, chart: &Chart, theirs: &[&Record], ours: &[&Record]) {
    if theirs.is_empty() {
        return;
    }
    out.push_str(
        "<p><b>Peers.</b> Squares and diamonds are programs of ours for packages of Python (<code>benchmarks/peers</code>) on one thread: \
         the same equations, grid, particles and steps, no line shared with the library. ",
    );
    let names = schemes(theirs);
    let of_name = |name: &String| Some((name.clone(), agreement(name, theirs, ours, chart.error)?));
    let found: Vec<(String, Agreement)> = names.iter().filter_map(of_name).collect();
    if let Some(worst) = found.iter().map(|(_, a)| a.difference).reduce(f64::max) {
        let _ = write!(out, "Their errors are ours within {} of them", percent(worst));
        out.push_str(if worst < ROUNDING {
            ", which is rounding: independent programs confirm what is computed here. "
        } else {
            ", which is more than rounding: a scheme amplifies it, or one of the programs computes something else. "
        });
    }
    out.push_str(
        "Each ran with no other run beside it; they have neither lists of blocks nor books nor checks of failures, and the force field takes much of \
         everyone's time. They are neither in the grey line nor in the choices.</p><div class=\"wide\"><table><tr><th>peer</th><th>same runs</th>\
         <th>largest difference of the error</th><th>core-seconds over ours</th><th>in the longest run</th></tr>",
    );
    for (name, Agreement { runs, difference, time, longest }) in &found {
        let _ = write!(
            out,
            "<tr><td>{}</td><td>{runs}</td><td>{}</td><td>{:.2} to {:.2}</td><td>{longest:.2}</td></tr>",
            escape(name),
            percent(*difference),
            time[0],
            time[1]
        );
    }
    out.push_str("</table></div>");
}

/// List missing packages in a sentence; nothing if there are none.
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

/// List installed packages with versions.
pub fn present(packages: &[Package]) -> String {
    let with = |p: &Package| Some(format!("{} {}", p.peer.name(), escape(p.version.as_deref()?)));
    packages.iter().filter_map(with).collect::<Vec<_>>().join(", ")
}
