//! The quality page: opening and closing it, its camera and its time axis.

use crate::app::quality::{TimeAxis, zoom_span};
use crate::app::window_state::session::Mode;
use crate::app::{App, Command};
use touchline_documents::document::CameraId;

/// Factor of one press of a zoom key.
const ZOOM_STEP: f64 = 2.0;

impl App {
    /// Opens or closes the quality page.
    pub(in crate::app) fn toggle_quality(&mut self) {
        self.session.quality.open = !self.session.quality.open;
        if !self.session.quality.open {
            return;
        }
        // Actions in the picture end, because the page covers it.
        self.commit_open_step();
        self.session.mode = Mode::Idle;
        self.session.points.hover = None;
        self.session.points.next_on_line = false;
    }

    /// Selects the camera of the page, and shows its whole time.
    pub(in crate::app::update) fn set_quality_camera(&mut self, camera: CameraId) {
        self.session.quality.camera = Some(camera);
        self.session.quality.span = None;
    }

    /// Selects the unit of time, and shows the whole time.
    pub(in crate::app::update) fn set_time_axis(&mut self, axis: TimeAxis) {
        if self.session.quality.axis != axis {
            self.session.quality.axis = axis;
            self.session.quality.span = None;
        }
    }

    /// Shows a part of the time, or all of it. An invalid span counts as none.
    pub(in crate::app::update) fn show_span(&mut self, span: Option<[f64; 2]>) {
        self.session.quality.span =
            span.filter(|[from, upto]| from.is_finite() && upto.is_finite() && from < upto);
    }

    /// Closes the page, and shows a frame and optionally one of its clicks.
    pub(in crate::app::update) fn look_at(&mut self, frame: usize, click: Option<usize>) {
        self.session.quality.open = false;
        self.go_to(frame);
        if click.is_some() {
            self.select(click);
        }
    }

    /// Zooms the time axis around the shown frame, or around the centre if the frame is not
    /// visible.
    pub(in crate::app::update) fn zoom_time(&mut self, command: Command) {
        let course = &self.quality.course;
        let Some(whole) = course.whole else { return };
        let span = self.session.quality.span.unwrap_or(whole);
        let shown = course
            .at_of(self.session.frame)
            .filter(|at| (span[0]..=span[1]).contains(at));
        let around = shown.unwrap_or(f64::midpoint(span[0], span[1]));
        self.session.quality.span = match command {
            Command::ZoomIn => zoom_span(span, whole, around, ZOOM_STEP),
            Command::ZoomOut => zoom_span(span, whole, around, 1.0 / ZOOM_STEP),
            _ => None,
        };
    }
}
