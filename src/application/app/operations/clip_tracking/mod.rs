//! Tracks cameras through the clip of the shown frame: from frames with a known camera to all
//! others. The results are suggestions: like the forest's, they are kept apart from the users'
//! work. What a command of the user has tracked is a step of undo.
//!
//! When the user corrects and accepts one of the frames, the clip is tracked again; the points that
//! were followed the first time are reused.

mod corrections;
mod suggestions;
mod tracking;

pub use tracking::ClipTracking;
pub(super) use tracking::step_of;

use crate::app::operation::{AsItWas, Slot};
use crate::app::operations::UnderWay;
use crate::app::window_state::session::Level;
use crate::app::{App, Command};
use std::sync::Arc;
use touchline_calibration::calibrate::{BulkChange, ClipEvidence, LengthOnLines, take_length};
use touchline_calibration::proposals::BatchId;
use touchline_core::geometry::pluralise;
use touchline_documents::document::{Document, Frame, FrameId, Step};
use tracking::Cause;

/// The name of the step of undo of a refined base, to which the cameras that are tracked with it
/// belong, too.
pub(super) const REFINED: &str = "Refine the base on the shot";

/// The running tracking, and the last result.
#[derive(Debug, Default)]
pub(in crate::app) struct ClipTrackingState {
    slot: Slot<ClipTracking>,
    last: Option<LastTracking>,
}

/// What is kept of the last result.
#[derive(Debug)]
struct LastTracking {
    /// Points tracked through the pictures of the clip, and the paint found in them.
    evidence: Arc<ClipEvidence>,
    /// The batch of its suggestions.
    batch: BatchId,
    /// The length of the field that its painted lines require, if the document states none, and the
    /// document in which it was measured.
    length: Option<(LengthOnLines, Document)>,
}

impl ClipTrackingState {
    /// The frame from whose shot cameras are being tracked.
    pub(super) fn tracked_frame(&self) -> Option<&Frame> {
        let tracking = self.slot.running()?.operation();
        tracking
            .document
            .frames
            .get(tracking.frame)
            .map(|frame| &**frame)
    }

    /// The running tracking with its progress, for the status row.
    pub(super) fn under_way(&self) -> Option<UnderWay> {
        let job = "Tracking cameras through the shot";
        let running = self.slot.running()?;
        Some(UnderWay::from_running(running, job, Command::StopTracking))
    }
}

impl App {
    /// Carries out a command of the tracking.
    pub(in crate::app) fn clip_tracking_command(&mut self, command: Command) {
        match command {
            Command::Track => {
                self.commit_open_step();
                self.track_clip_with(self.session.frame, Arc::default(), Cause::Command);
            }
            Command::RefineBaseOnShot => self.refine_base_on_shot(),
            Command::StopTracking if self.stop_refining_base() => {}
            Command::StopTracking if self.operations.clip_tracking.slot.cancel() => {
                self.session
                    .note("Tracking was stopped; nothing was changed.");
            }
            Command::DiscardTracked => self.discard_tracked(),
            Command::TakeLength => self.take_measured_length(),
            _ => {}
        }
    }

    /// Tracks the clip of a frame with a base that was just refined on it; by now another clip may
    /// be shown. Reuses the points that were followed for the refinement.
    pub(super) fn track_with_refined_base(&mut self, frame: &FrameId, evidence: Arc<ClipEvidence>) {
        let open = self.open.as_ref();
        let place = open.and_then(|open| open.document.frames.position_of(frame));
        if let Some(place) = place.filter(|_| self.why_not_follow_points().is_none()) {
            self.track_clip_with(place, evidence, Cause::Refined);
        }
    }

    /// Starts a tracking of the clip of a frame that reuses `evidence`.
    fn track_clip_with(&mut self, frame: usize, evidence: Arc<ClipEvidence>, cause: Cause) {
        let Some(open) = &mut self.open else { return };
        let Ok(field) = open.field_of(frame) else {
            return;
        };
        let (document, folder) = ((*open.document).clone(), open.folder.clone());
        self.start(ClipTracking {
            document,
            folder,
            frame,
            field,
            evidence,
            cause,
        });
    }
}

impl App {
    /// Why a command of the tracking is not available. None if it is.
    pub(in crate::app) fn why_not_clip_tracking(&self, command: Command) -> Option<&'static str> {
        let ClipTrackingState { slot, last } = &self.operations.clip_tracking;
        match command {
            Command::Track => self.why_not_track(),
            Command::DiscardTracked | Command::TakeLength if self.is_read_only() => {
                Some("The document is read-only.")
            }
            Command::TakeLength if last.as_ref().is_none_or(|last| last.length.is_none()) => {
                Some("No other length of the field was measured.")
            }
            Command::DiscardTracked if last.is_none() => Some("No cameras were tracked."),
            Command::RefineBaseOnShot => self.why_not_refine_base(),
            Command::StopTracking if !slot.is_running() && !self.is_refining_base() => {
                Some("No cameras are being tracked.")
            }
            _ => None,
        }
    }

    /// Why the shown clip cannot be tracked. None if it can.
    fn why_not_track(&self) -> Option<&'static str> {
        let open = self.open.as_ref()?;
        if let Some(why) = self.why_not_follow_points() {
            return Some(why);
        }
        let frame = self.frame()?;
        if open
            .document
            .camera_of(frame)
            .and_then(|camera| camera.base_for(frame))
            .is_none()
        {
            return Some("Its camera has no base yet.");
        }
        let mut others = open
            .document
            .frames
            .iter()
            .filter(|other| other.camera == frame.camera);
        others
            .all(|other| other.ptz.is_none())
            .then_some("No frame has a camera to track from: click one first.")
    }

    /// Why points cannot be followed through the shown clip. None if they can.
    pub(in crate::app::operations) fn why_not_follow_points(&self) -> Option<&'static str> {
        if self.is_read_only() {
            return Some("The document is read-only.");
        }
        if cfg!(not(feature = "opencv")) {
            return Some("This program was built without OpenCV and cannot follow points.");
        }
        let is_running = self.operations.clip_tracking.slot.is_running() || self.is_refining_base();
        is_running.then_some("Cameras are being tracked already.")
    }
}

/// The length of the field that the tracked frames require, as text.
fn describe_length(
    LengthOnLines {
        size,
        frames,
        is_prescribed,
        ..
    }: &LengthOnLines,
) -> String {
    let assumed = if *is_prescribed {
        "m is stated, and stays"
    } else {
        "m was assumed"
    };
    format!(
        "The painted lines of {} indicate a {} of {:.2} ± {:.2} m, where {} {assumed}.",
        pluralise(*frames, "frame"),
        size.name.trim_end_matches("_m"),
        size.value_m,
        size.error.sigma_m,
        size.assumed_m
    )
}

impl App {
    /// Reports another length of the field that the tracked frames require. Offers to use it if the
    /// document states none.
    fn report_length(&mut self, found: LengthOnLines) {
        let text = describe_length(&found);
        if found.is_prescribed {
            self.session.warn(text);
            return;
        }
        let then = self.open.as_ref().map(|open| (*open.document).clone());
        if let Some(last) = &mut self.operations.clip_tracking.last {
            last.length = then.map(|then| (found, then));
        }
        self.session
            .notify_with(Level::Warning, text, [("Take it", Command::TakeLength)]);
    }

    /// Uses the measured length; one step of undo. Frames with clicks are solved again; the others
    /// must be tracked again.
    fn take_measured_length(&mut self) {
        let (Some(open), Some(last)) = (&self.open, &self.operations.clip_tracking.last) else {
            return;
        };
        let Some((found, then)) = &last.length else {
            return;
        };
        let now = &open.document;
        let since = AsItWas { then, now };
        let mut cameras = found.shifts.iter().map(|(camera, _)| camera);
        if !cameras.all(|camera| since.has_base_and_field(camera)) {
            let text = "The base or the field changed in the meantime; the measured length was \
                        discarded.";
            let offers = [("Track again", Command::Track)];
            return self.session.notify_with(Level::Info, text, offers);
        }
        let mut numbers = open.document.clone();
        take_length(&mut numbers, found);
        let change = BulkChange::Numbers(Box::new(numbers));
        self.change_in_bulk(
            Step::on_document("Take the measured length"),
            change,
            |app, _| {
                if let Some(last) = &mut app.operations.clip_tracking.last {
                    last.length = None;
                }
                app.session.retract(Command::TakeLength);
                let text =
                    "The measured length was taken. Track the cameras through the shot again.";
                app.session
                    .notify_with(Level::Info, text, [("Track again", Command::Track)]);
            },
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::Action;
    use touchline_calibration::proposals::Finder;
    use touchline_core::camera::SizeError;
    use touchline_core::geometry::Vec3;
    use touchline_core::solve::base::FittedSize;
    use touchline_core::testing::{SIZE, base_at};
    use touchline_documents::testing::{WithFrames, match_from};

    /// An application after a clip was tracked, with a camera at (1, −62, 17) m.
    pub(super) fn app() -> App {
        let document = match_from(&base_at([1.0, -62.0, 17.0], SIZE), SIZE)
            .with_pictures(["a.jpg", "b.jpg"], SIZE);
        let mut app = App::with_document(document);
        let finder = Finder::Command {
            name: Command::Track.name().to_owned(),
        };
        let batch = app.open.as_mut().unwrap().project.open_batch(finder);
        let last = LastTracking {
            evidence: Arc::default(),
            batch,
            length: None,
        };
        app.operations.clip_tracking.last = Some(last);
        app
    }

    #[cfg(feature = "opencv")]
    #[test]
    fn after_a_refinement_its_own_clip_is_tracked_whichever_is_shown() {
        let mut app = app();
        let frame = app.open().unwrap().document.frames[1].id.clone();
        app.track_with_refined_base(&frame, Arc::default());
        let running = app.operations.clip_tracking.slot.running().unwrap();
        assert_eq!((app.session.frame, running.operation().frame), (0, 1));
    }

    fn measured(is_prescribed: bool) -> LengthOnLines {
        let (assumed_m, value_m, sigma_m) = (105.0, 101.0, 0.3);
        let name = "length_m".to_owned();
        let size = FittedSize {
            name,
            assumed_m,
            value_m,
            error: SizeError::alone(sigma_m),
            is_open: false,
        };
        LengthOnLines {
            size,
            shifts: vec![("main".into(), Vec3::new(2.0, 0.0, 0.0))],
            frames: 4,
            is_prescribed,
        }
    }

    #[test]
    fn a_measured_length_is_suggested_and_applied_in_one_step() {
        let mut app = app();
        assert!(app.why_not(Command::TakeLength).is_some());
        app.report_length(measured(false));
        assert!(
            app.session.offers(Command::TakeLength) && app.why_not(Command::TakeLength).is_none()
        );
        let before = (*app.open().unwrap().document).clone();
        app.update(Action::Command(Command::TakeLength));
        let now = |app: &App| {
            let document = &app.open().unwrap().document;
            (
                document.field.params.get("length_m").copied(),
                document.cameras[0].position_m.map(|at| at.x),
            )
        };
        assert_eq!(now(&app), (Some(101.0), Some(3.0)));
        assert!(
            !app.session.offers(Command::TakeLength) && app.why_not(Command::TakeLength).is_some()
        );
        app.update(Action::Command(Command::Undo));
        assert_eq!(*app.open().unwrap().document, before);
    }

    #[test]
    fn a_stated_length_stays() {
        let mut app = app();
        app.report_length(measured(true));
        assert!(app.why_not(Command::TakeLength).is_some());
        let texts: Vec<&str> = app
            .session
            .messages
            .notices
            .iter()
            .map(|notice| notice.text.as_str())
            .collect();
        assert!(
            texts[0].ends_with(
                "indicate a length of 101.00 ± 0.30 m, where 105 m is stated, and stays."
            ),
            "{texts:?}"
        );
    }
}
