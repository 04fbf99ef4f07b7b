//! Error-work charts: runs the sweeps and writes a page.

use std::process::ExitCode;

fn main() -> ExitCode {
    report::start()
}
