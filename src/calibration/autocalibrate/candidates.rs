//! Refines the hypotheses of the search with all frames and ranks them: the candidates for the camera's base.
//!
//! A hypothesis places the whole panorama, at one of a few focal scales and on one of a few field sizes. It becomes a candidate in
//! three steps, each with more freedom than the one before:
//!
//! 1. [`fit_panorama`] frees the focal scale, the crown and the field's size; the frames stay rigid to each other. The best
//!    [`MAX_REFINED`] that stand in different places go on.
//! 2. [`adjust_jointly`] frees pan, tilt and focal length of every frame and the lens, and fits the paint in the pictures. It is
//!    repeated from its own result ([`adjust_repeatedly`]).
//! 3. Where the field's size is unknown, the best [`MAX_RESIZED`] try neighbouring sizes ([`try_neighbouring_sizes`]).
//!
//! Candidates are ranked by their evidence after step 2: the score of the search does not tell right from wrong reliably.

use super::clicked::GroundClick;
use super::error::Stop;
use super::evidence::{doubts_of, measure_evidence};
use super::field_prior::FieldPrior;
use super::joint::{FrameObservations, FramePaint, JointAdjustment, JointStart, adjust_jointly};
use super::matched_frames::MatchedFrames;
use super::panorama_fit::{PanoramaFit, PanoramaStart, fit_panorama};
use super::pitch_map::PitchMap;
use super::progress::report;
use super::rotations_by_focal_scale::RotationsByFocalScale;
use super::search::Hypothesis;
use super::starts::{ScaledHypothesis, hypotheses_from_clicks, search_hypotheses};
use super::{Doubt, UnclickedError, UnclickedProgress, WatchUnclicked};
use crate::calibrate::UnclickedEvidence;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use touchline_core::camera::{CameraBase, Ptz};
use touchline_core::field::FieldModel;
use touchline_core::solve::base::FittedSize;
use touchline_vision::track::{Hold, Tie, filled};

/// Hypotheses that are adjusted with all frames, at most.
const MAX_REFINED: usize = 5;

/// Candidates for which neighbouring field sizes are tried, at most.
const MAX_RESIZED: usize = 2;

/// An adjustment replaces another one if its score is this many times higher.
const MIN_GAIN: f64 = 1.01;

/// Positions nearer to each other than this are one answer, m.
pub(super) const SAME_POSITION_M: f64 = 1.5;

/// The best candidate has no rival if its score is this many times that of the runner-up.
pub(super) const RUNNER_UP_RATIO: f64 = 1.35;

/// A base adjusted to all frames, with what speaks for and against it.
pub(super) struct Candidate {
    pub base: CameraBase,
    /// With the crown, and the size where that was fitted.
    pub field: FieldModel,
    /// The lengths of the field that were fitted.
    pub sizes: Vec<FittedSize>,
    /// Of each sampled frame; none for frames that match no other or show too little paint.
    pub ptz: Vec<Option<Ptz>>,
    pub evidence: UnclickedEvidence,
    pub doubts: Vec<Doubt>,
    pub view_graph: ViewGraph,
}

/// The matched frames and what constrains them: the matches between them and the paint in each. Frames are numbered within the
/// graph.
#[derive(Clone)]
pub(super) struct ViewGraph {
    /// Indices among the sampled frames.
    pub indices: Vec<usize>,
    /// The edges.
    pub matches: Arc<Vec<Tie>>,
    /// Of each frame, by the matches alone.
    pub ptz_by_matches: Vec<Ptz>,
    /// Of each frame, by the paint of all frames; none for frames that show too little.
    pub ptz: Vec<Option<Ptz>>,
    /// Persistent paint of each frame.
    pub paint: Vec<FramePaint>,
    /// What each frame's own paint says of its camera.
    pub paint_priors: Vec<Hold>,
}

/// A hypothesis after step 1.
struct PlacedPanorama<'a> {
    hypothesis: &'a ScaledHypothesis,
    fit: PanoramaFit,
}

/// A hypothesis after step 2.
struct JointFit<'a> {
    hypothesis: &'a ScaledHypothesis,
    joint: JointAdjustment,
    evidence: UnclickedEvidence,
}

impl Candidate {
    pub fn score(&self) -> f64 {
        self.evidence.score()
    }

    fn from_joint_fit(fit: JointFit<'_>, matched: &MatchedFrames, num_sampled: usize) -> Self {
        let JointFit { hypothesis, joint, evidence } = fit;
        let mut ptz = vec![None; num_sampled];
        for (index, frame_ptz) in matched.indices.iter().zip(&joint.ptz) {
            ptz[*index] = *frame_ptz;
        }
        let doubts = doubts_of(&evidence, &joint.base);
        let view_graph = ViewGraph {
            indices: matched.indices.clone(),
            matches: Arc::clone(&matched.matches),
            ptz_by_matches: hypothesis.rotations.ptz.clone(),
            paint: hypothesis.paint.clone(),
            paint_priors: joint.paint_priors(),
            ptz: joint.ptz,
        };
        Self { base: joint.base, field: joint.field, sizes: joint.sizes, ptz, evidence, doubts, view_graph }
    }
}

impl JointFit<'_> {
    fn score(&self) -> f64 {
        self.evidence.score()
    }
}

/// The candidates for the base of the matched frames' camera, best first.
///
/// With `clicks`, these determine the hypotheses; without, all poses are searched. `num_sampled` is the number of sampled frames, of
/// which the matched ones are a part.
pub(super) fn find_candidates(
    num_sampled: usize,
    matched: &MatchedFrames,
    clicks: Option<&[GroundClick]>,
    field_prior: &FieldPrior,
    watch: WatchUnclicked<'_>,
) -> Result<Vec<Candidate>, Stop> {
    report(watch, UnclickedProgress::Gathering)?;
    let fields = field_prior.search_fields();
    let maps: Vec<PitchMap> = fields.iter().map(PitchMap::with_grid).collect();
    let (hypotheses, rotations) = match clicks {
        None => search_hypotheses(matched, &maps, watch)?,
        Some(clicks) => hypotheses_from_clicks(matched, &fields, &maps, clicks, watch)?,
    };

    let panoramas = place_panoramas(&hypotheses, &fields, field_prior, &rotations);

    let num_done = AtomicUsize::new(0);
    let fits: Result<Vec<Option<JointFit<'_>>>, UnclickedError> = panoramas
        .par_iter()
        .map(|panorama| {
            let done = num_done.load(Ordering::Relaxed);
            report(watch, UnclickedProgress::Adjusting { done, of: panoramas.len() })?;
            let fit = adjust_with_and_without_size(panorama, &rotations, field_prior, matched);
            num_done.fetch_add(1, Ordering::Relaxed);
            Ok(fit)
        })
        .collect();
    // Rayon keeps the order of the hypotheses and the sort is stable: equal scores come out the same every time.
    let mut fits: Vec<JointFit<'_>> = fits?.into_iter().flatten().collect();
    sort_best_first(&mut fits);

    if field_prior.is_size_unknown() {
        let of = fits.len().min(MAX_RESIZED);
        for (done, fit) in fits.iter_mut().take(of).enumerate() {
            report(watch, UnclickedProgress::Sizing { done, of })?;
            try_neighbouring_sizes(fit, field_prior, matched);
        }
        sort_best_first(&mut fits);
    }
    Ok(fits.into_iter().map(|fit| Candidate::from_joint_fit(fit, matched, num_sampled)).collect())
}

fn sort_best_first(fits: &mut [JointFit<'_>]) {
    fits.sort_by(|a, b| b.score().total_cmp(&a.score()));
}

/// Step 1: fits the panorama of each hypothesis; the best first, one for each place where the camera may stand.
fn place_panoramas<'a>(
    hypotheses: &'a [ScaledHypothesis],
    fields: &[FieldModel],
    field_prior: &FieldPrior,
    rotations: &RotationsByFocalScale,
) -> Vec<PlacedPanorama<'a>> {
    let size_prior = field_prior.is_size_unknown().then_some(field_prior);
    let mut placed: Vec<PlacedPanorama<'_>> = hypotheses
        .par_iter()
        .filter_map(|hypothesis| {
            let Hypothesis { pose, field, .. } = hypothesis.hypothesis;
            let start = PanoramaStart { pose, log_scale: hypothesis.log_scale, field: &fields[field] };
            let fit = fit_panorama(hypothesis, &start, size_prior, rotations)?;
            Some(PlacedPanorama { hypothesis, fit })
        })
        .collect();

    // The fit says how much of the paint lies on lines, the search how many of the lines show paint.
    let score = |placed: &PlacedPanorama<'_>| placed.fit.explained * placed.hypothesis.hypothesis.visible;
    placed.sort_by(|a, b| score(b).total_cmp(&score(a)));

    // Neighbouring hypotheses converge to one place.
    let mut distinct: Vec<PlacedPanorama<'_>> = Vec::new();
    for candidate in placed {
        let position_m = candidate.fit.pose.position_m;
        let is_near = |other: &PlacedPanorama<'_>| (other.fit.pose.position_m - position_m).norm() < SAME_POSITION_M;
        if distinct.len() < MAX_REFINED && !distinct.iter().any(is_near) {
            distinct.push(candidate);
        }
    }
    distinct
}

/// Step 2: adjusts all frames jointly, on the field as assumed and, where the rules allow other sizes, with its size fitted.
fn adjust_with_and_without_size<'a>(
    panorama: &PlacedPanorama<'a>,
    rotations: &RotationsByFocalScale,
    field_prior: &FieldPrior,
    matched: &MatchedFrames,
) -> Option<JointFit<'a>> {
    let PlacedPanorama { hypothesis, fit } = panorama;
    // Step 1 fitted the size where it is unknown and kept it where it is stated. The other variant is fitted here.
    let (as_assumed, resized) = if field_prior.is_size_unknown() {
        (refit_assumed_field(panorama, None, rotations, field_prior), Some(fit.clone()))
    } else if field_prior.allows_other_sizes() {
        (Some(fit.clone()), refit_assumed_field(panorama, Some(field_prior), rotations, field_prior))
    } else {
        (Some(fit.clone()), None)
    };
    let (as_assumed, resized) = rayon::join(
        || adjust_repeatedly(&JointStart::from_panorama(&as_assumed?), None, hypothesis, matched),
        || adjust_repeatedly(&JointStart::from_panorama(&resized?), Some(field_prior), hypothesis, matched),
    );
    choose_size(as_assumed, resized, field_prior.is_known)
}

/// Fits a panorama again from where it stands, starting with the field as assumed.
fn refit_assumed_field(
    panorama: &PlacedPanorama<'_>,
    size_prior: Option<&FieldPrior>,
    rotations: &RotationsByFocalScale,
    field_prior: &FieldPrior,
) -> Option<PanoramaFit> {
    let PanoramaFit { pose, log_scale, .. } = panorama.fit;
    let start = PanoramaStart { pose, log_scale, field: &field_prior.assumed };
    fit_panorama(panorama.hypothesis, &start, size_prior, rotations)
}

impl JointStart {
    fn from_panorama(fit: &PanoramaFit) -> Self {
        let ptz = fit.rotations.ptz.iter().copied().map(Some).collect();
        Self { field: fit.field.clone(), base: fit.base(), ptz }
    }

    /// From the result of an adjustment. Frames that it dropped are placed by their matches with those that it kept.
    fn from_adjustment(fit: &JointFit<'_>, matched: &MatchedFrames) -> Option<Self> {
        let ptz = filled(&fit.joint.ptz, &fit.hypothesis.rotations.ptz, &matched.matches)?;
        Some(Self { field: fit.joint.field.clone(), base: fit.joint.base, ptz: ptz.into_iter().map(Some).collect() })
    }
}

/// Adjusts a base and its frames, and repeats that from the result while the score rises by [`MIN_GAIN`].
///
/// Paint is assigned to lines once per round, with the base of the moment. A frame that was assigned to the wrong lines, or dropped
/// because it lay near none, gets a second chance from the better base and field size.
fn adjust_repeatedly<'a>(
    start: &JointStart,
    size_prior: Option<&FieldPrior>,
    hypothesis: &'a ScaledHypothesis,
    matched: &MatchedFrames,
) -> Option<JointFit<'a>> {
    const MAX_PASSES: usize = 4;
    let mut best = adjust_and_measure(start, size_prior, hypothesis, matched)?;
    for _ in 1..MAX_PASSES {
        let Some(start) = JointStart::from_adjustment(&best, matched) else { break };
        let Some(next) = adjust_and_measure(&start, size_prior, hypothesis, matched) else { break };
        if next.score() <= MIN_GAIN * best.score() {
            break;
        }
        best = next;
    }
    Some(best)
}

/// One joint adjustment and the evidence for its result.
fn adjust_and_measure<'a>(
    start: &JointStart,
    size_prior: Option<&FieldPrior>,
    hypothesis: &'a ScaledHypothesis,
    matched: &MatchedFrames,
) -> Option<JointFit<'a>> {
    let paint = &hypothesis.paint;
    let observed = FrameObservations { paint, matches: &matched.matches, image_size: matched.size };
    let joint = adjust_jointly(start, size_prior, &observed)?;
    let evidence = measure_evidence(&joint, paint, &matched.strokes);
    Some(JointFit { hypothesis, joint, evidence })
}

/// Chooses between the field as assumed and the field of fitted size.
///
/// Where the size is unknown, the one with the higher score. Where the document states it, the stated one; another size that is
/// clearly better is recorded as evidence against it.
fn choose_size<'a>(
    as_assumed: Option<JointFit<'a>>,
    resized: Option<JointFit<'a>>,
    is_known: bool,
) -> Option<JointFit<'a>> {
    /// Two more parameters always explain a little more: 0.1 % on a real pitch of the stated size, 2.8 % on a drawn one that is 3 m
    /// wider than stated.
    const CLEARLY_BETTER: f64 = 1.01;
    /// Smaller differences are no doubt about the stated size, m: pitches are laid out by tape.
    const MIN_DIFFERENCE_M: f64 = 1.0;

    let (mut as_assumed, resized) = match (as_assumed, resized) {
        (Some(as_assumed), Some(resized)) => (as_assumed, resized),
        (as_assumed, resized) => return as_assumed.or(resized.filter(|_| !is_known)),
    };
    if !is_known {
        return Some(if resized.score() >= as_assumed.score() { resized } else { as_assumed });
    }
    if resized.score() > CLEARLY_BETTER * as_assumed.score() {
        let (stated, other) = (&as_assumed.joint.field, &resized.joint.field);
        let difference_m = (other.length_m - stated.length_m).abs().max((other.width_m - stated.width_m).abs());
        if difference_m > MIN_DIFFERENCE_M {
            as_assumed.evidence.other_size_m = Some([other.length_m, other.width_m]);
        }
    }
    Some(as_assumed)
}

/// Step 3: moves a fit to a neighbouring field size as long as that raises the score by [`MIN_GAIN`].
///
/// Least squares alone does not get there: while paint is assigned to the wrong lines, the size that fits best is the wrong one.
fn try_neighbouring_sizes(fit: &mut JointFit<'_>, field_prior: &FieldPrior, matched: &MatchedFrames) {
    const MAX_STEPS: usize = 3;
    for _ in 0..MAX_STEPS {
        let neighbours: Vec<JointFit<'_>> = field_prior
            .neighbouring_sizes(&fit.joint.field)
            .into_par_iter()
            .filter_map(|field| {
                let start = JointStart { field, base: fit.joint.base, ptz: fit.joint.ptz.clone() };
                adjust_and_measure(&start, Some(field_prior), fit.hypothesis, matched)
            })
            .collect();
        match neighbours.into_iter().max_by(|a, b| a.score().total_cmp(&b.score())) {
            Some(best) if best.score() > MIN_GAIN * fit.score() => *fit = best,
            _ => return,
        }
    }
}
