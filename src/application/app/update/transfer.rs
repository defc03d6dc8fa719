//! Exporting and importing: looked at in the background, written on request, taken over in one step of undo.

use super::App;
use crate::app::Question;
use crate::app::effect::Effect;
use crate::app::session::{Dialog, Level};
use crate::app::transfer::{Found, Look, TransferAction, TransferOrder, TransferTab, TransferWork, UnderWay};
use std::path::PathBuf;
use touchline_core::geometry::counted;
use touchline_documents::document::{Document, Step};
use touchline_documents::exchange::Joined;

impl App {
    /// Opens the dialog on a page.
    pub(super) fn open_transfer(&mut self, tab: TransferTab) {
        self.commit_open_step();
        self.session.dialog = Some(Dialog::Transfer);
        if self.session.transfer.under_way.is_none_or(|work| !work.writes) {
            self.session.transfer.tab = tab;
        }
        self.look();
    }

    pub(super) fn transfer(&mut self, action: TransferAction) {
        let transfer = &mut self.session.transfer;
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
            TransferAction::TakeOver => return self.take_over(),
            TransferAction::Stop => return self.stop_transfer(),
            TransferAction::Progress { ticket, done, of } => {
                if let Some(work) = transfer.under_way.as_mut().filter(|work| work.ticket == ticket) {
                    work.pictures = Some((done, of));
                }
                return;
            }
            TransferAction::Looked { ticket, look } => {
                if let Some(work) = transfer.under_way.take_if(|work| work.ticket == ticket) {
                    transfer.found = Some(Found { revision: work.revision, look });
                }
                return;
            }
            TransferAction::Written { ticket, result } => return self.transferred(ticket, result),
        }
        self.look();
    }

    /// Has the background look what an export or a dataset would be; an import waits for its file.
    fn look(&mut self) {
        let transfer = &mut self.session.transfer;
        transfer.found = None;
        // What is being written goes first; its end looks.
        if transfer.under_way.is_some_and(|work| work.writes) {
            return;
        }
        let work = match transfer.tab {
            TransferTab::Export => {
                let options = Box::new(transfer.export.clone());
                TransferWork::Export { format: transfer.format, options }
            }
            TransferTab::Dataset => TransferWork::PlanDataset(Box::new(transfer.dataset.clone())),
            TransferTab::Import => {
                if transfer.under_way.take().is_some() {
                    self.effects.push(Effect::CancelTransfer);
                }
                return;
            }
        };
        self.order(work);
    }

    fn order(&mut self, work: TransferWork) {
        let Some(open) = &self.open else { return };
        let transfer = &mut self.session.transfer;
        if transfer.under_way.is_some() {
            self.effects.push(Effect::CancelTransfer);
        }
        transfer.tickets += 1;
        let ticket = transfer.tickets;
        transfer.under_way = Some(UnderWay { ticket, revision: open.revision, writes: work.writes(), pictures: None });
        let (document, folder) = ((*open.document).clone(), open.folder.clone());
        self.effects.push(Effect::Transfer(Box::new(TransferOrder { ticket, document, folder, work })));
    }

    /// Asks where to write, or what to read.
    fn choose_place(&mut self) {
        let transfer = &self.session.transfer;
        let question = match transfer.tab {
            TransferTab::Export => Question::ExportAs(transfer.format),
            TransferTab::Dataset => Question::DatasetTo,
            TransferTab::Import => Question::ImportFrom(transfer.import_format),
        };
        self.effects.push(Effect::Ask(question));
    }

    /// Takes the place that was asked for. The dialog comes back: it says what became of it.
    /// `may_replace`: whether somebody was asked about a file that is there.
    pub(super) fn place_chosen(&mut self, question: Question, path: PathBuf, may_replace: bool) {
        self.session.dialog = Some(Dialog::Transfer);
        let transfer = &self.session.transfer;
        let revision = self.open.as_ref().map(|open| open.revision);
        let found = transfer.found.as_ref().filter(|found| Some(found.revision) == revision).map(|found| &found.look);
        let work = match question {
            Question::ExportAs(format) => {
                let made = match found {
                    Some(Look::Export(Ok(made))) if made.format == format => Some(made.clone()),
                    _ => None,
                };
                let options = Box::new(transfer.export.clone());
                TransferWork::WriteExport { format, options, made, to: path, replace: may_replace }
            }
            Question::ImportFrom(format) => {
                let mut options = transfer.import.clone();
                if let Some(open) = &self.open {
                    options.field = open.document.field.clone();
                }
                TransferWork::Import { from: path, format, options: Box::new(options) }
            }
            _ => {
                let plan = match found {
                    Some(Look::Dataset(Ok(plan))) => Some(plan.clone()),
                    _ => None,
                };
                let options = Box::new(transfer.dataset.clone());
                TransferWork::WriteDataset { plan, options, to: path, replace: transfer.replace }
            }
        };
        self.order(work);
    }

    fn stop_transfer(&mut self) {
        if self.session.transfer.under_way.take().is_some() {
            self.effects.push(Effect::CancelTransfer);
            self.session.notify(Level::Info, "Stopped; nothing was written.");
        }
    }

    fn transferred(&mut self, ticket: u64, result: Result<String, String>) {
        if self.session.transfer.under_way.take_if(|work| work.ticket == ticket).is_none() {
            return;
        }
        match result {
            Ok(text) => {
                if self.session.dialog == Some(Dialog::Transfer) {
                    self.session.dialog = None;
                }
                self.session.notify(Level::Info, text);
                self.tell_assumed_size();
            }
            Err(text) => self.session.notify(Level::Error, text),
        }
        if self.session.transfer.found.is_none() {
            self.look();
        }
    }

    /// Takes over what was read: one step of undo.
    fn take_over(&mut self) {
        let revision = self.open.as_ref().map(|open| open.revision);
        let found = self.session.transfer.found.take();
        let Some(Found { revision: then, look: Look::Import(Ok(joined)) }) = found else { return };
        if Some(then) != revision {
            self.session.notify(Level::Info, "The document changed in the meantime; choose the file again.");
            return;
        }
        if !self.begin_step(Step::on_document("Import labels")) {
            return;
        }
        if let Some(open) = &mut self.open {
            let Document { cameras, frames, .. } = &joined.document;
            (open.document.cameras, open.document.frames) = (cameras.clone(), frames.clone());
        }
        self.commit();
        self.session.dialog = None;
        self.session.notify(Level::Info, describe_joined(&joined));
    }
}

/// What was taken over, in words.
fn describe_joined(joined: &Joined) -> String {
    let frames = joined.matched + joined.added;
    format!(
        "Labels of {} were imported: {}, {}.",
        counted(frames, "frame"),
        counted(joined.clicks, "click"),
        counted(joined.cameras, "new camera")
    )
}
