//! Reading and writing documents for all commands.

use super::messages::Messages;
use super::output::{ending, is_pipe_or_device, print, refuse_existing, write_file};
use anyhow::bail;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use touchline_core::geometry::pluralise;
use touchline_documents::document::{Document, document_to_string};
use touchline_documents::store::{
    self, Location, OpenForWriting, Recovery, Reserved, open_for_writing, refuse_document, reserve,
    write_document,
};

/// The document that a command reads.
#[derive(clap::Args, Debug)]
pub struct DocumentArg {
    /// The project folder, its project.json, or a dataset file.
    #[arg(value_name = "DOC")]
    pub document: PathBuf,
}

/// Where a command writes a document.
#[derive(clap::Args, Debug, Default)]
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
        report_recovery(&recovery, messages);
        Ok(Self { location, document })
    }
}

fn report_recovery(recovery: &Recovery, messages: Messages) {
    if let Some(message) = recovery.message() {
        messages.note(&message);
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
    /// Checks where the result of a command goes and locks a document that is there, before the
    /// work begins. A document that is also one of the `inputs` is read here, and the result is
    /// joined with it.
    ///
    /// # Errors
    /// The output exists and `--force` was not given, is no document, or another program has it
    /// open.
    pub fn reserve(
        &self,
        command: &'static str,
        inputs: &[&Path],
        messages: Messages,
    ) -> anyhow::Result<Destination> {
        let mut destination = Destination {
            command,
            output: self.output.clone(),
            force: self.force,
            place: Place::Free,
            has_draft: AtomicBool::new(false),
            messages,
        };
        let Some(path) = self.output.as_deref() else {
            return Ok(destination);
        };
        refuse_existing(path, self.force)?;
        if is_pipe_or_device(path) {
            return Ok(destination);
        }
        // Locked now: otherwise the work of hours would be lost at the end.
        if inputs.iter().any(|input| is_same_document(input, path)) {
            let opened = open_for_writing(path)?;
            report_recovery(&opened.recovery, messages);
            destination.place = Place::Input(Box::new(opened));
        } else if let Some(reserved) = reserve(path)? {
            destination.place = Place::Other(reserved);
        }
        Ok(destination)
    }
}

impl DocumentOutput {
    /// Refuses an output for which an export is no document: one that exists without `--force`, and
    /// any document, whatever its name.
    ///
    /// # Errors
    /// It is one of these.
    pub fn refuse_for_export(&self) -> anyhow::Result<()> {
        let Some(path) = self.output.as_deref() else {
            return Ok(());
        };
        refuse_existing(path, self.force)?;
        Ok(refuse_document(path)?)
    }

    /// Refuses an output that is the input: what an export leaves out would be lost.
    ///
    /// # Errors
    /// It is the input.
    pub fn refuse_input(&self, input: &Path) -> anyhow::Result<()> {
        match &self.output {
            Some(path) if is_same_document(input, path) => bail!(
                "{} is the document that is exported; give another -o",
                path.display()
            ),
            _ => Ok(()),
        }
    }
}

/// Whether two paths lead to the same document.
fn is_same_document(one: &Path, other: &Path) -> bool {
    match [one, other].map(Location::find) {
        [Ok(one), Ok(other)] => one.is_same_document(&other),
        _ => false,
    }
}

/// Where a command writes its document, checked and locked before the work begins.
pub struct Destination {
    command: &'static str,
    output: Option<PathBuf>,
    force: bool,
    place: Place,
    /// Whether a draft of a new document was written.
    has_draft: AtomicBool,
    /// The messages of the command.
    pub messages: Messages,
}

/// What is at a destination.
enum Place {
    /// Nothing, a pipe, or standard output.
    Free,
    /// The document that the command reads.
    Input(Box<OpenForWriting>),
    /// Another document.
    Other(Reserved),
}

impl Destination {
    /// Reads an input of the command, and reports what was recovered from its journal.
    ///
    /// # Errors
    /// There is no document at the path, or it cannot be read.
    pub fn read(&self, path: &Path) -> anyhow::Result<Loaded> {
        match &self.place {
            Place::Input(opened) if is_same_document(path, opened.location.file()) => Ok(Loaded {
                location: opened.location.clone(),
                document: opened.document.clone(),
            }),
            _ => Loaded::read(path, self.messages),
        }
    }

    /// Writes a new document while the work goes on, so that a program that is killed leaves it.
    /// One that replaces another document is written at the end only, and so is text for a pipe.
    ///
    /// # Errors
    /// The output was made meanwhile, or cannot be written.
    pub fn write_draft(&self, document: &Document, folder: &Path) -> anyhow::Result<()> {
        let file = self.output.as_deref();
        let (Place::Free, Some(path)) = (&self.place, file.filter(|path| !is_pipe_or_device(path)))
        else {
            return Ok(());
        };
        let is_draft = self.has_draft.load(Ordering::Relaxed);
        if !is_draft {
            refuse_existing(path, self.force)?;
        }
        let location = Location::for_new_document(path)?;
        let document = document.clone().relocate(folder, location.folder());
        write_document(&location, &document, self.force || is_draft)?;
        self.has_draft.store(true, Ordering::Relaxed);
        Ok(())
    }

    /// Writes a document whose relative paths start from `folder`. They are changed so that they
    /// lead to the same files from the new place.
    ///
    /// # Errors
    /// The output was made meanwhile, or cannot be written. Nothing has been changed then.
    pub fn write(self, document: Document, folder: &Path) -> anyhow::Result<()> {
        // A pipe or a device gets the text alone. It has no folder, so that paths start from the
        // working folder, and there is nothing to lock or to keep as a backup.
        let file = self.output.as_deref();
        let Some(path) = file.filter(|path| !is_pipe_or_device(path)) else {
            let here = std::env::current_dir()?;
            let document = document.relocate(folder, &here);
            refuse_unwritable(&document, &here)?;
            let text = document_to_string(&document)?;
            return match &self.output {
                Some(pipe) => write_file(pipe, text.as_bytes(), self.force),
                None => print(&text),
            };
        };
        // The paths can be checked only here: which folders they name depends on the place of the
        // document.
        let relocate = |location: &Location| {
            let document = document.relocate(folder, location.folder());
            refuse_unwritable(&document, location.folder()).map(|()| document)
        };
        match self.place {
            Place::Free => {
                // A file that was made since is refused as before the work.
                let has_draft = self.has_draft.into_inner();
                if !has_draft {
                    refuse_existing(path, self.force)?;
                }
                let location = Location::for_new_document(path)?;
                write_document(&location, &relocate(&location)?, self.force || has_draft)?;
                if has_draft {
                    // The draft is no earlier version of a person. Without it there is nothing to remove.
                    let _ = std::fs::remove_file(location.backup());
                }
            }
            Place::Other(reserved) => {
                let document = relocate(reserved.location())?;
                reserved.write(&document)?;
            }
            Place::Input(opened) => {
                let document = relocate(&opened.location)?;
                let kept = opened.commit(&document, &format!("touchline {}", self.command))?;
                if let Some(first) = kept.first() {
                    self.messages.note(&format!(
                        "another program changed the document meanwhile: {} kept as it made them, \
                         the first is {first}",
                        pluralise(kept.len(), "frame")
                    ));
                }
            }
        }
        Ok(())
    }
}
