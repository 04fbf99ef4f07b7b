//! Write the page of a finished run: `cargo run --release -p impactite-report --example page -- FOLDER`.

use std::process::ExitCode;

fn main() -> ExitCode {
    let Some(folder) = std::env::args_os().nth(1) else {
        eprintln!("the folder of a run, with its `run.json` or `result.json`, must be given");
        return ExitCode::FAILURE;
    };
    match impactite_report::write_page(std::path::Path::new(&folder)) {
        Ok(page) => {
            println!("{}", page.display());
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
