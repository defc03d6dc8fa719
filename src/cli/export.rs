//! `touchline export`: the document in another format.

use super::Outcome;
use super::document::{DocumentArg, DocumentOutput, Loaded};
use super::messages::Messages;

/// Writes a document in another format.
#[derive(clap::Args, Debug)]
pub struct ExportArgs {
    #[command(flatten)]
    document: DocumentArg,
    /// The format.
    #[arg(long, value_enum)]
    format: Format,
    #[command(flatten)]
    output: DocumentOutput,
}

/// The formats that a document can be written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Format {
    /// A dataset: one file of the document's own schema, without unnamed clicks.
    Json,
}

/// Carries out the command.
///
/// # Errors
/// The document cannot be read, or the result cannot be written.
pub fn export(args: &ExportArgs, messages: Messages) -> anyhow::Result<Outcome> {
    args.output.refuse_existing()?;
    let Loaded { location, document } = args.document.load(messages)?;
    match args.format {
        Format::Json => args.output.write(&document.to_dataset(), location.folder())?,
    }
    Ok(Outcome::Done)
}
