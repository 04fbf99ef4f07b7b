//! Validation page and table.

use std::path::Path;

use examples::CaseError;
use mpm_core::output::write_whole;
use serde_json::Value;

use crate::runs::{CASES, Counts, Run};

/// Commit and machine of the runs.
#[derive(Clone, Debug)]
pub struct Made {
    /// Full hash of the single commit.
    pub commit: String,
    pub machine: String,
    /// True if the programs were not built for the page.
    pub as_built: bool,
}

/// Write `validation.md` and `validation.csv`.
///
/// # Errors
/// File or folder that cannot be written.
pub fn write(made: &Made, runs: &[Run], folder: &Path) -> Result<(), CaseError> {
    std::fs::create_dir_all(folder)
        .map_err(|source| CaseError::File { path: folder.to_path_buf(), source })?;
    for (name, text) in [("validation.md", page(made, runs)), ("validation.csv", table(runs))] {
        write_whole(folder.join(name), text)?;
    }
    Ok(())
}

fn page(made: &Made, runs: &[Run]) -> String {
    let mut text = format!("# Validation\n\nCommit {}.", made.commit);
    if made.as_built {
        text += " Programs as they were built, which may have been of another commit.";
    }
    text += &format!(" Machine: {}. {} of {} cases.\n\n", made.machine, runs.len(), CASES.len());
    text += "Written by `cargo run --release -p examples --bin validation`, which builds and runs the cases and takes a working \
             tree without changes only; do not edit. A row is a number of a case beside what it should be. **Marks**: [S] printed \
             in the source, [V] seen in public sources, [C] computed independently, [M] from memory of the literature: shown, \
             never judged. Counts are of all rows with a reference; missed ones stand first. **Declared** are those that are \
             known to be missed, with the reason; they count as missed. Core-seconds are those of the whole program, pictures \
             included. The same rows as a table: [validation.csv](validation.csv).\n\n";
    text += "| case | resolution | met | missed | of them declared | shown, not judged | not judged at this resolution | particles \
             | core-seconds |\n|---|---|---|---|---|---|---|---|---|\n";
    for run in runs {
        let row = match &run.broken {
            Some(why) => format!("broke off: {} | | | | | | {:.1} |", cell(why), run.core_seconds),
            None => {
                let Counts { met, missed, declared, shown, unjudged } = run.counts();
                let all = met + missed;
                let missed = if missed > 0 { format!("**{missed}**") } else { "0".into() };
                let particles = run.result["particles"].as_f64().unwrap_or(0.0);
                let seconds = run.core_seconds;
                format!(
                    "{met} of {all} | {missed} | {declared} | {shown} | {unjudged} | {particles} | {seconds:.1} |"
                )
            }
        };
        text += &format!("| [{}](#{}) | {} | {row}\n", run.case, run.case, run.resolution);
    }
    for run in runs.iter().filter(|r| r.broken.is_none()) {
        text += &section(run);
    }
    text
}

/// Format the rows of a case.
fn section(run: &Run) -> String {
    let mut text = format!("\n## {}\n", run.case);
    let head = "| quantity | this code | reference | difference | source | met or not |\n|---|---|---|---|---|---|\n";
    let of = |judged: bool| run.checks().iter().filter(move |c| c["pass"].is_boolean() == judged);
    for (judged, title) in
        [(true, ""), (false, "Shown, not judged: from memory, or without a reference.\n\n")]
    {
        if of(judged).next().is_some() {
            text += &format!("\n{title}{head}");
        }
        for check in of(judged) {
            let unit = check["unit"].as_str().unwrap_or("-");
            let value = check["value"].as_f64().unwrap_or(f64::NAN);
            let reference = check["reference"].as_f64();
            let difference = match reference {
                Some(r) if r != 0.0 => format!("{:+.2} %", 100.0 * (value / r - 1.0)),
                _ => String::new(),
            };
            text += &format!(
                "| {} | {} | {} | {difference} | {} | {} |\n",
                cell(check["name"].as_str().unwrap_or("")),
                number(value, unit),
                reference.map_or(String::new(), |r| number(r, unit)),
                cell(check["source"].as_str().unwrap_or("")),
                cell(&verdict(check)),
            );
        }
    }
    for row in run.unjudged() {
        let [name, unit, reason] = ["name", "unit", "reason"].map(|key| row[key].as_str().unwrap_or(""));
        let value = number(row["value"].as_f64().unwrap_or(f64::NAN), unit);
        text += &format!("\nNot judged at this resolution: {name}, {value}: {reason}.\n");
    }
    text
}

fn verdict(check: &Value) -> String {
    let allowed = check["tolerance"].as_f64().map_or(String::new(), |t| {
        if check["reference"] == 0.0 { format!(" ({t:.0e})") } else { format!(" ({} %)", short(100.0 * t)) }
    });
    let reason = check["known"].as_str();
    match (check["pass"].as_bool(), reason) {
        (Some(true), None) => format!("met{allowed}"),
        (Some(true), Some(reason)) => format!("met{allowed} (declared as missed: {reason})"),
        (Some(false), None) => format!("**missed**{allowed}"),
        (Some(false), Some(reason)) => format!("**missed**{allowed}; declared: {reason}"),
        (None, _) => "shown".into(),
    }
}

/// Format a number without trailing zeros.
fn short(x: f64) -> String {
    let text = format!("{x:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_string()
}

fn number(x: f64, unit: &str) -> String {
    let text = match x.abs() {
        0.0 => "0".to_string(),
        a if (0.01..1e5).contains(&a) => format!("{x:.3}"),
        _ => format!("{x:.2e}"),
    };
    if unit == "-" { text } else { format!("{text} {unit}") }
}

/// Escape text for the cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

fn table(runs: &[Run]) -> String {
    let mut text = String::from(
        "case,resolution,quantity,unit,value,reference,tolerance,verdict,declared,source,particles,core_seconds\n",
    );
    for run in runs {
        let particles = run.result["particles"].as_f64().unwrap_or(0.0);
        let end = format!("{particles},{:.2}\n", run.core_seconds);
        if let Some(why) = &run.broken {
            text += &format!("{},{},,,,,,broke off,,{},{end}", run.case, run.resolution, quoted(why));
        }
        for check in run.checks() {
            let plain = |key: &str| check[key].as_f64().map_or(String::new(), |x| x.to_string());
            let words = |key: &str| quoted(check[key].as_str().unwrap_or(""));
            let verdict = match check["pass"].as_bool() {
                Some(true) => "met",
                Some(false) => "missed",
                None => "shown",
            };
            text += &format!(
                "{},{},{},{},{},{},{},{verdict},{},{},{end}",
                run.case,
                run.resolution,
                words("name"),
                words("unit"),
                plain("value"),
                plain("reference"),
                plain("tolerance"),
                words("known"),
                words("source"),
            );
        }
        for row in run.unjudged() {
            let words = |key: &str| quoted(row[key].as_str().unwrap_or(""));
            let value = row["value"].as_f64().map_or(String::new(), |x| x.to_string());
            let Run { case, resolution, .. } = run;
            let [name, unit, reason] = ["name", "unit", "reason"].map(words);
            text += &format!("{case},{resolution},{name},{unit},{value},,,not judged,,{reason},{end}");
        }
    }
    text
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn runs() -> Vec<Run> {
        let row = |name: &str, pass: Option<bool>, known: Option<&str>| {
            let reference = pass.map(|_| 1.0);
            json!({ "name": name, "value": 2.0, "unit": "m", "reference": reference, "tolerance": 0.1, "source": "[C]",
                "pass": pass, "known": known })
        };
        let result = json!({
            "particles": 7,
            "checks": [
                row("bad", Some(false), None),
                row("worse", Some(false), Some("it is coarse")),
                row("good", Some(true), None),
                row("height", None, None),
            ],
            "not_judged": [{ "name": "speed", "value": 3.0, "unit": "m/s", "reason": "two cells" }],
        });
        let run = Run {
            case: "taylor_bar".into(),
            resolution: "smoke".into(),
            result,
            broken: None,
            core_seconds: 1.0,
        };
        let broken = Some("not finished after 1 s".into());
        vec![run.clone(), Run { case: "tnt_slab".into(), result: Value::Null, broken, ..run }]
    }

    fn made() -> Made {
        Made { commit: "0123456789abcdef".into(), machine: "abacus".into(), as_built: false }
    }

    #[test]
    fn the_page_counts_all_rows_and_has_the_commit_once() {
        let page = page(&made(), &runs());
        let count = CASES.len();
        let start = format!("# Validation\n\nCommit 0123456789abcdef. Machine: abacus. 2 of {count} cases.");
        assert!(page.starts_with(&start), "{page}");
        assert_eq!(page.matches("0123456789abcdef").count(), 1);
        assert!(
            page.contains("| [taylor_bar](#taylor_bar) | smoke | 1 of 3 | **2** | 1 | 1 | 1 | 7 | 1.0 |"),
            "{page}"
        );
        assert!(page.contains("| broke off: not finished after 1 s |"), "{page}");
        let at = |what: &str| page.find(what).expect(what);
        let order = ["| bad |", "| worse |", "| good |", "Shown, not judged:", "| height |"].map(at);
        assert!(order.is_sorted(), "missed ones first: {page}");
        assert!(page.contains("**missed** (10 %); declared: it is coarse |"), "{page}");
        assert!(page.contains("Not judged at this resolution: speed, 3.000 m/s: two cells."), "{page}");
    }

    #[test]
    fn the_table_has_every_row_once() {
        let table = table(&runs());
        let verdicts: Vec<&str> = table.lines().skip(1).map(|l| l.split(',').nth(7).unwrap_or("")).collect();
        assert_eq!(verdicts, ["missed", "missed", "met", "shown", "not judged", "broke off"]);
        let columns = table.lines().map(|l| l.split(',').count());
        assert!(columns.clone().all(|n| n == 12), "{table}");
    }

    #[test]
    fn programs_of_another_commit_are_not_hidden() {
        let made = Made { as_built: true, ..made() };
        assert!(page(&made, &runs()).contains("may have been of another commit"));
    }
}
