//! `touchline experiment` in a program without the experiments: says how to build one with them.

use crate::cli::Outcome;
use crate::cli::terminal::messages::Messages;
use anyhow::bail;

/// Measures the paper's tables and figures again, in a program that is built with them.
#[derive(clap::Args, Debug)]
pub struct ExperimentArgs {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, hide = true)]
    _arguments: Vec<String>,
}

/// Reports that the experiments are missing.
///
/// # Errors
/// Always.
pub fn experiment(_: &ExperimentArgs, _: Messages) -> anyhow::Result<Outcome> {
    bail!(
        "this program was built without the experiments; in the sources, cargo run --release --features experiments -- experiment all -o \
         DIR measures the paper's tables and figures"
    )
}
