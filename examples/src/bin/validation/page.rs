//! The page and the table.

use std::path::Path;

use examples::CaseError;
use serde_json::Value;

use crate::runs::Run;

/// Write `validation.md` and `validation.csv`.
///
/// # Errors
/// A file or folder that cannot be written.
pub fn write(runs: &[Run], folder: &Path) -> Result<(), CaseError> {
    std::fs::create_dir_all(folder)
        .map_err(|source| CaseError::File { path: folder.to_path_buf(), source })?;
    for (name, text) in [("validation.md", page(runs)), ("validation.csv", table(runs))] {
        let path = folder.join(name);
        std::fs::write(&path, text).map_err(|source| CaseError::File { path, source })?;
    }
    Ok(())
}

fn page(runs: &[Run]) -> String {
    let mut text = String::from(
        "# Validation\n\n\
         Written by `cargo build --release -p examples --bins && cargo run --release -p examples --bin validation`; \
         do not edit. A row is a number of a case beside what it should be. **Marks**: [S] printed in the source, [V] \
         seen in public sources, [C] computed independently, [M] from memory of the literature: shown, never decides. \
         Core-seconds are those of the whole program, pictures included. The same rows as a table: \
         [validation.csv](validation.csv).\n\n",
    );
    let mut machines: Vec<&str> = runs.iter().map(|r| r.machine.as_str()).collect();
    let mut commits: Vec<&str> = runs.iter().map(|r| r.commit.as_str()).collect();
    for list in [&mut machines, &mut commits] {
        list.sort_unstable();
        list.dedup();
    }
    text += &format!("Machine: {}. Commit: {}.\n\n", machines.join("; "), commits.join(", "));
    text += "| case | resolution | checks met | not met | particles | core-seconds |\n|---|---|---|---|---|---|\n";
    for run in runs {
        let [met, decide, noted] = run.counts();
        let row = match &run.broken {
            Some(why) => format!("broke off: {} | | | {:.1} |", cell(why), run.core_seconds),
            None => {
                let missed = decide - met + noted;
                let missed = if missed > 0 { format!("**{missed}**") } else { "0".into() };
                let particles = run.result["particles"].as_f64().unwrap_or(0.0);
                format!("{met} of {decide} | {missed} | {particles} | {:.1} |", run.core_seconds)
            }
        };
        text += &format!("| [{}](#{}) | {} | {row}\n", run.case, run.case, run.resolution);
    }
    for run in runs.iter().filter(|r| r.broken.is_none()) {
        text += &format!("\n## {}\n\n", run.case);
        text += "| quantity | this code | reference | difference | source | verdict |\n|---|---|---|---|---|---|\n";
        for check in run.checks() {
            let unit = check["unit"].as_str().unwrap_or("-");
            let value = check["value"].as_f64().unwrap_or(f64::NAN);
            let reference = check["reference"].as_f64();
            let difference = match reference {
                Some(r) if r != 0.0 => format!("{:+.2} %", 100.0 * (value / r - 1.0)),
                _ => String::new(),
            };
            text += &format!(
                "| {} | {} | {} | {difference} | {} | {} |\n",
                cell(check["name"].as_str().unwrap_or("").trim_start_matches("NOT MET: ")),
                number(value, unit),
                reference.map_or(String::new(), |r| number(r, unit)),
                cell(check["source"].as_str().unwrap_or("")),
                verdict(check),
            );
        }
    }
    text
}

fn verdict(check: &Value) -> String {
    let allowed = check["tolerance"].as_f64().map_or(String::new(), |t| {
        if check["reference"] == 0.0 { format!(" ({t:.0e})") } else { format!(" ({} %)", short(100.0 * t)) }
    });
    let noted = check["name"].as_str().is_some_and(|n| n.starts_with("NOT MET"));
    match check["pass"].as_bool() {
        Some(true) => format!("met{allowed}"),
        Some(false) => format!("**not met**{allowed}"),
        None if noted => "**not met**".into(),
        None => "shown".into(),
    }
}

/// Without zeros at the end.
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

/// Text that a table's cell may hold.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

fn table(runs: &[Run]) -> String {
    let mut text = String::from(
        "case,resolution,quantity,unit,value,reference,tolerance,verdict,source,particles,core_seconds,commit\n",
    );
    for run in runs {
        let particles = run.result["particles"].as_f64().unwrap_or(0.0);
        let end = format!("{particles},{:.2},{}\n", run.core_seconds, run.commit);
        if let Some(why) = &run.broken {
            text += &format!("{},{},,,,,,broke off,{},{end}", run.case, run.resolution, quoted(why));
        }
        for check in run.checks() {
            let plain = |key: &str| check[key].as_f64().map_or(String::new(), |x| x.to_string());
            let words = |key: &str| quoted(check[key].as_str().unwrap_or(""));
            let verdict = match (check["pass"].as_bool(), verdict(check).contains("not met")) {
                (Some(true), _) => "met",
                (_, true) => "not met",
                _ => "shown",
            };
            text += &format!(
                "{},{},{},{},{},{},{},{verdict},{},{end}",
                run.case,
                run.resolution,
                words("name"),
                words("unit"),
                plain("value"),
                plain("reference"),
                plain("tolerance"),
                words("source"),
            );
        }
    }
    text
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "\"\""))
}
