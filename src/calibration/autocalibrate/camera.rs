//! The search for a document's camera from end to end: sample the frames, match them, find
//! candidates for the base from clicks or from all places around the field, and decide between
//! them.

use crate::autocalibrate::adjustment::candidates::{
    PosesFrom, adjust_panoramas, find_panoramas, sort_best_first,
};
use crate::autocalibrate::adjustment::evidence::MIN_NATS;
use crate::autocalibrate::adjustment::hypothesis::Hypothesis;
use crate::autocalibrate::adjustment::refine::SearchedCamera;
use crate::autocalibrate::court::{CourtAnswer, search_court};
use crate::autocalibrate::error::Stop;
use crate::autocalibrate::field_prior::FieldPrior;
use crate::autocalibrate::frames::by_shot::{frames_of_fields, spread_over_shots_and_clicks};
use crate::autocalibrate::frames::matched_frames::MatchedFrames;
use crate::autocalibrate::frames::sampled_frames::{
    MAX_PICTURES_IN_MEMORY, PictureOfFrame, SampledFrame, sample_frames,
};
use crate::autocalibrate::progress::report;
use crate::autocalibrate::search::clicked::GroundClick;
use crate::autocalibrate::search::focal_scales::PartsOfStage;
use crate::autocalibrate::search::places::{SearchPlaces, has_repeating_lines, is_court};
use crate::autocalibrate::verdict::checks::contradicting_click;
use crate::autocalibrate::verdict::decision::Decision;
use crate::autocalibrate::verdict::wanted_clicks::wanted_clicks;
use crate::autocalibrate::{
    Abstention, AutocalibrationAnswer, AutocalibrationError, AutocalibrationProgress,
};
use crate::calibrate::kept::{KeepParts, NothingKept, from_bytes, to_bytes};
use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet};
use touchline_core::progress::Progress;
use touchline_documents::document::{CameraId, DocumentAt, FrameStatus};
use touchline_vision::features::Features;

/// Fewer clicks on landmarks of the ground determine no pose.
const MIN_CLICKS: usize = 2;

/// Finds a camera of a document from its frames' pictures, with the help of the clicks on landmarks
/// of the ground that there are. Samples at most `look_at` frames, spread evenly over all of them.
/// `picture` may be called for a frame more than once, because not all pictures are kept in memory.
///
/// Two or more clicks, in one frame or in several, determine the poses to begin with. Where these
/// give no answer, the camera is searched by its pictures alone, and the clicks, which then played
/// no part, confirm or contradict what is found.
///
/// # Errors
/// The search was stopped, the field of the document is not usable, or OpenCV is missing or failed.
/// An uncertain answer is no error but [`AutocalibrationAnswer::Abstained`].
pub fn find_camera(
    document: DocumentAt<'_>,
    camera: &CameraId,
    look_at: usize,
    picture: PictureOfFrame<'_>,
    progress: &Progress<'_, AutocalibrationProgress>,
) -> Result<AutocalibrationAnswer, AutocalibrationError> {
    let whole = SearchExtent {
        look_at,
        most_stages: usize::MAX,
        parts: &NothingKept,
    };
    find_camera_in_stages(document, camera, whole, picture, progress)
}

/// How far a search goes, and where its finished parts are kept.
#[derive(Clone, Copy)]
pub(crate) struct SearchExtent<'a> {
    /// Maximum number of sampled frames.
    pub look_at: usize,
    /// Maximum number of stages.
    pub most_stages: usize,
    /// The parts that the same search finished before.
    pub parts: &'a dyn KeepParts,
}

/// As [`find_camera`], in at most so many stages, each of which begins with
/// [`AutocalibrationProgress::Gathering`]: the answer after the last of them counts.
pub(crate) fn find_camera_in_stages(
    document: DocumentAt<'_>,
    camera: &CameraId,
    extent: SearchExtent<'_>,
    picture: PictureOfFrame<'_>,
    progress: &Progress<'_, AutocalibrationProgress>,
) -> Result<AutocalibrationAnswer, AutocalibrationError> {
    let mut search = Search::new(document, camera, progress)?;
    search.most_stages = extent.most_stages;
    search.parts = extent.parts;
    let clicks = GroundClick::from_frames(
        &document.frames,
        &search.of_camera,
        &search.field_prior.assumed,
    );
    search.clicks = clicks;
    search.run(extent.look_at, picture)
}

/// Finds a camera of a document from its frames' pictures alone, as [`find_camera`] does without
/// clicks; those of the document are not read.
///
/// # Errors
/// As [`find_camera`].
pub fn camera_without_clicks(
    document: DocumentAt<'_>,
    camera: &CameraId,
    look_at: usize,
    picture: PictureOfFrame<'_>,
    progress: &Progress<'_, AutocalibrationProgress>,
) -> Result<AutocalibrationAnswer, AutocalibrationError> {
    Search::new(document, camera, progress)?.run(look_at, picture)
}

struct Search<'a> {
    searched: SearchedCamera<'a>,
    field_prior: FieldPrior,
    /// Indices of the camera's frames in the document, without rejected ones and those of
    /// transitions and shots without a field.
    of_camera: Vec<usize>,
    /// The clicks that the search may use, with frames by their index in the document.
    clicks: Vec<GroundClick>,
    /// The number of stages until now: each finds candidates in one way and decides.
    stages: Cell<usize>,
    most_stages: usize,
    parts: &'a dyn KeepParts,
    progress: &'a Progress<'a, AutocalibrationProgress>,
}

impl<'a> Search<'a> {
    /// A search that uses no clicks.
    fn new(
        document: DocumentAt<'a>,
        camera: &'a CameraId,
        progress: &'a Progress<'a, AutocalibrationProgress>,
    ) -> Result<Self, AutocalibrationError> {
        let field_prior = FieldPrior::from_document(document, camera)?;
        let frames = document.document.frames.iter().enumerate();
        let of_camera = frames
            .filter(|(_, frame)| frame.camera == *camera && frame.status != FrameStatus::Rejected);
        Ok(Self {
            searched: SearchedCamera {
                document,
                camera,
                is_size_unknown: field_prior.is_size_unknown(),
            },
            of_camera: frames_of_fields(
                document.document,
                &of_camera.map(|(index, _)| index).collect::<Vec<_>>(),
            ),
            field_prior,
            clicks: Vec::new(),
            stages: Cell::new(0),
            most_stages: usize::MAX,
            parts: &NothingKept,
            progress,
        })
    }

    /// Returns the answer by at most so many sampled frames; abstaining is an answer, not an error.
    fn run(
        &self,
        max_sampled: usize,
        picture: PictureOfFrame<'_>,
    ) -> Result<AutocalibrationAnswer, AutocalibrationError> {
        if let Some(answer) = self.find_court(picture)? {
            return Ok(answer);
        }
        let matched = self
            .sample(&self.choose_frames(max_sampled), picture)
            .and_then(|sampled| MatchedFrames::from_sampled(&sampled, self.parts, self.progress))
            .map(|matched| self.with_stated_lens(matched));
        let (answer, matched) = match matched {
            Ok(matched) => (self.find(&matched, picture), Some(matched)),
            Err(stop) => (Err(stop), None),
        };
        match answer {
            Ok(answer) => Ok(answer),
            Err(Stop::Failed(error)) => Err(error),
            Err(Stop::Abstained(why)) => {
                let clicks = matched.and_then(|matched| {
                    let clicks = self.clicks_in_group(&matched);
                    wanted_clicks(&matched, &clicks, why.best())
                });
                Ok(AutocalibrationAnswer::Abstained { why, clicks })
            }
        }
    }

    /// The answer for a court, by the lines of single pictures. None for larger fields, where these
    /// are not decisive, where a click contradicts what was found, and where clicks may lead on.
    ///
    /// Where the pictures of a court do not decide one by one, neither does their panorama: seams
    /// and boards are most of its paint, and of no clip of a court it has given a camera.
    fn find_court(
        &self,
        picture: PictureOfFrame<'_>,
    ) -> Result<Option<AutocalibrationAnswer>, AutocalibrationError> {
        let field = &self.field_prior.assumed;
        if !is_court(field) {
            return Ok(None);
        }
        let answer = search_court(
            self.searched,
            field,
            &self.of_camera,
            picture,
            self.progress,
        )?;
        match answer {
            CourtAnswer::Found(found) => {
                let frames = &self.searched.document.document.frames;
                let contradicted = contradicting_click(&found, &self.clicks, frames);
                Ok(contradicted
                    .is_none()
                    .then_some(AutocalibrationAnswer::Found(found)))
            }
            CourtAnswer::NotFound(_) if self.clicks.len() >= MIN_CLICKS => Ok(None),
            CourtAnswer::NotFound(clicks) => Ok(Some(AutocalibrationAnswer::Abstained {
                why: Abstention::NoCourt,
                clicks,
            })),
        }
    }

    /// Whether another stage may follow.
    const fn may_go_on(&self) -> bool {
        self.stages.get() < self.most_stages
    }

    /// The matched frames with the lens that the document states of the camera.
    fn with_stated_lens(&self, matched: MatchedFrames) -> MatchedFrames {
        let SearchedCamera {
            document, camera, ..
        } = self.searched;
        match document.document.camera(camera) {
            Some(camera) => matched.with_lens(camera.stated_lens(), camera.image_size),
            None => matched,
        }
    }

    /// Finds candidates and decides between them; an abstention ends the stages early.
    fn find(
        &self,
        matched: &MatchedFrames,
        picture: PictureOfFrame<'_>,
    ) -> Result<AutocalibrationAnswer, Stop> {
        // Poses from clicks save the search.
        let field = &self.field_prior.assumed;
        let clicks = self.clicks_in_group(matched);
        if clicks.len() >= MIN_CLICKS {
            let origin = PosesFrom::Clicks(&clicks);
            let answer = self.find_among(origin, &mut Vec::new(), matched, picture);
            if !matches!(answer, Err(Stop::Abstained(_)))
                || is_court(field)
                || has_repeating_lines(field)
            {
                return answer;
            }
        } else if is_court(field) {
            // Without poses from clicks a court has no panorama: see `find_court`.
            return Err(Abstention::NoCourt.into());
        } else if has_repeating_lines(field) {
            return Err(Abstention::LinesRepeat.into());
        }
        // The usual place first. Where it gives no answer, all other places are searched, and what
        // they give competes with the candidates from the usual place.
        let mut candidates = Vec::new();
        let usual = PosesFrom::Places(&SearchPlaces::usual(field));
        let answer = self.find_among(usual, &mut candidates, matched, picture);
        if !matches!(answer, Err(Stop::Abstained(_))) || !self.may_go_on() {
            return answer;
        }
        let others = PosesFrom::Places(&SearchPlaces::others(field));
        let num_usual = candidates.len();
        let elsewhere = self.find_among(others, &mut candidates, matched, picture);
        match elsewhere {
            // Nothing elsewhere: the reason is that of the usual place.
            Err(Stop::Abstained(_)) if candidates.len() == num_usual => answer,
            elsewhere => elsewhere,
        }
    }

    /// Adds the candidates from `origin` to those that there are, and decides between all of them.
    /// Nothing fits if none is added. Of places that are not the usual one, only candidates count
    /// that may be an answer.
    fn find_among(
        &self,
        origin: PosesFrom<'_>,
        candidates: &mut Vec<Hypothesis>,
        matched: &MatchedFrames,
        picture: PictureOfFrame<'_>,
    ) -> Result<AutocalibrationAnswer, Stop> {
        let (prior, progress) = (&self.field_prior, self.progress);
        self.stages.set(self.stages.get() + 1);
        let mut decision = Decision {
            searched: self.searched,
            field_prior: prior,
            matched,
            clicks: &self.clicks,
            is_found_without_clicks: matches!(origin, PosesFrom::Places(_)),
            picture,
            progress,
        };
        let num_before = candidates.len();
        let parts = PartsOfStage {
            parts: self.parts,
            stage: self.stages.get(),
        };
        let placed = find_panoramas(matched, origin, prior, parts, progress)?;
        let mut added = adjust_panoramas(&placed, prior, matched, parts, progress)?;
        added.retain(|candidate| num_before == 0 || candidate.nats() >= MIN_NATS);
        if added.is_empty() {
            return Err(Abstention::NothingFits.into());
        }
        candidates.append(&mut added);
        sort_best_first(candidates);
        decision.decide(candidates.clone())
    }

    /// The clicks on matched frames, with frames numbered as in the group.
    fn clicks_in_group(&self, matched: &MatchedFrames) -> Vec<GroundClick> {
        let in_group = self.clicks.iter().filter_map(|click| {
            Some(GroundClick {
                frame: matched.number_of(click.frame)?,
                ..click.clone()
            })
        });
        in_group.collect()
    }

    /// The frames to sample: an even spread over those of the camera, with one of each shot where
    /// that is possible, and over those with a click.
    fn choose_frames(&self, max_sampled: usize) -> Vec<usize> {
        let clicked: BTreeSet<usize> = self.clicks.iter().map(|click| click.frame).collect();
        let clicked: Vec<usize> = clicked.into_iter().collect();
        let document = self.searched.document.document;
        spread_over_shots_and_clicks(document, &self.of_camera, &clicked, max_sampled)
    }

    /// Samples those of some frames whose picture can be read, a chunk at a time.
    fn sample(
        &self,
        indices: &[usize],
        picture: PictureOfFrame<'_>,
    ) -> Result<Vec<SampledFrame>, Stop> {
        let document = &self.searched.document;
        let masks_of = |index: usize| document.masks_of(&document.frames[index]);
        let mut sampled = Vec::new();
        for (chunk, some) in indices.chunks(MAX_PICTURES_IN_MEMORY).enumerate() {
            let done = chunk * MAX_PICTURES_IN_MEMORY;
            report(
                self.progress,
                AutocalibrationProgress::Looking {
                    done,
                    of: indices.len(),
                },
            )?;
            let name = format!("features-{}-{}", some[0], some[some.len() - 1]);
            let known = self.parts.recall(&name);
            let known: Option<BTreeMap<usize, Features>> =
                known.and_then(|bytes| from_bytes(&bytes));
            let is_known = known.is_some();
            let frames = sample_frames(some, masks_of, &known.unwrap_or_default(), picture)
                .map_err(AutocalibrationError::from)?;
            if !is_known {
                let features = frames
                    .iter()
                    .map(|frame| (frame.index, frame.features.clone()));
                let features: BTreeMap<usize, Features> = features.collect();
                self.parts.keep(&name, &to_bytes(&features));
            }
            sampled.extend(frames);
        }
        Ok(sampled)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::autocalibrate::rotating_camera::{document, draw_picture, ptz, soccer};
    use crate::calibrate::kept::KeptInMemory;
    use std::ops::ControlFlow;
    use std::path::Path;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// Searches among the views of a drawn camera until a number of pairs are matched. Returns the
    /// number of reported pairs.
    fn search_until(pairs: usize, parts: &KeptInMemory) -> usize {
        let (document, field, ptz) = (document(), soccer().assumed, ptz());
        let at = document.at(Path::new(""));
        let extent = SearchExtent {
            look_at: 40,
            most_stages: 1,
            parts,
        };
        let matched = AtomicUsize::new(0);
        let progress = Progress::new(|step| match step {
            AutocalibrationProgress::Tying { .. }
                if matched.fetch_add(1, Ordering::Relaxed) < pairs =>
            {
                ControlFlow::Continue(())
            }
            AutocalibrationProgress::Looking { .. } => ControlFlow::Continue(()),
            _ => ControlFlow::Break(()),
        });
        let mut picture =
            |index: usize| Some(draw_picture(&field, *ptz.get(index.checked_sub(10)?)?));
        let camera = CameraId::from("main");
        let _ = find_camera_in_stages(at, &camera, extent, &mut picture, &progress);
        drop(progress);
        matched.into_inner()
    }

    #[test]
    fn features_and_matches_of_a_killed_search_are_taken_up() {
        let parts = KeptInMemory::default();
        search_until(3, &parts);
        let names: Vec<String> = parts.kept.borrow().keys().cloned().collect();
        assert!(
            names.iter().all(|name| name.starts_with("features-")),
            "{names:?}"
        );
        assert!(parts.recalled.borrow().is_empty());
        let in_full = search_until(usize::MAX, &parts);
        let recalled: BTreeSet<String> = parts.recalled.borrow().iter().cloned().collect();
        assert_eq!(recalled, names.into_iter().collect());
        assert!(parts.kept.borrow().contains_key("matches-7"));
        assert!(in_full > 20, "every pair: {in_full}");
        assert_eq!(search_until(usize::MAX, &parts), 1, "the end alone");
    }
}
