//! Export and import in the window: examined in the background, written on request, imported as one
//! step of undo.
//!
//! There are two operations. A [`TransferPreview`] makes an export, plans a dataset or reads files,
//! and changes nothing. A [`TransferWrite`] writes. A newer look replaces an older one. A write is
//! never replaced, and no look starts while it runs.

mod format_groups;
mod look;
mod words;
mod write;

pub use format_groups::{FormatGroup, formats_in, group_and_name};
pub use look::{ImportPreview, PreviewResult, RevisionPreview, TransferPreview};
pub use words::{describe_bytes, describe_survey, in_dialog};
pub use write::{TransferWrite, Written};

use crate::app::effect::Effect;
use crate::app::operation::{Running, Slot};
use crate::app::operations::{ForeignLabels, UnderWay};
use crate::app::window_state::session::{Dialog, Level};
use crate::app::{App, Command, Question};
use look::PreviewSubject;
use std::path::PathBuf;
use std::sync::Arc;
use touchline_calibration::pipelines::MendOptions;
use touchline_documents::document::{Document, Step};
use touchline_documents::exchange::{
    DatasetOptions, ExportOptions, Format, FrameChoice, ImportOptions,
};
use words::describe_joined;
use write::Writing;

/// The tabs of the dialog.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TransferTab {
    /// The document in a foreign format.
    #[default]
    Export,
    /// A folder with labels, pictures and a description.
    Dataset,
    /// Labels from another program, joined with the document.
    Import,
}

/// The user's choices in the dialog, and the running work.
#[derive(Debug)]
pub struct TransferState {
    /// The selected tab.
    pub tab: TransferTab,
    /// The format of the export.
    pub format: Format,
    /// Whether the user has chosen it, or an import of this project has.
    is_chosen: bool,
    pub export: ExportOptions,
    pub dataset: DatasetOptions,
    /// Whether an existing dataset is replaced.
    pub replace: bool,
    pub import_format: Format,
    pub import: ImportOptions,
    /// The folder of the last export or dataset that was written.
    pub written_to: Option<PathBuf>,
    /// The result of the last look.
    pub found: Option<RevisionPreview>,
    look: Slot<TransferPreview>,
    write: Slot<TransferWrite>,
}

impl Default for TransferState {
    fn default() -> Self {
        Self {
            tab: TransferTab::default(),
            format: Format::Json,
            is_chosen: false,
            export: ExportOptions {
                frames: FrameChoice::reviewed_frames(),
                ..ExportOptions::default()
            },
            dataset: DatasetOptions::default(),
            replace: false,
            import_format: Format::SoccerNet,
            import: ImportOptions::default(),
            written_to: None,
            found: None,
            look: Slot::default(),
            write: Slot::default(),
        }
    }
}

impl TransferState {
    /// Whether a look is running.
    pub const fn is_looking(&self) -> bool {
        self.look.is_running()
    }

    /// The running write with its progress, for its card.
    pub(super) fn under_way(&self) -> Option<UnderWay> {
        let running = self.write.running()?;
        let progress = running.progress();
        let step = progress.map_or_else(String::new, |written| {
            format!("{} of {} pictures", written.done, written.of)
        });
        let share = progress.map(|progress| progress.fraction());
        Some(UnderWay::new("Writing the export", step, Command::StopExport).with_share(share))
    }

    pub const fn writing(&self) -> Option<&Running<TransferWrite>> {
        self.write.running()
    }
}

/// A choice in the dialog.
#[derive(Clone, Debug, PartialEq)]
pub enum TransferAction {
    /// Select a tab.
    Tab(TransferTab),
    /// Select the format of the export.
    Format(Format),
    /// Change the options of the export.
    Export(Box<ExportOptions>),
    /// Change the options of the dataset.
    Dataset(Box<DatasetOptions>),
    /// Choose whether an existing dataset is replaced.
    Replace(bool),
    /// Select the format of the import.
    ImportFormat(Format),
    /// Change the options of the import.
    Import(Box<ImportOptions>),
    /// Ask the user for a place to write to, or for a file to read.
    Choose,
    /// Take over what was read; one step of undo.
    TakeOver,
    /// Take over what was read, and mend the cameras.
    TakeOverAndMend,
    /// Stop what is running.
    Stop,
}

impl App {
    /// Opens the dialog on a tab. While something is being written, the tab stays.
    pub(in crate::app) fn open_transfer(&mut self, tab: TransferTab) {
        self.commit_open_step();
        self.session.dialog = Some(Dialog::Transfer);
        let transfer = &mut self.operations.transfer;
        if !transfer.write.is_running() {
            transfer.tab = tab;
            // The format that was used last, in this project or another.
            let last = self.settings.formats.first();
            let last = last.and_then(|name| Format::all().find(|of| of.name() == name));
            if let Some(last) = last.filter(|_| !transfer.is_chosen) {
                transfer.format = last;
            }
        }
        self.look_again();
    }

    /// Carries out a choice in the dialog.
    pub(in crate::app) fn transfer(&mut self, action: TransferAction) {
        let transfer = &mut self.operations.transfer;
        match action {
            TransferAction::Tab(tab) => transfer.tab = tab,
            TransferAction::Format(format) => {
                (transfer.format, transfer.is_chosen) = (format, true);
            }
            TransferAction::Export(options) => transfer.export = *options,
            TransferAction::Dataset(options) => transfer.dataset = *options,
            TransferAction::Replace(replace) => {
                transfer.replace = replace;
                return;
            }
            TransferAction::ImportFormat(format) => transfer.import_format = format,
            TransferAction::Import(options) => transfer.import = *options,
            TransferAction::Choose => return self.choose_place(),
            TransferAction::TakeOver => {
                self.take_import();
                return;
            }
            TransferAction::TakeOverAndMend => return self.take_import_and_mend(),
            TransferAction::Stop => return self.stop_transfer(),
        }
        self.look_again();
    }

    /// Starts a look at the export or dataset that is chosen. An import waits for its file.
    fn look_again(&mut self) {
        let transfer = &mut self.operations.transfer;
        transfer.found = None;
        // A running write takes precedence; a look follows at its end.
        if transfer.write.is_running() {
            return;
        }
        let at = match transfer.tab {
            TransferTab::Export => PreviewSubject::Export {
                format: transfer.format,
                options: Box::new(transfer.export.clone()),
            },
            TransferTab::Dataset => PreviewSubject::Dataset(Box::new(transfer.dataset.clone())),
            TransferTab::Import => {
                transfer.look.cancel();
                return;
            }
        };
        self.start_look(at);
    }

    /// Starts a look at the present document.
    fn start_look(&mut self, at: PreviewSubject) {
        let Some(open) = &self.open else { return };
        let (document, folder, revision) =
            ((*open.document).clone(), open.folder.clone(), open.revision);
        self.start(TransferPreview {
            document,
            folder,
            revision,
            at,
        });
    }

    /// Starts to write, in place of a look that is running.
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

    /// Asks the user where to write, or what to read.
    fn choose_place(&mut self) {
        let transfer = &self.operations.transfer;
        let question = match transfer.tab {
            TransferTab::Export => Question::ExportAs(transfer.format),
            TransferTab::Dataset => Question::DatasetTo,
            TransferTab::Import => Question::ImportFrom(transfer.import_format),
        };
        self.effects.push(Effect::Ask(question));
    }

    /// Starts the work on a path that the user chose, and shows the dialog again. `may_replace`
    /// says whether the user agreed to replace an existing file.
    pub(in crate::app) fn place_chosen(
        &mut self,
        question: Question,
        path: PathBuf,
        may_replace: bool,
    ) {
        self.session.dialog = Some(Dialog::Transfer);
        // The last look is reused if the document has not changed since.
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
                    Some(PreviewResult::Export(Ok(made))) if made.format == format => {
                        Some(made.clone())
                    }
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
            Question::ImportFrom(format) => self.look_at_labels(ForeignLabels { path, format }),
            _ => {
                let plan = match found {
                    Some(PreviewResult::Dataset(Ok(plan))) => Some(plan.clone()),
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

    /// Opens the dialog on labels of another program and shows what they would bring.
    pub(in crate::app) fn look_at_labels(&mut self, labels: ForeignLabels) {
        let Some(open) = &self.open else { return };
        let field = open.document.field.clone();
        self.open_transfer(TransferTab::Import);
        let ForeignLabels { path, format } = labels;
        let transfer = &mut self.operations.transfer;
        transfer.import_format = format;
        let options = ImportOptions {
            field,
            ..transfer.import.clone()
        };
        self.start_look(PreviewSubject::Import {
            from: path,
            format,
            options: Box::new(options),
        });
    }

    /// Why the folder of the last export cannot be shown. None if it can.
    pub(in crate::app) fn why_not_show_exported(&self) -> Option<&'static str> {
        let written_to = &self.operations.transfer.written_to;
        written_to
            .is_none()
            .then_some("Nothing was exported since the project was opened.")
    }

    /// Shows the folder of the last export in the system's file manager.
    pub(in crate::app) fn show_exported(&mut self) {
        if let Some(folder) = self.operations.transfer.written_to.clone() {
            self.effects.push(Effect::ShowFolder(folder));
        }
    }

    /// Why there is no export to stop. None if there is.
    pub(in crate::app) fn why_not_stop_export(&self) -> Option<&'static str> {
        let writing = self.operations.transfer.writing();
        writing.is_none().then_some("No export is being written.")
    }

    /// Stops the look and the writing; nothing is written.
    pub(in crate::app) fn stop_transfer(&mut self) {
        let transfer = &mut self.operations.transfer;
        // Without short-circuit: both are to be cancelled.
        if transfer.look.cancel() | transfer.write.cancel() {
            self.session.note("Stopped; nothing was written.");
        }
    }

    /// Takes over the import that was read and mends its cameras.
    fn take_import_and_mend(&mut self) {
        // The button of a message is no sign that this import can be mended: an older message may
        // still have one.
        if self.take_import() {
            self.mending_command(Command::MendCameras);
        }
    }

    /// Takes over the import that was read; one step of undo. Returns whether it brought cameras
    /// that can be mended.
    fn take_import(&mut self) -> bool {
        let found = self.operations.transfer.found.take();
        let Some(RevisionPreview {
            revision: then,
            look: PreviewResult::Import(Ok(look)),
        }) = found
        else {
            return false;
        };
        let Some(open) = &self.open else { return false };
        // The user or the background may have changed the document since: what was read is joined
        // with its present state, in which labels that a frame got meanwhile stay.
        let look = if open.revision == then {
            look
        } else {
            Arc::new(look.again(open.document.at(&open.folder)))
        };
        let joined = &look.joined;
        if !self.begin_step(Step::on_document("Import labels")) {
            return false;
        }
        if let Some(open) = &mut self.open {
            let Document {
                cameras, frames, ..
            } = &joined.document;
            (open.document.cameras, open.document.frames) = (cameras.clone(), frames.clone());
        }
        self.commit();
        self.session.dialog = None;
        self.follow_import(&look)
    }

    /// Completes an import: preselects the same format for the export, keeps the ways to attach the
    /// cameras for the mending, and reports the result. Returns whether there is something to mend.
    fn follow_import(&mut self, look: &ImportPreview) -> bool {
        let joined = &look.joined;
        if look.format.exports() {
            self.operations.transfer.format = look.format;
            self.operations.transfer.is_chosen = true;
        }
        let attachment = joined.attachment.as_ref().ok().and_then(Option::as_ref);
        let options = attachment.map(|attachment| MendOptions {
            shifts: attachment.shifts(),
        });
        self.operations.mending.options = options.unwrap_or_default();
        if let Some(open) = &mut self.open {
            // The counts of this state, from which it follows whether there is something to mend.
            open.derived.counts(&open.document);
        }
        let can_mend = joined.cameras > 0 && self.why_not(Command::MendCameras).is_none();
        let offers = can_mend.then_some(("Mend the cameras", Command::MendCameras));
        self.session
            .notify_with(Level::Info, describe_joined(joined), offers);
        can_mend
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Action;
    use touchline_documents::testing::soccer_document;

    #[test]
    fn the_button_of_an_older_message_mends_nothing_after_an_import_that_failed() {
        let mut app = App::with_document(soccer_document());
        app.session.notify_with(
            Level::Info,
            "An earlier import.",
            [("Mend the cameras", Command::MendCameras)],
        );
        // Nothing was read.
        app.update(Action::Transfer(TransferAction::TakeOverAndMend));
        assert!(app.session.offers(Command::MendCameras));
        let reason = app.why_not_mending(Command::StopMending);
        assert_eq!(reason, Some("No cameras are being mended."));
    }
}
