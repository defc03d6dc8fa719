//! `touchline experiment`: runs the laboratory, a program of its own beside this one.

use crate::cli::Outcome;
use anyhow::{Context as _, bail};
use std::ffi::OsString;
use std::process::Command;

/// Measures the paper's tables and figures again, with the program `touchline-experiment`.
#[derive(clap::Args, Debug)]
#[command(disable_help_flag = true)]
pub struct ExperimentArgs {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, hide = true)]
    arguments: Vec<OsString>,
}

/// Hands its arguments to `touchline-experiment` in the folder of this program.
///
/// # Errors
/// That program is not there, cannot be started, or failed; it has said why then.
pub fn experiment(args: &ExperimentArgs) -> anyhow::Result<Outcome> {
    let program = std::env::current_exe()?.with_file_name(format!(
        "touchline-experiment{}",
        std::env::consts::EXE_SUFFIX
    ));
    if !program.is_file() {
        bail!(
            "the paper's tables and figures are measured by a program of the sources, which is not beside this one; \
             there, `make experiments` builds and runs it"
        );
    }
    let status = Command::new(&program)
        .args(&args.arguments)
        .status()
        .with_context(|| format!("cannot start {}", program.display()))?;
    match status.code() {
        Some(0) => Ok(Outcome::Done),
        Some(code) => std::process::exit(code),
        None => bail!("{} was ended by a signal", program.display()),
    }
}
