//! Why the commands of clip tracking are not available, as sentences for their tooltips. A command
//! without such a reason can start.

use super::ClipTrackingState;
use crate::app::{App, Command};

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
    pub(super) fn why_not_track(&self) -> Option<&'static str> {
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
