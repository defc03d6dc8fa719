//! What the quality page shows: how the cameras of the frames run over time, derived and never stored.
//!
//! Nothing is derived while the page is closed, and only what changed is derived again. The page speaks of one camera of the
//! document at a time.

mod course;
mod thinned;

pub use course::{Course, CoursePoint, Kind, Quantity, TimeAxis, within_whole, zoomed};
pub use thinned::{Column, Drawn, drawn};

use super::{OpenProject, session::Session};
use crate::project::CameraId;

/// What a person chose on the quality page.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct QualityChoice {
    /// The page takes the window.
    pub open: bool,
    /// The camera it speaks of; none: the shown frame's.
    pub camera: Option<CameraId>,
    /// What time is counted in.
    pub axis: TimeAxis,
    /// The part of the time that is shown; none: all of it.
    pub span: Option<[f64; 2]>,
}

/// What the quality page shows of one camera: derived, never stored.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Quality {
    /// The camera.
    pub camera: Option<CameraId>,
    /// Pan, tilt and focal length over time.
    pub course: Course,
    derived_from: Option<(u64, TimeAxis)>,
}

impl Quality {
    /// Derives it anew if the page is open and something changed since the last time.
    pub(super) fn refresh(&mut self, open: Option<&mut OpenProject>, session: &Session) {
        let choice = &session.quality;
        let Some(open) = open.filter(|_| choice.open) else {
            if self.derived_from.is_some() {
                *self = Self::default();
            }
            return;
        };
        let camera = chosen_camera(open, session);
        let from = Some((open.document.version(), choice.axis));
        if self.derived_from != from || self.camera != camera {
            *self = Self::derive(open, camera, choice.axis);
            self.derived_from = from;
        }
    }

    fn derive(open: &OpenProject, camera: Option<CameraId>, axis: TimeAxis) -> Self {
        let Some(id) = &camera else { return Self::default() };
        Self { course: Course::of(&open.document, id, axis), camera, derived_from: None }
    }
}

/// The camera that was chosen, while the document has it; else the shown frame's, else the first.
fn chosen_camera(open: &OpenProject, session: &Session) -> Option<CameraId> {
    let document = &open.document;
    let chosen = session.quality.camera.clone().filter(|id| document.camera(id).is_some());
    chosen
        .or_else(|| open.frame(session.frame).map(|frame| frame.camera.clone()))
        .or_else(|| document.cameras.first().map(|camera| camera.id.clone()))
}
