//! Moves points that the user just placed onto the paint of the landmark that they name. The move
//! becomes a part of the step that placed them.
//!
//! A placed point waits until the frame has a camera (which predicts where the paint is) and no
//! other points are being processed.

use crate::app::App;
use crate::app::operation::{Context, Failure, Operation, Slot};
use crate::app::window_state::session::{Level, Mode};
use std::convert::Infallible;
use std::path::PathBuf;
use std::sync::Arc;
use touchline_calibration::calibrate::snap_clicks;
use touchline_calibration::proposals::{PictureError, read_picture};
use touchline_core::camera::PtzCamera;
use touchline_core::field::FieldModel;
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::{
    Click, Document, Frame, FrameId, FrameStatus, Shared, SolutionSource, Step, Target,
};
use touchline_vision::paint::SnappedPoint;

/// Finds the paint of some clicks of a frame.
#[derive(Debug)]
pub struct PointSnap {
    /// The document when the work started.
    pub document: Document,
    /// The folder to which its relative paths refer.
    folder: PathBuf,
    /// The frame when the work started.
    pub frame: Shared<Frame>,
    /// The field that the frame shows.
    field: Arc<FieldModel>,
    /// The frame's approximate camera.
    camera: PtzCamera,
    /// The indices of the clicks.
    pub clicks: Vec<usize>,
    /// The step of undo that placed the last of them.
    step: Option<Step>,
}

/// The points that wait to be moved onto the paint, and the running request.
#[derive(Debug, Default)]
pub(in crate::app) struct PointSnapState {
    slot: Slot<PointSnap>,
    waiting: Vec<PlacedPoint>,
    /// The last click that the user placed with the wish that it stays exactly there, so that
    /// naming it later does not move it.
    exact: Option<(FrameId, usize)>,
}

/// A point that the user placed. Identified by position and landmark, because indices of clicks
/// change.
#[derive(Clone, Debug, PartialEq)]
struct PlacedPoint {
    frame: FrameId,
    landmark: Target,
    at: ImagePoint,
}

impl PlacedPoint {
    fn is(&self, click: &Click) -> bool {
        click.snapped_sigma_px.is_none()
            && click.image == self.at
            && click.target.as_ref() == Some(&self.landmark)
    }
}

// ---- The work ----

impl Operation for PointSnap {
    type Progress = Infallible;
    type Output = Vec<(usize, SnappedPoint)>;
    type Error = PictureError;

    const NAME: &'static str = "snap points";

    /// The clicks whose landmark is certainly painted nearby, and the position of the paint.
    fn run(&self, context: &Context<'_, Infallible>) -> Result<Self::Output, PictureError> {
        let picture = read_picture(&mut *context.open_reader(), &self.frame, &self.folder)?;
        Ok(snap_clicks(
            &self.document,
            &self.frame,
            &self.field,
            &self.camera,
            &picture,
            &self.clicks,
        ))
    }

    fn slot(app: &mut App) -> &mut Slot<Self> {
        &mut app.operations.point_snap.slot
    }

    fn take_over(&self, app: &mut App, result: Result<Self::Output, Failure<PictureError>>) {
        match result {
            Ok(found) => app.move_points(self, found),
            // The viewport reports a missing picture already.
            Err(Failure::Failed(_)) => {}
            Err(failure) => app
                .session
                .notify(Level::Error, format!("Points not snapped: {failure}.")),
        }
    }
}

// ---- Which points wait ----

impl PointSnapState {
    /// Registers a click that was placed or moved. If `exactly`, it stays where it is.
    fn place(&mut self, frame: &Frame, index: usize, exactly: bool) {
        let here = (frame.id.clone(), index);
        if exactly {
            // A point that was named automatically as it was placed is waiting already.
            if let Some(click) = frame.clicks.get(index) {
                self.waiting
                    .retain(|placed| placed.frame != frame.id || !placed.is(click));
            }
            self.exact = Some(here);
            return;
        }
        self.exact.take_if(|exact| *exact == here);
        self.wait(frame, index);
    }

    /// Registers that a click got its name. It waits, unless it must stay exactly where it is.
    fn name(&mut self, frame: &Frame, index: usize) {
        let is_exact = self
            .exact
            .as_ref()
            .is_some_and(|(id, click)| (id, *click) == (&frame.id, index));
        if !is_exact {
            self.wait(frame, index);
        }
    }

    /// Adds a click to the waiting points, if it names a landmark and is not on its paint yet.
    fn wait(&mut self, frame: &Frame, index: usize) {
        let Some(click) = frame.clicks.get(index) else {
            return;
        };
        let Some(landmark @ Target::Landmark(_)) = &click.target else {
            return;
        };
        let placed = PlacedPoint {
            frame: frame.id.clone(),
            landmark: landmark.clone(),
            at: click.image,
        };
        if placed.is(click) && !self.waiting.contains(&placed) {
            self.waiting.push(placed);
        }
    }

    /// Removes the waiting points and returns those of the shown frame as indices of clicks. Empty
    /// while a request is running. Points of other frames are dropped.
    fn take_waiting(&mut self, frame: &Frame) -> Vec<usize> {
        // The user has left the other frames: their points stay where they were placed.
        self.waiting.retain(|placed| placed.frame == frame.id);
        if self.slot.is_running() {
            return Vec::new();
        }
        let clicks = frame
            .clicks
            .iter()
            .enumerate()
            .filter(|(_, click)| self.waiting.iter().any(|placed| placed.is(click)))
            .map(|(index, _)| index)
            .collect();
        self.waiting.clear();
        clicks
    }
}

// ---- In the application ----

impl App {
    /// Registers a click that was placed or moved. It is moved onto the paint as soon as a camera
    /// is known, unless `exactly` or the settings forbid it.
    pub(in crate::app) fn snap_later(&mut self, click: usize, exactly: bool) {
        let exactly = exactly || !self.settings.snap_points;
        if let Some(frame) = self
            .open
            .as_ref()
            .and_then(|open| open.frame(self.session.frame))
        {
            self.operations.point_snap.place(frame, click, exactly);
        }
    }

    /// Registers that a click got its name.
    pub(in crate::app) fn snap_named(&mut self, click: usize) {
        if let Some(frame) = self
            .open
            .as_ref()
            .and_then(|open| open.frame(self.session.frame))
        {
            self.operations.point_snap.name(frame, click);
        }
    }

    /// Starts the search for the paint of waiting points, between edits. Points wait until the
    /// frame has a camera.
    pub(in crate::app) fn snap_points(&mut self) {
        let Some(open) = self
            .open
            .as_ref()
            .filter(|open| !open.history.is_open() && open.read_only.is_none())
        else {
            return;
        };
        let Some(frame) = open.document.frames.get(self.session.frame) else {
            return;
        };
        let (Some(field), Some(camera)) = (self.current.field(), self.current.rough_camera())
        else {
            return;
        };
        if self.session.mode != Mode::Idle || !is_by_clicks(frame) {
            return;
        }
        let clicks = self.operations.point_snap.take_waiting(frame);
        if clicks.is_empty() {
            return;
        }
        // The step that the result will extend, if the last step belongs to this frame.
        let step = open
            .history
            .next_undo()
            .filter(|step| step.frame.as_ref() == Some(&frame.id))
            .cloned();
        let (document, folder) = ((*open.document).clone(), open.folder.clone());
        let (frame, field) = (frame.clone(), field.clone());
        self.start(PointSnap {
            document,
            folder,
            frame,
            field,
            camera,
            clicks,
            step,
        });
    }

    /// Moves points onto the paint that was found, as a part of the step that placed them. If the
    /// user has done something else since, they wait again.
    fn move_points(&mut self, request: &PointSnap, found: Vec<(usize, SnappedPoint)>) {
        let shown = self
            .open
            .as_ref()
            .and_then(|open| open.document.frames.get(self.session.frame));
        let Some(frame) = shown.filter(|frame| frame.id == request.frame.id) else {
            return;
        };
        // Clicks that were moved, renamed or removed while the work ran stay as they are.
        let found: Vec<(usize, SnappedPoint)> = found
            .into_iter()
            .filter(|(click, _)| {
                let now = frame.clicks.get(*click);
                now.is_some_and(|now| request.frame.clicks.get(*click) == Some(now))
            })
            .collect();
        // By now the frame may have numbers set by hand, a camera aligned to the paint, or the
        // user's acceptance.
        if found.is_empty() || !is_by_clicks(frame) {
            return;
        }
        // `resume` succeeds only if the step is still the last one: undo then takes back the
        // placing and the move together.
        let resumed = self.session.mode == Mode::Idle
            && request
                .step
                .as_ref()
                .is_some_and(|step| self.open.as_mut().is_some_and(|open| open.resume(step)));
        if !resumed {
            // The user has placed or is placing another point: these wait again and move together
            // with it.
            for (click, _) in found {
                self.snap_later(click, false);
            }
            return;
        }
        let Some(frame) = self.frame_mut() else {
            return;
        };
        for (click, snapped) in &found {
            if let Some(click) = frame.clicks.get_mut(*click) {
                (click.image, click.snapped_sigma_px) = (snapped.image, Some(snapped.sigma_px));
            }
        }
        self.session.points.just_snapped = found.into_iter().map(|(click, _)| click).collect();
        self.clicks_changed();
        self.commit();
    }
}

/// Whether a frame's camera comes from its clicks and may still change with them.
fn is_by_clicks(frame: &Frame) -> bool {
    let source = frame.source();
    !matches!(frame.status, FrameStatus::Reference | FrameStatus::Rejected)
        && !matches!(
            source,
            Some(SolutionSource::Manual | SolutionSource::Markings)
        )
}
