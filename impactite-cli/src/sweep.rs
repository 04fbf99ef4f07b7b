//! Parameter sweep: runs over lists of values.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use impactite::output::History;
use impactite::output::picture::{Axis, Chart, Marker, Panels, Picture, Series};
use impactite::scene::RunError;
use impactite_input::Source;
use impactite_report::convergence;
use serde::{Deserialize, Serialize};

use crate::CliError;
use crate::folder::{CHECKPOINT, FolderLock, RESULT, SCENE, remove};
use crate::job::{Job, Measured, Outcome};

/// Key of a sweep and its values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Values {
    /// Key, as `bodies.rod.speed`.
    pub key: String,
    /// Values, as written in scene files.
    pub list: Vec<String>,
}

/// Syntax of a key with its values.
const USAGE: &str = "write KEY=A,B,C or KEY=A..B/N UNIT, as parameters.speed=\"150..250/5 m/s\"";

impl std::str::FromStr for Values {
    type Err = String;
    /// Parse `KEY=A,B,C`, or `KEY=A..B/N UNIT` for N values from A to B in an optional unit.
    fn from_str(text: &str) -> Result<Self, String> {
        let (key, list) = text.split_once('=').ok_or(USAGE)?;
        if let Some((from, rest)) = list.split_once("..") {
            let (to, rest) = rest.split_once('/').ok_or(USAGE)?;
            let number = |s: &str| {
                let finite = s.trim().parse::<f64>().ok().filter(|x| x.is_finite());
                finite.ok_or_else(|| format!("`{s}` is no number; {USAGE}, with the unit at the end"))
            };
            let (from, to) = (number(from)?, number(to)?);
            let rest = rest.trim();
            let digits = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
            let (count, unit) = (&rest[..digits], rest[digits..].trim());
            let count: usize =
                count.parse().map_err(|_| format!("`{rest}` does not begin with a number of values"))?;
            if !(2..=1000).contains(&count) {
                return Err(format!("{count} values are not allowed; there must be 2 to 1000"));
            }
            let value = |n: usize| from + (to - from) * n as f64 / (count - 1) as f64;
            return Ok(Values {
                key: key.trim().into(),
                list: (0..count).map(|n| format!("{} {unit}", value(n)).trim().to_string()).collect(),
            });
        }
        let list: Vec<String> = list.split(',').map(|s| s.trim().to_string()).collect();
        if key.trim().is_empty() || list.iter().any(String::is_empty) {
            return Err(USAGE.into());
        }
        Ok(Values { key: key.trim().into(), list })
    }
}

/// Run of a sweep: values of the keys, and outcome.
#[derive(Clone, Debug)]
pub struct Point {
    /// Values, one per key.
    pub values: Vec<String>,
    /// Outcome, or the reason of failure.
    pub outcome: Result<Outcome, String>,
}

/// Name of the plan file in the folder of a sweep, from which the sweep is resumed.
pub const PLAN: &str = "sweep.json";
/// Names of the sweep's table and chart files.
const TABLE: &str = "sweep.csv";
const CHART: &str = "sweep.png";

/// Plan and progress of a sweep.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Plan {
    /// Name and text of the scene.
    name: String,
    scene: String,
    pub(crate) keys: Vec<Values>,
    /// Ratio of the sizes of neighbouring levels; `None` unless the sweep is a convergence study.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) ratio: Option<f64>,
    pictures: bool,
    report: bool,
    keep_checkpoint: bool,
    /// Reasons of failed runs, by run number from 1.
    failed: BTreeMap<usize, String>,
}

impl Plan {
    fn save(&self, folder: &Path) -> Result<(), CliError> {
        let text = serde_json::to_string_pretty(self).map_err(|e| CliError::option(PLAN, e.to_string()))?;
        Ok(impactite::output::write_whole(folder.join(PLAN), text + "\n")?)
    }

    /// Return all combinations of values; those of the last key vary fastest.
    fn combinations(&self) -> Vec<Vec<String>> {
        self.keys.iter().fold(vec![Vec::new()], |list, values| {
            let with = |before: &Vec<String>, v: &String| [before.clone(), vec![v.clone()]].concat();
            list.iter().flat_map(|before| values.list.iter().map(|v| with(before, v))).collect()
        })
    }
}

/// Run a scene for all combinations of values, each in a folder of its own (`001`, ...); then write the table `sweep.csv` and, for one key
/// with numbers, the chart `sweep.png`. [`resume`](crate::resume::resume) continues from the plan `sweep.json`.
///
/// A failed run is a row of NaN, and `sweep.json` has its reason; the other runs continue.
///
/// # Errors
/// Key that the scene does not have, file that cannot be written, folder locked by another run; a stop request.
pub fn sweep(base: &Job, keys: &[Values], stop: &AtomicBool) -> Result<Vec<Point>, CliError> {
    let (mut plan, _lock) = begin(base, keys, None)?;
    let points = go_on(base, &mut plan, stop)?;
    write(&base.folder, keys, &points)?;
    Ok(points)
}

/// Begin a sweep: lock its folder, remove the files of an earlier sweep and save the plan. `ratio` is the size ratio of the levels of a
/// convergence study.
pub(crate) fn begin(base: &Job, keys: &[Values], ratio: Option<f64>) -> Result<(Plan, FolderLock), CliError> {
    let plan = Plan {
        name: base.source.name.clone(),
        scene: base.source.anchored().text,
        keys: keys.to_vec(),
        ratio,
        pictures: base.pictures,
        report: base.report,
        keep_checkpoint: base.keep_checkpoint,
        failed: BTreeMap::new(),
    };
    let lock = FolderLock::new(&base.folder)?;
    sources(base, &plan)?;
    for name in [PLAN, TABLE, CHART].iter().chain(&convergence::FILES) {
        remove(&base.folder.join(name))?;
    }
    // Clear the runs of an earlier sweep, which may have had more runs.
    for number in 1.. {
        let folder = base.folder.join(run_folder(number));
        if !folder.is_dir() {
            break;
        }
        FolderLock::new(&folder)?.clear()?;
    }
    plan.save(&base.folder)?;
    Ok((plan, lock))
}

/// Reopen the sweep in a folder: its base, its plan, and the lock of the folder.
///
/// # Errors
/// Folder without a plan, or folder locked by another run.
pub(crate) fn reopen(
    folder: &Path,
    how: impl FnOnce(Job) -> Job,
) -> Result<(Job, Plan, FolderLock), CliError> {
    let path = folder.join(PLAN);
    let text = std::fs::read_to_string(&path).map_err(CliError::file(&path))?;
    let plan: Plan = serde_json::from_str(&text)
        .map_err(|e| CliError::NoResume { path: folder.into(), why: format!("`{PLAN}` is damaged: {e}") })?;
    let job = Job::new(Source::new(&plan.name, &plan.scene), folder);
    let base = how(Job {
        pictures: plan.pictures,
        report: plan.report,
        keep_checkpoint: plan.keep_checkpoint,
        ..job
    });
    Ok((base, plan, FolderLock::new(folder)?))
}

/// Return the scene of each run. Invalid scenes fail before the first run.
fn sources(base: &Job, plan: &Plan) -> Result<Vec<Source>, CliError> {
    let one = |combination: &Vec<String>| {
        let mut source = base.source.clone();
        for (values, value) in plan.keys.iter().zip(combination) {
            source = source.set(&format!("{}={value}", values.key))?;
        }
        source.parse()?;
        Ok(source)
    };
    plan.combinations().iter().map(one).collect()
}

/// Run a plan, whose folder the caller has locked.
pub(crate) fn go_on(base: &Job, plan: &mut Plan, stop: &AtomicBool) -> Result<Vec<Point>, CliError> {
    let mut points = Vec::new();
    for (n, (source, values)) in sources(base, plan)?.into_iter().zip(plan.combinations()).enumerate() {
        let number = n + 1;
        let folder = base.folder.join(run_folder(number));
        let outcome = match (done(&folder, &source), plan.failed.get(&number)) {
            (Some(outcome), _) => Ok(outcome),
            (None, Some(why)) => Err(why.clone()),
            (None, None) => {
                let pairs = plan.keys.iter().zip(&values).map(|(k, v)| format!("{} = {v}", k.key));
                tracing::info!("{}", pairs.collect::<Vec<_>>().join(", "));
                let job = Job { source, folder: folder.clone(), ..base.clone() };
                let job = match folder.join(CHECKPOINT).exists().then(|| Job::resume(&folder)) {
                    Some(Ok(there)) if there.source.resumes_as(&job.source) => Job { resume: true, ..job },
                    _ => job,
                };
                match job.run(stop) {
                    Err(CliError::Run(interrupted @ RunError::Interrupted { .. })) => {
                        tracing::warn!("`impactite resume {}` goes on with the sweep", base.folder.display());
                        return Err(interrupted.into());
                    }
                    Err(why) => {
                        // A full disk or a locked folder is retried when the sweep is resumed; an error of the scene would recur.
                        if why.is_of_the_scene() {
                            plan.failed.insert(number, why.to_string());
                            plan.save(&base.folder)?;
                        }
                        Err(why.to_string())
                    }
                    Ok(outcome) => Ok(outcome),
                }
            }
        };
        points.push(Point { values, outcome });
    }
    Ok(points)
}

/// Name of the folder of a run, numbered from 1, within that of the sweep.
pub(crate) fn run_folder(number: usize) -> String {
    format!("{number:03}")
}

/// Return the outcome of a finished run in its folder, if its scene is unchanged.
fn done(folder: &Path, source: &Source) -> Option<Outcome> {
    let text = std::fs::read_to_string(folder.join(RESULT)).ok()?;
    let scene = std::fs::read_to_string(folder.join(SCENE)).ok()?;
    (scene == source.anchored().text).then(|| serde_json::from_str(&text).ok()).flatten()
}

fn number(text: &str) -> Option<f64> {
    let number = text.trim_matches('"').split_whitespace().next()?;
    number.parse().ok()
}

/// Return the common unit of all values; "-" for plain numbers and for mixed units.
fn common_unit(values: &Values) -> &str {
    let units =
        values.list.iter().map(|v| v.trim_matches('"').split_once(' ').map_or("-", |(_, unit)| unit.trim()));
    let mut units = units.filter(|unit| !unit.is_empty());
    match units.next() {
        Some(first) if units.all(|unit| unit == first) => first,
        _ => "-",
    }
}

/// Write the table of a sweep and, for one key with numbers, its chart.
pub(crate) fn write(folder: &Path, keys: &[Values], points: &[Point]) -> Result<(), CliError> {
    let Some(first) = points.iter().find_map(|p| p.outcome.as_ref().ok()) else { return Ok(()) };
    let columns = keys.iter().map(|k| (k.key.as_str(), common_unit(k)));
    let columns =
        columns.chain(first.measures.iter().map(|Measured(name, _, unit)| (name.as_str(), unit.as_str())));
    let columns: Vec<(&str, &str)> = columns.chain([("energy error", "-"), ("time in steps", "s")]).collect();
    let mut file = History::create(folder.join(TABLE), columns)?;
    for point in points {
        let keys = point.values.iter().map(|v| number(v).unwrap_or(f64::NAN));
        let row: Vec<f64> = match &point.outcome {
            Ok(o) => {
                keys.chain(o.measures.iter().map(|m| m.1)).chain([o.energy_error, o.wall_seconds]).collect()
            }
            Err(_) => keys.chain(vec![f64::NAN; first.measures.len() + 2]).collect(),
        };
        file.push(&row)?;
    }
    let ([key], false) = (keys, first.measures.is_empty()) else { return Ok(()) };
    let done: Vec<(&Point, &Outcome)> =
        points.iter().filter_map(|p| Some((p, p.outcome.as_ref().ok()?))).collect();
    let values =
        Values { key: key.key.clone(), list: done.iter().map(|(p, _)| p.values[0].clone()).collect() };
    let of = |(m, Measured(name, _, unit)): (usize, &Measured)| {
        (name.clone(), unit.clone(), done.iter().map(|(_, o)| o.measures[m].1).collect())
    };
    let measures: Vec<(String, String, Vec<f64>)> = first.measures.iter().enumerate().map(of).collect();
    if let Some(picture) = chart(&format!("{} over {}", first.case, key.key), &values, &measures)? {
        picture.save(folder.join(CHART))?;
    }
    Ok(())
}

/// Draw a chart of measures over the values of a key; `None` for fewer than two values and for values that are no numbers. A measure
/// consists of its name, its unit, and one number per value.
///
/// # Errors
/// Picture that cannot be drawn.
pub fn chart(
    title: &str,
    values: &Values,
    measures: &[(String, String, Vec<f64>)],
) -> Result<Option<Picture>, CliError> {
    let x: Option<Vec<f64>> = values.list.iter().map(|v| number(v)).collect();
    let Some(x) = x.filter(|x| x.len() > 1 && !measures.is_empty()) else { return Ok(None) };
    let across = measures.len().min(3);
    let mut panels = Panels::new(across).title(fitting(title, WIDTH * across));
    for (name, unit, y) in measures {
        let chart = Chart::new(WIDTH, 520)
            .x(Axis::new(&values.key).unit(common_unit(values), 1.0))
            .y(Axis::new(name).unit(unit, 1.0));
        let chart = chart.series(Series::new(name, &x, y)?.marker(Marker::Circle));
        panels = panels.panel("", chart.draw()?);
    }
    Ok(Some(panels.compose()?))
}

/// Width of a chart, pixels.
const WIDTH: usize = 640;

/// Shorten a title to fit a picture of this width; its end, which contains the key, stays.
fn fitting(title: &str, width: usize) -> String {
    // Average letters of a title are at most 12 pixels wide.
    let most = width / 12;
    let letters: Vec<char> = title.chars().collect();
    if letters.len() <= most {
        return title.into();
    }
    let end = most / 2;
    let (start, rest) = (&letters[..most - end - 3], &letters[letters.len() - end..]);
    format!("{}...{}", start.iter().collect::<String>(), rest.iter().collect::<String>())
}
