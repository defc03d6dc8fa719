//! Labelling a match whose clicks determine its camera: no search is needed.
//!
//! 1. The clicks give the base, as for one frame with four landmarks they do.
//! 2. The shots with clicks are tracked from the clicked frames, and the base is refined on the
//!    paint of all their frames.
//! 3. A forest learns from the tracked frames and is queried for some frames of the other shots;
//!    the shots in which it is certain are tracked from these.
//!
//! The paint judges what the clicks say: where the tracked frames do not lie on it, nothing is
//! answered, and the search of [`label_match`](super::label_match) follows.

use super::clip_evidence::ClipEvidences;
use super::forest_labels::{PictureFiles, is_certain, learn_from_frames};
use super::kept_work::DocumentChange;
use super::match_labels::{
    LabelMatchError, LabelledMatch, Labelling, MatchEvent, frames_without_camera, has_video,
    query_forest,
};
use super::track_clips::{
    TrackingEvent, TrackingOptions, give_first_base, mean_confidence, track_kept_clips,
};
use crate::calibrate::{ClipFrames, clips};
use crate::proposals::LearnOptions;
use std::collections::BTreeMap;
use std::sync::Arc;
use touchline_core::geometry::subsample;
use touchline_core::solve::base::BaseOptions;
use touchline_documents::document::{Camera, CameraId, Document, ShotContent, shots_of_frames};

/// Minimum mean confidence of the tracked frames. Where the clicks give a wrong base, the paint
/// contradicts most of them.
const MIN_CONFIDENCE: f64 = 0.5;

/// Maximum number of tracked frames that a forest learns from, and of frames of other shots that it
/// is queried for, where these shots are not too many.
const MAX_LEARNT: usize = 60;
const MAX_ASKED: usize = 60;

/// Minimum number of frames of a shot that the forest is queried for, however many shots there are.
const MIN_ASKED_OF_SHOT: usize = 3;

impl Labelling<'_> {
    /// Labels a match from the clicks in its frames. None, with the document unchanged, where the
    /// clicks determine no camera, or one that the paint contradicts; and for images of which most
    /// get no camera, as they are no sequence.
    ///
    /// # Errors
    /// The field of a camera is not valid, or the forest for the other shots cannot be trained.
    pub(super) fn label_from_clicks(
        &mut self,
        camera: &CameraId,
    ) -> Result<Option<LabelledMatch>, LabelMatchError> {
        let mut trial = self.document.clone();
        let options = BaseOptions::default();
        let Ok(renamed) = give_first_base(&mut trial, self.folder, camera, &options) else {
            return Ok(None);
        };
        if let Some(names) = renamed {
            let event = TrackingEvent::Renamed(camera.clone(), names);
            let _ = self.progress.report(MatchEvent::Tracking(event));
        }
        let open = frames_without_camera(&trial);
        let clips = clips(trial.at(self.folder), None);
        let mut evidence = ClipEvidences::in_work(Arc::clone(&self.work));
        self.track(&mut trial, &clips, true, &mut evidence)?;
        if mean_confidence(&trial) < MIN_CONFIDENCE {
            return Ok(None);
        }
        if self.label_other_shots(&mut trial)? {
            self.track(&mut trial, &clips, false, &mut evidence)?;
        }
        let labelled = LabelledMatch::count(&trial, Vec::new(), &open);
        if !has_video(&trial) && labelled.unanswered > labelled.answered {
            return Ok(None);
        }
        *self.document = trial;
        // The work is done and cannot be cancelled.
        let _ = self.progress.report(MatchEvent::FromClicks {
            camera: camera.clone(),
            base: self
                .document
                .camera(camera)
                .and_then(Camera::base)
                .map(Box::new),
        });
        Ok(Some(labelled))
    }

    fn track(
        &mut self,
        document: &mut Document,
        clips: &[ClipFrames],
        refine_base: bool,
        evidence: &mut ClipEvidences,
    ) -> Result<(), LabelMatchError> {
        let options = TrackingOptions {
            refine_base,
            ..TrackingOptions::default()
        };
        let progress = self.progress.part(MatchEvent::Tracking);
        track_kept_clips(
            document,
            self.folder,
            clips,
            self.reader,
            &options,
            evidence,
            &progress,
        )?;
        Ok(())
    }

    /// Queries a forest that learns from the tracked frames for some of the frames that tracking
    /// did not reach, or takes its answers where they were kept. True if it is certain of any.
    pub(super) fn label_other_shots(
        &mut self,
        document: &mut Document,
    ) -> Result<bool, LabelMatchError> {
        let key = self.work.begin_key("other shots").and_then(|mut parts| {
            let at = document.at(self.folder);
            parts.add_document(at);
            parts.add_frames(at);
            parts.finish()
        });
        let kept: Option<(bool, DocumentChange)> =
            key.as_ref().and_then(|key| self.work.recall(key));
        if let Some((is_certain, change)) = kept
            && let Some(changed) = change.apply(document)
        {
            *document = changed;
            return Ok(is_certain);
        }
        let before = document.clone();
        let is_certain = self.ask_forest_of_other_shots(document)?;
        if let Some(key) = key.filter(|_| !self.progress.is_cancelled())
            && let Some(change) = DocumentChange::between(&before, document)
        {
            self.work.keep(&key, &(is_certain, change));
        }
        Ok(is_certain)
    }

    fn ask_forest_of_other_shots(
        &mut self,
        document: &mut Document,
    ) -> Result<bool, LabelMatchError> {
        let open = frames_to_ask(document);
        if open.is_empty() || self.progress.is_cancelled() {
            return Ok(false);
        }
        let certain =
            (0..document.frames.len()).filter(|&index| is_certain(&document.frames[index]));
        let learnt: Vec<usize> = subsample(certain.collect::<Vec<_>>(), MAX_LEARNT).collect();
        if learnt.is_empty() {
            return Ok(false);
        }
        let store = self.feature_store();
        let at = document.at(self.folder);
        let progress = self.progress.part(MatchEvent::Learning);
        let options = LearnOptions::default();
        let Some(forest) =
            learn_from_frames(at, &learnt, self.reader, &store, &options, &progress)?
        else {
            return Ok(false);
        };
        let files = PictureFiles {
            folder: self.folder,
            store: &store,
        };
        query_forest(
            document,
            files,
            self.reader,
            &open,
            &forest.model,
            self.progress,
        )?;
        Ok(open
            .iter()
            .any(|&index| is_certain(&document.frames[index])))
    }
}

/// Some frames without a camera of the shots that show a field, of each about as many: about
/// [`MAX_ASKED`] of all shots, or more where the shots are many.
fn frames_to_ask(document: &Document) -> Vec<usize> {
    let shots = shots_of_frames(document);
    let mut open: BTreeMap<Option<usize>, Vec<usize>> = BTreeMap::new();
    for frame in frames_without_camera(document) {
        let shot = shots[frame];
        let content = shot.and_then(|shot| document.shots[shot].content);
        if content != Some(ShotContent::NoField) {
            open.entry(shot).or_default().push(frame);
        }
    }
    let of_shot = MAX_ASKED.div_ceil(open.len().max(1)).max(MIN_ASKED_OF_SHOT);
    let mut queried: Vec<usize> = open
        .into_values()
        .flat_map(|frames| subsample(frames, of_shot))
        .collect();
    queried.sort_unstable();
    queried
}
