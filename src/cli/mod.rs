//! The command line: one file per command.
//!
//! Results go to `-o` or standard output, messages and progress to standard error. Exit 0: done; 1: done, but some
//! frames could not be (they are named); 2: wrong usage or unreadable input, in one line.

mod output;
mod render;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Calibrates a pan-tilt-zoom sports camera from two clicks.
#[derive(Parser)]
#[command(name = "touchline", version, about)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    Render(render::RenderArgs),
}

/// How a command ended, when it did not fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Exit 0: all of it was done.
    Done,
    /// Exit 1: done, but some frames could not be; they have been named on standard error.
    SomeFailed,
}

/// Runs the program with the process's arguments.
#[must_use]
pub fn run() -> ExitCode {
    let cli = Cli::parse();
    let result: anyhow::Result<Outcome> = match cli.command {
        Some(Command::Render(args)) => render::render(&args),
        None => Ok(Outcome::Done),
    };
    match result {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::SomeFailed) => ExitCode::from(1),
        Err(error) => {
            eprintln!("touchline: {error:#}");
            ExitCode::from(2)
        }
    }
}
