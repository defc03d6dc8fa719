//! Refines the poses of the search with all frames and ranks them: the candidates for the camera's
//! base.
//!
//! A pose places the whole panorama, at one of a few focal scales and on one of a few field sizes.
//! It becomes a [`Hypothesis`] in three steps, each with more freedom than the one before:
//!
//! 1. [`fit_panorama`] frees the focal scale, the crown and the field's size; the frames stay rigid
//!    to each other. The best [`MAX_REFINED`] in different positions go on.
//! 2. [`Hypothesis::adjust`] frees pan, tilt and focal length of every frame and the lens, and fits
//!    the paint in the pictures. It is repeated from its own result
//!    ([`Hypothesis::adjust_repeatedly`]).
//! 3. Where the field's size is unknown, the best [`MAX_RESIZED`] are adjusted until it stands
//!    still ([`Hypothesis::settle`]) and try neighbouring sizes (`neighbours.rs`).
//!
//! Hypotheses are ranked by their evidence after step 2: the score of the search does not separate
//! right from wrong reliably.

use super::hypothesis::{Hypothesis, KeptHypothesis};
use super::joint::JointStart;
use super::neighbours::try_neighbouring_sizes;
use crate::autocalibrate::error::Stop;
use crate::autocalibrate::field_prior::FieldPrior;
use crate::autocalibrate::frames::matched_frames::MatchedFrames;
use crate::autocalibrate::frames::rotations_by_focal_scale::RotationsByFocalScale;
use crate::autocalibrate::progress::report;
use crate::autocalibrate::search::clicked::GroundClick;
use crate::autocalibrate::search::focal_scales::{
    PartsOfStage, PosesByFocalScale, ScaledPose, poses_from_clicks, search_poses,
};
use crate::autocalibrate::search::panorama_fit::{PanoramaFit, PanoramaStart, fit_panorama};
use crate::autocalibrate::search::pitch_map::PitchMap;
use crate::autocalibrate::search::places::{SearchPlaces, relative_size};
use crate::autocalibrate::search::pose_score::ScoredPose;
use crate::autocalibrate::{AutocalibrationError, AutocalibrationProgress};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use touchline_core::field::{FieldModel, Symmetry};
use touchline_core::geometry::Vec3;
use touchline_core::progress::Progress;

/// Maximum number of hypotheses that are adjusted with all frames.
const MAX_REFINED: usize = 5;

/// Maximum number of candidates for which neighbouring field sizes are tried.
const MAX_RESIZED: usize = 2;

/// Positions nearer to each other than this are one answer, on a soccer pitch, m.
const SAME_POSITION_M: f64 = 1.5;

/// A candidate is a runner-up if the evidence for it is less than this below that for the best,
/// nats.
pub const RUNNER_UP_NATS: f64 = 100.0;

/// Whether two positions of the camera are one answer. A field that looks the same after half a turn
/// does so from the position opposite, too.
pub fn is_same_position(one_m: Vec3, other_m: Vec3, field: &FieldModel) -> bool {
    let within_m = SAME_POSITION_M * relative_size(field);
    let opposite_m = Vec3::new(-other_m.x, -other_m.y, other_m.z);
    (one_m - other_m).norm() < within_m
        || ((one_m - opposite_m).norm() < within_m && is_symmetric_by_half_turn(field))
}

/// Whether half a turn about the middle of a field moves each of its lines onto a line.
pub fn is_symmetric_by_half_turn(field: &FieldModel) -> bool {
    field
        .lines
        .iter()
        .all(|line| Symmetry::Turn180.line_twin(field, line).is_some())
}

/// Where the poses come from.
#[derive(Clone, Copy)]
pub enum PosesFrom<'a> {
    /// The exhaustive search of some places.
    Places(&'a SearchPlaces),
    /// Pairs of clicks.
    Clicks(&'a [GroundClick]),
}

/// A pose after step 1.
struct PlacedPanorama {
    pose: ScaledPose,
    fit: PanoramaFit,
}

impl PlacedPanorama {
    /// Both kinds of evidence: the share of paint on lines, from the fit, times the share of lines
    /// with paint, from the search.
    fn score(&self) -> f64 {
        self.fit.explained * self.pose.scored.visible
    }

    /// Whether it gives nearly the position of another one, which was searched on one of `fields`.
    fn is_near(&self, other: &Self, fields: &[FieldModel]) -> bool {
        let field = &fields[other.pose.scored.field];
        is_same_position(self.fit.pose.position_m, other.fit.pose.position_m, field)
    }
}

/// What step 1 gives: the panoramas in different positions, best first, and the rotations of the
/// frames by focal scale.
pub struct PlacedPanoramas {
    panoramas: Vec<PlacedPanorama>,
    rotations: RotationsByFocalScale,
}

/// Finds the poses of `origin` and fits the panorama at each of them (step 1).
pub fn find_panoramas(
    matched: &MatchedFrames,
    origin: PosesFrom<'_>,
    field_prior: &FieldPrior,
    parts: PartsOfStage<'_>,
    progress: &Progress<'_, AutocalibrationProgress>,
) -> Result<PlacedPanoramas, Stop> {
    report(progress, AutocalibrationProgress::Gathering)?;
    let fields = field_prior.search_fields();
    let maps: Vec<PitchMap> = fields.iter().map(PitchMap::with_grid).collect();
    let found = match origin {
        PosesFrom::Places(places) => {
            search_poses(matched, &fields, &maps, places, parts, progress)?
        }
        PosesFrom::Clicks(clicks) => poses_from_clicks(matched, &fields, &maps, clicks, progress)?,
    };
    Ok(place_panoramas(found, &fields, field_prior))
}

/// The hypotheses for the base of the matched frames' camera, best first: steps 2 and 3.
pub fn adjust_panoramas(
    placed: &PlacedPanoramas,
    field_prior: &FieldPrior,
    matched: &MatchedFrames,
    parts: PartsOfStage<'_>,
    progress: &Progress<'_, AutocalibrationProgress>,
) -> Result<Vec<Hypothesis>, Stop> {
    let PlacedPanoramas {
        panoramas,
        rotations,
    } = placed;

    // Step 2 for all panoramas in parallel. The counter is for progress only.
    let num_done = AtomicUsize::new(0);
    let adjusted: Vec<Option<KeptHypothesis>> = parts.part("adjusted", || {
        let adjusted: Result<Vec<_>, AutocalibrationError> = panoramas
            .par_iter()
            .map(|panorama| {
                let done = num_done.load(Ordering::Relaxed);
                report(
                    progress,
                    AutocalibrationProgress::Adjusting {
                        done,
                        of: panoramas.len(),
                    },
                )?;
                let hypothesis =
                    adjust_with_and_without_size(panorama, rotations, field_prior, matched);
                num_done.fetch_add(1, Ordering::Relaxed);
                Ok(hypothesis.map(KeptHypothesis::from))
            })
            .collect();
        Ok::<_, Stop>(adjusted?)
    })?;
    // Rayon keeps the order of the panoramas and the sort is stable: equal scores come out the same
    // every time.
    let with_panoramas = adjusted.into_iter().zip(panoramas);
    let mut hypotheses: Vec<Hypothesis> = with_panoramas
        .filter_map(|(kept, panorama)| Some(kept?.into_hypothesis(&panorama.pose.frames)))
        .collect();
    sort_best_first(&mut hypotheses);

    // Step 3, in place, and the order once more.
    if field_prior.is_size_unknown() {
        let of = hypotheses.len().min(MAX_RESIZED);
        for (done, hypothesis) in hypotheses.iter_mut().take(of).enumerate() {
            report(progress, AutocalibrationProgress::Sizing { done, of })?;
            let sized = parts.part(&format!("sized-{done}"), || {
                let mut sized = hypothesis.clone();
                sized.settle(field_prior, matched);
                try_neighbouring_sizes(&mut sized, field_prior, matched);
                Ok::<_, Stop>(KeptHypothesis::from(sized))
            })?;
            *hypothesis = sized.into_hypothesis(&hypothesis.frames);
        }
        sort_best_first(&mut hypotheses);
    }
    Ok(hypotheses)
}

pub fn sort_best_first(hypotheses: &mut [Hypothesis]) {
    hypotheses.sort_by(|a, b| b.nats().total_cmp(&a.nats()));
}

/// Step 1: fits the panorama at each pose that was found on some fields. Returns the best first, one
/// for each position.
fn place_panoramas(
    found: PosesByFocalScale,
    fields: &[FieldModel],
    field_prior: &FieldPrior,
) -> PlacedPanoramas {
    let PosesByFocalScale { poses, rotations } = found;
    let size_prior = field_prior.is_size_unknown().then_some(field_prior);
    let mut placed: Vec<PlacedPanorama> = poses
        .into_par_iter()
        .filter_map(|scaled| {
            let ScoredPose { pose, field, .. } = scaled.scored;
            let log_scale = scaled.frames.log_scale;
            let start = PanoramaStart {
                pose,
                log_scale,
                field: &fields[field],
            };
            let fit = fit_panorama(&scaled.frames, &start, size_prior, &rotations)?;
            Some(PlacedPanorama { pose: scaled, fit })
        })
        .collect();

    placed.sort_by(|a, b| b.score().total_cmp(&a.score()));

    // Neighbouring poses converge to one position; keep the best of each.
    let mut panoramas: Vec<PlacedPanorama> = Vec::new();
    for candidate in placed {
        if panoramas.len() >= MAX_REFINED {
            break;
        }
        let is_new = !panoramas
            .iter()
            .any(|better| better.is_near(&candidate, fields));
        if is_new {
            panoramas.push(candidate);
        }
    }
    PlacedPanoramas {
        panoramas,
        rotations,
    }
}

/// Step 2: adjusts all frames jointly, on the field as assumed and, where the rules allow other
/// sizes, with its size fitted.
fn adjust_with_and_without_size(
    panorama: &PlacedPanorama,
    rotations: &RotationsByFocalScale,
    field_prior: &FieldPrior,
    matched: &MatchedFrames,
) -> Option<Hypothesis> {
    let PlacedPanorama {
        pose: ScaledPose { frames, .. },
        fit,
    } = panorama;
    // Step 1 fitted the size where it is unknown and kept it where it is stated. The other variant
    // is fitted here.
    let (as_assumed, resized) = if field_prior.is_size_unknown() {
        (
            refit_assumed_field(panorama, None, rotations, field_prior),
            Some(fit.clone()),
        )
    } else if field_prior.allows_other_sizes() {
        (
            Some(fit.clone()),
            refit_assumed_field(panorama, Some(field_prior), rotations, field_prior),
        )
    } else {
        (Some(fit.clone()), None)
    };
    // Both variants are adjusted in parallel.
    let (as_assumed, resized) = rayon::join(
        || {
            Hypothesis::adjust_repeatedly(
                &JointStart::from_panorama(&as_assumed?),
                None,
                frames,
                matched,
            )
        },
        || {
            Hypothesis::adjust_repeatedly(
                &JointStart::from_panorama(&resized?),
                Some(field_prior),
                frames,
                matched,
            )
        },
    );
    let resized = match (&as_assumed, resized) {
        (Some(as_assumed), Some(resized)) => {
            let from_assumed = resize_from_assumed(as_assumed, &resized, field_prior, matched);
            Some(from_assumed.unwrap_or(resized))
        }
        (_, resized) => resized,
    };
    choose_size(as_assumed, resized, field_prior.is_known)
}

/// Fits the size once more, from the field as assumed, in place of a fit that ended at the limit of
/// what is usual: that one was stopped on its way to a wrong minimum, most often to the boards
/// behind the far lines, and can be no answer. None if it did not end there, or if this one does
/// too or much less speaks for it.
fn resize_from_assumed(
    as_assumed: &Hypothesis,
    resized: &Hypothesis,
    field_prior: &FieldPrior,
    matched: &MatchedFrames,
) -> Option<Hypothesis> {
    field_prior.unusual_length(&resized.camera.field)?;
    let start = JointStart::from_hypothesis(as_assumed, matched)?;
    let frames = &as_assumed.frames;
    let again = Hypothesis::adjust_repeatedly(&start, Some(field_prior), frames, matched)?;
    let is_usual = field_prior.unusual_length(&again.camera.field).is_none();
    (is_usual && resized.nats() < again.nats() + RUNNER_UP_NATS).then_some(again)
}

/// Fits a panorama again from its own pose, starting with the field as assumed.
fn refit_assumed_field(
    panorama: &PlacedPanorama,
    size_prior: Option<&FieldPrior>,
    rotations: &RotationsByFocalScale,
    field_prior: &FieldPrior,
) -> Option<PanoramaFit> {
    let PanoramaFit {
        pose, log_scale, ..
    } = panorama.fit;
    let start = PanoramaStart {
        pose,
        log_scale,
        field: &field_prior.assumed,
    };
    fit_panorama(&panorama.pose.frames, &start, size_prior, rotations)
}

impl JointStart {
    fn from_panorama(fit: &PanoramaFit) -> Self {
        let ptz = fit.rotations.ptz.iter().copied().map(Some).collect();
        Self {
            field: fit.field.clone(),
            base: fit.base(),
            ptz,
        }
    }
}

/// Chooses between the field as assumed and the field of fitted size.
///
/// Where the size is unknown, the one with more evidence. Where the document states it, the stated
/// one; another size that is clearly better is recorded as evidence against it.
fn choose_size(
    as_assumed: Option<Hypothesis>,
    resized: Option<Hypothesis>,
    is_known: bool,
) -> Option<Hypothesis> {
    /// Two more parameters always explain a little more, nats.
    const CLEARLY_BETTER_NATS: f64 = 20.0;
    /// Smaller differences from the stated size do not count, m: pitches are laid out by tape.
    const MIN_DIFFERENCE_M: f64 = 1.0;

    let (mut as_assumed, resized) = match (as_assumed, resized) {
        (Some(as_assumed), Some(resized)) => (as_assumed, resized),
        (as_assumed, resized) => return as_assumed.or(resized.filter(|_| !is_known)),
    };
    // The size is unknown: more evidence wins, the fitted size if equal.
    if !is_known {
        return Some(if resized.nats() >= as_assumed.nats() {
            resized
        } else {
            as_assumed
        });
    }
    // The size is stated: keep it, but record a clearly better one.
    if resized.nats() > as_assumed.nats() + CLEARLY_BETTER_NATS {
        let (stated, other) = (&as_assumed.camera.field, &resized.camera.field);
        let difference_m = (other.length_m - stated.length_m)
            .abs()
            .max((other.width_m - stated.width_m).abs());
        if difference_m > MIN_DIFFERENCE_M {
            as_assumed.camera.evidence.other_size_m = Some([other.length_m, other.width_m]);
        }
    }
    Some(as_assumed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::autocalibrate::rotating_camera::{
        IMAGE_SIZE, bare_frame, base, document, frames_at_scale, hypothesis, matched_views,
        matched_views_with_pixels, ptz, soccer,
    };
    use crate::autocalibrate::search::pose::PanoramaPose;
    use crate::calibrate::kept::{KeptInMemory, NothingKept};
    use std::ops::ControlFlow;
    use std::path::Path;
    use std::sync::{Arc, Mutex};
    use touchline_core::camera::PtzCamera;
    use touchline_core::geometry::Vec3;
    use touchline_documents::document::FieldSize;

    const NOTHING_KEPT: PartsOfStage<'_> = PartsOfStage {
        parts: &NothingKept,
        stage: 1,
    };

    const ALL_VIEWS: [usize; 7] = [0, 1, 2, 3, 4, 5, 6];

    /// A soccer field whose size is known.
    fn known_field() -> FieldPrior {
        let mut document = document();
        document.field.size = Some(FieldSize::Confirmed);
        FieldPrior::from_document(document.at(Path::new("")), &"main".into()).unwrap()
    }

    /// Poses beside the right one, each with its score of the search, as if found at one focal
    /// scale.
    fn poses_beside(field: &FieldModel, beside: &[(Vec3, f64)]) -> PosesByFocalScale {
        let frames = frames_at_scale(field);
        let scaled = |&(shift_m, explained): &(Vec3, f64)| {
            let pose = PanoramaPose::upright(base().position_m + shift_m, base().angles().heading);
            ScaledPose {
                scored: ScoredPose {
                    pose,
                    field: 0,
                    explained,
                    visible: 1.0,
                },
                frames: Arc::clone(&frames),
            }
        };
        let poses = beside.iter().map(scaled).collect();
        let rotations = RotationsByFocalScale::new([(100, frames.rotations.clone())]);
        PosesByFocalScale { poses, rotations }
    }

    #[test]
    fn poses_near_each_other_become_one_candidate_at_the_right_place() {
        let prior = known_field();
        let matched = matched_views_with_pixels(&prior.assumed, &ALL_VIEWS);
        let found = poses_beside(
            &prior.assumed,
            &[
                (Vec3::new(0.6, -0.8, 0.3), 0.8),
                (Vec3::new(-0.5, 0.7, 0.0), 0.9),
            ],
        );
        let steps = Mutex::new(Vec::new());
        let progress = Progress::new(|step: AutocalibrationProgress| {
            steps.lock().unwrap().push(step);
            ControlFlow::Continue(())
        });
        let placed = place_panoramas(found, &prior.search_fields(), &prior);
        let candidates = adjust_panoramas(&placed, &prior, &matched, NOTHING_KEPT, &progress)
            .ok()
            .unwrap();
        let [candidate] = candidates.as_slice() else {
            panic!("{} candidates", candidates.len())
        };
        let off_m = (candidate.position_m() - base().position_m).norm();
        assert!(off_m < 0.1, "{off_m:.3} m");
        assert!(candidate.nats() > 300.0, "{}", candidate.nats());
        assert_eq!(candidate.doubts(), []);
        let adjusting = AutocalibrationProgress::Adjusting { done: 0, of: 1 };
        assert_eq!(
            *steps.lock().unwrap(),
            [adjusting],
            "no other size is tried where it is known"
        );
    }

    #[test]
    fn candidates_of_a_killed_search_are_taken_up() {
        let prior = soccer();
        let matched = matched_views_with_pixels(&prior.assumed, &ALL_VIEWS);
        let found = poses_beside(&prior.assumed, &[(Vec3::new(0.6, -0.8, 0.3), 0.8)]);
        let placed = place_panoramas(found, &prior.search_fields(), &prior);
        let kept = KeptInMemory::default();
        let parts = PartsOfStage {
            parts: &kept,
            stage: 1,
        };
        let [whole, taken_up] = [(), ()].map(|()| {
            let progress = Progress::default();
            let candidates = adjust_panoramas(&placed, &prior, &matched, parts, &progress);
            let [candidate] = candidates.ok().unwrap().try_into().ok().unwrap();
            candidate
        });
        assert_eq!(*kept.recalled.borrow(), ["adjusted-1", "sized-0-1"]);
        assert_eq!(taken_up.camera, whole.camera);
        assert_eq!(taken_up.ptz, whole.ptz);
        assert_eq!(taken_up.paint_priors, whole.paint_priors);
    }

    #[test]
    fn without_poses_there_is_no_candidate() {
        let prior = known_field();
        let found = poses_beside(&prior.assumed, &[]);
        let progress = Progress::default();
        let placed = place_panoramas(found, &prior.search_fields(), &prior);
        let none = adjust_panoramas(&placed, &prior, &matched_views(), NOTHING_KEPT, &progress);
        assert_eq!(none.ok().map(|candidates| candidates.len()), Some(0));
    }

    #[test]
    fn frames_without_paint_are_said_to_show_too_little() {
        let prior = known_field();
        let views = [0, 2, 4];
        let mut matched = matched_views_with_pixels(&prior.assumed, &views);
        matched
            .marking_pixels
            .fill(bare_frame(0, IMAGE_SIZE).marking_pixels);
        let click = |(frame, landmark): (usize, &str)| {
            let at = prior
                .assumed
                .landmark_in_world(prior.assumed.landmark(landmark).unwrap());
            let image = PtzCamera::new(base(), ptz()[views[frame]])
                .image_from_world(at)
                .unwrap();
            GroundClick {
                frame,
                landmark: landmark.into(),
                image,
            }
        };
        let clicks = [(0, "penalty_mark_left"), (2, "centre_mark")].map(click);
        let nothing = find_panoramas(
            &matched,
            PosesFrom::Clicks(&clicks),
            &prior,
            NOTHING_KEPT,
            &Progress::default(),
        );
        assert!(matches!(
            nothing,
            Err(Stop::Abstained(
                crate::autocalibrate::Abstention::LittlePaint { places: 0 }
            ))
        ));
    }

    #[test]
    fn the_search_for_candidates_stops_when_it_is_cancelled() {
        let progress = Progress::new(|_| ControlFlow::Break(()));
        let usual = SearchPlaces::usual(&known_field().assumed);
        let origin = PosesFrom::Places(&usual);
        let stopped = find_panoramas(
            &matched_views(),
            origin,
            &known_field(),
            NOTHING_KEPT,
            &progress,
        );
        assert!(matches!(
            stopped,
            Err(Stop::Failed(AutocalibrationError::Stopped))
        ));
    }

    /// The right hypothesis on a field of this length, with evidence.
    fn of_length(length_m: f64, nats: f64) -> Hypothesis {
        let mut hypothesis = hypothesis(&soccer().assumed);
        hypothesis.camera.field.length_m = length_m;
        hypothesis.camera.evidence.nats = nats;
        hypothesis
    }

    #[test]
    fn a_stated_size_stays_and_a_better_one_is_recorded_against_it() {
        let choose = |resized: Hypothesis, is_known: bool| {
            let chosen =
                choose_size(Some(of_length(105.0, 500.0)), Some(resized), is_known).unwrap();
            (
                chosen.camera.field.length_m,
                chosen
                    .camera
                    .evidence
                    .other_size_m
                    .map(|[length_m, _]| length_m),
            )
        };
        assert_eq!(choose(of_length(102.0, 600.0), true), (105.0, Some(102.0)));
        assert_eq!(
            choose(of_length(102.0, 505.0), true),
            (105.0, None),
            "hardly better"
        );
        assert_eq!(
            choose(of_length(104.5, 600.0), true),
            (105.0, None),
            "hardly another size"
        );
        assert_eq!(choose(of_length(102.0, 600.0), false), (102.0, None));
        assert_eq!(choose(of_length(102.0, 400.0), false), (105.0, None));
        assert!(choose_size(None, Some(of_length(102.0, 600.0)), true).is_none());
    }
}
