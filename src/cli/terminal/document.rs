//! Reading and writing documents for all commands.

use super::messages::Messages;
use super::output::{ending, is_pipe_or_device, print, refuse_existing, write_file};
use anyhow::bail;
use std::path::{Path, PathBuf};
use touchline_documents::document::{Document, document_to_string};
use touchline_documents::store::{self, Location, refuse_open, write_document};

/// The document that a command reads.
#[derive(clap::Args, Debug)]
pub struct DocumentArg {
    /// The project folder, its project.json, or a dataset file.
    #[arg(value_name = "DOC")]
    pub document: PathBuf,
}

/// Where a command writes a document.
#[derive(clap::Args, Debug)]
pub struct DocumentOutput {
    /// The document to write, a file or a folder; standard output if absent.
    #[arg(short, long, value_name = "OUT")]
    pub output: Option<PathBuf>,
    /// Replace what exists.
    #[arg(long)]
    pub force: bool,
}

/// A document that has been read, and its place.
pub struct Loaded {
    /// Its file and folder.
    pub location: Location,
    /// The document, including the edits in its journal.
    pub document: Document,
}

impl DocumentArg {
    /// Reads the document and reports what was recovered from its journal.
    ///
    /// # Errors
    /// There is no document at the path, or it cannot be read.
    pub fn load(&self, messages: Messages) -> anyhow::Result<Loaded> {
        Loaded::read(&self.document, messages)
    }
}

impl Loaded {
    /// Reads the document at a path and reports what was recovered from its journal.
    ///
    /// # Errors
    /// There is no document at the path, or it cannot be read.
    pub fn read(path: &Path, messages: Messages) -> anyhow::Result<Self> {
        let (location, document, recovery) = store::read(path)?;
        if let Some(message) = recovery.message() {
            messages.note(&message);
        }
        Ok(Self { location, document })
    }
}

/// Whether a path is a project folder or a JSON file.
pub fn is_document(path: &Path) -> bool {
    path.join(store::PROJECT_FILE).is_file() || ending(path) == "json"
}

/// Refuses a document that would have to contain a path that is not UTF-8.
///
/// # Errors
/// A folder's name on the path to a frame is not UTF-8.
pub fn refuse_unwritable(document: &Document, folder: &Path) -> anyhow::Result<()> {
    match document.unwritable_path(folder) {
        Some(path) => {
            bail!(
                "{path}: a document cannot name it, for a folder's name in it is not UTF-8; rename the folder"
            )
        }
        None => Ok(()),
    }
}

impl DocumentOutput {
    /// Refuses an output that exists, or a document that another program has open. To be called
    /// before the work begins.
    ///
    /// # Errors
    /// The output exists and `--force` was not given, or another program has it open.
    pub fn refuse_existing(&self) -> anyhow::Result<()> {
        let Some(path) = self.output.as_deref() else {
            return Ok(());
        };
        refuse_existing(path, self.force)?;
        // Check now: otherwise the work of hours would be lost at the end.
        Ok(refuse_open(path)?)
    }

    /// Writes a document whose relative paths start from `folder`. They are changed so that they
    /// lead to the same files from the new place.
    ///
    /// # Errors
    /// The output exists, or cannot be written. Nothing has been changed then.
    pub fn write(&self, document: Document, folder: &Path) -> anyhow::Result<()> {
        // A pipe or a device gets the text alone. It has no folder, so that paths start from the
        // working folder, and there is nothing to lock or to keep as a backup.
        let file = self
            .output
            .as_deref()
            .filter(|path| !is_pipe_or_device(path));
        let Some(path) = file else {
            let here = std::env::current_dir()?;
            let document = document.relocate(folder, &here);
            refuse_unwritable(&document, &here)?;
            let text = document_to_string(&document)?;
            return match &self.output {
                Some(pipe) => write_file(pipe, text.as_bytes(), self.force),
                None => print(&text),
            };
        };
        refuse_existing(path, self.force)?;
        // The check before the work is repeated above, for the file may have been made since. The
        // paths can be checked only here: which folders they name depends on the place of the
        // document.
        let location = Location::for_new_document(path)?;
        let document = document.relocate(folder, location.folder());
        refuse_unwritable(&document, location.folder())?;
        Ok(write_document(&location, &document, self.force)?)
    }
}
