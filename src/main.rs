//! The program `touchline`: the desktop app and the command line.

use std::process::ExitCode;

fn main() -> ExitCode {
    touchline::cli::run()
}
