//! The decision between the candidates for a base: reject, align, refine, and give the verdict.
//!
//! The best candidate is compared with the next one in another position. Both are aligned to each
//! frame's own picture, and adjusted once more where that does not tell them apart. What remains
//! has to pass the checks of `checks.rs`.

use super::checks::{
    MIN_ALIGNED, MIN_ALIGNED_WITH_RUNNER_UP, MIN_LINES_WITH_CLICKS, cameras_and_pictures,
    contradicting_click, few_aligned, few_aligned_before_refining, is_confirmed_by_clicks,
    is_confirmed_in_mean, is_refuted, open_size, uncertain, unsteady_size, unusual_size,
};
use super::deciding_landmark::deciding_landmark;
use super::faint_lines::{LinesInMean, find_lines_in_mean};
use crate::autocalibrate::adjustment::align::align_frames;
use crate::autocalibrate::adjustment::candidates::{RUNNER_UP_NATS, is_same_position};
use crate::autocalibrate::adjustment::evidence::{labels, missing_lines};
use crate::autocalibrate::adjustment::hypothesis::Hypothesis;
use crate::autocalibrate::adjustment::refine::{SearchedCamera, refine_base};
use crate::autocalibrate::error::Stop;
use crate::autocalibrate::field_prior::FieldPrior;
use crate::autocalibrate::frames::matched_frames::MatchedFrames;
use crate::autocalibrate::frames::sampled_frames::PictureOfFrame;
use crate::autocalibrate::search::clicked::GroundClick;
use crate::autocalibrate::{Abstention, AutocalibrationAnswer, AutocalibrationProgress, Doubt};
use crate::calibrate::AutocalibratedCamera;
use crate::evidence::Evidence;
use touchline_core::progress::Progress;
use touchline_core::solve::base::BaseOptions;

/// What a decision is made with.
pub struct Decision<'a> {
    pub searched: SearchedCamera<'a>,
    pub field_prior: &'a FieldPrior,
    pub matched: &'a MatchedFrames,
    /// Clicks on landmarks of the ground, with frames by their index in the document. An answer
    /// must not contradict them.
    pub clicks: &'a [GroundClick],
    /// Whether the clicks played no part in finding the candidates, so that they can confirm one.
    pub is_found_without_clicks: bool,
    pub picture: PictureOfFrame<'a>,
    pub progress: &'a Progress<'a, AutocalibrationProgress>,
}

/// The best candidate, and one in another position that explains the paint nearly as well.
struct Choice {
    best: Hypothesis,
    runner_up: Option<Hypothesis>,
}

impl Decision<'_> {
    /// Rejects, aligns, refines and judges the best candidates.
    ///
    /// `candidates` come best first. Those that a click contradicts come after all others.
    pub fn decide(
        &mut self,
        mut candidates: Vec<Hypothesis>,
    ) -> Result<AutocalibrationAnswer, Stop> {
        candidates.sort_by_key(|candidate| self.contradicting_click(&candidate.camera).is_some());
        let Choice { best, runner_up } = choose(candidates)?;
        let runner_up = runner_up.filter(|other| self.contradicting_click(&other.camera).is_none());
        if let Some(doubt) = self.contradicting_click(&best.camera) {
            return Err(uncertain(vec![doubt], best.camera));
        }

        // Reject the best candidate early, except for missing lines: these are checked again with
        // the refined camera, because a line may lie just beside its paint until then.
        let mut doubts = best.doubts();
        if doubts
            .iter()
            .any(|doubt| !matches!(doubt, Doubt::LinesMissing { .. }))
        {
            // A pitch of an unusual size looks like this as well, until its size is stated.
            doubts.extend(unusual_size(&best.camera, self.field_prior));
            return Err(uncertain(doubts, best.camera));
        }
        let is_doubted = !doubts.is_empty();
        let best = self.align(best)?;
        match (runner_up, self.few_aligned_before_refining(&best.camera)) {
            (Some(runner_up), _) => self.decide_between(best, runner_up, is_doubted),
            (None, Some(doubt)) => Err(uncertain(vec![doubt], best.camera)),
            (None, None) => self.refine_and_judge(&best, MIN_ALIGNED),
        }
    }

    /// Decides between two candidates that explain the paint about equally well. `best` is already
    /// aligned; `is_doubted` says that some evidence contradicts it.
    fn decide_between(
        &mut self,
        best: Hypothesis,
        mut runner_up: Hypothesis,
        is_doubted: bool,
    ) -> Result<AutocalibrationAnswer, Stop> {
        let is_doubted = is_doubted || !runner_up.doubts().is_empty();
        runner_up.camera.evidence.runner_up_nats = Some(best.nats());
        let runner_up = self.align(runner_up)?;

        // The frames' own pictures decide first. If too few of them agree with the best candidate,
        // the two change places, unless some evidence contradicts either, or too few agree with the
        // runner-up as well: then there is no answer.
        let is_misaligned = |hypothesis: &Hypothesis| {
            self.few_aligned_before_refining(&hypothesis.camera)
                .is_some()
        };
        let [best, runner_up] = match self.few_aligned_before_refining(&best.camera) {
            Some(doubt) if is_doubted || is_misaligned(&runner_up) => {
                return Err(uncertain(vec![doubt], best.camera));
            }
            Some(_) => [runner_up, best],
            None => [best, runner_up],
        };
        // A runner-up that the pictures refute is out; the best must then agree with more frames
        // than without a runner-up.
        if is_refuted(&runner_up.camera) {
            return self.refine_and_judge(&best, MIN_ALIGNED_WITH_RUNNER_UP);
        }

        // Else refine both, from the same pictures.
        let options = BaseOptions::default();
        let refined = [
            self.refine(&best, &options)?,
            self.refine(&runner_up, &options)?,
        ];
        let [best, runner_up] = match refined {
            // Candidates that converge to one position differed only in the size of the field.
            [Some(best), Some(runner_up)]
                if is_same_position(
                    best.position_m(),
                    runner_up.position_m(),
                    &best.camera.field,
                ) =>
            {
                let best = self.align(best)?;
                return self.judge(best, MIN_ALIGNED_WITH_RUNNER_UP);
            }
            [refined_best, refined_runner_up] => [
                self.align_refined(refined_best, best)?.camera,
                self.align_refined(refined_runner_up, runner_up)?.camera,
            ],
        };
        self.leave_to_a_click(best, &runner_up, is_doubted)
    }

    /// Abstains between two cameras, and asks for the click that separates them best; with it, a
    /// further search contradicts one of them. No other stage would separate them. Each has to agree
    /// with as many frames as a candidate that refutes a runner-up.
    fn leave_to_a_click(
        &mut self,
        best: AutocalibratedCamera,
        other: &AutocalibratedCamera,
        is_doubted: bool,
    ) -> Result<AutocalibrationAnswer, Stop> {
        let doubt = |camera| {
            few_aligned(camera, MIN_ALIGNED_WITH_RUNNER_UP)
                .or_else(|| open_size(camera))
                .or_else(|| unsteady_size(camera))
                .or_else(|| unusual_size(camera, self.field_prior))
                .or_else(|| self.contradicting_click(camera))
        };
        let mut doubts: Vec<Doubt> = [&best, other].into_iter().filter_map(doubt).collect();
        if is_doubted || !doubts.is_empty() {
            doubts.insert(0, Doubt::Rival);
            return Err(uncertain(doubts, best));
        }
        let clicks = deciding_landmark(&self.searched.document, &best, other);
        Ok(AutocalibrationAnswer::Abstained {
            why: Abstention::Uncertain {
                doubts: vec![Doubt::Rival],
                best: Some(Box::new(best)),
            },
            clicks,
        })
    }

    /// Refines the only remaining candidate, aligns its frames with the refined base and gives the
    /// verdict.
    fn refine_and_judge(
        &mut self,
        hypothesis: &Hypothesis,
        min_aligned: f64,
    ) -> Result<AutocalibrationAnswer, Stop> {
        let options = BaseOptions::default();
        let Some(mut best) = self.refine_and_align(hypothesis, &options)? else {
            return Err(uncertain(vec![Doubt::NotHeld], hypothesis.camera.clone()));
        };
        if few_aligned(&best.camera, min_aligned).is_some() {
            // Few aligned frames can have moved the principal point away from where the others need
            // it. Try again with the principal point in the centre; keep the result with most
            // aligned frames.
            let centred = BaseOptions {
                placing_frames: usize::MAX,
                ..options
            };
            let again = self.refine_and_align(hypothesis, &centred)?;
            let aligned = best.camera.aligned_frame_count();
            if let Some(again) = again.filter(|it| it.camera.aligned_frame_count() > aligned) {
                best = again;
            }
        }
        self.judge(best, min_aligned)
    }

    /// A refined hypothesis with its frames aligned; the unrefined one where refining failed.
    fn align_refined(
        &mut self,
        refined: Option<Hypothesis>,
        unrefined: Hypothesis,
    ) -> Result<Hypothesis, Stop> {
        match refined {
            Some(refined) => self.align(refined),
            None => Ok(unrefined),
        }
    }

    /// Refines the base of a hypothesis and aligns its frames with it; none if the paint does not
    /// determine a base.
    fn refine_and_align(
        &mut self,
        hypothesis: &Hypothesis,
        options: &BaseOptions,
    ) -> Result<Option<Hypothesis>, Stop> {
        match self.refine(hypothesis, options)? {
            Some(refined) => Ok(Some(self.align(refined)?)),
            None => Ok(None),
        }
    }

    /// Aligns each frame of a hypothesis with the lines of its own picture.
    fn align(&mut self, hypothesis: Hypothesis) -> Result<Hypothesis, Stop> {
        align_frames(hypothesis, self.matched, self.picture, self.progress)
    }

    /// Refines the base of a hypothesis; none if the paint does not determine one.
    fn refine(
        &mut self,
        hypothesis: &Hypothesis,
        options: &BaseOptions,
    ) -> Result<Option<Hypothesis>, Stop> {
        refine_base(
            hypothesis,
            options,
            self.searched,
            self.matched,
            self.picture,
            self.progress,
        )
    }

    /// The reason to reject a camera that a click contradicts.
    fn contradicting_click(&self, camera: &AutocalibratedCamera) -> Option<Doubt> {
        contradicting_click(camera, self.clicks, &self.searched.document.frames)
    }

    /// Whether clicks that played no part in finding a camera confirm it.
    fn is_confirmed_by_clicks(&self, camera: &AutocalibratedCamera) -> bool {
        let frames = &self.searched.document.frames;
        self.is_found_without_clicks && is_confirmed_by_clicks(camera, self.clicks, frames)
    }

    /// The reason to reject a camera before its base is refined. None if clicks confirm it.
    fn few_aligned_before_refining(&self, camera: &AutocalibratedCamera) -> Option<Doubt> {
        few_aligned_before_refining(camera).filter(|_| !self.is_confirmed_by_clicks(camera))
    }

    /// Returns the camera as the answer if enough frames agree with it, no line is missing and no
    /// click contradicts it.
    fn judge(
        &mut self,
        mut hypothesis: Hypothesis,
        min_aligned: f64,
    ) -> Result<AutocalibrationAnswer, Stop> {
        // What the frames do not show of the field is drawn as it is recorded, and the frames are
        // checked and answered as they lie on that field.
        if self.field_prior.assume_open_lengths(&mut hypothesis.camera) {
            hypothesis = self.align(hypothesis)?;
        }
        let mut camera = hypothesis.camera;
        // Three checks at full resolution and two of the field; the first that fails is reported.
        // What single pictures do not confirm, clicks or the mean of all pictures may.
        let few = few_aligned(&camera, min_aligned);
        let frames = cameras_and_pictures(&camera, self.matched);
        let mut missing = missing_lines(&camera.field, &frames);
        camera.evidence.nats = Evidence::weigh(&camera.field, &frames).nats();
        let in_mean = if few.is_some() || !missing.is_empty() {
            find_lines_in_mean(&camera, self.matched, self.picture)
        } else {
            LinesInMean::default()
        };
        let is_confirmed = is_confirmed_in_mean(&camera, &in_mean)
            || (in_mean.seen.len() >= MIN_LINES_WITH_CLICKS
                && self.is_confirmed_by_clicks(&camera));
        let few = few.filter(|_| !is_confirmed);
        missing.retain(|line| !in_mean.seen.contains(line));
        camera.evidence.missing = labels(&camera.field, &missing);
        let lines = &camera.evidence.missing;
        let missing = || {
            (!lines.is_empty()).then(|| Doubt::LinesMissing {
                lines: lines.clone(),
            })
        };
        match few
            .or_else(missing)
            .or_else(|| unsteady_size(&camera))
            .or_else(|| unusual_size(&camera, self.field_prior))
            .or_else(|| self.contradicting_click(&camera))
        {
            Some(doubt) => Err(uncertain(vec![doubt], camera)),
            None => Ok(AutocalibrationAnswer::Found(Box::new(camera))),
        }
    }
}

/// Chooses the best candidate, and the next one in another position as the runner-up if it explains
/// nearly as much. `candidates` come best first.
fn choose(candidates: Vec<Hypothesis>) -> Result<Choice, Abstention> {
    let mut candidates = candidates.into_iter();
    let mut best = candidates.next().ok_or(Abstention::NothingFits)?;
    // Candidates in the position of the best are the same answer, and what one of them found
    // against the stated size counts against all.
    let (same, elsewhere): (Vec<Hypothesis>, Vec<Hypothesis>) = candidates.partition(|other| {
        is_same_position(other.position_m(), best.position_m(), &best.camera.field)
    });
    let other_sizes = same.iter().map(|same| same.camera.evidence.other_size_m);
    let of_best = &mut best.camera.evidence.other_size_m;
    *of_best = of_best.or_else(|| other_sizes.flatten().next());
    best.camera.evidence.runner_up_nats = elsewhere.first().map(Hypothesis::nats);
    // A candidate against which there is evidence cannot question one without, and does not hide
    // the one after it.
    let is_runner_up = |other: &Hypothesis| {
        best.nats() < RUNNER_UP_NATS + other.nats()
            && (other.doubts().is_empty() || !best.doubts().is_empty())
    };
    let runner_up = elsewhere.into_iter().find(is_runner_up);
    Ok(Choice { best, runner_up })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::autocalibrate::rotating_camera::{hypothesis, soccer};
    use touchline_core::geometry::Vec3;

    /// A hypothesis beside the right one, with evidence that passes all checks.
    fn beside(x_m: f64, nats: f64) -> Hypothesis {
        let mut hypothesis = hypothesis(&soccer().assumed);
        hypothesis.camera.base.position_m += Vec3::x() * x_m;
        let evidence = &mut hypothesis.camera.evidence;
        (evidence.nats, evidence.frames) = (nats, 7);
        hypothesis
    }

    /// The recorded evidence of the next position, and the distance of the runner-up from the best,
    /// m.
    fn chosen(candidates: Vec<Hypothesis>) -> (Option<f64>, Option<f64>) {
        let Choice { best, runner_up } = choose(candidates).unwrap();
        let apart_m = |other: Hypothesis| (other.position_m() - best.position_m()).norm();
        (best.camera.evidence.runner_up_nats, runner_up.map(apart_m))
    }

    #[test]
    fn one_position_twice_has_no_runner_up() {
        assert_eq!(
            chosen(vec![beside(0.0, 500.0), beside(1.0, 490.0)]),
            (None, None)
        );
    }

    /// From behind a goal, the position opposite is the same answer on a field that looks the same
    /// after half a turn.
    #[test]
    fn the_position_opposite_is_no_runner_up() {
        let opposite = |nats: f64| {
            let mut hypothesis = beside(0.0, nats);
            let at_m = &mut hypothesis.camera.base.position_m;
            (at_m.x, at_m.y) = (-at_m.x, -at_m.y);
            hypothesis
        };
        let same = chosen(vec![beside(0.0, 500.0), opposite(490.0)]);
        assert_eq!(same, (None, None));
    }

    #[test]
    fn nearly_as_much_speaks_for_the_runner_up() {
        let [best, same] = [beside(0.0, 500.0), beside(1.0, 495.0)];
        assert_eq!(
            chosen(vec![best.clone(), same, beside(8.0, 450.0)]),
            (Some(450.0), Some(8.0))
        );
        assert_eq!(
            chosen(vec![best, beside(8.0, 200.0)]),
            (Some(200.0), None),
            "its evidence is recorded nevertheless"
        );
    }

    #[test]
    fn a_doubtful_candidate_is_no_runner_up_to_one_without_doubts() {
        let with_doubt = |x_m: f64, nats: f64| {
            let mut hypothesis = beside(x_m, nats);
            hypothesis.camera.evidence.missing = vec!["Halfway line".to_owned()];
            hypothesis
        };
        let (best, doubtful) = (beside(0.0, 500.0), with_doubt(8.0, 480.0));
        assert_eq!(
            chosen(vec![best.clone(), doubtful.clone()]),
            (Some(480.0), None)
        );
        assert_eq!(
            chosen(vec![best, doubtful.clone(), beside(-9.0, 450.0)]),
            (Some(480.0), Some(9.0)),
            "nor does it hide another one"
        );
        assert_eq!(
            chosen(vec![with_doubt(0.0, 500.0), doubtful]),
            (Some(480.0), Some(8.0)),
            "where the best has doubts too"
        );
    }

    /// On a pitch of 105 m said to be 103 m long, the start with most evidence went to a wrong size,
    /// and the two beside it found the right one.
    #[test]
    fn another_size_found_from_beside_the_best_is_a_doubt() {
        let mut same = beside(1.0, 495.0);
        same.camera.evidence.other_size_m = Some([105.1, 68.0]);
        let mut away = beside(8.0, 490.0);
        away.camera.evidence.other_size_m = Some([90.0, 75.0]);
        let size_of = |candidates| {
            choose(candidates)
                .unwrap()
                .best
                .camera
                .evidence
                .other_size_m
        };
        let best = beside(0.0, 500.0);
        assert_eq!(size_of(vec![best.clone(), away.clone()]), None);
        assert_eq!(size_of(vec![best, away, same]), Some([105.1, 68.0]));
    }

    #[test]
    fn without_candidates_nothing_fits() {
        assert_eq!(choose(Vec::new()).err(), Some(Abstention::NothingFits));
    }
}
