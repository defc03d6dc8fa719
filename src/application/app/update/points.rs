//! Points moved onto the paint that they name, as part of the step that placed them.

use super::App;
use crate::app::effect::Effect;
use crate::app::paint_orders::{PointSnapOrder, SnapFailure};
use crate::app::session::{Level, Mode};
use touchline_documents::document::{Frame, FrameStatus, SolutionSource};
use touchline_vision::paint::SnappedPoint;

impl App {
    /// A click was placed or moved: it is moved onto the paint as soon as a camera is known, unless it is to stay.
    pub(super) fn snap_later(&mut self, click: usize, exactly: bool) {
        let exactly = exactly || !self.settings.snap_points;
        if let Some(frame) = self.open.as_ref().and_then(|open| open.frame(self.session.frame)) {
            self.point_snaps.placed(frame, click, exactly);
        }
    }

    /// A click got its name.
    pub(super) fn snap_named(&mut self, click: usize) {
        if let Some(frame) = self.open.as_ref().and_then(|open| open.frame(self.session.frame)) {
            self.point_snaps.named(frame, click);
        }
    }

    /// Has points that were placed looked for in the picture, between edits. Until the frame has a camera they wait.
    pub(super) fn snap_points(&mut self) {
        let Some(open) = self.open.as_ref().filter(|open| !open.history.is_open() && open.read_only.is_none()) else {
            return;
        };
        let Some(frame) = open.document.frames.get(self.session.frame) else { return };
        let (Some(field), Some(camera)) = (self.current.field(), self.current.rough_camera()) else { return };
        if self.session.mode != Mode::Idle || !is_by_clicks(frame) {
            return;
        }
        let Some((ticket, clicks)) = self.point_snaps.next(frame, open.history.next_undo()) else { return };
        self.effects.push(Effect::SnapPoints(Box::new(PointSnapOrder {
            ticket,
            document: (*open.document).clone(),
            folder: open.folder.clone(),
            frame: self.session.frame,
            field: field.clone(),
            camera,
            clicks,
        })));
    }

    /// Moves the points that were found on the paint: part of the step that placed them, where nothing was done since.
    pub(super) fn points_snapped(&mut self, ticket: u64, found: Result<Vec<(usize, SnappedPoint)>, SnapFailure>) {
        let Some(asked) = self.point_snaps.take(ticket) else { return };
        let found = match found {
            Ok(found) => found,
            // The viewport says why there is no picture.
            Err(SnapFailure::Picture(_)) => return,
            Err(failure) => {
                self.session.notify(Level::Error, format!("Points not snapped: {failure}."));
                return;
            }
        };
        let shown = self.open.as_ref().and_then(|open| open.document.frames.get(self.session.frame));
        let Some(frame) = shown.filter(|frame| frame.id == asked.frame.id) else { return };
        let is_as_asked = |(click, _): &(usize, SnappedPoint)| {
            frame.clicks.get(*click).is_some_and(|here| asked.frame.clicks.get(*click) == Some(here))
        };
        let found: Vec<(usize, SnappedPoint)> = found.into_iter().filter(is_as_asked).collect();
        if found.is_empty() {
            return;
        }
        if !is_by_clicks(frame) {
            // Numbers by hand, or the paint itself, decide now; or somebody has accepted the frame.
            return;
        }
        let resumed = self.session.mode == Mode::Idle
            && asked.step.as_ref().is_some_and(|step| self.open.as_mut().is_some_and(|open| open.resume(step)));
        if !resumed {
            // Another point is being placed, or was: these go with it.
            for (click, _) in found {
                self.snap_later(click, false);
            }
            return;
        }
        let Some(frame) = self.frame_mut() else { return };
        for (click, snapped) in &found {
            if let Some(click) = frame.clicks.get_mut(*click) {
                (click.image, click.snapped_sigma_px) = (snapped.image, Some(snapped.sigma_px));
            }
        }
        self.session.just_snapped = found.into_iter().map(|(click, _)| click).collect();
        self.clicks_changed();
        self.commit();
    }
}

/// Whether a frame is being labelled by its clicks: what moves them moves its camera.
fn is_by_clicks(frame: &Frame) -> bool {
    let source = frame.solution.as_ref().and_then(|solution| solution.source);
    !matches!(frame.status, FrameStatus::Reference | FrameStatus::Rejected)
        && !matches!(source, Some(SolutionSource::Manual | SolutionSource::Markings))
}
