//! Compares the open document with another annotator's.

use crate::app::App;
use crate::app::operation::{Context, Failure, Operation, Running, Slot, WorkError};
use crate::app::window_state::session::Level;
use std::convert::Infallible;
use std::path::PathBuf;
use std::sync::Arc;
use touchline_calibration::evaluate::{Agreement, agreement};
use touchline_documents::document::Document;
use touchline_documents::store::read;

/// Compares the open document with another one.
#[derive(Debug)]
pub struct Comparison {
    /// The open document.
    pub document: Document,
    /// The folder to which its relative paths refer.
    pub folder: PathBuf,
    pub revision: u64,
    /// The file of the other document.
    pub with: PathBuf,
}

/// The result of a comparison: derived, never stored.
#[derive(Clone, Debug, PartialEq)]
pub struct ComparisonResult {
    /// The file of the other document, as the user chose it.
    pub file: PathBuf,
    /// The revision of the open document that was compared.
    pub revision: u64,
    /// The agreement of the two; the open document is the first.
    pub agreement: Agreement,
}

/// The comparison on the open document.
#[derive(Debug, Default)]
pub struct ComparisonState {
    slot: Slot<Comparison>,
    made: Option<Arc<ComparisonResult>>,
}

impl ComparisonState {
    /// Whether a comparison is running.
    pub const fn is_running(&self) -> bool {
        self.slot.is_running()
    }

    /// The inputs of the running comparison.
    pub fn running(&self) -> Option<&Comparison> {
        self.slot.running().map(Running::operation)
    }

    /// The result of the last comparison; none while another one is running.
    pub const fn last_result(&self) -> Option<&Arc<ComparisonResult>> {
        self.made.as_ref()
    }
}

impl Operation for Comparison {
    type Progress = Infallible;
    type Output = ComparisonResult;
    type Error = WorkError;

    const NAME: &'static str = "compare";

    fn run(&self, _: &Context<'_, Infallible>) -> Result<ComparisonResult, WorkError> {
        let (location, other, _) = read(&self.with)?;
        let agreement = agreement(self.document.at(&self.folder), other.at(location.folder()))?;
        Ok(ComparisonResult {
            file: self.with.clone(),
            revision: self.revision,
            agreement,
        })
    }

    fn slot(app: &mut App) -> &mut Slot<Self> {
        &mut app.operations.comparison.slot
    }

    fn take_over(&self, app: &mut App, result: Result<ComparisonResult, Failure<WorkError>>) {
        match result {
            Ok(compared) => app.operations.comparison.made = Some(Arc::new(compared)),
            Err(failure) => app.session.notify(Level::Error, failure.to_string()),
        }
    }
}

impl App {
    /// Why the document cannot be compared now. None if it can.
    pub(in crate::app) fn why_not_compare(&self) -> Option<&'static str> {
        self.operations
            .comparison
            .is_running()
            .then_some("A comparison is under way.")
    }

    /// Compares the document as it is now with another one, and opens the quality page, which shows
    /// the result.
    pub(in crate::app) fn compare(&mut self, with: PathBuf) {
        if !self.session.quality.open {
            self.toggle_quality();
        }
        // The result of an earlier comparison must not be taken for this one's.
        let Some(open) = &self.open else { return };
        let (document, folder, revision) =
            ((*open.document).clone(), open.folder.clone(), open.revision);
        self.operations.comparison.made = None;
        self.start(Comparison {
            document,
            folder,
            revision,
            with,
        });
    }
}
