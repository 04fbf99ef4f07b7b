//! Reader of the output folder of a run.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde::Deserialize;

use crate::error::ReportError;
use crate::number::{quantity, real};
use crate::record::{
    Balances, Check, Column, FILE, FORMAT, Frames, HistoryRecord, PictureRecord, Progress, Record,
};

/// Result file of an example case, in its folder.
const RESULT: &str = "result.json";

impl Record {
    /// Read the record of the run in `folder` from `run.json`, or else from `result.json` of an example case, with all histories
    /// (CSV) and pictures (PNG) in the folder.
    ///
    /// # Errors
    /// A folder with neither; a file that cannot be read, is no record, or has another format version.
    pub fn open(folder: impl AsRef<Path>) -> Result<Record, ReportError> {
        let folder = folder.as_ref();
        let (record, result) = (folder.join(FILE), folder.join(RESULT));
        if record.is_file() {
            of_run(&record)
        } else if result.is_file() {
            of_case(folder, &result)
        } else {
            // Report an unreadable folder as such.
            fs::read_dir(folder).map_err(ReportError::read(folder))?;
            Err(ReportError::NoRun(folder.to_path_buf()))
        }
    }
}

fn of_run(path: &Path) -> Result<Record, ReportError> {
    #[derive(Deserialize)]
    struct Version {
        format: u64,
    }
    let text = fs::read_to_string(path).map_err(ReportError::read(path))?;
    let damaged = |error: serde_json::Error| ReportError::damaged(path, format!("no record: {error}"));
    // The version comes first, as records of other versions may have other fields.
    let Version { format } = serde_json::from_str(&text).map_err(damaged)?;
    if format != u64::from(FORMAT) {
        let why = format!("format = {format} is not allowed; it must be {FORMAT}");
        return Err(ReportError::damaged(path, why));
    }
    let record: Record = serde_json::from_str(&text).map_err(damaged)?;
    record.check_fields().map_err(|error| ReportError::damaged(path, error))?;
    Ok(record)
}

/// Result of an example case.
#[derive(Deserialize)]
struct Case {
    case: String,
    resolution: serde_json::Value,
    #[serde(default)]
    settings: serde_json::Value,
    particles: usize,
    steps: u64,
    simulated_seconds: f64,
    wall_seconds: f64,
    particle_updates_per_second: f64,
    peak_memory_bytes: usize,
    checks: Vec<Check>,
    #[serde(default)]
    not_judged: Vec<NotJudged>,
    #[serde(with = "real")]
    energy_error: f64,
    #[serde(with = "real")]
    momentum_error: f64,
}

/// Check without a verdict at the resolution of its case.
#[derive(Deserialize)]
struct NotJudged {
    name: String,
    #[serde(with = "real")]
    value: f64,
    unit: String,
    reason: String,
}

fn of_case(folder: &Path, path: &Path) -> Result<Record, ReportError> {
    let text = fs::read_to_string(path).map_err(ReportError::read(path))?;
    let case: Case = serde_json::from_str(&text)
        .map_err(|error| ReportError::damaged(path, format!("no result of a case: {error}")))?;
    let words = |value: &serde_json::Value| match value {
        serde_json::Value::String(text) => text.clone(),
        other => other.to_string(),
    };
    let mut record = Record::new(&case.case)
        .setting("resolution", words(&case.resolution), "")
        .setting("points, all simulations", case.particles, "")
        .setting("simulated time, all simulations", quantity(case.simulated_seconds, "s", 4), "")
        .checks(case.checks);
    if let serde_json::Value::Object(settings) = &case.settings {
        for (name, value) in settings {
            record = record.setting(name, words(value), "");
        }
    }
    record.balances = Some(Balances::errors(case.energy_error, case.momentum_error));
    // The file is written at the end of a case, whose simulations may end at several times.
    record.progress = Progress::Finished { time: None };
    for row in case.not_judged {
        let remark = format!("not judged at this resolution: {}", row.reason);
        record.checks.push(Check::shown(row.name, row.value, &row.unit, &remark));
    }
    record.timing.steps = case.steps;
    record.timing.stepping = Some(case.wall_seconds);
    record.timing.updates = case.wall_seconds * case.particle_updates_per_second;
    record.timing.bytes = Some(case.peak_memory_bytes);
    // The case was run by another program, possibly of another version.
    record.machine.versions.clear();
    record.machine.features.clear();
    let mut series: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for name in names(folder)? {
        let title = || name.rsplit_once('.').map_or(&*name, |(stem, _)| stem).replace('_', " ");
        if name.ends_with(".csv") {
            record.histories.push(HistoryRecord::new(title(), &name));
        } else if let Some(of) = frame_of(&name) {
            series.entry(of.into()).or_default().push(name);
        } else if name.ends_with(".png") {
            record.pictures.push(PictureRecord { file: name.clone(), caption: title() });
        }
    }
    let longest = series.into_iter().rev().max_by_key(|(_, files)| files.len());
    record.animation =
        longest.map(|(of, files)| Frames { files, caption: of.replace('_', " "), times: Vec::new() });
    record.check_fields().map_err(|error| ReportError::damaged(path, error))?;
    Ok(record)
}

/// Return the series of a frame file, `bar` for `bar_000007.png`.
fn frame_of(name: &str) -> Option<&str> {
    let (of, number) = name.strip_suffix(".png")?.rsplit_once('_')?;
    (number.len() == 6 && number.bytes().all(|b| b.is_ascii_digit())).then_some(of)
}

/// List the files in a folder, sorted; temporary files and names that are not valid UTF-8 are omitted.
pub(crate) fn names(folder: &Path) -> Result<Vec<String>, ReportError> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).map_err(ReportError::read(folder))? {
        let entry = entry.map_err(ReportError::read(folder))?;
        let file = entry.path().is_file();
        names.extend(
            entry
                .file_name()
                .into_string()
                .ok()
                .filter(|name| file && !name.ends_with(".part") && !name.starts_with('.')),
        );
    }
    names.sort();
    Ok(names)
}

/// Read the history in the CSV file `path`. An incomplete last row, as of a killed run, is ignored.
///
/// # Errors
/// A file that cannot be read; a header without names; rows of another length; a value that is neither a number nor empty.
pub fn history(path: &Path) -> Result<Vec<Column>, ReportError> {
    let text = fs::read_to_string(path).map_err(ReportError::read(path))?;
    let mut reader = csv::ReaderBuilder::new().flexible(true).from_reader(text.as_bytes());
    let damaged = |why: String| ReportError::damaged(path, why);
    let header = reader.headers().map_err(|error| damaged(error.to_string()))?.clone();
    if header.iter().all(|title| title.trim().is_empty()) {
        return Err(damaged("its first line has no names of columns".into()));
    }
    let mut columns: Vec<Column> = header.iter().map(column).collect();
    let whole = text.ends_with('\n');
    let mut rows = reader.records().enumerate().peekable();
    while let Some((n, row)) = rows.next() {
        let row = row.map_err(|error| damaged(error.to_string()))?;
        let last = rows.peek().is_none();
        if last && !whole {
            break;
        }
        let line = n + 2;
        if row.len() != columns.len() {
            return Err(damaged(format!(
                "line {line} has {} numbers, and there are {} columns",
                row.len(),
                columns.len()
            )));
        }
        for (column, cell) in columns.iter_mut().zip(&row) {
            let cell = cell.trim();
            let number = if cell.is_empty() { Ok(f64::NAN) } else { cell.parse() };
            column.values.push(number.map_err(|_| {
                damaged(format!("line {line}: {cell:?} of column `{}` is no number", column.name))
            })?);
        }
    }
    Ok(columns)
}

/// Parse `length [m]`: a name and a unit.
fn column(title: &str) -> Column {
    let parts = title.trim().strip_suffix(']').and_then(|rest| rest.rsplit_once('['));
    let (name, unit) = parts.map_or((title.trim(), "-"), |(name, unit)| (name.trim(), unit.trim()));
    Column { name: name.into(), unit: unit.into(), values: Vec::new() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    use impactite_output::History;

    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let folder = std::env::temp_dir().join(format!("impactite-report-{name}-{}", std::process::id()));
            fs::create_dir_all(&folder).expect("a folder");
            Folder(folder)
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn histories_come_back_as_they_were_written() {
        let folder = Folder::new("history");
        let path = folder.0.join("bar.csv");
        let mut file =
            History::create(&path, [("time", "s"), ("force, \"mean\"", "N"), ("ratio", "")]).expect("a file");
        let rows = [[0.0, 1.0 / 3.0, f64::NAN], [1.0e-6, -2.0e9, 5.0]];
        rows.iter().for_each(|row| file.push(row).expect("a row"));
        let read = history(&path).expect("the same");
        let titles: Vec<[&str; 2]> = read.iter().map(|c| [&*c.name, &*c.unit]).collect();
        assert_eq!(titles, [["time", "s"], ["force, \"mean\"", "N"], ["ratio", "-"]]);
        for (c, column) in read.iter().enumerate() {
            let bits = |x: &f64| x.to_bits();
            assert_eq!(
                column.values.iter().map(bits).collect::<Vec<_>>(),
                rows.iter().map(|row| row[c].to_bits()).collect::<Vec<_>>()
            );
        }
        // Incomplete last row of a killed run.
        let text = fs::read_to_string(&path).expect("text");
        fs::write(&path, format!("{text}2e-6,1,3")).expect("written");
        assert_eq!(history(&path).expect("the whole rows")[0].values, [0.0, 1.0e-6]);
        fs::write(&path, format!("{text}2e-6,broken,3\n")).expect("written");
        let error = history(&path).expect_err("no number").to_string();
        assert!(error.contains("bar.csv") && error.contains("line 4: \"broken\""), "{error}");
        fs::write(&path, format!("{text}2e-6,3\n{text}")).expect("written");
        let error = history(&path).expect_err("a short row").to_string();
        assert!(error.contains("line 4 has 2 numbers, and there are 3 columns"), "{error}");
    }

    #[test]
    fn a_folder_that_cannot_be_read_says_why() {
        let folder = Folder::new("open");
        let said = |folder: &Path| Record::open(folder).expect_err("refused").to_string();
        assert!(said(&folder.0.join("nowhere")).contains("cannot read"));
        assert!(said(&folder.0).contains("neither `run.json` nor `result.json`"));
        let run = folder.0.join(FILE);
        for (text, why) in [
            ("{", "no record"),
            ("{\"format\": 2, \"title\": 5}", "format = 2 is not allowed; it must be 1"),
            ("{\"format\": 1}", "missing field `title`"),
            ("{\"format\": 1, \"title\": \" \"}", "title = \" \" is not allowed"),
            (
                "{\"format\": 1, \"title\": \"x\", \"pictures\": [{\"file\": \"../secret.png\", \"caption\": \"\"}]}",
                "picture = \"../secret.png\" is not allowed; it must be a path within the folder",
            ),
        ] {
            fs::write(&run, text).expect("written");
            let error = said(&folder.0);
            assert!(error.contains("run.json") && error.contains(why), "{error}");
        }
    }

    #[test]
    fn a_case_has_a_record() {
        let folder = Folder::new("case");
        // Format of `Report` of the examples.
        let json = r#"{"case":"taylor_bar","resolution":"smoke","settings":{"speed":190.0,"grid":"sparse"},"particles":12,"steps":34,
            "simulated_seconds":8e-5,"wall_seconds":2.0,"particle_updates_per_second":204.0,"peak_memory_bytes":1000,
            "checks":[{"name":"length","value":0.0163,"unit":"m","reference":0.0162,"tolerance":0.02,"source":"[S]","pass":true,"known":null},
            {"name":"width","value":null,"unit":"m","reference":0.0142,"tolerance":0.02,"source":"[S]","pass":false,"known":"too coarse"}],
            "met":1,"missed":1,"shown":0,"not_judged":[{"name":"spall","value":1.0,"unit":"m","reason":"two cells"}],"energy_error":-0.012,"momentum_error":1e-15}"#;
        fs::write(folder.0.join(RESULT), json).expect("written");
        fs::write(folder.0.join("length_copper.csv"), "time [s],length [m]\n0,1\n").expect("written");
        for name in ["bar.png", "film_000001.png", "film_000000.png", "other_000000.png", "bar_12.png"] {
            fs::write(folder.0.join(name), "").expect("written");
        }
        let record = Record::open(&folder.0).expect("a record");
        assert_eq!((record.title.as_str(), record.met()), ("taylor_bar", [1, 2]));
        assert!(record.checks[1].value.is_nan());
        assert_eq!(record.checks[1].known.as_deref(), Some("too coarse"));
        assert_eq!(record.histories, [HistoryRecord::new("length copper", "length_copper.csv")]);
        let pictures: Vec<&str> = record.pictures.iter().map(|p| p.file.as_str()).collect();
        assert_eq!(pictures, ["bar.png", "bar_12.png"]);
        assert_eq!(record.animation.as_ref().expect("frames").files, ["film_000000.png", "film_000001.png"]);
        assert_eq!(
            (record.checks[2].pass, &*record.checks[2].source),
            (None, "not judged at this resolution: two cells")
        );
        assert_eq!(record.balances.and_then(|b| b.energy_error), Some(-0.012));
        assert_eq!(record.timing.rate(), Some(204.0));
    }
}
