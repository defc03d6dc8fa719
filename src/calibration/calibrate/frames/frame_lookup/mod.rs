//! Where each camera of a document usually looks and how fast it moves, updated incrementally.
//!
//! Every solve needs both as a prior. Computing them from all frames each time would make solving a
//! document quadratic in its length. The lookup therefore keeps, for each camera, the sorted values
//! of its accepted frames and which frames have clicks; for each shot, the solved frames in the
//! order of the video and the sorted speeds between them. A changed frame changes a few entries of
//! these lists, and a prior that leaves one frame out is read off them without a copy.

mod accepted;
mod shot;
mod sorted;

use crate::calibrate::BaseReadiness;
use accepted::Accepted;
use shot::{Moment, Shot};
use std::collections::{BTreeMap, BTreeSet};
use touchline_core::camera::Ptz;
use touchline_core::solve::MotionPrior;
use touchline_documents::document::{
    CameraId, Clip, Document, Frame, FrameChanges, FramePtz, FrameStatus, Frames,
};

/// Priors of a document's cameras. It is valid for the document that it was built from or last
/// updated with; an update takes time only for frames that have changed.
#[derive(Clone, Debug, Default)]
pub struct FrameLookup {
    /// The frames as of the last update, by their index in the document.
    frames: Frames,
    accepted: BTreeMap<CameraId, Accepted>,
    shots: BTreeMap<ShotKey, Shot>,
    clicked: BTreeMap<CameraId, ClickedFrames>,
}

/// The frames of a camera that have clicks, and what all its frames contribute to its base.
#[derive(Clone, Debug, Default)]
struct ClickedFrames {
    places: BTreeSet<usize>,
    readiness: BaseReadiness,
}

/// Solved frames with the same key form one sequence.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct ShotKey {
    camera: CameraId,
    clip: Option<Clip>,
    video: String,
}

impl FrameLookup {
    /// Builds the lookup of a document.
    pub fn from_document(document: &Document) -> Self {
        let mut accepted: BTreeMap<CameraId, Vec<Ptz>> = BTreeMap::new();
        let mut shots: BTreeMap<ShotKey, BTreeMap<Moment, Ptz>> = BTreeMap::new();
        let mut clicked: BTreeMap<CameraId, ClickedFrames> = BTreeMap::new();
        for (index, frame) in document.frames.iter().enumerate() {
            if let Some(ptz) = accepted_ptz(frame) {
                accepted.entry(frame.camera.clone()).or_default().push(ptz);
            }
            if let Some((key, number, ptz)) = ptz_in_shot(frame) {
                shots.entry(key).or_default().insert((number, index), ptz);
            }
            // A frame without clicks also counts if it was excluded from the base.
            let readiness = BaseReadiness::from_frame(frame);
            if !frame.clicks.is_empty() || readiness != BaseReadiness::default() {
                let of_camera = clicked.entry(frame.camera.clone()).or_default();
                of_camera.readiness += readiness;
                if !frame.clicks.is_empty() {
                    of_camera.places.insert(index);
                }
            }
        }
        Self {
            clicked,
            frames: document.frames.clone(),
            accepted: accepted
                .into_iter()
                .map(|(camera, all)| (camera, Accepted::from_ptz(&all)))
                .collect(),
            shots: shots
                .into_iter()
                .map(|(key, solved)| (key, Shot::new(solved)))
                .collect(),
        }
    }

    /// Updates the lookup after changes of the document. If frames were added, removed or
    /// reordered, it is built anew.
    pub fn update(&mut self, document: &Document) {
        let FrameChanges::At(changed) = document.frames.changes_since(&self.frames) else {
            *self = Self::from_document(document);
            return;
        };
        let before = std::mem::replace(&mut self.frames, document.frames.clone());
        for index in changed {
            self.replace(index, &before[index], &document.frames[index]);
        }
    }

    fn replace(&mut self, index: usize, before: &Frame, frame: &Frame) {
        // Clicks and readiness, also if the frame has moved to another camera.
        let clicked = [before, frame].map(|frame| {
            (
                &frame.camera,
                !frame.clicks.is_empty(),
                BaseReadiness::from_frame(frame),
            )
        });
        if clicked[0] != clicked[1] {
            let [(camera, _, readiness), added] = clicked;
            let of_camera = self.clicked.entry(camera.clone()).or_default();
            of_camera.places.remove(&index);
            of_camera.readiness -= readiness;
            let (camera, has_clicks, readiness) = added;
            let of_camera = self.clicked.entry(camera.clone()).or_default();
            of_camera.readiness += readiness;
            if has_clicks {
                of_camera.places.insert(index);
            }
        }
        // Accepted cameras. Within one camera, removal and insertion are one change, so that the
        // gaps of pan are recomputed once.
        let accepted = [before, frame].map(|frame| Some((&frame.camera, accepted_ptz(frame)?)));
        if accepted[0] != accepted[1] {
            let same_camera = before.camera == frame.camera;
            let [removed, added] = accepted.map(|accepted| accepted.map(|(_, ptz)| ptz));
            if same_camera {
                self.accepted
                    .entry(frame.camera.clone())
                    .or_default()
                    .change(removed, added);
            } else {
                self.accepted
                    .entry(before.camera.clone())
                    .or_default()
                    .change(removed, None);
                self.accepted
                    .entry(frame.camera.clone())
                    .or_default()
                    .change(None, added);
            }
        }
        // The solved frames of a shot, and the speeds beside the change.
        let solved = [before, frame].map(ptz_in_shot);
        if solved[0] != solved[1] {
            let [removed, added] = solved;
            if let Some((key, number, _)) = removed {
                self.shots.entry(key).or_default().remove((number, index));
            }
            if let Some((key, number, ptz)) = added {
                self.shots
                    .entry(key)
                    .or_default()
                    .insert((number, index), ptz);
            }
        }
    }

    /// The indices of a camera's frames that have clicks, ascending.
    pub fn clicked_frames(&self, camera: &CameraId) -> Vec<usize> {
        self.clicked
            .get(camera)
            .map(|clicked| clicked.places.iter().copied().collect())
            .unwrap_or_default()
    }

    /// Number of a camera's frames that have clicks.
    pub fn clicked_frame_count(&self, camera: &CameraId) -> usize {
        self.clicked
            .get(camera)
            .map_or(0, |clicked| clicked.places.len())
    }

    /// What a camera's frames contribute to its base.
    pub fn readiness(&self, camera: &CameraId) -> BaseReadiness {
        self.clicked
            .get(camera)
            .map(|clicked| clicked.readiness)
            .unwrap_or_default()
    }

    /// The prior of a frame from all others: the ranges of its camera's accepted frames, and the
    /// nearest solved frame of its shot with the usual motion from there. Empty for an index that
    /// the document does not have.
    ///
    /// The frame itself is excluded; otherwise a wrong solution would confirm itself when it is
    /// solved again.
    pub fn prior(&self, index: usize) -> MotionPrior {
        let Some(frame) = self.frames.get(index) else {
            return MotionPrior::default();
        };
        // Both parts are read off sorted lists. To build them anew without the frame would take a
        // pass over the document for each solve.
        let seen = self
            .accepted
            .get(&frame.camera)
            .and_then(|accepted| accepted.without(accepted_ptz(frame)));
        let motion =
            shot_of(frame).and_then(|(key, number)| self.shots.get(&key)?.motion((number, index)));
        MotionPrior { seen, motion }
    }
}

/// Pan, tilt and focal length of an accepted frame.
fn accepted_ptz(frame: &Frame) -> Option<Ptz> {
    frame
        .ptz
        .as_ref()
        .filter(|_| frame.status == FrameStatus::Reference)
        .map(FramePtz::ptz)
}

/// The shot of a frame of a video, and its frame number there.
fn shot_of(frame: &Frame) -> Option<(ShotKey, u64)> {
    let video = frame.video.as_ref()?;
    let key = ShotKey {
        camera: frame.camera.clone(),
        clip: frame.clip.clone(),
        video: video.path.clone(),
    };
    Some((key, video.frame_index))
}

/// The shot, frame number, and pan, tilt and focal length of a solved frame of a video.
fn ptz_in_shot(frame: &Frame) -> Option<(ShotKey, u64, Ptz)> {
    let ptz = frame
        .ptz
        .as_ref()
        .filter(|_| frame.status != FrameStatus::Rejected && frame.vouches())?
        .ptz();
    let (key, number) = shot_of(frame)?;
    Some((key, number, ptz))
}

#[cfg(test)]
mod tests;
