//! Labelling a match: from the pictures of its frames, and the clicks if there are any, to a camera
//! for each.
//!
//! 0. The shots of a video are found, and which of them show a field (`shots.rs`). Where clicks
//!    determine the camera of a video, it is labelled from them (`clicked_match.rs`).
//!    Else:
//! 1. Where the user has venue files, their cameras are tried (`venue_choice.rs`). Else the camera
//!    is found from some frames, evenly spread over all
//!    ([`find_camera`](crate::autocalibrate::find_camera)).
//! 2. Sampled frames that overlap with none of the others belong to another camera, and so do shots
//!    that overlap but are not answered. They are split off and searched in their turn, whether the
//!    one before was found or not (`find_cameras.rs`, `other_cameras.rs`).
//! 3. The frames that were not sampled follow. Those of a video are tracked from the others, and
//!    the base is refined on the paint of all of them; shots without a known frame are answered by
//!    a forest that learns from the tracked frames, and are tracked in their turn. For images, a
//!    forest is trained on the frames that lie on their paint, and queried.

use super::clip_evidence::ClipEvidences;
use super::forest_labels::{
    ForestRequest, LearnForestError, LearningProgress, LearntForest, PictureFiles, label_frames,
    learn_from_frames,
};
use super::kept_work::KeptWork;
use super::no_camera::NoCamera;
use super::shots::mark_shots;
use super::track_clips::{TrackingEvent, TrackingOptions, track_kept_clips};
use super::venues::{Venue, VenueEvent};
use crate::autocalibrate::{AutocalibrationError, AutocalibrationProgress};
use crate::calibrate::{AutocalibratedCamera, clips};
use crate::proposals::{FeatureStore, LearnOptions, PictureError, WorkFolder};
use std::path::Path;
use std::sync::Arc;
use thiserror::Error;
use touchline_core::camera::CameraBase;
use touchline_core::field::FieldError;
use touchline_core::progress::{Progress, Share};
use touchline_documents::document::{
    CameraId, Document, DocumentAt, FrameStatus, Shot, ShotContent, ShotKind, frames_in_transitions,
};
use touchline_vision::media::ReadFrames;
use touchline_vision::relocalize::{ForestModel, RelocalizeOptions};

/// Options of labelling a match.
#[derive(Clone, Debug, PartialEq)]
pub struct MatchOptions {
    /// Maximum number of frames from which each camera is found. 40 by default.
    pub sampled_frames: usize,
    /// Whether the other frames are labelled as well. True by default.
    pub label_the_rest: bool,
    /// Whether the shots of a video are found first, which reads all its frames. True by default.
    pub find_shots: bool,
    /// The folder in which finished parts of the work are kept, by content: work that was stopped
    /// goes on from there, and memory does not grow with the length of a video. None by default:
    /// nothing is kept.
    pub work: Option<WorkFolder>,
    /// Venues whose cameras are tried before one is searched. None by default.
    pub venues: Vec<Venue>,
}

impl Default for MatchOptions {
    fn default() -> Self {
        Self {
            sampled_frames: 40,
            label_the_rest: true,
            find_shots: true,
            work: None,
            venues: Vec::new(),
        }
    }
}

/// Events while a match is labelled.
#[derive(Debug)]
pub enum MatchEvent {
    /// The frames of a video are compared with their neighbours to find its shots.
    FindingShots(Share),
    /// The shots are known.
    Shots {
        /// Number of shots.
        shots: usize,
        /// Number of fades, dissolves and wipes between them.
        transitions: usize,
        /// Number of shots that show no field.
        without_field: usize,
    },
    /// A venue is tried, or its camera was recognised or not.
    Venue(VenueEvent),
    /// Progress of the search for a camera.
    Searching(AutocalibrationProgress),
    /// The picture of a frame cannot be read. The search continues with the others.
    Unreadable {
        /// The frame's name.
        frame: String,
        /// Why.
        error: PictureError,
    },
    /// A camera was found.
    Found {
        /// Id of the camera.
        camera: CameraId,
        /// The camera.
        found: Arc<AutocalibratedCamera>,
        /// For every camera but the first: number of sampled frames that overlap with none of the
        /// cameras before.
        separate_frames: Option<usize>,
        /// The present document, which has this camera: what is written now survives whatever ends
        /// the program.
        document: Box<Document>,
    },
    /// Sampled frames that matched none of a known camera's show it all the same: the search from
    /// them ended where that camera stands.
    Joined {
        /// Id of the known camera.
        camera: CameraId,
        /// Number of the frames.
        frames: usize,
        /// The present document.
        document: Box<Document>,
    },
    /// The clicks give the camera, and the frames tracked from them lie on their paint.
    FromClicks {
        /// Id of the camera.
        camera: CameraId,
        /// Its base.
        base: Option<Box<CameraBase>>,
    },
    /// One of several cameras was not found; its frames stay without one.
    NotFound {
        /// The present document.
        document: Box<Document>,
        /// Id of the camera.
        camera: CameraId,
        /// Why there is no answer.
        why: NoCamera,
        /// For every camera but the first: number of sampled frames that overlap with none of the
        /// cameras before.
        separate_frames: Option<usize>,
    },
    /// A forest is trained on the frames that were found.
    Learning(LearningProgress),
    /// The forest is queried for the other frames.
    Asking {
        /// Number of frames done.
        done: usize,
        /// Total number of frames.
        of: usize,
    },
    /// The other frames of a video are tracked.
    Tracking(TrackingEvent),
}

/// The result of labelling a match.
#[derive(Debug)]
pub enum MatchLabels {
    /// Its frames have cameras.
    Labelled(LabelledMatch),
    /// No camera was found, for this reason the first; the document is unchanged.
    NoCamera(NoCamera),
}

/// The cameras of a match that was labelled.
#[derive(Debug)]
pub struct LabelledMatch {
    /// The cameras that were found by a search; empty where clicks gave the camera.
    pub cameras: Vec<Arc<AutocalibratedCamera>>,
    /// Number of frames that were not sampled and have a camera now.
    pub answered: usize,
    /// Number of frames without a camera; rejected ones and those between shots do not count.
    pub unanswered: usize,
    /// Whether the work was cancelled after the first camera was found. What was done until then
    /// is in the document.
    pub is_stopped: bool,
}

impl LabelledMatch {
    /// The cameras of a match with the counts of its frames, of which `open` had none at first.
    pub(super) fn count(
        document: &Document,
        cameras: Vec<Arc<AutocalibratedCamera>>,
        open: &[usize],
    ) -> Self {
        // Counted frame by frame, and not as a difference of two counts: a refined base may also
        // take the camera from a frame that had one.
        let frames = &document.frames;
        let answered = open.iter().filter(|&&index| frames[index].ptz.is_some());
        Self {
            cameras,
            answered: answered.count(),
            unanswered: frames_without_camera(document).len(),
            is_stopped: false,
        }
    }
}

/// Why a match could not be labelled.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LabelMatchError {
    /// The search failed, or was cancelled.
    #[error(transparent)]
    Search(#[from] AutocalibrationError),
    /// The field of a camera is not valid.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// No forest could be trained for the frames that were not sampled.
    #[error(transparent)]
    Learn(#[from] LearnForestError),
}

/// Labels the frames of a document that has no cameras yet: finds `camera`, to which they all are
/// assigned, from the clicks in them or without any, and the other cameras among them, and writes
/// the cameras of all frames as suggestions. `folder` is where the document's relative paths start.
///
/// A cancellation before the first camera is found is an error; after that it ends the work, and
/// what is done stays ([`LabelledMatch::is_stopped`]).
///
/// # Errors
/// The field is not valid, features cannot be found, no forest can be trained, or `progress`
/// cancelled the search for the first camera.
pub fn label_match(
    document: &mut Document,
    folder: &Path,
    camera: &CameraId,
    reader: &mut dyn ReadFrames,
    options: &MatchOptions,
    progress: &Progress<'_, MatchEvent>,
) -> Result<MatchLabels, LabelMatchError> {
    let mut labelling = Labelling {
        document,
        folder,
        reader,
        options,
        progress,
        work: Arc::new(
            options
                .work
                .as_ref()
                .map_or_else(KeptWork::none, KeptWork::in_folder),
        ),
    };
    if options.find_shots && has_video(labelling.document) {
        labelling.find_shots()?;
    }
    if options.label_the_rest
        && let Some(labelled) = labelling.label_from_clicks(camera)?
    {
        return Ok(MatchLabels::Labelled(labelled));
    }
    let cameras = match labelling.find_cameras(camera)? {
        Ok(cameras) => cameras,
        Err(why) => return Ok(MatchLabels::NoCamera(why)),
    };
    // Then the frames that were not sampled.
    let open = frames_without_camera(labelling.document);
    if options.label_the_rest && !open.is_empty() && !progress.is_cancelled() {
        labelling.label_the_rest(&cameras)?;
    }
    let labelled = LabelledMatch {
        is_stopped: progress.is_cancelled(),
        ..LabelledMatch::count(labelling.document, cameras, &open)
    };
    Ok(MatchLabels::Labelled(labelled))
}

/// The indices of a document's frames that have no camera, without rejected ones, which a person
/// decided on, and those of transitions between shots, which show two pictures or none.
pub(super) fn frames_without_camera(document: &Document) -> Vec<usize> {
    let is_between_shots = frames_in_transitions(document);
    (0..document.frames.len())
        .filter(|&index| {
            let frame = &document.frames[index];
            frame.ptz.is_none() && frame.status != FrameStatus::Rejected && !is_between_shots[index]
        })
        .collect()
}

/// Trains a forest on those frames of found cameras that are aligned to their own paint, as if the
/// user had accepted them; in the document they stay suggestions. The document holds the cameras
/// as `found` has them. None if `progress` cancelled it.
///
/// # Errors
/// No frame gives a training sample, or the document's cameras cannot be serialised.
pub fn learn_from_found(
    at: DocumentAt<'_>,
    found: &[Arc<AutocalibratedCamera>],
    reader: &mut dyn ReadFrames,
    store: &FeatureStore,
    progress: &Progress<'_, LearningProgress>,
) -> Result<Option<LearntForest>, LearnForestError> {
    let frames = found.iter().flat_map(|found| &found.frames);
    // The training frames, in the document's order.
    let mut on_paint: Vec<usize> = frames
        .filter(|frame| frame.snapped.is_some())
        .map(|frame| frame.index)
        .collect();
    on_paint.sort_unstable();
    learn_from_frames(
        at,
        &on_paint,
        reader,
        store,
        &LearnOptions::default(),
        progress,
    )
}

/// Queries a forest for frames of a document and aligns the answers to their paint.
///
/// # Errors
/// A field of the document is not valid.
pub(super) fn query_forest(
    document: &mut Document,
    files: PictureFiles<'_>,
    reader: &mut dyn ReadFrames,
    frames: &[usize],
    model: &ForestModel,
    progress: &Progress<'_, MatchEvent>,
) -> Result<(), FieldError> {
    // There is one forest, so its generation distinguishes nothing.
    let forest = ForestRequest {
        model,
        generation: 0,
        options: RelocalizeOptions::default(),
    };
    let of = frames.len();
    let progress = progress.part(|done| MatchEvent::Asking { done, of });
    label_frames(document, files, reader, frames, &forest, true, &progress)?;
    Ok(())
}

/// Whether some frames are of a video. Others can be tracked only if they are a sequence.
pub(super) fn has_video(document: &Document) -> bool {
    document.frames.iter().any(|frame| frame.video.is_some())
}

/// The state while a match is labelled.
pub(super) struct Labelling<'a> {
    pub document: &'a mut Document,
    pub folder: &'a Path,
    pub reader: &'a mut dyn ReadFrames,
    pub options: &'a MatchOptions,
    pub progress: &'a Progress<'a, MatchEvent>,
    /// The finished parts.
    pub work: Arc<KeptWork>,
}

impl Labelling<'_> {
    /// The features of pictures; on disk where work is kept.
    pub(super) fn feature_store(&self) -> FeatureStore {
        let folder = self.options.work.as_ref();
        folder.map_or_else(FeatureStore::in_memory, FeatureStore::on_disk)
    }

    /// Finds the shots of videos that have none in the document yet.
    fn find_shots(&mut self) -> Result<(), AutocalibrationError> {
        let progress = self.progress.part(MatchEvent::FindingShots);
        mark_shots(
            self.document,
            self.folder,
            self.reader,
            &self.work,
            &progress,
        );
        if progress.is_cancelled() {
            return Err(AutocalibrationError::Stopped);
        }
        let count = |is_one: fn(&Shot) -> bool| {
            let shots = self.document.shots.iter();
            shots.filter(|shot| is_one(shot)).count()
        };
        let transitions = count(|shot| shot.kind == ShotKind::Transition);
        let _ = self.progress.report(MatchEvent::Shots {
            shots: self.document.shots.len() - transitions,
            transitions,
            without_field: count(|shot| shot.content == Some(ShotContent::NoField)),
        });
        Ok(())
    }

    /// Labels the frames that have no camera yet: by tracking if the document has videos, else by a
    /// forest.
    fn label_the_rest(
        &mut self,
        found: &[Arc<AutocalibratedCamera>],
    ) -> Result<(), LabelMatchError> {
        if !has_video(self.document) {
            return self.label_by_forest(found);
        }
        // The base comes from the sampled frames only, so it is refined on all of them.
        self.track_known_shots(true)?;
        // Shots without a sampled frame of their own camera are answered by a forest.
        if !self.progress.is_cancelled() {
            let mut document = self.document.clone();
            match self.label_other_shots(&mut document) {
                Ok(true) => {
                    *self.document = document;
                    self.track_known_shots(false)?;
                }
                // What was tracked stays where nothing can be learnt from it.
                Ok(false) | Err(LabelMatchError::Learn(_)) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Tracks the shots in which a frame has a camera and another one has none.
    fn track_known_shots(&mut self, refine_base: bool) -> Result<(), LabelMatchError> {
        let options = TrackingOptions {
            refine_base,
            ..TrackingOptions::default()
        };
        let mut clips = clips(self.document.at(self.folder), None);
        clips.retain(|clip| {
            let places = || clip.frames.iter().filter_map(|frame| frame.place);
            let is_known = |place: usize| self.document.frames[place].ptz.is_some();
            places().any(is_known) && !places().all(is_known)
        });
        let progress = self.progress.part(MatchEvent::Tracking);
        track_kept_clips(
            self.document,
            self.folder,
            &clips,
            self.reader,
            &options,
            &mut ClipEvidences::in_work(Arc::clone(&self.work)),
            &progress,
        )?;
        Ok(())
    }

    /// Trains a forest on the frames that were found and queries it for the rest.
    fn label_by_forest(
        &mut self,
        found: &[Arc<AutocalibratedCamera>],
    ) -> Result<(), LabelMatchError> {
        let store = self.feature_store();
        let at = self.document.at(self.folder);
        let progress = self.progress.part(MatchEvent::Learning);
        let Some(learnt) = learn_from_found(at, found, &mut *self.reader, &store, &progress)?
        else {
            return Ok(());
        };
        let open = frames_without_camera(self.document);
        let files = PictureFiles {
            folder: self.folder,
            store: &store,
        };
        query_forest(
            self.document,
            files,
            self.reader,
            &open,
            &learnt.model,
            self.progress,
        )?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchline_core::geometry::ImageSize;
    use touchline_documents::testing::{new_frame, ptz_at, soccer_document};

    #[test]
    fn a_rejected_frame_wants_no_camera() {
        let mut document = soccer_document();
        for number in 0..3 {
            let name = format!("{number}.jpg");
            let frame = new_frame(&name, ImageSize::new(64, 36));
            document.frames.push(frame.into());
        }
        document.frames[0].ptz = ptz_at(0.0, -9.0, 90.0);
        document.frames[1].status = FrameStatus::Rejected;
        assert_eq!(frames_without_camera(&document), [2]);
    }
}
