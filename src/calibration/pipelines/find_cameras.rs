//! The searches for the cameras of a match, one after the other: the frames that overlap with none
//! of one camera's frames are another camera's, whether the one before was found or not.

use super::kept_search::{KeptAnswer, KeptSearch, SearchEnd};
use super::kept_work::{KeptWork, WorkKey};
use super::match_labels::{Labelling, MatchEvent};
use super::no_camera::NoCamera;
use super::other_cameras::{MIN_FRAMES, frames_of_others, split_off};
use super::same_camera::join_same;
use crate::autocalibrate::{
    AutocalibrationAnswer, AutocalibrationError, SearchExtent, find_camera_in_stages,
};
use crate::calibrate::kept::KeepParts;
use crate::calibrate::{AutocalibratedCamera, record_found};
use crate::proposals::read_picture;
use std::collections::{BTreeSet, VecDeque};
use std::ops::ControlFlow;
use std::sync::{Arc, Mutex, PoisonError};
use touchline_core::progress::Progress;
use touchline_documents::document::CameraId;

/// The answer of a search for a camera; none where its frames are of several cameras, which are to
/// be divided first.
type SearchAnswer = Option<Result<Arc<AutocalibratedCamera>, NoCamera>>;

/// A search that ran to its end.
type Searched = Result<(SearchEnd, SearchAnswer), AutocalibrationError>;

/// How far a search for a camera goes.
#[derive(Clone, Copy, Debug)]
struct SearchLimits {
    /// Maximum number of its stages.
    most_stages: usize,
    /// Whether it ends where enough frames for another camera match none of its own.
    divides: bool,
}

/// A camera that is to be searched.
#[derive(Clone, Debug)]
struct Waiting {
    camera: CameraId,
    /// For every camera but the first: the number of sampled frames that were split off.
    separate_frames: Option<usize>,
    /// The camera that its frames go back to where it is not found: the search tied them to that
    /// camera, which may know them all the same.
    back_to: Option<CameraId>,
}

impl Labelling<'_> {
    /// Searches for all cameras, and writes them into the document. Sampled frames that match none
    /// of the largest group are split off as another camera before the search goes on, so that each
    /// camera is searched from as many of its own frames as if it were alone; shots of the group
    /// that a found camera does not answer are another camera's, too. A camera that is not found
    /// leaves its frames without one, and the others are searched all the same. Returns the cameras
    /// that were found; if there are none, the reason for the first one, and the document is
    /// unchanged.
    ///
    /// # Errors
    /// A search failed, or was cancelled before a camera was found.
    pub(super) fn find_cameras(
        &mut self,
        first: &CameraId,
    ) -> Result<Result<Vec<Arc<AutocalibratedCamera>>, NoCamera>, AutocalibrationError> {
        self.find_cameras_by(first, Self::recognise_or_search)
    }

    /// As [`find_cameras`](Self::find_cameras), where `search` searches for a camera.
    fn find_cameras_by(
        &mut self,
        first: &CameraId,
        search: impl Fn(&mut Self, &CameraId, SearchLimits) -> Searched,
    ) -> Result<Result<Vec<Arc<AutocalibratedCamera>>, NoCamera>, AutocalibrationError> {
        let before = self.document.clone();
        let mut found = Vec::new();
        // Why the first camera was not found: the answer, unless another one is found.
        let mut why_not_first = None;
        // What one camera costs is a measure for the others: where there is no answer, the search
        // goes on to all places.
        let mut most_stages = usize::MAX;
        let mut waiting = VecDeque::from([Waiting {
            camera: first.clone(),
            separate_frames: None,
            back_to: None,
        }]);
        'cameras: while let Some(next) = waiting.pop_front() {
            let Waiting {
                camera,
                separate_frames,
                back_to,
            } = next;
            let mut divides = true;
            let (end, answer) = loop {
                let limits = SearchLimits {
                    most_stages,
                    divides,
                };
                let (end, answer) = match search(self, &camera, limits) {
                    Err(AutocalibrationError::Stopped) if !found.is_empty() => break 'cameras,
                    searched => searched?,
                };
                let other = split_off(self.document, &camera, &end.searched, &end.others);
                divides = other.is_some();
                waiting.extend(other.map(|other| Waiting {
                    camera: other,
                    separate_frames: Some(end.others.len()),
                    back_to: back_to.clone(),
                }));
                let Some(answer) = answer else { continue };
                let num_waiting = waiting.len();
                for others in frames_of_others(self.document, &end, answer.is_ok()) {
                    let other = split_off(self.document, &camera, &end.searched, &others);
                    waiting.extend(other.map(|other| Waiting {
                        camera: other,
                        separate_frames: Some(others.len()),
                        back_to: Some(back_to.as_ref().unwrap_or(&camera).clone()),
                    }));
                }
                // Without the shots of other cameras a refused one may be certain.
                if answer.is_ok() || waiting.len() == num_waiting {
                    break (end, answer);
                }
            };
            if separate_frames.is_none() {
                most_stages = end.stages;
            }
            match answer {
                Ok(of_camera) => {
                    if self.join_known(&camera, &of_camera, &found) {
                        continue;
                    }
                    record_found(self.document, &camera, &of_camera);
                    if let Some(why) = why_not_first.take() {
                        self.report_not_found(first, why, None);
                    }
                    // What follows checks for itself whether the work is cancelled, and keeps what
                    // is done.
                    let _ = self.progress.report(MatchEvent::Found {
                        camera: camera.clone(),
                        found: Arc::clone(&of_camera),
                        separate_frames,
                        document: Box::new(self.document.clone()),
                    });
                    found.push((camera, of_camera));
                }
                Err(why) if separate_frames.is_none() => why_not_first = Some(why),
                Err(why) => {
                    self.report_not_found(&camera, why, separate_frames);
                    if let Some(back_to) = back_to {
                        self.give_frames_to(&camera, &back_to);
                    }
                }
            }
        }
        Ok(match why_not_first {
            Some(why) => {
                *self.document = before;
                Err(why)
            }
            None => Ok(found.into_iter().map(|(_, of_camera)| of_camera).collect()),
        })
    }

    /// Gives a found camera's frames to the camera that was found at the same place before, with
    /// its base. Returns whether there is one.
    fn join_known(
        &mut self,
        camera: &CameraId,
        of_camera: &AutocalibratedCamera,
        found: &[(CameraId, Arc<AutocalibratedCamera>)],
    ) -> bool {
        let document = &*self.document;
        let joined = found.iter().find_map(|(known, of_known)| {
            let image_size = |index: usize| document.frames[index].image_size;
            Some((known, join_same(of_known, of_camera, image_size)?))
        });
        let Some((known, joined)) = joined else {
            return false;
        };
        self.give_frames_to(camera, known);
        record_found(self.document, known, &joined);
        let _ = self.progress.report(MatchEvent::Joined {
            camera: known.clone(),
            frames: of_camera.frames.len(),
            document: Box::new(self.document.clone()),
        });
        true
    }

    /// Gives all frames of a camera to another one, and removes it.
    fn give_frames_to(&mut self, camera: &CameraId, other: &CameraId) {
        for index in 0..self.document.frames.len() {
            if self.document.frames[index].camera == *camera {
                self.document.frames[index].camera = other.clone();
            }
        }
        self.document.cameras.retain(|one| one.id != *camera);
    }

    fn report_not_found(&self, camera: &CameraId, why: NoCamera, separate_frames: Option<usize>) {
        let _ = self.progress.report(MatchEvent::NotFound {
            document: Box::new(self.document.clone()),
            camera: camera.clone(),
            why,
            separate_frames,
        });
    }

    /// Recognises a camera of the user's venues; where none took the frames, searches for theirs.
    fn recognise_or_search(&mut self, camera: &CameraId, limits: SearchLimits) -> Searched {
        match self.find_in_venues(camera)? {
            Some((end, found)) => Ok((end, Some(Ok(found)))),
            None => self.search(camera, limits),
        }
    }

    /// Searches for a camera, unless the answer to the same search was kept.
    fn search(&mut self, camera: &CameraId, limits: SearchLimits) -> Searched {
        let key = self.work.begin_key("search").and_then(|mut parts| {
            let at = self.document.at(self.folder);
            parts.add(camera);
            parts.add(&self.options.sampled_frames);
            parts.add_text(&format!("{limits:?}"));
            parts.add_document(at);
            parts.add_frames(at);
            parts.finish()
        });
        let kept: Option<KeptSearch> = key.as_ref().and_then(|key| self.work.recall(key));
        if let Some((end, answer)) = kept {
            return Ok((end, answer.map(KeptAnswer::into_answer)));
        }
        let parts = PartsInWork {
            work: Arc::clone(&self.work),
            search: key.clone(),
        };
        let (end, answer) = self.search_afresh(camera, limits, &parts)?;
        if let Some(key) = key {
            let kept = answer.as_ref();
            let kept = kept.map(|answer| KeptAnswer::from_answer(answer, self.document));
            self.work.keep(&key, &(end.clone(), kept));
        }
        Ok((end, answer))
    }

    /// Searches for a camera. Each picture that cannot be read is reported once.
    fn search_afresh(
        &mut self,
        camera: &CameraId,
        limits: SearchLimits,
        parts: &dyn KeepParts,
    ) -> Searched {
        let at = self.document.at(self.folder);
        let mut unreadable = BTreeSet::new();
        let mut picture = |index: usize| {
            let frame = &at.document.frames[index];
            match read_picture(&mut *self.reader, frame, at.folder) {
                Ok(picture) => Some(picture),
                Err(error) => {
                    if unreadable.insert(index) {
                        let _ = self.progress.report(MatchEvent::Unreadable {
                            frame: frame.name(),
                            error,
                        });
                    }
                    None
                }
            }
        };
        let end = Mutex::new(SearchEnd::default());
        // Its own progress, so that a division does not cancel the whole work.
        let progress = Progress::new(|step| {
            let is_divided = {
                let mut end = end.lock().unwrap_or_else(PoisonError::into_inner);
                end.note(&step);
                limits.divides && end.others.len() >= MIN_FRAMES
            };
            match self.progress.report(MatchEvent::Searching(step)) {
                ControlFlow::Continue(()) if is_divided => ControlFlow::Break(()),
                answer => answer,
            }
        });
        let extent = SearchExtent {
            look_at: self.options.sampled_frames,
            most_stages: limits.most_stages,
            parts,
        };
        let answer = find_camera_in_stages(at, camera, extent, &mut picture, &progress);
        drop(progress);
        let answer = match answer {
            Err(AutocalibrationError::Stopped) if !self.progress.is_cancelled() => None,
            answer => Some(match answer? {
                AutocalibrationAnswer::Found(found) => Ok(Arc::from(found)),
                AutocalibrationAnswer::Abstained { why, clicks } => {
                    Err(NoCamera::Abstained { why, clicks })
                }
            }),
        };
        let mut end = end.into_inner().unwrap_or_else(PoisonError::into_inner);
        end.note_best(answer.as_ref().and_then(|answer| match answer {
            Ok(found) => Some(&**found),
            Err(why) => why.best(),
        }));
        Ok((end, answer))
    }
}

/// The parts of a search among the finished work, under its key.
struct PartsInWork {
    work: Arc<KeptWork>,
    search: Option<WorkKey>,
}

impl PartsInWork {
    fn file_of(&self, part: &str) -> Option<String> {
        let search = self.search.as_ref()?;
        Some(format!("{}-{part}", search.name()))
    }
}

impl KeepParts for PartsInWork {
    fn recall(&self, part: &str) -> Option<Vec<u8>> {
        self.work.recall_bytes(&self.file_of(part)?)
    }

    fn keep(&self, part: &str, bytes: &[u8]) {
        if let Some(file) = self.file_of(part) {
            self.work.keep_bytes(&file, bytes);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::autocalibrate::Abstention;
    use crate::calibrate::{AutocalibratedFrame, AutocalibrationEvidence};
    use crate::pipelines::MatchOptions;
    use std::path::Path;
    use touchline_core::camera::Ptz;
    use touchline_core::geometry::ImageSize;
    use touchline_core::testing::{soccer, turned_base};
    use touchline_documents::document::{Camera, Document, ShotKind};
    use touchline_documents::testing::cut_video;
    use touchline_vision::media::FrameReader;

    /// Four shots of 20 frames.
    fn four_shots() -> Document {
        let cuts = [20, 40, 60].map(|start| (start, ShotKind::Cut));
        let mut document = cut_video("a.mp4", 80, &cuts);
        let size = document.frames[0].image_size;
        document
            .cameras
            .push(Camera::new("main".into(), size).into());
        document
    }

    /// The camera of a shot, found from its first frame, at this height.
    fn camera_at(height_m: f64, shot: usize, size: ImageSize) -> AutocalibratedCamera {
        let mut base = turned_base([0.0, -60.0, height_m], [0.0; 3], size);
        base.sigma.position_m = [0.06, 0.3, 0.07].into();
        let frame = AutocalibratedFrame {
            index: 20 * shot,
            ptz: Ptz::from_degrees(10.0 * shot as f64, -12.0, f64::from(size.width)),
            uncertainty: None,
            snapped: None,
            unaligned_score: None,
        };
        AutocalibratedCamera {
            base,
            field: soccer(),
            sizes: Vec::new(),
            frames: vec![frame],
            others: Vec::new(),
            paint: Vec::new(),
            evidence: AutocalibrationEvidence::default(),
        }
    }

    /// Searches for the cameras of four shots by a search of its own. Returns what was found, and
    /// the document.
    fn find_by(
        search: impl Fn(&mut Labelling<'_>, &CameraId, SearchLimits) -> Searched,
    ) -> (Result<Vec<Arc<AutocalibratedCamera>>, NoCamera>, Document) {
        let mut document = four_shots();
        let mut labelling = Labelling {
            document: &mut document,
            folder: Path::new("."),
            reader: &mut FrameReader::new(),
            options: &MatchOptions::default(),
            progress: &Progress::default(),
            work: Arc::new(KeptWork::none()),
        };
        let found = labelling.find_cameras_by(&"main".into(), search);
        (found.unwrap(), document)
    }

    /// Heights of four cameras.
    const DIFFERENT_M: [f64; 4] = [15.0, 16.0, 17.0, 18.0];

    /// Searches for the cameras of four shots at these heights, of which those in `refused` give
    /// none. Returns the frames from which each was searched, whether any was found, and the
    /// document.
    fn find_in_shots(heights_m: [f64; 4], refused: &[usize]) -> (Vec<Vec<usize>>, bool, Document) {
        let searched = Mutex::new(Vec::new());
        let (found, document) = find_by(|labelling, camera, limits| {
            let frames = &labelling.document.frames;
            let of_camera = (0..80).filter(|at| frames[*at].camera == *camera);
            let of_camera: Vec<usize> = of_camera.collect();
            let shot = of_camera[0] / 20;
            let (matching, others): (Vec<usize>, Vec<usize>) =
                of_camera.iter().partition(|frame| **frame / 20 == shot);
            let is_divided = limits.divides && others.len() >= MIN_FRAMES;
            let end = SearchEnd {
                stages: 1,
                searched: matching,
                others,
                ..SearchEnd::default()
            };
            if is_divided {
                return Ok((end, None));
            }
            searched.lock().unwrap().push(of_camera);
            let answer = if refused.contains(&shot) {
                let (why, clicks) = (Abstention::NothingFits, None);
                Err(NoCamera::Abstained { why, clicks })
            } else {
                let size = frames[0].image_size;
                Ok(Arc::new(camera_at(heights_m[shot], shot, size)))
            };
            Ok((end, Some(answer)))
        });
        (searched.into_inner().unwrap(), found.is_ok(), document)
    }

    #[test]
    fn each_camera_is_searched_from_its_own_frames_whether_others_are_found_or_not() {
        let each: Vec<Vec<usize>> = (0..4)
            .map(|shot| (20 * shot..20 * (shot + 1)).collect())
            .collect();
        for refused in [&[][..], &[0], &[1], &[3], &[0, 1, 2]] {
            let (searched, is_found, _) = find_in_shots(DIFFERENT_M, refused);
            assert_eq!((searched, is_found), (each.clone(), true), "{refused:?}");
        }
        let (searched, is_found, document) = find_in_shots(DIFFERENT_M, &[0, 1, 2, 3]);
        assert_eq!((searched, is_found), (each, false));
        assert_eq!(document, four_shots(), "unchanged");
    }

    /// The frames of all four shots match each other: one search has them all, and its answer is
    /// that of the first shot. The next has those that were split off.
    #[test]
    fn shots_of_a_group_that_its_camera_does_not_answer_are_searched_for_another() {
        // Of the shots in `known` each camera answers one; no camera answers the others.
        for (known, cameras) in [(&[0, 1, 2, 3][..], 4), (&[0, 2], 2)] {
            let (found, document) = find_by(|labelling, camera, _| {
                let frames = &labelling.document.frames;
                let searched: Vec<usize> =
                    (0..80).filter(|at| frames[*at].camera == *camera).collect();
                let of_shot = |shot: usize| 20 * shot..20 * (shot + 1);
                let mut shots = known.iter().copied();
                let shot = shots.find(|shot| searched.contains(&(20 * shot)));
                let answer = match shot {
                    Some(shot) => Ok(Arc::new(camera_at(
                        DIFFERENT_M[shot],
                        shot,
                        frames[0].image_size,
                    ))),
                    None => Err(NoCamera::Before {
                        message: String::new(),
                        asks_for_clicks: false,
                    }),
                };
                let end = SearchEnd {
                    stages: 1,
                    searched,
                    others: Vec::new(),
                    agreeing: shot.map(of_shot).into_iter().flatten().collect(),
                    links: Vec::new(),
                };
                Ok((end, Some(answer)))
            });
            assert_eq!(found.unwrap().len(), cameras, "{known:?}");
            let ids: BTreeSet<&CameraId> = (0..4)
                .map(|shot| &document.frames[20 * shot].camera)
                .collect();
            assert_eq!((ids.len(), document.cameras.len()), (cameras, cameras));
            // Frames that no camera answers go back to the first, which may know them all the same.
            let of_second = document.frames[30].camera.as_str();
            assert_eq!(of_second == "main", !known.contains(&1), "{of_second}");
        }
    }

    #[test]
    fn a_camera_that_is_found_again_gets_its_frames() {
        let (searched, _, document) = find_in_shots([15.0, 18.0, 15.0, 18.0], &[]);
        assert_eq!(searched.len(), 4);
        assert_eq!(document.cameras.len(), 2);
        let camera_of = |frame: usize| &document.frames[frame].camera;
        assert_eq!(camera_of(5).as_str(), "main");
        assert_eq!(
            (camera_of(45), camera_of(65)),
            (camera_of(5), camera_of(25))
        );
        assert!(document.frames[40].ptz.is_some());
    }
}
