//! What the quality page shows, derived and never stored: how the cameras of the frames run over
//! time, how far clicks lie from what they name, where frames look.
//!
//! Nothing is derived while the page is closed, and only what changed is derived again. The page
//! speaks of one camera of the document at a time.

mod course;
mod errors;
mod seen;
mod targets;
mod thinned;

pub use super::choices::{QualityChoice, TimeAxis};
pub use course::{Course, CoursePoint, PointKind, Quantity, within_whole, zoomed};
pub use errors::{Bin, ClickError, ClickErrors, Histogram, Spread};
pub use seen::Seen;
pub use targets::{TargetErrors, by_target};
pub use thinned::{Column, Drawn, drawn};

use super::{OpenProject, session::Session};
use touchline_documents::document::{CameraId, Document, Frame};

/// What the quality page shows of one camera: derived, never stored.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Quality {
    /// The camera.
    pub camera: Option<CameraId>,
    /// Pan, tilt and focal length over time.
    pub course: Course,
    /// How far clicks lie from what they name.
    pub errors: ClickErrors,
    /// The same by landmark and line.
    pub targets: Vec<TargetErrors>,
    /// Accepted frames whose paint contradicts their cameras, by their places in the document.
    pub off_paint: Vec<usize>,
    /// Where references and suggestions look; none while the camera's base is not known.
    pub seen: Option<Seen>,
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

    fn derive(open: &mut OpenProject, camera: Option<CameraId>, axis: TimeAxis) -> Self {
        let Some(id) = &camera else {
            return Self::default();
        };
        let fields = open.fields();
        let disagreements = open.derived.disagreements(&open.document);
        let document = &*open.document;
        let off_paint = off_paint(document, id);
        let course_of = || Course::of(document, disagreements, id, axis);
        // Without a valid field nothing can be off.
        let Ok(fields) = fields else {
            return Self {
                course: course_of(),
                camera,
                off_paint,
                ..Self::default()
            };
        };
        let errors_of = || {
            let errors = ClickErrors::of(document, &fields, id);
            let targets = by_target(&errors);
            (errors, targets)
        };
        let place = document.cameras.iter().position(|camera| camera.id == *id);
        let field = place.map(|place| fields.of_cameras(document).swap_remove(place));
        let seen_of = || Seen::of(document, &*field?, id);
        let (course, ((errors, targets), seen)) =
            rayon::join(course_of, || rayon::join(errors_of, seen_of));
        Self {
            course,
            errors,
            targets,
            off_paint,
            seen,
            camera,
            derived_from: None,
        }
    }
}

/// The accepted frames of a camera that their paint contradicts.
fn off_paint(document: &Document, camera: &CameraId) -> Vec<usize> {
    let is_off = |frame: &Frame| frame.camera == *camera && frame.accepted_off_paint().is_some();
    document
        .frames
        .iter()
        .enumerate()
        .filter(|(_, frame)| is_off(frame))
        .map(|(index, _)| index)
        .collect()
}

/// The camera that was chosen, while the document has it; else the shown frame's, else the first.
fn chosen_camera(open: &OpenProject, session: &Session) -> Option<CameraId> {
    let document = &open.document;
    let chosen = session
        .quality
        .camera
        .clone()
        .filter(|id| document.camera(id).is_some());
    chosen
        .or_else(|| open.frame(session.frame).map(|frame| frame.camera.clone()))
        .or_else(|| document.cameras.first().map(|camera| camera.id.clone()))
}
