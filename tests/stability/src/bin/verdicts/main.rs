//! Runs all scenes and writes their verdicts: CSV, JSON, a table in Markdown and a page.

mod map;
mod page;
mod record;

use std::fs;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use stability::scenes;
use stability::verdict::Size;
use verification::origin::said_by;

use record::Record;

/// Verdicts on every scheme in every scene in which methods are known to fail.
#[derive(Debug, Parser)]
#[command(name = "verdicts", version)]
struct Options {
    /// The fast set of the tests instead of all
    #[arg(long)]
    quick: bool,
    /// Folder for tables and page
    #[arg(long, value_name = "DIR", default_value = "out/stability")]
    out: PathBuf,
    /// Run these scenes alone and write nothing
    #[arg(long, value_name = "ID", num_args = 1..)]
    only: Vec<String>,
}

fn main() -> ExitCode {
    match run(&Options::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// Run the scenes and write the results; return true if all rows are as expected or as noted.
fn run(options: &Options) -> Result<bool, Box<dyn std::error::Error>> {
    let size = if options.quick { Size::Fast } else { Size::Full };
    let all = scenes::all();
    if let Some(wrong) = options.only.iter().find(|id| !all.iter().any(|s| s.id == **id)) {
        let ids: Vec<_> = all.iter().map(|s| s.id).collect();
        return Err(format!("--only {wrong} is not allowed; it must be of {}", ids.join(", ")).into());
    }
    let (mut records, mut good) = (Vec::new(), true);
    for scene in all.iter().filter(|s| options.only.is_empty() || options.only.iter().any(|id| id == s.id)) {
        for judged in scene.run(size) {
            println!("{} {}", if judged.known() { "  " } else { "!!" }, judged.line());
            good &= judged.known();
            records.push(Record::of(&judged));
        }
    }
    if options.only.is_empty() {
        fs::create_dir_all(&options.out)?;
        record::write_csv(&options.out.join("stability.csv"), &records)?;
        fs::write(options.out.join("stability.json"), serde_json::to_string_pretty(&records)?)?;
        fs::write(options.out.join("stability.md"), page::markdown(&all, &records))?;
        let made = page::Making {
            commit: said_by("git", &["describe", "--always", "--dirty"]),
            date: said_by("date", &["+%Y-%m-%d"]),
            set: if options.quick { "fast" } else { "full" },
        };
        let file = options.out.join("stability.html");
        fs::write(&file, page::page(&all, &records, &made))?;
        println!("{} rows, {}", records.len(), file.display());
    }
    Ok(good)
}
