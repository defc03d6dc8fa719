//! Exporting and importing in the window: looked at in the background, written on request, taken
//! over in one step of undo.
//!
//! Two operations: a [`TransferLook`] makes an export, plans a dataset or reads files, and changes
//! nothing; a [`TransferWrite`] writes. A newer look replaces an older one; a write is replaced by
//! nothing, and no look begins while it lasts.

mod look;
mod words;
mod write;

pub use look::{Found, Look, TransferLook};
pub use words::{describe_bytes, in_dialog};
pub use write::TransferWrite;

use crate::app::effect::Effect;
use crate::app::operation::{Running, Slot};
use crate::app::session::{Dialog, Level};
use crate::app::{App, Question};
use look::LookAt;
use std::path::PathBuf;
use touchline_documents::document::{Document, Step};
use touchline_documents::exchange::{
    DatasetOptions, ExportOptions, Format, FrameChoice, ImportOptions,
};
use words::describe_joined;
use write::Writing;

/// The pages of the dialog.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TransferTab {
    /// The document in a foreign format.
    #[default]
    Export,
    /// A folder with labels, pictures and their card.
    Dataset,
    /// Labels of another program, joined with the document.
    Import,
}

/// What was chosen in the dialog, and what is under way.
#[derive(Debug)]
pub struct TransferState {
    /// The page.
    pub tab: TransferTab,
    /// The format of an export.
    pub format: Format,
    /// How it is exported.
    pub export: ExportOptions,
    /// How a dataset is written.
    pub dataset: DatasetOptions,
    /// A dataset that is there is replaced.
    pub replace: bool,
    /// The format of an import.
    pub import_format: Format,
    /// How files are read.
    pub import: ImportOptions,
    /// What the last look found.
    pub found: Option<Found>,
    look: Slot<TransferLook>,
    write: Slot<TransferWrite>,
}

impl Default for TransferState {
    fn default() -> Self {
        Self {
            tab: TransferTab::default(),
            format: Format::Json,
            export: ExportOptions {
                frames: FrameChoice::reviewed(),
                ..ExportOptions::default()
            },
            dataset: DatasetOptions::default(),
            replace: false,
            import_format: Format::SoccerNet,
            import: ImportOptions::default(),
            found: None,
            look: Slot::default(),
            write: Slot::default(),
        }
    }
}

impl TransferState {
    /// Whether the background looks what an export, a dataset or an import would be.
    #[must_use]
    pub const fn is_looking(&self) -> bool {
        self.look.is_running()
    }

    /// What is being written.
    #[must_use]
    pub const fn writing(&self) -> Option<&Running<TransferWrite>> {
        self.write.running()
    }
}

/// What is chosen in the dialog.
#[derive(Clone, Debug, PartialEq)]
pub enum TransferAction {
    /// Another page.
    Tab(TransferTab),
    /// Another format of an export.
    Format(Format),
    /// Other options of an export.
    Export(Box<ExportOptions>),
    /// Other options of a dataset.
    Dataset(Box<DatasetOptions>),
    /// Whether a dataset that is there is replaced.
    Replace(bool),
    /// Another format of an import.
    ImportFormat(Format),
    /// Other options of an import.
    Import(Box<ImportOptions>),
    /// A place to write to, or a file to read, is asked for.
    Choose,
    /// What was read is taken over: one step of undo.
    TakeOver,
    /// What is under way ends.
    Stop,
}

impl App {
    /// Opens the dialog on a page.
    pub(in crate::app) fn open_transfer(&mut self, tab: TransferTab) {
        self.commit_open_step();
        self.session.dialog = Some(Dialog::Transfer);
        if !self.operations.transfer.write.is_running() {
            self.operations.transfer.tab = tab;
        }
        self.look_again();
    }

    /// Takes what was chosen in the dialog.
    pub(in crate::app) fn transfer(&mut self, action: TransferAction) {
        let transfer = &mut self.operations.transfer;
        match action {
            TransferAction::Tab(tab) => transfer.tab = tab,
            TransferAction::Format(format) => transfer.format = format,
            TransferAction::Export(options) => transfer.export = *options,
            TransferAction::Dataset(options) => transfer.dataset = *options,
            TransferAction::Replace(replace) => {
                transfer.replace = replace;
                return;
            }
            TransferAction::ImportFormat(format) => transfer.import_format = format,
            TransferAction::Import(options) => transfer.import = *options,
            TransferAction::Choose => return self.choose_place(),
            TransferAction::TakeOver => return self.take_import(),
            TransferAction::Stop => return self.stop_transfer(),
        }
        self.look_again();
    }

    /// Has the background look what an export or a dataset would be; an import waits for its file.
    fn look_again(&mut self) {
        let transfer = &mut self.operations.transfer;
        transfer.found = None;
        // What is being written goes first; its end looks.
        if transfer.write.is_running() {
            return;
        }
        let at = match transfer.tab {
            TransferTab::Export => LookAt::Export {
                format: transfer.format,
                options: Box::new(transfer.export.clone()),
            },
            TransferTab::Dataset => LookAt::Dataset(Box::new(transfer.dataset.clone())),
            TransferTab::Import => {
                transfer.look.cancel();
                return;
            }
        };
        self.start_look(at);
    }

    fn start_look(&mut self, at: LookAt) {
        let Some(open) = &self.open else { return };
        let (document, folder, revision) =
            ((*open.document).clone(), open.folder.clone(), open.revision);
        self.start(TransferLook {
            document,
            folder,
            revision,
            at,
        });
    }

    fn start_write(&mut self, writing: Writing) {
        let Some(open) = &self.open else { return };
        self.operations.transfer.look.cancel();
        let (document, folder) = ((*open.document).clone(), open.folder.clone());
        self.start(TransferWrite {
            document,
            folder,
            writing,
        });
    }

    /// Asks where to write, or what to read.
    fn choose_place(&mut self) {
        let transfer = &self.operations.transfer;
        let question = match transfer.tab {
            TransferTab::Export => Question::ExportAs(transfer.format),
            TransferTab::Dataset => Question::DatasetTo,
            TransferTab::Import => Question::ImportFrom(transfer.import_format),
        };
        self.effects.push(Effect::Ask(question));
    }

    /// Takes the place that was asked for. The dialog comes back: it says what became of it.
    /// `may_replace`: whether the user was asked about a file that is there.
    pub(in crate::app) fn place_chosen(
        &mut self,
        question: Question,
        path: PathBuf,
        may_replace: bool,
    ) {
        self.session.dialog = Some(Dialog::Transfer);
        let transfer = &self.operations.transfer;
        let revision = self.open.as_ref().map(|open| open.revision);
        let found = transfer
            .found
            .as_ref()
            .filter(|found| Some(found.revision) == revision)
            .map(|found| &found.look);
        match question {
            Question::ExportAs(format) => {
                let made = match found {
                    Some(Look::Export(Ok(made))) if made.format == format => Some(made.clone()),
                    _ => None,
                };
                let options = Box::new(transfer.export.clone());
                self.start_write(Writing::Export {
                    format,
                    options,
                    made,
                    to: path,
                    replace: may_replace,
                });
            }
            Question::ImportFrom(format) => {
                let mut options = transfer.import.clone();
                if let Some(open) = &self.open {
                    options.field = open.document.field.clone();
                }
                self.start_look(LookAt::Import {
                    from: path,
                    format,
                    options: Box::new(options),
                });
            }
            _ => {
                let plan = match found {
                    Some(Look::Dataset(Ok(plan))) => Some(plan.clone()),
                    _ => None,
                };
                let options = Box::new(transfer.dataset.clone());
                self.start_write(Writing::Dataset {
                    plan,
                    options,
                    to: path,
                    replace: transfer.replace,
                });
            }
        }
    }

    fn stop_transfer(&mut self) {
        let transfer = &mut self.operations.transfer;
        if transfer.look.cancel() | transfer.write.cancel() {
            self.session
                .notify(Level::Info, "Stopped; nothing was written.");
        }
    }

    /// Takes over what was read: one step of undo.
    fn take_import(&mut self) {
        let revision = self.open.as_ref().map(|open| open.revision);
        let found = self.operations.transfer.found.take();
        let Some(Found {
            revision: then,
            look: Look::Import(Ok(joined)),
        }) = found
        else {
            return;
        };
        if Some(then) != revision {
            self.session.notify(
                Level::Info,
                "The document changed in the meantime; choose the file again.",
            );
            return;
        }
        if !self.begin_step(Step::on_document("Import labels")) {
            return;
        }
        if let Some(open) = &mut self.open {
            let Document {
                cameras, frames, ..
            } = &joined.document;
            (open.document.cameras, open.document.frames) = (cameras.clone(), frames.clone());
        }
        self.commit();
        self.session.dialog = None;
        self.session.notify(Level::Info, describe_joined(&joined));
    }
}
