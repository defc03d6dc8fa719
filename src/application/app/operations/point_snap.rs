//! Points that were placed or dropped, moved onto the paint that they name: part of the step that
//! placed them.

use crate::app::App;
use crate::app::operation::{Context, Failure, Operation, Slot};
use crate::app::session::{Level, Mode};
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

/// Clicks of a frame are to be moved onto the paint.
#[derive(Debug)]
pub struct PointSnap {
    /// The document.
    pub document: Document,
    /// Where its relative paths start.
    folder: PathBuf,
    /// The frame as it is.
    pub frame: Shared<Frame>,
    /// The field that it shows.
    field: Arc<FieldModel>,
    /// About how the frame's camera is pointed.
    camera: PtzCamera,
    /// Which of its clicks.
    pub clicks: Vec<usize>,
    /// The step of undo that placed the last of them.
    step: Option<Step>,
}

/// Points that wait to be moved onto the paint, and those that are being looked for.
#[derive(Debug, Default)]
pub(in crate::app) struct PointSnapState {
    slot: Slot<PointSnap>,
    waiting: Vec<PlacedPoint>,
    /// The last click that is to stay where it is: also once it gets its name.
    exact: Option<(FrameId, usize)>,
}

/// A point that the user placed.
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

    /// The clicks whose landmark is certainly painted near by, and where.
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
            // The viewport says why there is no picture.
            Err(Failure::Failed(_)) => {}
            Err(failure) => app
                .session
                .notify(Level::Error, format!("Points not snapped: {failure}.")),
        }
    }
}

// ---- Which points wait ----

impl PointSnapState {
    /// A click was placed, moved or named; `exactly`: it is to stay where it is.
    fn place(&mut self, frame: &Frame, index: usize, exactly: bool) {
        let here = (frame.id.clone(), index);
        if exactly {
            // One that named itself as it was placed waits already.
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

    /// A click got its name: it waits, unless it is to stay where it is.
    fn name(&mut self, frame: &Frame, index: usize) {
        let is_exact = self
            .exact
            .as_ref()
            .is_some_and(|(id, click)| (id, *click) == (&frame.id, index));
        if !is_exact {
            self.wait(frame, index);
        }
    }

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

    /// The clicks of the shown frame to look for next; none while others are being looked for.
    /// Points of frames that were left wait no longer.
    fn take_waiting(&mut self, frame: &Frame) -> Vec<usize> {
        self.waiting.retain(|placed| placed.frame == frame.id);
        if self.slot.is_running() {
            return Vec::new();
        }
        let waits = |click: &Click| self.waiting.iter().any(|placed| placed.is(click));
        let clicks = frame
            .clicks
            .iter()
            .enumerate()
            .filter(|(_, click)| waits(click))
            .map(|(index, _)| index)
            .collect();
        self.waiting.clear();
        clicks
    }
}

// ---- In the application ----

impl App {
    /// A click was placed or moved: it is moved onto the paint as soon as a camera is known, unless
    /// it is to stay.
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

    /// A click got its name.
    pub(in crate::app) fn snap_named(&mut self, click: usize) {
        if let Some(frame) = self
            .open
            .as_ref()
            .and_then(|open| open.frame(self.session.frame))
        {
            self.operations.point_snap.name(frame, click);
        }
    }

    /// Has points that were placed looked for in the picture, between edits. Until the frame has a
    /// camera they wait.
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

    /// Moves the points that were found on the paint: part of the step that placed them, where
    /// nothing was done since.
    fn move_points(&mut self, asked: &PointSnap, found: Vec<(usize, SnappedPoint)>) {
        let shown = self
            .open
            .as_ref()
            .and_then(|open| open.document.frames.get(self.session.frame));
        let Some(frame) = shown.filter(|frame| frame.id == asked.frame.id) else {
            return;
        };
        let is_as_asked = |(click, _): &(usize, SnappedPoint)| {
            frame
                .clicks
                .get(*click)
                .is_some_and(|here| asked.frame.clicks.get(*click) == Some(here))
        };
        let found: Vec<(usize, SnappedPoint)> = found.into_iter().filter(is_as_asked).collect();
        // Numbers by hand or the paint itself may decide by now, or the user has accepted the
        // frame.
        if found.is_empty() || !is_by_clicks(frame) {
            return;
        }
        let resumed = self.session.mode == Mode::Idle
            && asked
                .step
                .as_ref()
                .is_some_and(|step| self.open.as_mut().is_some_and(|open| open.resume(step)));
        if !resumed {
            // Another point is being placed, or was: these go with it.
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

/// Whether a frame is being labelled by its clicks: what moves them moves its camera.
fn is_by_clicks(frame: &Frame) -> bool {
    let source = frame.source();
    !matches!(frame.status, FrameStatus::Reference | FrameStatus::Rejected)
        && !matches!(
            source,
            Some(SolutionSource::Manual | SolutionSource::Markings)
        )
}
