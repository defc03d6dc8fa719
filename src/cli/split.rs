//! `touchline split`: divides a document into work packages for several people.

use super::Outcome;
use crate::cli::terminal::document::{DocumentArg, Loaded};
use crate::cli::terminal::messages::Messages;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use touchline_core::geometry::pluralise;
use touchline_documents::exchange::write_packages;

/// Splits a document into work packages: projects with copies of their pictures that
/// `touchline merge` takes back.
#[derive(clap::Args, Debug)]
pub struct SplitArgs {
    #[command(flatten)]
    document: DocumentArg,
    /// How many frames a package has; the last one may have fewer.
    #[arg(long, value_name = "N")]
    frames: NonZeroUsize,
    /// The folder to write: package001 and so on. It must be empty or not there.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Also copy pictures that lie outside the project's folder. Another person's project may refer
    /// to any file.
    #[arg(long)]
    outside_pictures: bool,
}

/// Writes the packages.
///
/// # Errors
/// The document or a picture cannot be read, or the folder is not empty.
pub fn split(args: &SplitArgs, messages: Messages) -> anyhow::Result<Outcome> {
    let Loaded { location, document } = args.document.load(messages)?;
    anyhow::ensure!(
        !document.frames.is_empty(),
        "{} has no frames to split",
        location.file().display()
    );
    let at = document.at(location.folder());
    let counts = write_packages(at, args.frames.get(), &args.output, args.outside_pictures)?;
    let frames: usize = counts.iter().sum();
    messages.note(&format!(
        "{} in {} in {}",
        pluralise(frames, "frame"),
        pluralise(counts.len(), "package"),
        args.output.display()
    ));
    Ok(Outcome::Done)
}
