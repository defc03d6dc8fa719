//! The laboratory as a script sees it, and the report that is committed.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test says what failed by failing"
)]

mod command;
mod committed_report;
mod given_data;
mod published_data;

use std::path::Path;
use std::process::Command;

/// What a run of the program left.
struct Ran {
    code: i32,
    stderr: String,
}

/// Runs `touchline experiment` with arguments separated by blanks, in a folder.
fn touchline(folder: &Path, arguments: &str) -> Ran {
    let arguments = arguments.split_whitespace();
    let output = Command::new(env!("CARGO_BIN_EXE_touchline-experiment"))
        .args(arguments.skip_while(|word| *word == "experiment"))
        .current_dir(folder)
        .output()
        .unwrap();
    Ran {
        code: output.status.code().unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}
