//! Charts of error against work: runs the sweeps and writes a page.

use std::process::ExitCode;

fn main() -> ExitCode {
    report::start()
}
