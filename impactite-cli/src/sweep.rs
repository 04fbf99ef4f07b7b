//! Runs over lists of values.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use impactite::output::History;
use impactite::output::picture::{Axis, Chart, Marker, Panels, Picture, Series};
use impactite_input::Source;

use crate::CliError;
use crate::job::{Job, Outcome};

/// One key and the values that it takes.
#[derive(Clone, Debug, PartialEq)]
pub struct Values {
    /// The key, as `bodies.rod.speed`.
    pub key: String,
    /// The values, as they are written in files.
    pub list: Vec<String>,
}

/// How values are written.
const USAGE: &str = "write KEY=A,B,C or KEY=A..B/N UNIT, as parameters.speed=\"150..250/5 m/s\"";

impl std::str::FromStr for Values {
    type Err = String;
    /// `KEY=A,B,C`, or `KEY=A..B/N UNIT` for N values from A to B in a unit, which may be left out.
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

/// A run of a sweep: the values of the keys, and what came.
#[derive(Clone, Debug)]
pub struct Point {
    /// A value a key.
    pub values: Vec<String>,
    /// What came.
    pub outcome: Result<Outcome, String>,
}

/// All combinations of values, each in a folder of its own (`001`, ...); then `sweep.csv` and, of one key with numbers, the chart `sweep.png`.
///
/// A run that fails is a row that says so; the others go on.
///
/// # Errors
/// A key that the scene has not, a file that cannot be written; asked to stop.
pub fn sweep(base: &Job, keys: &[Values], stop: &AtomicBool) -> Result<Vec<Point>, CliError> {
    let mut combinations: Vec<Vec<String>> = vec![Vec::new()];
    for values in keys {
        combinations = combinations
            .iter()
            .flat_map(|before| values.list.iter().map(|v| [before.clone(), vec![v.clone()]].concat()))
            .collect();
    }
    let sources: Result<Vec<Source>, CliError> = combinations
        .iter()
        .map(|combination| {
            let mut source = base.source.clone();
            for (values, value) in keys.iter().zip(combination) {
                source = source.set(&format!("{}={value}", values.key))?;
            }
            // What is no scene says so before the first run.
            source.parse()?;
            Ok(source)
        })
        .collect();
    let mut points = Vec::new();
    for (n, (source, values)) in sources?.into_iter().zip(combinations).enumerate() {
        let folder = base.folder.join(format!("{:03}", n + 1));
        tracing::info!(
            "{}",
            keys.iter().zip(&values).map(|(k, v)| format!("{} = {v}", k.key)).collect::<Vec<_>>().join(", ")
        );
        let outcome = Job { source, folder, ..base.clone() }.run(stop);
        if let Err(CliError::Run(interrupted @ impactite::scene::RunError::Interrupted { .. })) = outcome {
            return Err(interrupted.into());
        }
        points.push(Point { values, outcome: outcome.map_err(|e| e.to_string()) });
    }
    write(&base.folder, keys, &points)?;
    Ok(points)
}

fn number(text: &str) -> Option<f64> {
    let number = text.trim_matches('"').split_whitespace().next()?;
    number.parse().ok()
}

/// The unit that all values are written with; "-" of plain numbers, and of several units.
fn common_unit(values: &Values) -> &str {
    let units =
        values.list.iter().map(|v| v.trim_matches('"').split_once(' ').map_or("-", |(_, unit)| unit.trim()));
    let mut units = units.filter(|unit| !unit.is_empty());
    match units.next() {
        Some(first) if units.all(|unit| unit == first) => first,
        _ => "-",
    }
}

fn write(folder: &Path, keys: &[Values], points: &[Point]) -> Result<(), CliError> {
    let done: Vec<(&Point, &Outcome)> =
        points.iter().filter_map(|p| Some((p, p.outcome.as_ref().ok()?))).collect();
    let Some((_, first)) = done.first() else { return Ok(()) };
    let columns = keys.iter().map(|k| (k.key.as_str(), common_unit(k)));
    let columns = columns.chain(first.measures.iter().map(|(name, _, unit)| (name.as_str(), *unit)));
    let columns: Vec<(&str, &str)> = columns.chain([("energy error", "-"), ("time in steps", "s")]).collect();
    let mut file = History::create(folder.join("sweep.csv"), columns)?;
    for (point, outcome) in &done {
        let keys = point.values.iter().map(|v| number(v).unwrap_or(f64::NAN));
        let row: Vec<f64> = keys
            .chain(outcome.measures.iter().map(|m| m.1))
            .chain([outcome.energy_error, outcome.wall_seconds])
            .collect();
        file.push(&row)?;
    }
    let ([key], false) = (keys, first.measures.is_empty()) else { return Ok(()) };
    let list = done.iter().map(|(p, _)| p.values[0].clone()).collect();
    let values = Values { key: key.key.clone(), list };
    let measures: Vec<(String, String, Vec<f64>)> = first
        .measures
        .iter()
        .enumerate()
        .map(|(m, (name, _, unit))| {
            (name.clone(), unit.to_string(), done.iter().map(|(_, o)| o.measures[m].1).collect())
        })
        .collect();
    if let Some(picture) = chart(&format!("{} over {}", first.case, key.key), &values, &measures)? {
        picture.save(folder.join("sweep.png"))?;
    }
    Ok(())
}

/// Chart of measures over the values of a key; None for fewer than two values and for values that are no numbers. A measure is its name, its
/// unit, and one number per value.
///
/// # Errors
/// A picture that cannot be drawn.
pub fn chart(
    title: &str,
    values: &Values,
    measures: &[(String, String, Vec<f64>)],
) -> Result<Option<Picture>, CliError> {
    let x: Option<Vec<f64>> = values.list.iter().map(|v| number(v)).collect();
    let Some(x) = x.filter(|x| x.len() > 1 && !measures.is_empty()) else { return Ok(None) };
    let mut panels = Panels::new(measures.len().min(3)).title(title);
    for (name, unit, y) in measures {
        let chart = Chart::new(640, 520)
            .x(Axis::new(&values.key).unit(common_unit(values), 1.0))
            .y(Axis::new(name).unit(unit, 1.0));
        let chart = chart.series(Series::new(name, &x, y)?.marker(Marker::Circle));
        panels = panels.panel("", chart.draw()?);
    }
    Ok(Some(panels.compose()?))
}
