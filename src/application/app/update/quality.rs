//! The quality page: opened, closed, left for a frame, and the part of the time that it shows.

use super::App;
use crate::app::Command;
use crate::app::quality::{TimeAxis, zoomed};
use crate::app::session::Mode;
use touchline_documents::document::CameraId;

/// One step of the zoom keys.
const ZOOM_STEP: f64 = 2.0;

impl App {
    pub(in crate::app) fn toggle_quality(&mut self) {
        self.session.quality.open = !self.session.quality.open;
        if !self.session.quality.open {
            return;
        }
        // What was begun in the picture does not go on behind the page.
        self.commit_open_step();
        self.session.mode = Mode::Idle;
        self.session.points.hover = None;
        self.session.points.next_on_line = false;
    }

    pub(super) fn set_quality_camera(&mut self, camera: CameraId) {
        self.session.quality.camera = Some(camera);
        self.session.quality.span = None;
    }

    pub(super) fn set_time_axis(&mut self, axis: TimeAxis) {
        if self.session.quality.axis != axis {
            self.session.quality.axis = axis;
            self.session.quality.span = None;
        }
    }

    pub(super) fn show_span(&mut self, span: Option<[f64; 2]>) {
        let is_one = |[from, upto]: &[f64; 2]| from.is_finite() && upto.is_finite() && from < upto;
        self.session.quality.span = span.filter(is_one);
    }

    /// Shows a frame and one of its clicks instead of the page.
    pub(super) fn look_at(&mut self, frame: usize, click: Option<usize>) {
        self.session.quality.open = false;
        self.go_to(frame);
        if click.is_some() {
            self.select(click);
        }
    }

    /// Zooms the time axis around the shown frame, or around the middle where that is out of sight.
    pub(super) fn zoom_time(&mut self, command: Command) {
        let course = &self.quality.course;
        let Some(whole) = course.whole else { return };
        let span = self.session.quality.span.unwrap_or(whole);
        let shown = course
            .at_of(self.session.frame)
            .filter(|at| (span[0]..=span[1]).contains(at));
        let around = shown.unwrap_or(f64::midpoint(span[0], span[1]));
        self.session.quality.span = match command {
            Command::ZoomIn => zoomed(span, whole, around, ZOOM_STEP),
            Command::ZoomOut => zoomed(span, whole, around, 1.0 / ZOOM_STEP),
            _ => None,
        };
    }
}
