//! Estimates a camera's base from the clicks of its frames and, if the user wants it, from the
//! painted lines of their pictures. The result is shown as a proposal; using it is one step of
//! undo.

use crate::app::operation::{AsItWas, Context, Failure, Operation, Running, Slot, WorkError};
use crate::app::operations::UnderWay;
use crate::app::window_state::session::{Level, SidePanel};
use crate::app::{App, Command};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use touchline_calibration::calibrate::{
    BaseProblem, BulkChange, EstimatedBase, describe_size, estimate_on_paint,
};
use touchline_calibration::proposals::read_picture;
use touchline_core::geometry::pluralise;
use touchline_core::progress::Progress;
use touchline_core::solve::base::{BaseOptions, BaseProgress};
use touchline_documents::document::{CameraId, Document, Frame, FrameStatus, Step};

/// Estimates the base of a camera.
#[derive(Debug)]
pub struct BaseEstimate {
    document: Document,
    /// The folder to which its relative paths refer.
    folder: PathBuf,
    camera: CameraId,
    /// Whether the size of the field is fitted as well.
    with_size: bool,
    /// Whether the painted lines of the pictures are used as well.
    with_paint: bool,
    /// The data used, as text.
    pub from: String,
}

/// The progress of an estimation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EstimateProgress {
    /// Adjustments to points, or to points and paint.
    Adjusting(BaseProgress),
    /// Pictures examined for painted lines.
    Looking {
        /// Their number so far.
        pictures: usize,
    },
}

/// The running estimation, and the last result.
#[derive(Debug, Default)]
pub struct BaseEstimateState {
    slot: Slot<BaseEstimate>,
    last: LastEstimate,
    /// The document and the camera of the last result.
    of: Option<(Document, CameraId)>,
}

/// The state of the last result.
#[derive(Debug, Default)]
enum LastEstimate {
    /// There is none, or the user dismissed it.
    #[default]
    Nothing,
    /// It is shown and waits for the user's decision.
    Proposed(Arc<EstimatedBase>),
    /// The user accepted it. Its tables remain available.
    Applied(Arc<EstimatedBase>),
}

// ---- The work ----

impl Operation for BaseEstimate {
    type Progress = EstimateProgress;
    type Output = Box<EstimatedBase>;
    type Error = WorkError;

    const NAME: &'static str = "base";

    fn run(
        &self,
        context: &Context<'_, EstimateProgress>,
    ) -> Result<Box<EstimatedBase>, WorkError> {
        let reported = Mutex::new(None);
        let progress = Progress::new(|progress: EstimateProgress| {
            // Several threads adjust, so their counts may arrive out of order. Only later ones are
            // reported.
            let mut reported = reported.lock().unwrap_or_else(PoisonError::into_inner);
            if reported.is_some_and(|before| !progress.is_later_than(before)) {
                return context.check();
            }
            *reported = Some(progress);
            context.report(progress)
        });
        if self.with_paint {
            self.estimate_on_paint(context, &progress)
        } else {
            self.estimate(&progress)
        }
    }

    fn slot(app: &mut App) -> &mut Slot<Self> {
        &mut app.operations.base_estimate.slot
    }

    fn take_over(&self, app: &mut App, result: Result<Box<EstimatedBase>, Failure<WorkError>>) {
        match result {
            Ok(_) if !app.has_field_of(&self.document, &self.camera) => app.report_other_field(),
            Ok(found) => {
                let hint = app.settings.keys.with_key(Command::Compare, |key| {
                    format!("; hold {key} for the current base")
                });
                let text = describe(&found, &hint);
                app.session.retract(Command::EstimateBase);
                let state = &mut app.operations.base_estimate;
                state.last = LastEstimate::Proposed(found.into());
                state.of = Some((self.document.clone(), self.camera.clone()));
                app.session.note(text);
            }
            Err(failure) => app
                .session
                .notify(failure.level(), format!("No base: {failure}.")),
        }
    }
}

impl BaseEstimate {
    /// Estimates the base from clicks alone.
    fn estimate(
        &self,
        progress: &Progress<'_, EstimateProgress>,
    ) -> Result<Box<EstimatedBase>, WorkError> {
        let adjusting = progress.part(EstimateProgress::Adjusting);
        let (at, options) = (self.document.at(&self.folder), BaseOptions::default());
        let problem = BaseProblem::from_document(at, &self.camera)?;
        let found = if self.with_size {
            problem.estimate_with_size(at, &options, &adjusting)
        } else {
            problem.estimate(at.document, &options, &adjusting)
        };
        Ok(Box::new(found?))
    }

    /// Estimates the base from clicks and painted lines.
    fn estimate_on_paint(
        &self,
        context: &Context<'_, EstimateProgress>,
        progress: &Progress<'_, EstimateProgress>,
    ) -> Result<Box<EstimatedBase>, WorkError> {
        let (at, options) = (self.document.at(&self.folder), BaseOptions::default());
        let mut reader = context.open_reader();
        let mut count = 0;
        let mut pictures = |frame: &Frame| {
            count += 1;
            // After a cancellation no further pictures are read, and the estimation ends soon.
            let goes_on = progress
                .report(EstimateProgress::Looking { pictures: count })
                .is_continue();
            goes_on
                .then(|| read_picture(&mut *reader, frame, &self.folder).ok())
                .flatten()
        };
        let adjusting = progress.part(EstimateProgress::Adjusting);
        let found = estimate_on_paint(
            at,
            &self.camera,
            &options,
            self.with_size,
            &mut pictures,
            &adjusting,
        )?;
        // Reads the pictures a second time, hence "twice" in the description of the command.
        Ok(Box::new(found.with_pulled_frames(at, &mut pictures)?))
    }
}

// ---- In the application ----

impl BaseEstimateState {
    /// The running estimation.
    pub const fn running(&self) -> Option<&Running<BaseEstimate>> {
        self.slot.running()
    }

    /// The result that waits for the user's decision.
    pub const fn proposed_base(&self) -> Option<&Arc<EstimatedBase>> {
        match &self.last {
            LastEstimate::Proposed(found) => Some(found),
            LastEstimate::Applied(_) | LastEstimate::Nothing => None,
        }
    }

    /// The result that the user accepted.
    pub const fn applied_base(&self) -> Option<&Arc<EstimatedBase>> {
        match &self.last {
            LastEstimate::Applied(found) => Some(found),
            LastEstimate::Proposed(_) | LastEstimate::Nothing => None,
        }
    }

    /// The last result, accepted or not.
    pub fn estimated_base(&self) -> Option<&EstimatedBase> {
        self.proposed_base()
            .or_else(|| self.applied_base())
            .map(|found| &**found)
    }

    /// Whether an estimation is running or a result waits for a decision.
    pub const fn is_open(&self) -> bool {
        self.slot.is_running() || self.proposed_base().is_some()
    }
}

impl App {
    /// Why a command of the estimation is not available. None if it is.
    pub(in crate::app) fn why_not_base_estimate(&self, command: Command) -> Option<&'static str> {
        let state = &self.operations.base_estimate;
        match command {
            Command::EstimateBase | Command::FitFieldSize if self.is_read_only() => {
                Some("The document is read-only.")
            }
            Command::UseEstimatedBase if state.proposed_base().is_none() => {
                Some("There is no estimated base.")
            }
            Command::DropEstimatedBase if !state.is_open() => Some("No base is being estimated."),
            _ => None,
        }
    }

    /// Carries out a command of the estimation.
    pub(in crate::app) fn base_estimate_command(&mut self, command: Command) {
        match command {
            Command::EstimateBase => self.estimate_base(false),
            Command::FitFieldSize => self.estimate_base(true),
            Command::UseEstimatedBase => self.use_estimated_base(),
            Command::DropEstimatedBase => self.drop_estimated_base(),
            _ => {}
        }
    }

    /// Starts an estimation of the base, and of the field's size `with_size`.
    fn estimate_base(&mut self, with_size: bool) {
        let ready = self.base_readiness();
        let (Some(open), Some(camera)) = (&self.open, self.camera_id().cloned()) else {
            return;
        };
        if ready.wide == 0 && self.current.base.is_none() {
            self.session
                .note(format!("Not enough points yet. {}", ready.describe()));
            return;
        }
        let with_paint = self.settings.base_on_paint;
        let paint = if with_paint { ", painted lines" } else { "" };
        let from = format!(
            "{}, {}{paint}",
            pluralise(ready.frames, "frame"),
            pluralise(ready.clicks, "click")
        );
        let (document, folder) = ((*open.document).clone(), open.folder.clone());
        self.operations.base_estimate.last = LastEstimate::Nothing;
        self.start(BaseEstimate {
            document,
            folder,
            camera,
            with_size,
            with_paint,
            from,
        });
        self.session.panel = SidePanel::Camera;
    }

    /// Stops the running estimation and dismisses a result that waits for a decision.
    pub(in crate::app) fn drop_estimated_base(&mut self) {
        let state = &mut self.operations.base_estimate;
        state.slot.cancel();
        if state.proposed_base().is_some() {
            state.last = LastEstimate::Nothing;
        }
    }

    /// Stops the running estimation and dismisses the last estimate and its tables, which name
    /// frames by their index in a document that is no longer the present one.
    pub(in crate::app) fn forget_estimate(&mut self) {
        let state = &mut self.operations.base_estimate;
        state.slot.cancel();
        state.last = LastEstimate::Nothing;
    }

    /// Whether a camera's field is still the one of a document in which work on it began.
    pub(super) fn has_field_of(&self, then: &Document, camera: &CameraId) -> bool {
        self.open.as_ref().is_some_and(|open| {
            let now = &open.document;
            AsItWas { then, now }.has_field(camera)
        })
    }

    fn report_other_field(&mut self) {
        let text = "The field changed in the meantime; the estimated base was discarded.";
        let offers = [("Estimate again", Command::EstimateBase)];
        self.session.notify_with(Level::Info, text, offers);
    }

    /// Writes the proposed base into the document; one step of undo.
    fn use_estimated_base(&mut self) {
        let of = self.operations.base_estimate.of.as_ref();
        if of.is_some_and(|(then, camera)| !self.has_field_of(then, camera)) {
            self.operations.base_estimate.last = LastEstimate::Nothing;
            return self.report_other_field();
        }
        if let Some(found) = self.operations.base_estimate.proposed_base() {
            let change = BulkChange::Base(Arc::clone(found));
            self.change_in_bulk(
                Step::on_document("Estimate base"),
                change,
                Self::report_base_used,
            );
        }
    }

    /// Removes a frame from the list of frames with mirrored names, because the user has corrected
    /// it.
    pub(in crate::app) fn forget_mirrored(&mut self, frame: usize) {
        let last = &mut self.operations.base_estimate.last;
        if let LastEstimate::Proposed(found) | LastEstimate::Applied(found) = last {
            Arc::make_mut(found)
                .estimate
                .mirrored
                .retain(|mirrored| mirrored.frame != frame);
        }
    }

    /// Updates the application after a proposed base was written into the document.
    fn report_base_used(&mut self, change: &BulkChange) {
        let BulkChange::Base(found) = change else {
            return;
        };
        self.session.retract(Command::UseEstimatedBase);
        self.session.retract(Command::EstimateBase);
        self.operations.base_estimate.last = LastEstimate::Applied(Arc::clone(found));
        self.report_assumed_size();
        if self.session.panel == SidePanel::Camera {
            self.session.panel = SidePanel::Frame;
        }
        self.show_waiting_draft(&found.camera);
    }

    /// Shows the first frame of a camera that its clicks have solved and that waits for Enter,
    /// unless the shown frame is one.
    fn show_waiting_draft(&mut self, camera: &CameraId) {
        let Some(open) = &self.open else { return };
        let waits = |frame: &Frame| {
            frame.camera == *camera && frame.status == FrameStatus::Draft && frame.ptz.is_some()
        };
        let is_shown = open.frame(self.session.frame).is_some_and(waits);
        let first = open.document.frames.iter().position(|frame| waits(frame));
        if let Some(first) = first.filter(|_| !is_shown) {
            self.go_to(first);
        }
    }
}

// ---- Words ----

impl EstimateProgress {
    /// Whether this progress is later than the other. A change of the kind counts as later.
    const fn is_later_than(self, other: Self) -> bool {
        match (self, other) {
            (Self::Adjusting(this), Self::Adjusting(other)) => this.done > other.done,
            (Self::Looking { pictures }, Self::Looking { pictures: before }) => pictures > before,
            _ => true,
        }
    }

    /// The progress, such as "12 of 40 adjustments".
    pub fn describe(self) -> String {
        match self {
            Self::Adjusting(BaseProgress { done, total }) => {
                format!("{done} of {total} adjustments")
            }
            Self::Looking { pictures: 1 } => "1 picture looked at".to_owned(),
            Self::Looking { pictures } => format!("{pictures} pictures looked at"),
        }
    }

    /// The share that is done, 0 to 1; none if the total is unknown.
    pub fn share(self) -> Option<f32> {
        match self {
            Self::Adjusting(BaseProgress { done, total }) => {
                Some(done as f32 / total.max(1) as f32)
            }
            Self::Looking { .. } => None,
        }
    }
}

impl BaseEstimateState {
    /// The running estimation with its progress, for the status row.
    pub fn under_way(&self) -> Option<UnderWay> {
        let running = self.slot.running()?;
        let progress = running.progress();
        let from = format!("From {}", running.operation().from);
        let step = progress.map_or(from, |progress| progress.describe());
        let share = progress.and_then(|progress| progress.share());
        let job = "Estimating the base";
        Some(UnderWay::new(job, step, Command::DropEstimatedBase).with_share(share))
    }
}

/// The result in one sentence, with the error of the previous base. `hint` says how to see that
/// base.
fn describe(found: &EstimatedBase, hint: &str) -> String {
    let estimate = &found.estimate;
    let frames = estimate.frames.iter().flatten().count();
    let before = estimate
        .previous_median_px
        .filter(|px| px.is_finite())
        .map(|px| format!(" (currently {px:.1} px){hint}"))
        .unwrap_or_default();
    let one_view = estimate
        .one_view()
        .map_or_else(String::new, |reason| format!(" But {reason}."));
    let pixels = estimate
        .pixel_aspect
        .map_or_else(String::new, |aspect| format!(" But {aspect}."));
    let sizes: Vec<String> = found.sizes.iter().map(describe_size).collect();
    let sizes = if sizes.is_empty() {
        String::new()
    } else {
        format!(" Field {}.", sizes.join(", "))
    };
    let paint = found
        .on_paint
        .as_ref()
        .map_or_else(String::new, |on_paint| on_paint.seen.describe());
    format!(
        "Base estimated from {}: median error {:.1} px{before}.{paint}{sizes}{one_view}{pixels}",
        pluralise(frames, "frame"),
        estimate.median_px
    )
}
