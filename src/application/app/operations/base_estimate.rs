//! The base of a camera, estimated from the clicks of its frames and the paint in their pictures:
//! on request, shown as a proposal, taken over as one step of undo.

use crate::app::operation::{Context, Failure, Operation, Running, Slot};
use crate::app::operations::UnderWay;
use crate::app::session::{Level, SidePanel};
use crate::app::{App, Command};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use thiserror::Error;
use touchline_calibration::calibrate::{
    BaseEstimationError, BaseOnPaintError, BaseProblem, BulkChange, EstimatedBase, describe_size,
    estimate_on_paint,
};
use touchline_calibration::proposals::read_picture;
use touchline_core::geometry::counted;
use touchline_core::progress::Progress;
use touchline_core::solve::base::{BaseOptions, BaseProgress};
use touchline_documents::document::{CameraId, Document, Frame, Step};

/// The base of a camera is to be estimated.
#[derive(Debug)]
pub struct BaseEstimate {
    document: Document,
    /// Where its relative paths start.
    folder: PathBuf,
    camera: CameraId,
    /// The field's size is fitted as well.
    with_size: bool,
    /// The painted lines of the pictures take part.
    with_paint: bool,
    /// From what, in words.
    pub from: String,
}

/// How far an estimation has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EstimateProgress {
    /// Adjustments to points, or to points and paint.
    Adjusting(BaseProgress),
    /// Pictures whose painted lines were looked at.
    Looking {
        /// So far.
        pictures: usize,
    },
}

/// Why there is no base.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BaseEstimateError {
    /// The frames give none.
    #[error(transparent)]
    Impossible(#[from] BaseEstimationError),
    /// The frames and their painted lines give none.
    #[error(transparent)]
    OnPaint(#[from] BaseOnPaintError),
}

/// The estimation under way, and what the last one found.
#[derive(Debug, Default)]
pub struct BaseEstimateState {
    slot: Slot<BaseEstimate>,
    last: LastEstimate,
}

/// What has become of the last base that was estimated.
#[derive(Debug, Default)]
enum LastEstimate {
    /// There is none, or it was discarded.
    #[default]
    Nothing,
    /// It is shown, but not taken over.
    Proposed(Arc<EstimatedBase>),
    /// It was taken over; its tables stay to be worked with.
    Applied(Arc<EstimatedBase>),
}

// ---- The work ----

impl Operation for BaseEstimate {
    type Progress = EstimateProgress;
    type Output = Box<EstimatedBase>;
    type Error = BaseEstimateError;

    const NAME: &'static str = "base";

    fn run(
        &self,
        context: &Context<'_, EstimateProgress>,
    ) -> Result<Box<EstimatedBase>, BaseEstimateError> {
        let reported = Mutex::new(None);
        let progress = Progress::new(|progress: EstimateProgress| {
            // Adjustments are made by several threads, whose counts overtake each other on the way.
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

    fn take_over(
        &self,
        app: &mut App,
        result: Result<Box<EstimatedBase>, Failure<BaseEstimateError>>,
    ) {
        match result {
            Ok(found) => {
                let text = describe(&found);
                app.session.retract(Command::EstimateBase);
                app.operations.base_estimate.last = LastEstimate::Proposed(found.into());
                app.session.notify(Level::Info, text);
            }
            Err(failure) => app
                .session
                .notify(failure.level(), format!("No base: {failure}.")),
        }
    }
}

impl BaseEstimate {
    /// The base from clicks alone.
    fn estimate(
        &self,
        progress: &Progress<'_, EstimateProgress>,
    ) -> Result<Box<EstimatedBase>, BaseEstimateError> {
        let adjusting = progress.part(EstimateProgress::Adjusting);
        let (at, options) = (self.document.at(&self.folder), BaseOptions::default());
        let problem = BaseProblem::of(at, &self.camera)?;
        let found = if self.with_size {
            problem.estimate_with_size(at, &options, &adjusting)
        } else {
            problem.estimate(at.document, &options, &adjusting)
        };
        Ok(Box::new(found?))
    }

    /// The base from clicks and painted lines.
    fn estimate_on_paint(
        &self,
        context: &Context<'_, EstimateProgress>,
        progress: &Progress<'_, EstimateProgress>,
    ) -> Result<Box<EstimatedBase>, BaseEstimateError> {
        let (at, options) = (self.document.at(&self.folder), BaseOptions::default());
        let mut reader = context.open_reader();
        let mut count = 0;
        let mut pictures = |frame: &Frame| {
            count += 1;
            // Without further pictures the estimation ends soon.
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
        Ok(Box::new(found.with_pulled_frames(at, &mut pictures)?))
    }
}

// ---- In the application ----

impl BaseEstimateState {
    /// The estimation that is under way.
    #[must_use]
    pub const fn running(&self) -> Option<&Running<BaseEstimate>> {
        self.slot.running()
    }

    /// What was found and waits for a decision.
    #[must_use]
    pub const fn proposed(&self) -> Option<&Arc<EstimatedBase>> {
        match &self.last {
            LastEstimate::Proposed(found) => Some(found),
            LastEstimate::Applied(_) | LastEstimate::Nothing => None,
        }
    }

    /// What was taken over.
    #[must_use]
    pub const fn applied(&self) -> Option<&Arc<EstimatedBase>> {
        match &self.last {
            LastEstimate::Applied(found) => Some(found),
            LastEstimate::Proposed(_) | LastEstimate::Nothing => None,
        }
    }

    /// What was found last, taken over or not.
    #[must_use]
    pub fn found(&self) -> Option<&EstimatedBase> {
        self.proposed()
            .or_else(|| self.applied())
            .map(|found| &**found)
    }

    /// Something is being estimated or waits for a decision.
    #[must_use]
    pub const fn is_open(&self) -> bool {
        self.slot.is_running() || self.proposed().is_some()
    }
}

impl App {
    /// Why a command of the estimation is not available; none if it is.
    pub(in crate::app) fn why_not_base_estimate(&self, command: Command) -> Option<&'static str> {
        let state = &self.operations.base_estimate;
        match command {
            Command::EstimateBase | Command::FitFieldSize if self.is_read_only() => {
                Some("The document is read-only.")
            }
            Command::UseEstimatedBase if state.proposed().is_none() => {
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

    /// Has the base estimated in the background, and the field's size with it.
    fn estimate_base(&mut self, with_size: bool) {
        let ready = self.base_readiness();
        let (Some(open), Some(camera)) = (&self.open, self.camera_id().cloned()) else {
            return;
        };
        if ready.wide == 0 && self.current.base.is_none() {
            self.session.notify(
                Level::Info,
                format!("Not enough points yet. {}", ready.describe()),
            );
            return;
        }
        let with_paint = self.settings.base_on_paint;
        let paint = if with_paint { ", painted lines" } else { "" };
        let from = format!(
            "{}, {}{paint}",
            counted(ready.frames, "frame"),
            counted(ready.clicks, "click")
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

    /// Gives up what is being estimated or what was found.
    pub(in crate::app) fn drop_estimated_base(&mut self) {
        let state = &mut self.operations.base_estimate;
        state.slot.cancel();
        if state.proposed().is_some() {
            state.last = LastEstimate::Nothing;
        }
    }

    /// Takes over what was found: one step of undo.
    fn use_estimated_base(&mut self) {
        if let Some(found) = self.operations.base_estimate.proposed() {
            let change = BulkChange::Base(Arc::clone(found));
            self.change_in_bulk(
                Step::on_document("Estimate base"),
                change,
                Self::tell_base_used,
            );
        }
    }

    /// The names of a frame's clicks are right now: it is no longer listed as mirrored.
    pub(in crate::app) fn forget_mirrored(&mut self, frame: usize) {
        let last = &mut self.operations.base_estimate.last;
        if let LastEstimate::Proposed(found) | LastEstimate::Applied(found) = last {
            Arc::make_mut(found)
                .estimate
                .mirrored
                .retain(|mirrored| mirrored.frame != frame);
        }
    }

    /// What follows in the window from a base that was taken over.
    fn tell_base_used(&mut self, change: &BulkChange) {
        let BulkChange::Base(found) = change else {
            return;
        };
        self.session.retract(Command::UseEstimatedBase);
        self.session.retract(Command::EstimateBase);
        self.operations.base_estimate.last = LastEstimate::Applied(Arc::clone(found));
        self.tell_assumed_size();
    }
}

// ---- Words ----

impl EstimateProgress {
    /// Whether this was reported later than another.
    const fn is_later_than(self, other: Self) -> bool {
        match (self, other) {
            (Self::Adjusting(this), Self::Adjusting(other)) => this.done > other.done,
            (Self::Looking { pictures }, Self::Looking { pictures: before }) => pictures > before,
            _ => true,
        }
    }

    /// In a few words: "12 of 40 adjustments".
    #[must_use]
    pub fn describe(self) -> String {
        match self {
            Self::Adjusting(BaseProgress { done, total }) => {
                format!("{done} of {total} adjustments")
            }
            Self::Looking { pictures: 1 } => "1 picture looked at".to_owned(),
            Self::Looking { pictures } => format!("{pictures} pictures looked at"),
        }
    }

    /// The share that is done, where it is known.
    #[must_use]
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
    /// The estimation under way, with how far it has come.
    #[must_use]
    pub fn under_way(&self) -> Option<UnderWay> {
        let running = self.slot.running()?;
        let far = running
            .progress()
            .map(|progress| format!(": {}", progress.describe()))
            .unwrap_or_default();
        let text = format!(
            "Estimating the base from {}{far}…",
            running.operation().from
        );
        let share = running.progress().and_then(|progress| progress.share());
        Some(UnderWay {
            text,
            share,
            stop: Command::DropEstimatedBase,
        })
    }
}

/// The outcome in one sentence, with what it was before.
fn describe(found: &EstimatedBase) -> String {
    let estimate = &found.estimate;
    let frames = estimate.frames.iter().flatten().count();
    let before = estimate
        .previous_median_px
        .filter(|px| px.is_finite())
        .map(|px| format!(" (currently {px:.1} px); hold B for the current base"))
        .unwrap_or_default();
    let one_view = estimate
        .one_view()
        .map_or_else(String::new, |reason| format!(" But {reason}."));
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
        "Base estimated from {}: median error {:.1} px{before}.{paint}{sizes}{one_view}",
        counted(frames, "frame"),
        estimate.median_px
    )
}
