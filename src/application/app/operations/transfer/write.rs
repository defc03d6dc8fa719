//! Writes an export or a dataset.

use super::words::describe_error;
use crate::app::effect::Effect;
use crate::app::operation::{Context, Failure, Operation, Slot};
use crate::app::window_state::session::{Dialog, Level};
use crate::app::{App, Command, sentence};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use touchline_core::geometry::pluralise;
use touchline_core::progress::Share;
use touchline_documents::document::Document;
use touchline_documents::exchange::{
    DatasetDone, DatasetOptions, DatasetPlan, ExchangeError, ExportOptions, Exported, Format,
    export, folder_for_new, plan_dataset, write_dataset,
};

/// Writes an export or a dataset.
#[derive(Debug)]
pub struct TransferWrite {
    pub(super) document: Document,
    /// The folder to which its relative paths refer.
    pub(super) folder: PathBuf,
    pub(super) writing: Writing,
}

/// What was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Written {
    /// The message to the user.
    pub says: String,
    /// The file or folder.
    pub to: PathBuf,
}

/// The subject of a write.
#[derive(Debug)]
pub(super) enum Writing {
    Export {
        format: Format,
        options: Box<ExportOptions>,
        /// The export as the look made it; none if the document has changed since.
        made: Option<Arc<Exported>>,
        to: PathBuf,
        /// Whether an existing file is replaced. Existing folders never are.
        replace: bool,
    },
    Dataset {
        /// The plan that the look made; none if the document has changed since.
        plan: Option<Arc<DatasetPlan>>,
        options: Box<DatasetOptions>,
        to: PathBuf,
        /// Whether an existing dataset is replaced.
        replace: bool,
    },
}

impl Operation for TransferWrite {
    /// Pictures of a dataset that have been written.
    type Progress = Share;
    type Output = Written;
    type Error = ExchangeError;

    const NAME: &'static str = "export";

    fn run(&self, context: &Context<'_, Share>) -> Result<Written, ExchangeError> {
        match &self.writing {
            Writing::Export {
                format,
                options,
                made,
                to,
                replace,
            } => {
                let exported = match made {
                    Some(made) => Arc::clone(made),
                    None => Arc::new(export(self.document.at(&self.folder), *format, options)?),
                };
                let to = if format.is_folder() {
                    folder_for_new(to, format.name())
                } else {
                    to.clone()
                };
                // The user may have stopped it while the export was made.
                if context.check().is_break() {
                    return Err(ExchangeError::Stopped);
                }
                exported.write(&to, *replace && !exported.is_folder())?;
                let frames = pluralise(exported.frames, "frame");
                let says = format!("{frames} written as {format}: {}", to.display());
                Ok(Written { says, to })
            }
            Writing::Dataset {
                plan,
                options,
                to,
                replace,
            } => {
                let at = self.document.at(&self.folder);
                let plan = match plan {
                    Some(plan) => Arc::clone(plan),
                    None => Arc::new(plan_dataset(at, options)?),
                };
                let (to, mut reader) = (folder_for_new(to, "dataset"), context.open_reader());
                let done = write_dataset(
                    at,
                    &plan,
                    options,
                    &mut *reader,
                    &to,
                    *replace,
                    &context.progress(),
                )?;
                let says = describe_dataset(&done, &to);
                Ok(Written { says, to })
            }
        }
    }

    fn slot(app: &mut App) -> &mut Slot<Self> {
        &mut app.operations.transfer.write
    }

    fn take_over(&self, app: &mut App, result: Result<Written, Failure<ExchangeError>>) {
        match result {
            Ok(Written { says, to }) => {
                let folder = if to.is_dir() { Some(&*to) } else { to.parent() };
                app.operations.transfer.written_to = folder.map(Path::to_path_buf);
                if let Writing::Export { format, .. } = &self.writing {
                    app.settings.remember_format(*format);
                    app.effects.push(Effect::SaveSettings);
                }
                if app.session.dialog == Some(Dialog::Transfer) {
                    app.session.dialog = None;
                }
                // The result comes last, so that it is the message in the row.
                app.report_assumed_size();
                let offers = [("Open folder", Command::ShowExported)];
                app.session.notify_with(Level::Info, says, offers);
            }
            Err(Failure::Failed(error)) => app.session.notify(Level::Error, describe_error(&error)),
            Err(failure) => app
                .session
                .notify(Level::Error, sentence(&failure.to_string())),
        }
        // A look that was due while the write ran.
        let transfer = &app.operations.transfer;
        if transfer.found.is_none() && !transfer.is_looking() {
            app.look_again();
        }
    }
}

/// What was written, as text.
fn describe_dataset(done: &DatasetDone, to: &Path) -> String {
    let left_out = match done.left_out.len() {
        0 => String::new(),
        count => format!(", {count} left out"),
    };
    format!(
        "Dataset of {}{left_out} written: {}",
        pluralise(done.frames, "frame"),
        to.display()
    )
}
