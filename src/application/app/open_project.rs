//! The document that is open, with its history.

use super::Versioned;
use super::derived::{Derived, FrameCounts};
use super::effect::Snapshot;
use super::prepared::Prepared;
use std::path::PathBuf;
use std::sync::Arc;
use touchline_calibration::calibrate::{BetterCamera, CalibrationError, better_camera, calibrate};
use touchline_calibration::proposals::{
    BatchId, CarriedProposal, Discarded, Finder, Offer, Project, Proposal,
};
use touchline_core::field::{FieldError, FieldModel, Template};
use touchline_core::solve::FrameSolution;
use touchline_documents::document::{
    Document, DocumentAt, Edit, EditKind, Fields, Frame, FrameStatus, History, Shared, Step,
    VideoShots,
};

/// The document that is open.
#[derive(Debug)]
pub struct OpenProject {
    /// The document as it is now; frames that nobody has touched show what is suggested for them.
    pub document: Versioned<Document>,
    /// Undo and redo of what people did: what is suggested is not in it.
    pub history: History<Document>,
    /// What relative paths start from.
    pub folder: PathBuf,
    /// The file.
    pub file: PathBuf,
    /// Why it can only be looked at, if so.
    pub read_only: Option<String>,
    /// Counts every edit that was journalled.
    pub revision: u64,
    /// The newest forest that has proposed anything.
    pub(super) forest_generation: u64,
    /// The document as the journal has it: what people did, and what is suggested beside it.
    pub(super) project: Project,
    /// What follows from the document.
    pub(super) derived: Derived,
}

impl OpenProject {
    /// The number of the frame at a position, as people see it: [`Frame::number_at`].
    #[must_use]
    pub fn frame_number(&self, position: usize) -> u64 {
        self.frame(position)
            .map_or(position as u64, |frame| frame.number_at(position))
    }

    /// The frames of the video that a position belongs to, in the document's order: their positions
    /// and numbers. Images are all of one.
    pub(super) fn numbered_beside(
        &self,
        position: usize,
    ) -> impl Iterator<Item = (usize, u64)> + '_ {
        let video_of = |frame: &Frame| frame.video.as_ref().map(|video| video.path.clone());
        let here = self.frame(position).and_then(video_of);
        let frames = self.document.frames.iter().enumerate();
        let alike = frames.filter(move |(_, frame)| {
            frame.video.as_ref().map(|video| &video.path) == here.as_ref()
        });
        alike.map(|(at, frame)| (at, frame.number_at(at)))
    }

    /// The lowest and the highest number of the frames of the video that a position belongs to.
    #[must_use]
    pub fn numbers_beside(&self, position: usize) -> (u64, u64) {
        let numbers = self.numbered_beside(position).map(|(_, number)| number);
        numbers.fold((u64::MAX, 0), |(least, most), number| {
            (least.min(number), most.max(number))
        })
    }

    /// A document to which nothing has been done yet, its file and its folder, and why it can only
    /// be looked at, if so.
    #[must_use]
    pub fn new(
        document: Document,
        file: PathBuf,
        folder: PathBuf,
        read_only: Option<String>,
    ) -> Self {
        Self::of(Prepared::of(document), file, folder, read_only)
    }

    /// The same, for a document that has been made ready.
    pub(super) fn of(
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

    /// The document in its folder.
    #[must_use]
    pub fn at(&self) -> DocumentAt<'_> {
        self.document.at(&self.folder)
    }

    /// A frame by its place.
    #[must_use]
    pub fn frame(&self, index: usize) -> Option<&Frame> {
        self.document.frames.get(index).map(|frame| &**frame)
    }

    /// What has changed since the last time this was asked, to be journalled; none if nothing has.
    /// `kind` is what it is to undo and redo.
    pub(super) fn take_edit(&mut self, name: &str, kind: EditKind) -> Option<Edit> {
        for (position, frame) in self.project.not_shown_in(&self.document) {
            self.document.frames[position] = frame;
        }
        let edit = self
            .project
            .take_in(self.document.keeping_version(), name)?
            .of_kind(kind);
        self.revision += 1;
        Some(edit)
    }

    /// The document as the journal has it, with its history.
    pub(super) fn snapshot(&self) -> Snapshot {
        let (document, history) = (self.project.view().clone(), self.history.committed());
        Snapshot {
            document,
            history,
            revision: self.revision,
        }
    }

    /// Takes in what forests answered, to be journalled; none if nothing new is seen. Answers of an
    /// older forest than the last one are dropped.
    pub(super) fn take_proposals(&mut self, proposals: &[Proposal]) -> Option<Edit> {
        let newest = proposals.iter().map(|proposal| proposal.generation).max()?;
        self.forest_generation = self.forest_generation.max(newest);
        let is_current = |proposal: &&Proposal| proposal.generation == self.forest_generation;
        let current = proposals.iter().filter(is_current);
        let offers: Vec<_> = current.filter_map(Proposal::offer).collect();
        let batch = self.batch_of_forest(self.forest_generation);
        self.suggest(batch, &offers)
    }

    /// Takes in cameras that were carried from what forests answered, the `newest` of them among
    /// these, in the same way.
    pub(super) fn take_carried(
        &mut self,
        carried: &[CarriedProposal],
        newest: u64,
    ) -> Option<Edit> {
        let current = carried
            .iter()
            .filter(|carried| carried.generation >= self.forest_generation);
        let offers: Vec<_> = current.map(CarriedProposal::offer).collect();
        let batch = self.batch_of_forest(newest);
        self.suggest(batch, &offers)
    }

    /// The batch of a forest's answers and of the cameras that were carried from them.
    fn batch_of_forest(&mut self, generation: u64) -> BatchId {
        self.project.batch_of_finder(Finder::Forest { generation })
    }

    /// Takes what was found for frames into a batch, to be journalled; none if nothing new is seen.
    /// It is no step of undo.
    pub(super) fn suggest(&mut self, batch: BatchId, offers: &[Offer]) -> Option<Edit> {
        let mut document = self.document.clone();
        let edit = self.project.suggest(&mut document, batch, offers)?;
        *self.document = document;
        self.revision += 1;
        Some(edit)
    }

    /// Discards a batch of suggestions in the frames that nobody has touched since. It is no step
    /// of undo.
    pub(super) fn discard_batch(&mut self, batch: BatchId, newest_forest: u64) -> Discarded {
        let mut document = self.document.clone();
        let discarded = self.project.discard(&mut document, batch, newest_forest);
        if discarded.edit.is_some() {
            *self.document = document;
            self.revision += 1;
        }
        discarded
    }

    /// The field that a frame shows, its parameters filled in.
    ///
    /// # Errors
    /// There is no such template, or it does not take a parameter or its value.
    pub fn field_of(&mut self, index: usize) -> Result<Arc<FieldModel>, FieldError> {
        let spec = match self.document.frames.get(index) {
            Some(frame) => self.document.field_of(frame),
            None => &self.document.field,
        };
        self.derived.field(&self.document, spec)
    }

    /// The fields of all cameras, each built once.
    ///
    /// # Errors
    /// One of them is not valid.
    pub fn fields(&mut self) -> Result<Arc<Fields>, FieldError> {
        self.derived.fields(&self.document)
    }

    /// A field template was read, or cannot be.
    pub(super) fn template_read(
        &mut self,
        name: &str,
        template: Result<Box<Template>, FieldError>,
    ) {
        self.derived.template_read(name, template);
        self.document.raise_version();
    }

    /// Field templates that could not be read are to be read again.
    pub(super) fn want_failed_templates_again(&mut self) {
        self.derived.want_failed_templates_again();
        self.document.raise_version();
    }

    /// How many frames there were of each kind after the last action.
    #[must_use]
    pub const fn counts(&self) -> &FrameCounts {
        self.derived.last_counts()
    }

    /// What a frame's clicks say, another camera that fits better among the warnings. None where
    /// there is no such frame or its field is not valid.
    pub(super) fn solve(
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

    /// A camera that fits a solved frame better than its own.
    pub(super) fn better_camera(
        &mut self,
        index: usize,
        solved: &FrameSolution,
    ) -> Option<BetterCamera> {
        if self.document.cameras.len() < 2 {
            return None;
        }
        let fields = self.fields().ok()?.of_cameras(&self.document);
        better_camera(&self.document, self.frame(index)?, solved, &fields)
    }

    /// How many frames have each status.
    #[must_use]
    pub fn count(&self, status: FrameStatus) -> usize {
        self.document
            .frames
            .iter()
            .filter(|frame| frame.status == status)
            .count()
    }

    /// The next frame from `from` (not itself) in a direction for which `wanted` holds; the search
    /// does not wrap.
    #[must_use]
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

    /// Begins a step of undo.
    pub(super) fn begin(&mut self, step: Step) {
        self.history
            .begin(&self.project.edits_in(&self.document), step);
    }

    /// Begins the last step of undo again, if it is this one and none is open.
    pub(super) fn resume(&mut self, step: &Step) -> bool {
        self.history
            .resume(&self.project.edits_in(&self.document), step)
    }

    /// Closes the step of undo.
    pub(super) fn commit(&mut self) {
        self.history.commit(&self.project.edits_in(&self.document));
    }

    /// Gives the open step of undo up.
    pub(super) fn abort(&mut self) {
        let mut edited = self.project.edited().clone();
        if self.history.abort(&mut edited) {
            *self.document = self.project.view_with(&edited);
        }
    }

    /// Marks shots that were looked for when `num_below` steps could be undone. True where a person
    /// did or undid something since: then the step lies beneath that, and the history as a whole
    /// has changed.
    pub(super) fn mark_shots(&mut self, shots: VideoShots, step: Step, num_below: usize) -> bool {
        let before = self.project.edits_in(&self.document);
        let goes_beneath =
            num_below < self.history.num_done() || self.history.next_redo().is_some();
        if !goes_beneath {
            self.history.begin(&before, step);
            shots.write(&mut self.document);
            self.commit();
            return false;
        }
        shots.write(&mut self.document);
        let after = self.project.edits_in(&self.document);
        self.history.insert_shots(num_below, step, &before, &after);
        true
    }

    /// Takes the last step back, or does it again, and says which it was.
    pub(super) fn undo(&mut self, back: bool) -> Option<Step> {
        let mut edited = self.project.edits_in(&self.document);
        let step = if back {
            self.history.undo(&mut edited)
        } else {
            self.history.redo(&mut edited)
        }?;
        self.project.keep_answers_not_in(&edited);
        *self.document = self.project.view_with(&edited);
        Some(step)
    }
}
