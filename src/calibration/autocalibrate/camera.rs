//! The search for a document's camera from end to end: sample the frames, match them, find
//! candidates for the base, align and refine the best two, and give the verdict.

use super::align::align_frames;
use super::candidates::{
    PosesFrom, RUNNER_UP_RATIO, SAME_POSITION_M, adjust_panoramas, apart_m, find_panoramas,
    sort_best_first,
};
use super::clicked::GroundClick;
use super::deciding_landmark::deciding_landmark;
use super::error::Stop;
use super::evidence::labels;
use super::faint_lines::{LinesInMean, find_lines_in_mean};
use super::field_prior::FieldPrior;
use super::hypothesis::Hypothesis;
use super::joint::FirstReach;
use super::matched_frames::MatchedFrames;
use super::neighbours::try_neighbouring_distances;
use super::progress::report;
use super::refine::{SearchedCamera, refine_base};
use super::sampled_frames::{
    MAX_PICTURES_IN_MEMORY, PictureOfFrame, SampledFrame, sample_frames, spread_evenly,
};
use super::search_places::SearchPlaces;
use super::verdict::{
    MIN_ALIGNED, MIN_ALIGNED_BEFORE_REFINING, MIN_ALIGNED_WITH_RUNNER_UP, MIN_EXPLAINED_ELSEWHERE,
    contradicting_click, few_aligned, is_confirmed_in_mean, is_refuted, missing_in_frames,
    open_size, uncertain, unusual_size,
};
use super::wanted_clicks::wanted_clicks;
use super::{
    Abstention, AutocalibrationAnswer, AutocalibrationError, AutocalibrationProgress, Doubt,
    WantedClicks,
};
use crate::calibrate::AutocalibratedCamera;
use std::collections::BTreeSet;
use touchline_core::progress::Progress;
use touchline_core::solve::base::BaseOptions;
use touchline_documents::document::{CameraId, DocumentAt, FrameStatus};

/// Fewer clicks on landmarks of the ground determine no pose.
const MIN_CLICKS: usize = 2;

/// Without an answer, it is tried again if the best candidate explains at least this share of the
/// paint.
const MIN_EXPLAINED_TO_RETRY: f64 = 0.6;

/// Maximum number of candidates that are moved to a neighbouring minimum.
const MAX_MOVED: usize = 2;

/// Finds a camera of a document from its frames' pictures alone; clicks are not read. Samples at
/// most `look_at` frames, spread evenly over all of them. `picture` may be called for a frame more
/// than once, because not all pictures are kept in memory.
///
/// # Errors
/// The search was stopped, the field of the document is not usable, or OpenCV is missing or failed.
/// An uncertain answer is no error but [`AutocalibrationAnswer::Abstained`].
pub fn camera_without_clicks(
    document: DocumentAt<'_>,
    camera: &CameraId,
    look_at: usize,
    picture: PictureOfFrame<'_>,
    progress: &Progress<'_, AutocalibrationProgress>,
) -> Result<AutocalibrationAnswer, AutocalibrationError> {
    Search::new(document, camera, false, progress)?.run(look_at, picture)
}

/// Finds a camera of a document from two or more clicks on landmarks of the ground, in one frame or
/// in several. The clicks determine the poses to begin with, in place of the search. The answer has
/// to pass all checks of [`camera_without_clicks`], and the clicks have to agree with it.
///
/// # Errors
/// As [`camera_without_clicks`].
pub fn camera_from_few_clicks(
    document: DocumentAt<'_>,
    camera: &CameraId,
    look_at: usize,
    picture: PictureOfFrame<'_>,
    progress: &Progress<'_, AutocalibrationProgress>,
) -> Result<AutocalibrationAnswer, AutocalibrationError> {
    Search::new(document, camera, true, progress)?.run(look_at, picture)
}

struct Search<'a> {
    document: DocumentAt<'a>,
    camera: &'a CameraId,
    field_prior: FieldPrior,
    /// Whether clicks determine the initial poses.
    by_clicks: bool,
    progress: &'a Progress<'a, AutocalibrationProgress>,
}

/// The best candidate, and one in another position that explains the paint nearly as well.
struct Choice {
    best: Hypothesis,
    runner_up: Option<Hypothesis>,
}

impl<'a> Search<'a> {
    fn new(
        document: DocumentAt<'a>,
        camera: &'a CameraId,
        by_clicks: bool,
        progress: &'a Progress<'a, AutocalibrationProgress>,
    ) -> Result<Self, AutocalibrationError> {
        Ok(Self {
            document,
            camera,
            field_prior: FieldPrior::from_document(document, camera)?,
            by_clicks,
            progress,
        })
    }

    /// Returns the answer; abstaining is an answer, not an error.
    fn run(
        &self,
        max_sampled: usize,
        picture: PictureOfFrame<'_>,
    ) -> Result<AutocalibrationAnswer, AutocalibrationError> {
        let matched = match self.match_frames(max_sampled, picture) {
            Ok(matched) => matched,
            Err(stop) => return without_answer(stop, || None),
        };
        let wanted = || wanted_clicks(&matched, self.all_clicks(&matched.indices).len());
        self.find(&matched, picture)
            .or_else(|stop| without_answer(stop, wanted))
    }

    /// Samples the frames of the camera and matches them with each other.
    fn match_frames(
        &self,
        max_sampled: usize,
        picture: PictureOfFrame<'_>,
    ) -> Result<MatchedFrames, Stop> {
        let indices = self.choose_frames(max_sampled);
        // Too few clicks determine no pose; abstain before any picture is read.
        if self.by_clicks && self.clicks(&indices).len() < MIN_CLICKS {
            return Err(Abstention::NothingFits.into());
        }
        let sampled = self.sample(&indices, picture)?;
        MatchedFrames::from_sampled(&sampled, self.progress)
    }

    /// Finds candidates and decides between them; an abstention ends the stages early.
    fn find(
        &self,
        matched: &MatchedFrames,
        picture: PictureOfFrame<'_>,
    ) -> Result<AutocalibrationAnswer, Stop> {
        let mut candidates = Vec::new();
        if self.by_clicks {
            let clicks = self.clicks_in_group(matched);
            let origin = PosesFrom::Clicks(&clicks);
            return self.find_among(origin, 0.0, &mut candidates, matched, picture);
        }
        // The usual place first. Where it gives no answer, all other places are searched, and what
        // they give competes with the candidates from the usual place if it explains enough.
        let usual = PosesFrom::Places(&SearchPlaces::usual());
        let answer = self.find_among(usual, 0.0, &mut candidates, matched, picture);
        let Err(Stop::Abstained(_)) = answer else {
            return answer;
        };
        let others = PosesFrom::Places(&SearchPlaces::others());
        let num_usual = candidates.len();
        let min_explained = MIN_EXPLAINED_ELSEWHERE;
        let elsewhere = self.find_among(others, min_explained, &mut candidates, matched, picture);
        match elsewhere {
            // Nothing elsewhere: the reason is that of the usual place.
            Err(Stop::Abstained(_)) if candidates.len() == num_usual => answer,
            elsewhere => elsewhere,
        }
    }

    /// Adds the candidates from `origin` that explain enough of the paint to those that there are,
    /// and decides between all of them. Nothing fits if none is added.
    ///
    /// Without an answer, the joint adjustment may have gone to a wrong minimum. So it begins once
    /// more with a narrower reach, the best candidates are moved to neighbouring minima where these
    /// are better, and it is decided again.
    fn find_among(
        &self,
        origin: PosesFrom<'_>,
        min_explained: f64,
        candidates: &mut Vec<Hypothesis>,
        matched: &MatchedFrames,
        picture: PictureOfFrame<'_>,
    ) -> Result<AutocalibrationAnswer, Stop> {
        let (prior, progress) = (&self.field_prior, self.progress);
        let num_before = candidates.len();
        let placed = find_panoramas(matched, origin, prior, progress)?;
        let add = |candidates: &mut Vec<Hypothesis>, reach| -> Result<(), Stop> {
            let mut added = adjust_panoramas(&placed, reach, prior, matched, progress)?;
            added.retain(|candidate| candidate.camera.evidence.explained >= min_explained);
            candidates.append(&mut added);
            sort_best_first(candidates);
            Ok(())
        };
        add(candidates, FirstReach::Wide)?;
        let answer = if candidates.len() > num_before {
            self.decide(candidates.clone(), matched, picture)
        } else {
            Err(Abstention::NothingFits.into())
        };
        let is_hopeful = candidates
            .first()
            .is_some_and(|best| best.camera.evidence.explained >= MIN_EXPLAINED_TO_RETRY);
        if !matches!(answer, Err(Stop::Abstained(_))) || !is_hopeful {
            return answer;
        }
        add(candidates, FirstReach::Narrow)?;
        if candidates.len() == num_before {
            return answer;
        }
        for candidate in candidates.iter_mut().take(MAX_MOVED) {
            report(progress, AutocalibrationProgress::Refining)?;
            if let Some(moved) = try_neighbouring_distances(candidate, prior, matched) {
                *candidate = moved;
            }
        }
        sort_best_first(candidates);
        self.decide(candidates.clone(), matched, picture)
    }

    /// Rejects, aligns, refines and judges the best candidates.
    fn decide(
        &self,
        candidates: Vec<Hypothesis>,
        matched: &MatchedFrames,
        picture: PictureOfFrame<'_>,
    ) -> Result<AutocalibrationAnswer, Stop> {
        let Choice { best, runner_up } = choose(candidates)?;

        // Reject the best candidate early, except for missing lines: these are checked again with
        // the refined camera, because a line may lie just beside its paint until then.
        let mut doubts = best.doubts();
        if doubts
            .iter()
            .any(|doubt| !matches!(doubt, Doubt::LinesMissing { .. }))
        {
            // A pitch of an unusual size looks like this as well, until its size is stated.
            doubts.extend(unusual_size(&best.camera, &self.field_prior));
            return Err(uncertain(doubts, best.camera));
        }
        let is_doubted = !doubts.is_empty();
        let best = align_frames(best, matched, picture, self.progress)?;
        match (
            runner_up,
            few_aligned(&best.camera, MIN_ALIGNED_BEFORE_REFINING),
        ) {
            (Some(runner_up), _) => {
                self.decide_between(best, runner_up, is_doubted, matched, picture)
            }
            (None, Some(doubt)) => Err(uncertain(vec![doubt], best.camera)),
            (None, None) => self.refine_and_judge(&best, matched, picture, MIN_ALIGNED),
        }
    }

    /// Decides between two candidates that explain the paint about equally well. `best` is already
    /// aligned; `is_doubted` says that some evidence contradicts it.
    fn decide_between(
        &self,
        best: Hypothesis,
        mut runner_up: Hypothesis,
        is_doubted: bool,
        matched: &MatchedFrames,
        picture: PictureOfFrame<'_>,
    ) -> Result<AutocalibrationAnswer, Stop> {
        let is_doubted = is_doubted || !runner_up.doubts().is_empty();
        runner_up.camera.evidence.rival = best.score();
        let runner_up = align_frames(runner_up, matched, picture, self.progress)?;

        // The frames' own pictures decide first. If too few of them agree with the best candidate,
        // the two change places, unless some evidence contradicts either, or too few agree with the
        // runner-up as well: then there is no answer.
        let is_misaligned = |hypothesis: &Hypothesis| {
            few_aligned(&hypothesis.camera, MIN_ALIGNED_BEFORE_REFINING).is_some()
        };
        let [best, runner_up] = match few_aligned(&best.camera, MIN_ALIGNED_BEFORE_REFINING) {
            Some(doubt) if is_doubted || is_misaligned(&runner_up) => {
                return Err(uncertain(vec![doubt], best.camera));
            }
            Some(_) => [runner_up, best],
            None => [best, runner_up],
        };
        // A runner-up that the pictures refute is out; the best must then agree with more frames
        // than without a runner-up.
        if is_refuted(&runner_up.camera) {
            return self.refine_and_judge(&best, matched, picture, MIN_ALIGNED_WITH_RUNNER_UP);
        }

        // Else refine both, from the same pictures.
        let options = BaseOptions::default();
        let refined = [
            self.refine(&best, &options, matched, picture)?,
            self.refine(&runner_up, &options, matched, picture)?,
        ];
        let [best, runner_up] = match refined {
            // Candidates that converge to one position differed only in the size of the field.
            [Some(best), Some(runner_up)]
                if apart_m(
                    best.position_m(),
                    runner_up.position_m(),
                    &best.camera.field,
                ) < SAME_POSITION_M =>
            {
                let best = align_frames(best, matched, picture, self.progress)?;
                return self.judge(best.camera, matched, picture, MIN_ALIGNED_WITH_RUNNER_UP);
            }
            [refined_best, refined_runner_up] => [
                self.align_refined(refined_best, best, matched, picture)?
                    .camera,
                self.align_refined(refined_runner_up, runner_up, matched, picture)?
                    .camera,
            ],
        };
        self.leave_to_a_click(best, runner_up, is_doubted)
    }

    /// Returns both cameras for the user to choose from. Each has to agree with as many frames as a
    /// candidate that refutes a runner-up.
    fn leave_to_a_click(
        &self,
        best: AutocalibratedCamera,
        other: AutocalibratedCamera,
        is_doubted: bool,
    ) -> Result<AutocalibrationAnswer, Stop> {
        let doubt = |camera| {
            few_aligned(camera, MIN_ALIGNED_WITH_RUNNER_UP)
                .or_else(|| open_size(camera))
                .or_else(|| unusual_size(camera, &self.field_prior))
        };
        let mut doubts: Vec<Doubt> = [&best, &other].into_iter().filter_map(doubt).collect();
        if is_doubted || !doubts.is_empty() {
            doubts.insert(0, Doubt::Rival);
            return Err(uncertain(doubts, best));
        }
        // Suggest the click that separates them best.
        let deciding = deciding_landmark(&self.document, &best, &other);
        Ok(AutocalibrationAnswer::Two {
            best: Box::new(best),
            other: Box::new(other),
            deciding,
        })
    }

    /// Refines the only remaining candidate, aligns its frames with the refined base and gives the
    /// verdict.
    fn refine_and_judge(
        &self,
        hypothesis: &Hypothesis,
        matched: &MatchedFrames,
        picture: PictureOfFrame<'_>,
        min_aligned: f64,
    ) -> Result<AutocalibrationAnswer, Stop> {
        let Some(refined) = self.refine(hypothesis, &BaseOptions::default(), matched, picture)?
        else {
            return Err(uncertain(vec![Doubt::NotHeld], hypothesis.camera.clone()));
        };
        let mut best = align_frames(refined, matched, picture, self.progress)?;
        if few_aligned(&best.camera, min_aligned).is_some() {
            // Few aligned frames can have moved the principal point away from where the others need
            // it. Try again with the principal point in the centre and keep the result with more
            // aligned frames.
            let centred = BaseOptions {
                placing_frames: usize::MAX,
                ..BaseOptions::default()
            };
            if let Some(refined) = self.refine(hypothesis, &centred, matched, picture)? {
                let other = align_frames(refined, matched, picture, self.progress)?;
                if other.camera.aligned_frame_count() > best.camera.aligned_frame_count() {
                    best = other;
                }
            }
        }
        self.judge(best.camera, matched, picture, min_aligned)
    }

    /// A refined hypothesis with its frames aligned; the unrefined one where refining failed.
    fn align_refined(
        &self,
        refined: Option<Hypothesis>,
        unrefined: Hypothesis,
        matched: &MatchedFrames,
        picture: PictureOfFrame<'_>,
    ) -> Result<Hypothesis, Stop> {
        match refined {
            Some(refined) => align_frames(refined, matched, picture, self.progress),
            None => Ok(unrefined),
        }
    }

    /// Refines the base of a hypothesis; none if the paint does not determine one.
    fn refine(
        &self,
        hypothesis: &Hypothesis,
        options: &BaseOptions,
        matched: &MatchedFrames,
        picture: PictureOfFrame<'_>,
    ) -> Result<Option<Hypothesis>, Stop> {
        let (document, camera) = (self.document, self.camera);
        let is_size_unknown = self.field_prior.is_size_unknown();
        let searched = SearchedCamera {
            document,
            camera,
            is_size_unknown,
        };
        refine_base(
            hypothesis,
            options,
            searched,
            matched,
            picture,
            self.progress,
        )
    }

    /// Returns the camera as the answer if enough frames agree with it, no line is missing and no
    /// click contradicts it.
    fn judge(
        &self,
        mut camera: AutocalibratedCamera,
        matched: &MatchedFrames,
        picture: PictureOfFrame<'_>,
        min_aligned: f64,
    ) -> Result<AutocalibrationAnswer, Stop> {
        // What the frames do not show of the field is drawn as it is recorded.
        if camera.sizes.iter().any(|size| size.is_open) {
            let prior = &self.field_prior;
            camera.field = prior
                .with_open_as_assumed(&camera.field, &camera.sizes)
                .unwrap_or(camera.field);
        }
        // Three checks at full resolution and one of the field; the first that fails is reported.
        // What single pictures do not confirm, the mean of all of them may.
        let few = few_aligned(&camera, min_aligned);
        let mut missing = missing_in_frames(&camera, matched);
        let in_mean = if few.is_some() || !missing.is_empty() {
            find_lines_in_mean(&camera, matched, picture)
        } else {
            LinesInMean::default()
        };
        let few = few.filter(|_| !is_confirmed_in_mean(&camera, &in_mean));
        missing.retain(|line| !in_mean.seen.contains(line));
        camera.evidence.missing = labels(&camera.field, &missing);
        let lines = &camera.evidence.missing;
        let missing = || {
            (!lines.is_empty()).then(|| Doubt::LinesMissing {
                lines: lines.clone(),
            })
        };
        let indices: Vec<usize> = camera.frames.iter().map(|frame| frame.index).collect();
        let contradicted =
            || contradicting_click(&camera, &self.clicks(&indices), &self.document.frames);
        match few
            .or_else(missing)
            .or_else(|| unusual_size(&camera, &self.field_prior))
            .or_else(contradicted)
        {
            Some(doubt) => Err(uncertain(vec![doubt], camera)),
            None => Ok(AutocalibrationAnswer::Found(Box::new(camera))),
        }
    }

    /// The clicks on ground landmarks in some frames of the document; none where clicks are not
    /// used.
    fn clicks(&self, indices: &[usize]) -> Vec<GroundClick> {
        if self.by_clicks {
            self.all_clicks(indices)
        } else {
            Vec::new()
        }
    }

    /// The clicks on ground landmarks in some frames of the document.
    fn all_clicks(&self, indices: &[usize]) -> Vec<GroundClick> {
        GroundClick::from_frames(&self.document.frames, indices, &self.field_prior.assumed)
    }

    /// The clicks on matched frames, with frames numbered as in the group.
    fn clicks_in_group(&self, matched: &MatchedFrames) -> Vec<GroundClick> {
        let renumber = |click: GroundClick| {
            Some(GroundClick {
                frame: matched.number_of(click.frame)?,
                ..click
            })
        };
        self.clicks(&matched.indices)
            .into_iter()
            .filter_map(renumber)
            .collect()
    }

    /// The frames to sample: an even spread over those of the camera that are not rejected, and,
    /// where clicks are used, every frame with a click.
    fn choose_frames(&self, max_sampled: usize) -> Vec<usize> {
        let frames = self.document.frames.iter().enumerate();
        let usable = frames.filter(|(_, frame)| {
            frame.camera == *self.camera && frame.status != FrameStatus::Rejected
        });
        let of_camera: Vec<usize> = usable.map(|(index, _)| index).collect();
        let clicked = self.clicks(&of_camera).into_iter().map(|click| click.frame);
        let chosen: BTreeSet<usize> = spread_evenly(&of_camera, max_sampled)
            .chain(clicked)
            .collect();
        chosen.into_iter().collect()
    }

    /// Samples the frames whose picture can be read, a chunk at a time.
    fn sample(
        &self,
        indices: &[usize],
        picture: PictureOfFrame<'_>,
    ) -> Result<Vec<SampledFrame>, Stop> {
        let masks_of = |index: usize| self.document.masks_of(&self.document.frames[index]);
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
            sampled.extend(
                sample_frames(some, masks_of, picture).map_err(AutocalibrationError::from)?,
            );
        }
        Ok(sampled)
    }
}

/// The answer of a search that stopped, with the clicks that would help; or the error.
fn without_answer(
    stop: Stop,
    wanted: impl FnOnce() -> Option<WantedClicks>,
) -> Result<AutocalibrationAnswer, AutocalibrationError> {
    match stop {
        Stop::Abstained(why) => Ok(AutocalibrationAnswer::Abstained {
            why,
            clicks: wanted(),
        }),
        Stop::Failed(error) => Err(error),
    }
}

/// Chooses the best candidate, and the next one in another position as the runner-up if it explains
/// nearly as much. `candidates` come best first.
fn choose(candidates: Vec<Hypothesis>) -> Result<Choice, Abstention> {
    let mut candidates = candidates.into_iter();
    let mut best = candidates.next().ok_or(Abstention::NothingFits)?;
    // Candidates in the position of the best are the same answer.
    let is_elsewhere = |other: &Hypothesis| {
        let apart_m = apart_m(other.position_m(), best.position_m(), &best.camera.field);
        apart_m > SAME_POSITION_M && other.score() > 0.0
    };
    let elsewhere = candidates.find(is_elsewhere);
    best.camera.evidence.rival = elsewhere.as_ref().map_or(0.0, Hypothesis::score);
    // A candidate against which there is evidence cannot question one without.
    let is_runner_up = |other: &Hypothesis| {
        best.score() < RUNNER_UP_RATIO * other.score()
            && (other.doubts().is_empty() || !best.doubts().is_empty())
    };
    let runner_up = elsewhere.filter(is_runner_up);
    Ok(Choice { best, runner_up })
}

#[cfg(test)]
mod tests {
    use super::super::rotating_camera::{hypothesis, soccer};
    use super::*;
    use touchline_core::geometry::Vec3;

    /// A hypothesis beside the right one, with evidence that passes all checks.
    fn beside(x_m: f64, score: f64) -> Hypothesis {
        let mut hypothesis = hypothesis(&soccer().assumed);
        hypothesis.camera.base.position_m += Vec3::x() * x_m;
        let evidence = &mut hypothesis.camera.evidence;
        (evidence.explained, evidence.visible, evidence.frames) = (score, 1.0, 7);
        evidence.lines = ["a", "b", "c", "d", "e"].map(str::to_owned).to_vec();
        hypothesis
    }

    /// The recorded score of the next position, and the distance of the runner-up from the best, m.
    fn chosen(candidates: Vec<Hypothesis>) -> (f64, Option<f64>) {
        let Choice { best, runner_up } = choose(candidates).unwrap();
        let apart_m = |other: Hypothesis| (other.position_m() - best.position_m()).norm();
        (best.camera.evidence.rival, runner_up.map(apart_m))
    }

    #[test]
    fn one_position_twice_has_no_runner_up() {
        assert_eq!(
            chosen(vec![beside(0.0, 0.9), beside(1.0, 0.89)]),
            (0.0, None)
        );
    }

    /// From behind a goal, the position opposite is the same answer on a field that looks the same
    /// after half a turn.
    #[test]
    fn the_position_opposite_is_no_runner_up() {
        let opposite = |score: f64| {
            let mut hypothesis = beside(0.0, score);
            let at_m = &mut hypothesis.camera.base.position_m;
            (at_m.x, at_m.y) = (-at_m.x, -at_m.y);
            hypothesis
        };
        assert_eq!(chosen(vec![beside(0.0, 0.9), opposite(0.89)]), (0.0, None));
    }

    #[test]
    fn the_runner_up_explains_nearly_as_much() {
        assert_eq!(
            chosen(vec![beside(0.0, 0.9), beside(1.0, 0.89), beside(8.0, 0.8)]),
            (0.8, Some(8.0))
        );
        let (score, runner_up) = chosen(vec![beside(0.0, 0.9), beside(8.0, 0.62)]);
        assert_eq!(
            (score, runner_up),
            (0.62, None),
            "its score is recorded nevertheless"
        );
    }

    #[test]
    fn a_doubtful_candidate_is_no_runner_up_to_one_without_doubts() {
        let mut doubtful = beside(8.0, 0.85);
        doubtful.camera.evidence.lines.clear();
        assert_eq!(
            chosen(vec![beside(0.0, 0.9), doubtful.clone()]),
            (0.85, None)
        );
        let mut best = beside(0.0, 0.9);
        best.camera.evidence.lines.clear();
        assert_eq!(
            chosen(vec![best, doubtful]),
            (0.85, Some(8.0)),
            "where the best has doubts too"
        );
    }

    #[test]
    fn without_candidates_nothing_fits() {
        assert_eq!(choose(Vec::new()).err(), Some(Abstention::NothingFits));
    }
}
