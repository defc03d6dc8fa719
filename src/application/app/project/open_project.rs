//! The open document with its history, its suggestions and the values derived from it.
//!
//! `document` is what the window shows: the users' work, and suggestions in the frames without
//! users' work. `project` keeps both apart, as the journal stores them. Undo and redo apply to the
//! users' work alone.

use super::derived::{Derived, FrameCounts};
use super::opened::Prepared;
use crate::app::Versioned;
use crate::app::effect::Snapshot;
use std::path::PathBuf;
use std::sync::Arc;
use touchline_calibration::calibrate::{BetterCamera, CalibrationError, better_camera, calibrate};
use touchline_calibration::proposals::{
    BatchId, Discarded, Finder, Project, Proposal, SuggestionUpdate, TrackedProposal,
};
use touchline_core::field::{FieldError, FieldModel, Template};
use touchline_core::solve::FrameSolution;
use touchline_documents::document::{
    Document, DocumentAt, Edit, EditKind, Fields, Frame, FrameStatus, History, Shared, Step,
};

/// The document that is open.
#[derive(Debug)]
pub struct OpenProject {
    /// The document as it is shown, with suggestions in frames that users have not changed.
    pub document: Versioned<Document>,
    /// Undo and redo of the users' work, without suggestions.
    pub history: History<Document>,
    /// The folder to which relative paths refer.
    pub folder: PathBuf,
    /// The document's file.
    pub file: PathBuf,
    /// Why the document is read-only, if it is.
    pub read_only: Option<String>,
    /// The number of edits written to the journal.
    pub revision: u64,
    /// The generation of the newest forest that has proposed anything.
    pub(in crate::app) forest_generation: u64,
    /// The document as the journal has it: users' work, and suggestions beside it.
    pub(in crate::app) project: Project,
    /// Values derived from the document.
    pub(in crate::app) derived: Derived,
}

impl OpenProject {
    /// The number of the frame at a position, as the window shows it: [`Frame::number_at`].
    pub fn frame_number(&self, position: usize) -> u64 {
        self.frame(position)
            .map_or(position as u64, |frame| frame.number_at(position))
    }

    /// Positions and numbers of the frames in the same video as the frame at `position`, in the
    /// document's order. All still images count as one video.
    pub(in crate::app) fn frame_numbers_in_video(
        &self,
        position: usize,
    ) -> impl Iterator<Item = (usize, u64)> + '_ {
        let here = self.frame(position).and_then(Frame::video_path);
        let frames = self.document.frames.iter().enumerate();
        let alike = frames.filter(move |(_, frame)| frame.video_path() == here);
        alike.map(|(at, frame)| (at, frame.number_at(at)))
    }

    /// The lowest and highest number among the frames in the same video as the frame at `position`.
    pub fn numbers_beside(&self, position: usize) -> (u64, u64) {
        let numbers = self
            .frame_numbers_in_video(position)
            .map(|(_, number)| number);
        numbers.fold((u64::MAX, 0), |(least, most), number| {
            (least.min(number), most.max(number))
        })
    }

    /// Opens a document; `read_only` is the reason why it cannot be changed, if so.
    pub fn new(
        document: Document,
        file: PathBuf,
        folder: PathBuf,
        read_only: Option<String>,
    ) -> Self {
        Self::from_prepared(Prepared::from_document(document), file, folder, read_only)
    }

    /// The open document of a test.
    #[cfg(any(test, feature = "testing"))]
    pub fn with_document(document: Document) -> Self {
        Self::new(
            document,
            "/match/project.json".into(),
            "/match".into(),
            None,
        )
    }

    /// [`Self::new`] for a prepared document.
    pub(in crate::app) fn from_prepared(
        prepared: Prepared,
        file: PathBuf,
        folder: PathBuf,
        read_only: Option<String>,
    ) -> Self {
        let Prepared { project, derived } = prepared;
        Self {
            document: Versioned::new(project.view().clone()),
            project,
            history: History::default(),
            folder,
            file,
            read_only,
            revision: 0,
            forest_generation: 0,
            derived,
        }
    }

    /// The document with its folder.
    pub fn at(&self) -> DocumentAt<'_> {
        self.document.at(&self.folder)
    }

    pub fn frame(&self, index: usize) -> Option<&Frame> {
        self.document.frames.get(index).map(|frame| &**frame)
    }

    /// Shows the suggestion again of each frame from which the user's work was removed.
    fn show_suggestions_again(&mut self) {
        for (position, frame) in self.project.not_shown_in(&self.document) {
            self.document.frames[position] = frame;
        }
    }

    /// The changes since the last call, to be written to the journal; none if there are none.
    /// `kind` says what undo and redo make of the edit.
    pub(in crate::app) fn take_edit(&mut self, name: &str, kind: EditKind) -> Option<Edit> {
        self.show_suggestions_again();
        // `take_in` writes nothing but the revisions of frames, from which nothing is derived.
        let edit = self
            .project
            .take_in(self.document.keeping_version(), name)?
            .with_kind(kind);
        self.revision += 1;
        Some(edit)
    }

    /// The document as the journal has it, with the history up to the last commit.
    pub(in crate::app) fn snapshot(&self) -> Snapshot {
        let (document, history) = (
            self.project.view().clone(),
            self.history.without_open_transaction(),
        );
        Snapshot {
            document,
            history,
            revision: self.revision,
        }
    }

    /// Takes in proposals of forests as suggestions. Returns the edit for the journal; none if
    /// nothing changes. Proposals of any but the newest forest are dropped.
    pub(in crate::app) fn take_proposals(&mut self, proposals: &[Proposal]) -> Option<Edit> {
        // Reports of one forest may arrive after those of the next one, which knows more.
        let newest = proposals.iter().map(|proposal| proposal.generation).max()?;
        self.forest_generation = self.forest_generation.max(newest);
        let current = proposals
            .iter()
            .filter(|proposal| proposal.generation == self.forest_generation);
        let updates: Vec<_> = current.filter_map(Proposal::update).collect();
        let batch = self.batch_of_forest(self.forest_generation);
        self.suggest(batch, &updates)
    }

    /// Takes in cameras that were tracked from a forest's proposals. `newest` is the newest
    /// generation among them. Cameras from an outdated forest are dropped.
    pub(in crate::app) fn take_tracked(
        &mut self,
        tracked: &[TrackedProposal],
        newest: u64,
    ) -> Option<Edit> {
        let current = tracked
            .iter()
            .filter(|tracked| tracked.generation >= self.forest_generation);
        let updates: Vec<_> = current.map(TrackedProposal::update).collect();
        let batch = self.batch_of_forest(newest);
        self.suggest(batch, &updates)
    }

    /// The batch for a forest's proposals and for the cameras tracked from them.
    fn batch_of_forest(&mut self, generation: u64) -> BatchId {
        self.project.batch_of_finder(Finder::Forest { generation })
    }

    /// Adds suggestions to a batch; this is no step of undo. Returns the edit for the journal; none
    /// if nothing changes.
    pub(in crate::app) fn suggest(
        &mut self,
        batch: BatchId,
        updates: &[SuggestionUpdate],
    ) -> Option<Edit> {
        // Change a copy: writing into the document raises its version, which costs all derived
        // values, and often nothing changes.
        let mut document = self.document.clone();
        let edit = self.project.suggest(&mut document, batch, updates)?;
        *self.document = document;
        self.revision += 1;
        Some(edit)
    }

    /// [`Self::suggest`] as a step of undo, for what a command of the user has found.
    pub(in crate::app) fn suggest_as_step(
        &mut self,
        step: Step,
        batch: BatchId,
        updates: &[SuggestionUpdate],
    ) -> Option<Edit> {
        let change = |open: &mut Self| drop(open.suggest(batch, updates));
        self.change_suggestions(step, change).0
    }

    /// Removes a batch of suggestions from the frames that users have not changed since; one step
    /// of undo.
    pub(in crate::app) fn discard_batch(
        &mut self,
        step: Step,
        batch: BatchId,
        newest_forest: u64,
    ) -> Discarded {
        let (edit, discarded) = self.change_suggestions(step, |open| {
            let mut document = open.document.clone();
            let discarded = open.project.discard(&mut document, batch, newest_forest);
            if discarded.frames() > 0 {
                *open.document = document;
            }
            discarded
        });
        Discarded { edit, ..discarded }
    }

    /// Makes a step of undo of a change that suggests or discards, and returns its edit for the
    /// journal; none if nothing changes.
    fn change_suggestions<T>(
        &mut self,
        step: Step,
        change: impl FnOnce(&mut Self) -> T,
    ) -> (Option<Edit>, T) {
        let (before, name) = (self.project.view().clone(), step.name.clone());
        let revision = self.revision;
        // The step may have been resumed already.
        if !self.history.is_open() {
            self.begin(step);
        }
        let kind = self.history.open_kind();
        let result = change(self);
        // The project shows its suggestions already; what else has changed is taken in here. Both
        // are one edit.
        let edited = self.project.edits_in(&self.document);
        let suggestions = self.document.suggestion_changes_since(&before);
        let is_step = self.history.commit_with(&edited, suggestions);
        self.project.take_in(self.document.keeping_version(), &name);
        let edit = Edit::between(&before, self.project.view(), &name);
        let edit = edit.with_kind(if is_step { kind } else { EditKind::NoStep });
        let edit = Some(edit).filter(|edit| !edit.is_empty());
        self.revision = revision + u64::from(edit.is_some());
        (edit, result)
    }

    /// The field that a frame shows, with its parameters.
    ///
    /// # Errors
    /// The template is missing, or it rejects a parameter or its value.
    pub fn field_of(&mut self, index: usize) -> Result<Arc<FieldModel>, FieldError> {
        let spec = match self.document.frames.get(index) {
            Some(frame) => self.document.field_of(frame),
            None => &self.document.field,
        };
        self.derived.field(&self.document, spec)
    }

    /// The fields of all cameras; equal ones are built once.
    ///
    /// # Errors
    /// One of them is invalid.
    pub fn fields(&mut self) -> Result<Arc<Fields>, FieldError> {
        self.derived.fields(&self.document)
    }

    /// Stores a field template that was read, or the error.
    pub(in crate::app) fn template_read(
        &mut self,
        name: &str,
        template: Result<Box<Template>, FieldError>,
    ) {
        self.derived.template_read(name, template);
        self.document.raise_version();
    }

    /// Requests again the templates that could not be read.
    pub(in crate::app) fn want_failed_templates_again(&mut self) {
        self.derived.want_failed_templates_again();
        self.document.raise_version();
    }

    /// The counts of frames after the last action.
    pub const fn counts(&self) -> &FrameCounts {
        self.derived.last_counts()
    }

    /// Solves a frame from its clicks. If another camera of the document fits better, this is the
    /// first warning. None if the frame does not exist or its field is invalid.
    pub(in crate::app) fn solve(
        &mut self,
        index: usize,
    ) -> Option<Result<FrameSolution, CalibrationError>> {
        let field = self.field_of(index).ok()?;
        let lookup = self.derived.lookup(&self.document);
        let frame = self.document.frames.get(index)?;
        let mut solved = calibrate(&self.document, lookup, frame, &field, index);
        if let Ok(solved) = &mut solved
            && let Some(better) = self.better_camera(index, solved)
        {
            solved.warnings.insert(0, better.warning());
        }
        Some(solved)
    }

    /// Another camera of the document that fits a solved frame better than its own.
    pub(in crate::app) fn better_camera(
        &mut self,
        index: usize,
        solved: &FrameSolution,
    ) -> Option<BetterCamera> {
        if self.document.cameras.len() < 2 {
            return None;
        }
        let fields = self.fields().ok()?.per_camera(&self.document);
        better_camera(&self.document, self.frame(index)?, solved, &fields)
    }

    /// The number of frames with a status.
    pub fn count(&self, status: FrameStatus) -> usize {
        self.document
            .frames
            .iter()
            .filter(|frame| frame.status == status)
            .count()
    }

    /// The nearest frame before or after `from` for which `wanted` is true. Does not wrap around.
    pub fn find(
        &self,
        from: usize,
        forward: bool,
        wanted: impl Fn(&Frame) -> bool,
    ) -> Option<usize> {
        let frames = &self.document.frames;
        let is_wanted = |index: &usize| {
            frames
                .get(*index)
                .is_some_and(|frame: &Shared<Frame>| wanted(frame))
        };
        if forward {
            (from + 1..frames.len()).find(is_wanted)
        } else {
            (0..from.min(frames.len())).rev().find(is_wanted)
        }
    }

    /// Opens a step of undo.
    pub(in crate::app) fn begin(&mut self, step: Step) {
        self.history
            .begin(&self.project.edits_in(&self.document), step);
    }

    /// Reopens the last step of undo, if it equals `step` and none is open. Returns whether it did.
    pub(in crate::app) fn resume(&mut self, step: &Step) -> bool {
        self.history
            .resume(&self.project.edits_in(&self.document), step)
    }

    /// Closes the open step of undo.
    pub(in crate::app) fn commit(&mut self) {
        if !self.history.is_open() {
            return;
        }
        // The view is the document before the step, but for suggestions that have come since; the
        // document has these, too.
        self.show_suggestions_again();
        let suggestions = self.document.suggestion_changes_since(self.project.view());
        self.history
            .commit_with(&self.project.edits_in(&self.document), suggestions);
    }

    /// Aborts the open step of undo: the document returns to its state before the step.
    pub(in crate::app) fn abort(&mut self) {
        let mut edited = self.project.edited_document().clone();
        if self.history.abort(&mut edited) {
            *self.document = self.project.view_with(&edited);
        }
    }

    /// Writes the shots that a search found by `mark`; `num_below` is the number of steps in the
    /// history when it began. If the user made or undid steps since, the shots are inserted below
    /// those, the whole history changes, and the result is true.
    pub(in crate::app) fn mark_shots(
        &mut self,
        mark: impl Fn(&mut Document),
        step: Step,
        num_below: usize,
    ) -> bool {
        let before = self.project.edits_in(&self.document);
        // A step on top of the user's own would be the first to be undone, although the search was
        // started before them. With steps to redo, a new step would drop those.
        let goes_beneath =
            num_below < self.history.num_done() || self.history.next_redo().is_some();
        if !goes_beneath {
            self.history.begin(&before, step);
            mark(&mut self.document);
            self.commit();
            return false;
        }
        mark(&mut self.document);
        let after = self.project.edits_in(&self.document);
        self.history
            .insert_shots(num_below, step, [&before, &after], mark);
        true
    }

    /// Undoes the last step (`back`) or redoes the next one, and returns it.
    pub(in crate::app) fn undo(&mut self, back: bool) -> Option<Step> {
        // The history has the users' work alone. Undo there, then show the suggestions in the
        // frames that have no work afterwards.
        let mut edited = self.project.edits_in(&self.document);
        let step = if back {
            self.history.undo(&mut edited)
        } else {
            self.history.redo(&mut edited)
        }?;
        *self.document = self.project.view_after(&edited, &step, back);
        Some(step)
    }
}
