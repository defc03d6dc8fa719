//! Refines the base on the clip of the shown frame. One clicked frame is enough: cameras are
//! tracked through the clip, the painted lines of all its frames correct the base, and both are
//! repeated until the base no longer changes.
//!
//! Only the base and the field's size are taken over, as one step of undo. Then the clip is tracked
//! with them as usual; the points that were followed for the refinement are reused.

use crate::app::operation::{AsItWas, Context, Failure, Operation, Slot, WorkError};
use crate::app::operations::clip_tracking::{REFINED, step_of};
use crate::app::operations::{OperationStep, UnderWay};
use crate::app::{App, Command};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use touchline_calibration::calibrate::{BulkChange, ClipEvidence, ClipFrames, clip_of_frame};
use touchline_calibration::pipelines::{TrackingEvent, TrackingOptions, track_clips};
use touchline_core::progress::Progress;
use touchline_documents::document::{Camera, Document, Frame, FrameId, Step};

/// Refines the base of a clip's camera.
pub struct BaseRefinement {
    document: Document,
    /// The folder to which its relative paths refer.
    folder: PathBuf,
    /// The index of one frame of the clip.
    frame: usize,
}

/// A base that was refined on a clip.
#[derive(Clone)]
pub struct RefinedBase {
    /// The document with the refined base.
    found: Document,
    /// Median distance between the lines and paint that was held out of the fit, before the first
    /// round and after the last, px. None if no round of paint improved the base; if it changed all
    /// the same, it was estimated from the points.
    off_px: Option<(f64, f64)>,
    /// Points tracked through the pictures of the clip, and the paint found in them.
    evidence: ClipEvidence,
}

/// The running refinement.
#[derive(Debug, Default)]
pub(in crate::app) struct BaseRefinementState {
    slot: Slot<BaseRefinement>,
    /// The clip that is tracked as soon as its refined base has been written into the document.
    refined: Option<RefinedClip>,
}

/// A clip on which a base was refined.
#[derive(Debug)]
struct RefinedClip {
    /// One frame of the clip.
    frame: FrameId,
    /// What was followed through its pictures.
    evidence: Arc<ClipEvidence>,
}

// ---- The work ----

/// What the events of a refinement amount to.
#[derive(Default)]
struct RoundsOutcome {
    /// See [`RefinedBase::off_px`].
    off_px: Option<(f64, f64)>,
    /// Why the clip could not be tracked.
    failure: Option<String>,
}

impl RoundsOutcome {
    /// Updates the outcome by an event of the pipeline.
    fn note(&mut self, event: &TrackingEvent) {
        match event {
            TrackingEvent::Refined(_, seen) => {
                // "Before" is that of the first round, "after" that of the last one so far.
                if let (Some(before), Some(after)) = (seen.before.paint, seen.after.paint) {
                    let first = self.off_px.map_or(before.median_px, |(first, _)| first);
                    self.off_px = Some((first, after.median_px));
                }
            }
            TrackingEvent::Failed(_, error) => self.failure = Some(error.to_string()),
            _ => {}
        }
    }
}

impl Operation for BaseRefinement {
    type Progress = OperationStep;
    type Output = RefinedBase;
    type Error = WorkError;

    const NAME: &'static str = "refine the base";

    fn run(&self, context: &Context<'_, OperationStep>) -> Result<RefinedBase, WorkError> {
        let mut reader = context.open_reader();
        let clip = self.clip().ok_or("the frame has no picture")?;
        let mut document = self.document.clone();
        let options = TrackingOptions {
            refine_base: true,
            ..TrackingOptions::default()
        };
        let (mut evidence, outcome) = (Vec::new(), Mutex::new(RoundsOutcome::default()));
        // Two kinds of events are progress; the others describe the outcome.
        let progress = Progress::new(|event| match event {
            TrackingEvent::Progress(progress) => context.report(step_of(&progress)),
            TrackingEvent::Refining(_) => {
                let step = "Adjusting the base to the painted lines of all frames";
                context.report(OperationStep::new(step, None))
            }
            other => {
                outcome
                    .lock()
                    .unwrap_or_else(PoisonError::into_inner)
                    .note(&other);
                context.check()
            }
        });
        let (folder, clips) = (&self.folder, [clip]);
        let tracked = track_clips(
            &mut document,
            folder,
            &clips,
            &mut *reader,
            &options,
            &mut evidence,
            &progress,
        )?;
        // Ends its borrow of `outcome`.
        drop(progress);
        let RoundsOutcome { off_px, failure } =
            outcome.into_inner().unwrap_or_else(PoisonError::into_inner);
        match failure {
            Some(error) => return Err(error.into()),
            None if tracked.is_stopped => return Err("stopped; nothing was changed".into()),
            None => {}
        }
        Ok(RefinedBase {
            found: document,
            off_px,
            evidence: evidence.pop().unwrap_or_default(),
        })
    }

    fn slot(app: &mut App) -> &mut Slot<Self> {
        &mut app.operations.base_refinement.slot
    }

    fn must_wait(app: &App) -> bool {
        app.is_amid_change()
    }

    fn take_over(&self, app: &mut App, result: Result<RefinedBase, Failure<WorkError>>) {
        match result {
            Ok(refined) => app.take_refined_base(self, refined),
            Err(failure) => app.session.notify(
                failure.level(),
                format!("The base was not refined: {failure}."),
            ),
        }
    }
}

impl BaseRefinement {
    fn clip(&self) -> Option<ClipFrames> {
        clip_of_frame(self.document.at(&self.folder), self.frame)
    }
}

// ---- In the application ----

impl App {
    /// Why the base cannot be refined on the shown clip. None if it can.
    pub(in crate::app) fn why_not_refine_base(&self) -> Option<&'static str> {
        if self.operations.base_refinement.slot.is_running() {
            return Some("The base is being refined already.");
        }
        let frame = self.frame()?;
        let open = self.open.as_ref()?;
        let is_known = open
            .document
            .frames
            .iter()
            .filter(|other| other.camera == frame.camera)
            .any(|other| other.ptz.is_some() || !other.clicks.is_empty());
        if !is_known {
            return Some("No frame has points or a camera: click one first.");
        }
        self.why_not_follow_points()
    }

    /// Starts a refinement on the shown clip.
    pub(in crate::app) fn refine_base_on_shot(&mut self) {
        self.commit_open_step();
        let Some(open) = &self.open else { return };
        let (document, folder) = ((*open.document).clone(), open.folder.clone());
        self.start(BaseRefinement {
            document,
            folder,
            frame: self.session.frame,
        });
    }

    /// Stops the refinement. Returns whether one was running.
    pub(in crate::app) fn stop_refining_base(&mut self) -> bool {
        let is_stopped = self.operations.base_refinement.slot.cancel();
        if is_stopped {
            self.session
                .note("Refining the base was stopped; nothing was changed.");
        }
        is_stopped
    }

    /// Whether a refinement is running.
    pub(in crate::app) const fn is_refining_base(&self) -> bool {
        self.operations.base_refinement.slot.is_running()
    }

    /// Writes a refined base into the document, as one step of undo, and tracks the clip with it.
    fn take_refined_base(&mut self, refinement: &BaseRefinement, refined: RefinedBase) {
        let Some(open) = &self.open else { return };
        let before = &refinement.document;
        let Some(frame) = before.frames.get(refinement.frame) else {
            return;
        };
        let camera = &frame.camera;
        // A refinement may change base and field, and is valid only for those that it began with.
        let [field, field_before] = [&open.document, before].map(|of| of.field_of_camera(camera));
        let since = AsItWas {
            then: before,
            now: &open.document,
        };
        if !since.has_base_and_field(camera) || field != field_before {
            let text = "The base or the field changed in the meantime; the refined base was \
                        discarded.";
            self.session.note(text);
            return;
        }
        let RefinedBase {
            found,
            off_px,
            evidence,
        } = refined;
        let is_refined = !AsItWas {
            then: before,
            now: &found,
        }
        .has_base_and_field(camera);
        let base = found.camera(camera).and_then(Camera::base);
        let Some(base) = base.filter(|_| is_refined) else {
            self.session
                .note("The base already lies on the painted lines of this shot.");
            return;
        };
        // Only the base and the camera's field, which may be the document's, are copied; everything
        // else may have changed since the work started.
        let mut numbers = open.document.clone();
        if let (Some(known), Some(of_found)) = (numbers.camera_mut(camera), found.camera(camera)) {
            known.set_base(&base);
            if of_found.field.is_some() {
                known.field.clone_from(&of_found.field);
            } else {
                numbers.field.clone_from(&found.field);
            }
        }
        self.operations.base_refinement.refined = Some(RefinedClip {
            frame: frame.id.clone(),
            evidence: Arc::new(evidence),
        });
        let change = BulkChange::Numbers(Box::new(numbers));
        let is_changed = self.change_in_bulk(Step::on_document(REFINED), change, |app, _| {
            if let Some(clip) = app.operations.base_refinement.refined.take() {
                app.track_with_refined_base(&clip.frame, clip.evidence);
            }
        });
        // A change that was refused has reported that.
        if is_changed {
            self.session.note(describe_refined(off_px));
        }
    }
}

// ---- Words ----

impl BaseRefinementState {
    /// The frame on whose shot the base is being refined.
    pub(super) fn tracked_frame(&self) -> Option<&Frame> {
        let refinement = self.slot.running()?.operation();
        refinement
            .document
            .frames
            .get(refinement.frame)
            .map(|frame| &**frame)
    }

    /// The running refinement with its progress, for the status row.
    pub(super) fn under_way(&self) -> Option<UnderWay> {
        let job = "Refining the base on this shot";
        let running = self.slot.running()?;
        Some(UnderWay::from_running(running, job, Command::StopTracking))
    }
}

/// How much nearer to the paint the lines are, as text.
fn describe_refined(off_px: Option<(f64, f64)>) -> String {
    match off_px {
        Some((before, after)) => format!(
            "The base was refined: its lines lie {after:.2} px beside paint that it has not seen, {before:.2} px before."
        ),
        None => "The base was estimated from the points.".to_owned(),
    }
}
