//! Two cameras that explain the paint about equally well: the question to the user, what becomes
//! of either answer, and the click that would decide between them. The click is compared with where
//! each of the two projects its landmark.

use super::words::describe_place;
use super::{CameraSearch, SearchFollowUp};
use crate::app::window_state::session::{Level, SidePanel};
use crate::app::{App, Command};
use std::sync::Arc;
use touchline_calibration::autocalibrate::DecidingLandmark;
use touchline_calibration::calibrate::{AutocalibratedCamera, FoundCamera};
use touchline_core::camera::CameraBase;
use touchline_core::field::LandmarkId;
use touchline_core::geometry::ImagePoint;
use touchline_documents::document::{Camera, Document, FrameId, Target};

/// A click decides for a camera if the other camera's projection is more than this many times as
/// far away from it.
const NEARER: f64 = 2.0;

/// Two cameras that explain the paint about equally well.
#[derive(Debug)]
pub struct TwoCameras {
    /// The camera that explains more paint first.
    pub cameras: [Arc<FoundCamera>; 2],
    /// The document when the search began.
    then: Document,
    /// The click that would decide between them, if there is one.
    pub deciding: Option<DecidingClick>,
}

/// A click that would decide between two cameras.
#[derive(Clone, Debug, PartialEq)]
pub struct DecidingClick {
    /// The frame in which to click.
    pub frame: FrameId,
    /// The landmark to click there.
    pub landmark: LandmarkId,
    /// Where the first and the second camera project the landmark, px.
    image: [ImagePoint; 2],
    /// Both positions, as text.
    says: String,
}

impl DecidingClick {
    /// The index of the camera that the document's click favours. None if the landmark is not
    /// clicked in that frame, or the click lies between the two projections.
    pub(super) fn favoured_camera(&self, document: &Document) -> Option<usize> {
        let frame = &document.frames[document.frames.position_of(&self.frame)?];
        // Where the two projections are nearly equally far, the click noise would decide.
        let target = Some(Target::Landmark(self.landmark.clone()));
        let click = frame.clicks.iter().find(|click| click.target == target)?;
        let [here, there] = self.image.map(|image| image.distance_px(click.image));
        if NEARER * here < there {
            Some(0)
        } else if NEARER * there < here {
            Some(1)
        } else {
            None
        }
    }
}

impl TwoCameras {
    /// Two answers of a search. `label` returns the label of a landmark.
    pub(super) fn new(
        search: &CameraSearch,
        cameras: [AutocalibratedCamera; 2],
        deciding: Option<DecidingLandmark>,
        label: impl Fn(&DecidingLandmark) -> String,
    ) -> Self {
        let deciding = deciding.map(|deciding| {
            let [here, there] = deciding
                .image
                .map(|image| format!("({:.0}, {:.0})", image.x, image.y));
            let frame = &search.document.frames[deciding.frame];
            let says = format!(
                "{} on frame {} is at {here} px with the first and at {there} px with the other",
                label(&deciding),
                frame.number_at(deciding.frame)
            );
            DecidingClick {
                frame: frame.id.clone(),
                landmark: deciding.landmark,
                image: deciding.image,
                says,
            }
        });
        Self {
            cameras: cameras.map(|found| search.with_frame_ids(found)),
            then: search.document.clone(),
            deciding,
        }
    }

    /// The question to the user, with the deciding click if there is one.
    pub fn describe(&self) -> String {
        let [best, other] = [0, 1].map(|which| describe_place(&self.cameras[which].found));
        let by = self.deciding.as_ref().map_or_else(
            || "Try each and look at the lines.".to_owned(),
            |deciding| format!("One click decides: {}.", deciding.says),
        );
        format!("Two positions of the camera explain the painted lines: {best}, and {other}. {by}")
    }
}

impl App {
    /// Asks the user which of two cameras is right.
    pub(super) fn ask_which_camera(&mut self, two: TwoCameras) {
        let offers = [
            ("Try the first", Command::TryFirstCamera),
            ("Try the other", Command::TryOtherCamera),
        ];
        self.session
            .notify_with(Level::Warning, two.describe(), offers);
        self.session.panel = SidePanel::Camera;
        let state = &mut self.operations.camera_search;
        state.found = Some(Arc::clone(&two.cameras[0]));
        state.left = SearchFollowUp::Two(Box::new(two));
    }

    /// If the deciding click between two cameras has been made, uses the camera that it favours.
    /// Called after each action.
    pub(in crate::app) fn decide_camera_by_click(&mut self) {
        if self.is_amid_change() {
            return;
        }
        let (SearchFollowUp::Two(two), Some(open)) =
            (&self.operations.camera_search.left, &self.open)
        else {
            return;
        };
        let Some(which) = two
            .deciding
            .as_ref()
            .and_then(|deciding| deciding.favoured_camera(&open.document))
        else {
            return;
        };
        // A base that the user has found in another way since takes precedence over both.
        let camera = open.document.camera(&two.cameras[0].camera);
        if let Some(base) = camera.and_then(Camera::base)
            && two.cameras.iter().all(|found| !is_at(&found.found, &base))
        {
            return;
        }
        // The choice is settled before the camera is used, or this would run again after it.
        let (found, then) = (Arc::clone(&two.cameras[which]), two.then.clone());
        self.operations.camera_search.left = SearchFollowUp::Nothing;
        self.session.retract(Command::TryFirstCamera);
        self.session.retract(Command::TryOtherCamera);
        if !self.refuses_other_field(&then, &found.camera) {
            self.use_found_camera(found);
        }
    }

    /// Uses one of the two cameras; each attempt is one step of undo.
    pub(super) fn try_camera(&mut self, which: usize) {
        if let SearchFollowUp::Two(two) = &self.operations.camera_search.left {
            let (found, then) = (Arc::clone(&two.cameras[which]), two.then.clone());
            if !self.refuses_other_field(&then, &found.camera) {
                self.use_found_camera(found);
            }
        }
    }
}

/// Whether a base is at the position of a found camera.
fn is_at(found: &AutocalibratedCamera, base: &CameraBase) -> bool {
    (found.base.position_m - base.position_m).norm() < 1e-6
}
