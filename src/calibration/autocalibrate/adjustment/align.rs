//! Aligns the frames of a hypothesis to the paint of their own pictures.
//!
//! A frame's camera is constrained from three sides: its paint in the joint adjustment, its matches
//! with other frames, and, once a base is known, the painted lines of its own picture at full
//! resolution. The three are combined in two passes of one least-squares problem over all frames
//! ([`adjust_matched_frames`]):
//!
//! 1. matches and the paint of the joint adjustment place every frame; from there each is aligned
//!    to its own picture ([`snap`]);
//! 2. where that succeeds, its result replaces the first paint. An alignment that the neighbours
//!    contradict by more than [`MAX_CONTRADICTION_PX`] went to the wrong lines and is dropped; a
//!    frame that stays uncertain is not answered.

use super::hypothesis::Hypothesis;
use crate::autocalibrate::AutocalibrationProgress;
use crate::autocalibrate::error::Stop;
use crate::autocalibrate::frames::matched_frames::MatchedFrames;
use crate::autocalibrate::frames::sampled_frames::{MAX_PICTURES_IN_MEMORY, PictureOfFrame};
use crate::autocalibrate::progress::report;
use crate::calibrate::{AutocalibratedCamera, AutocalibratedFrame};
use std::collections::BTreeMap;
use touchline_core::camera::{CameraBase, PanTilt, Ptz, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{ImageSize, Mat3, Vec3};
use touchline_core::progress::Progress;
use touchline_core::solve::{Loss, Uncertainty};
use touchline_vision::paint::{
    GroundPicture, SnapError, SnapOptions, Snapped, check_lines, overlays_apart_px, snap,
};
use touchline_vision::track::{AdjustedFrame, PosePrior, PriorSource, adjust_matched_frames};

/// A frame is not answered if the 1-σ of its overlay at the worst corner, from paint and matches,
/// exceeds this, px at 1920 px width.
const MAX_CORNER_SIGMA_PX: f64 = 3.0;

/// An alignment that moves the overlay farther than this from where the neighbours place the frame
/// went to other lines, px at 1920 px width.
const MAX_CONTRADICTION_PX: f64 = 8.0;

/// Scale of the robust loss of an alignment, in its own 1-σ.
const ALIGNED_LOSS_SIGMAS: f64 = 3.0;

/// Lower bound of the 1-σ of an alignment at a corner, px at 1920 px width: errors of base and lens
/// are not part of its covariance.
const MIN_ALIGNED_SIGMA_PX: f64 = 1.0;

/// Aligns all frames of a hypothesis to their own pictures. Returns the hypothesis unchanged if
/// matches and paint leave a frame undetermined.
pub fn align_frames(
    mut hypothesis: Hypothesis,
    matched: &MatchedFrames,
    picture: PictureOfFrame<'_>,
    progress: &Progress<'_, AutocalibrationProgress>,
) -> Result<Hypothesis, Stop> {
    // Pass 1: place every frame by matches and by the paint of the joint adjustment, and align each
    // to its own picture from there. Pass 2: place all frames again with the alignments.
    let Some(placed) = ConstrainedFrames::solve(&hypothesis, &hypothesis.paint_priors, matched)
    else {
        return Ok(hypothesis);
    };
    hypothesis.camera.frames = placed.frames(matched);
    align_to_pictures(&mut hypothesis.camera, matched, picture, progress)?;
    placed.combine_with_alignments(&mut hypothesis, matched);
    Ok(hypothesis)
}

/// Aligns each frame to the painted lines of its own picture, where these determine it. Pictures
/// are read in chunks, to bound memory, and the frames of a chunk are aligned in parallel.
fn align_to_pictures(
    camera: &mut AutocalibratedCamera,
    matched: &MatchedFrames,
    picture: PictureOfFrame<'_>,
    progress: &Progress<'_, AutocalibrationProgress>,
) -> Result<(), Stop> {
    let AutocalibratedCamera {
        base,
        field,
        frames,
        ..
    } = camera;
    let of = frames.len();
    for (chunk, some) in frames.chunks_mut(MAX_PICTURES_IN_MEMORY).enumerate() {
        report(
            progress,
            AutocalibrationProgress::Snapping {
                done: chunk * MAX_PICTURES_IN_MEMORY,
                of,
            },
        )?;
        let aligned = matched.look_at_pictures(some, picture, |frame, ground| {
            align_to_picture(&PtzCamera::new(*base, frame.ptz), field, ground)
        });
        for (frame, aligned) in some.iter_mut().zip(aligned) {
            (frame.snapped, frame.unaligned_score) = match aligned {
                Some(Ok(alignment)) => (Some(alignment), None),
                Some(Err(score)) => (None, score),
                None => continue,
            };
        }
    }
    Ok(())
}

/// Aligns a camera to the painted lines of its picture. Where that fails, returns the score of the
/// line check instead: what the picture says of the camera counts all the same. It says nothing if
/// hardly any place of the lines is on open ground, as where turf in deep shade is not taken for
/// ground.
fn align_to_picture(
    camera: &PtzCamera,
    field: &FieldModel,
    ground: &GroundPicture,
) -> Result<Snapped, Option<f64>> {
    let options = SnapOptions::default();
    snap(ground, field, camera.base(), camera.ptz(), &[], &options).map_err(|error| {
        if let SnapError::NotBorneOut { score } = error {
            return Some(score);
        }
        let check = check_lines(ground, field, camera);
        check.can_say().then_some(check.score)
    })
}

/// All matched frames, placed by their pose priors and by the matches between them.
struct ConstrainedFrames {
    base: CameraBase,
    image_size: ImageSize,
    frames: Vec<AdjustedFrame>,
}

impl ConstrainedFrames {
    /// Solves for all frames, with pose priors for some of them. None if that leaves a frame
    /// undetermined.
    fn solve(
        hypothesis: &Hypothesis,
        priors: &[PosePrior],
        matched: &MatchedFrames,
    ) -> Option<Self> {
        let base = hypothesis.camera.base;
        let start = hypothesis.all_ptz(matched)?;
        let frames =
            adjust_matched_frames(&base, &start, &matched.matches, priors, matched.image_size)?;
        Some(Self {
            base,
            image_size: matched.image_size,
            frames,
        })
    }

    /// The frames with their indices in the document, uncertain ones included, none of them
    /// aligned.
    fn frames(&self, matched: &MatchedFrames) -> Vec<AutocalibratedFrame> {
        let frame = |(&index, held): (&usize, &AdjustedFrame)| AutocalibratedFrame {
            index,
            ptz: held.ptz,
            uncertainty: self.uncertainty(held),
            snapped: None,
            unaligned_score: None,
        };
        matched
            .indices
            .iter()
            .zip(&self.frames)
            .map(frame)
            .collect()
    }

    /// Places all frames again, by their alignments where these succeeded. Drops alignments that
    /// the neighbours contradict, and frames that stay uncertain.
    fn combine_with_alignments(&self, hypothesis: &mut Hypothesis, matched: &MatchedFrames) {
        // One prior per frame: its alignment, else its paint in the joint adjustment. Never both:
        // they are measurements of the same paint and not independent.
        let mut priors: Vec<PosePrior> = Vec::new();
        for (number, frame) in hypothesis.camera.frames.iter().enumerate() {
            let aligned = frame.snapped.as_ref().and_then(|snapped| {
                prior_from_alignment(
                    number,
                    snapped.ptz,
                    &snapped.uncertainty.clicks,
                    self.image_size,
                )
            });
            let by_joint_paint = || {
                hypothesis
                    .paint_priors
                    .iter()
                    .find(|prior| prior.frame == number)
                    .copied()
            };
            priors.extend(aligned.or_else(by_joint_paint));
        }
        // Without a solution the frames stay as pass 1 placed them.
        let Some(placed) = Self::solve(hypothesis, &priors, matched) else {
            return;
        };

        // A robust loss has weakened alignments that neighbours contradict; those that remain far
        // off are dropped for good.
        let scale = self.image_size.scale_from_1920();
        for (frame, held) in hypothesis.camera.frames.iter_mut().zip(&placed.frames) {
            frame.ptz = held.ptz;
            frame.uncertainty = placed.uncertainty(held);
            let camera = PtzCamera::new(self.base, held.ptz);
            // Compare the alignment with the camera that all constraints together give.
            let agrees = |snapped: &Snapped| {
                overlays_apart_px(&camera, snapped.ptz, self.image_size)
                    <= MAX_CONTRADICTION_PX * scale
            };
            frame.snapped = frame.snapped.take().filter(agrees);
        }
        // Directions come from all frames, so they are collected before uncertain frames go.
        hypothesis.camera.paint = placed.paint_directions(hypothesis);
        hypothesis.camera.frames.retain(|frame| {
            // The base is taken as exact: its error is common to all frames and is part of its own
            // covariance.
            let is_certain = |known: &Uncertainty| {
                self.corner_sigma_px(frame, known) <= MAX_CORNER_SIGMA_PX * scale
            };
            frame.uncertainty.as_ref().is_some_and(is_certain)
        });
    }

    /// The directions of persistent paint in the base, one in each cell of a grid over pan and
    /// tilt.
    fn paint_directions(&self, hypothesis: &Hypothesis) -> Vec<PanTilt> {
        const CELL_DEG: f64 = 0.04;
        let mut by_cell: BTreeMap<(i64, i64), PanTilt> = BTreeMap::new();
        for (held, paint) in self.frames.iter().zip(&hypothesis.frames.paint) {
            let camera = PtzCamera::new(self.base, held.ptz);
            for ray in paint
                .iter()
                .filter_map(|paint| camera.ray_from_image(paint.at).ok())
            {
                let [pan, tilt] =
                    [ray.pan, ray.tilt].map(|angle| (angle.degrees() / CELL_DEG).floor() as i64);
                by_cell.entry((pan, tilt)).or_insert(ray);
            }
        }
        by_cell.into_values().collect()
    }

    /// The uncertainty of a placed frame; none if its covariance is not usable.
    fn uncertainty(&self, held: &AdjustedFrame) -> Option<Uncertainty> {
        Uncertainty::from_covariance(
            &PtzCamera::new(self.base, held.ptz),
            held.covariance,
            self.image_size,
        )
        .ok()
    }

    /// 1-σ of the overlay at the worst corner, px, with the base taken as exact.
    fn corner_sigma_px(&self, frame: &AutocalibratedFrame, known: &Uncertainty) -> f64 {
        let camera = PtzCamera::new(self.base, frame.ptz);
        known
            .with_exact_base()
            .worst_corner_sigma_px(&camera, self.image_size)
    }
}

/// The pose prior of a frame from the alignment to its own paint, which has the `covariance` of
/// (pan rad, tilt rad, focal length px).
///
/// `adjust_matched_frames` works with log f, so row and column of f are divided by f. The floor
/// [`MIN_ALIGNED_SIGMA_PX`] = δ at a corner is δ/f as an angle. A change of log f moves a point
/// half a width from the centre by width/2 times that change, so its floor is 2δ/width. Adding the
/// floor to the covariance keeps it invertible.
pub fn prior_from_alignment(
    frame: usize,
    ptz: Ptz,
    covariance: &Mat3,
    image_size: ImageSize,
) -> Option<PosePrior> {
    // The floor, for each of (pan, tilt, log f).
    let least_angle = MIN_ALIGNED_SIGMA_PX * image_size.scale_from_1920() / ptz.focal_px;
    let least_log_focal =
        2.0 * MIN_ALIGNED_SIGMA_PX * image_size.scale_from_1920() / f64::from(image_size.width);
    let least = Vec3::new(least_angle, least_angle, least_log_focal);
    let floor = Mat3::from_diagonal(&least.map(|sigma| sigma * sigma));
    let to_log_focal = Mat3::from_diagonal(&Vec3::new(1.0, 1.0, ptz.focal_px.recip()));
    let information = (to_log_focal * covariance * to_log_focal + floor).try_inverse()?;
    let loss = Loss::Cauchy {
        c: ALIGNED_LOSS_SIGMAS,
    };
    Some(PosePrior {
        loss,
        ..PosePrior::new(frame, ptz, information, PriorSource::Paint)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::autocalibrate::rotating_camera::{
        IMAGE_SIZE, base, hypothesis, matched_views, ptz, soccer,
    };
    use std::ops::ControlFlow;
    use touchline_core::testing::SIZE;
    use touchline_vision::media::Picture;

    fn worst_apart_px(found: &[Ptz], truth: &[Ptz]) -> f64 {
        let apart_px = |(found, truth): (&Ptz, &Ptz)| {
            overlays_apart_px(&PtzCamera::new(base(), *truth), *found, IMAGE_SIZE)
        };
        found.iter().zip(truth).map(apart_px).fold(0.0, f64::max)
    }

    #[test]
    fn a_frame_without_paint_is_placed_by_its_matches() {
        let (matched, mut hypothesis) = (matched_views(), hypothesis(&soccer().assumed));
        hypothesis.ptz[3] = None;
        hypothesis.paint_priors.retain(|prior| prior.frame != 3);
        let solved =
            ConstrainedFrames::solve(&hypothesis, &hypothesis.paint_priors, &matched).unwrap();
        let found: Vec<Ptz> = solved
            .frames(&matched)
            .iter()
            .map(|frame| frame.ptz)
            .collect();
        assert!(worst_apart_px(&found, &ptz()) < 0.1, "{found:?}");
    }

    #[test]
    fn frames_without_any_prior_stay_as_they_are() {
        let (matched, mut hypothesis) = (matched_views(), hypothesis(&soccer().assumed));
        hypothesis.ptz.fill(None);
        let no_picture = &mut |_: usize| None;
        let frames = hypothesis.camera.frames.clone();
        let same = align_frames(hypothesis, &matched, no_picture, &Progress::default());
        assert_eq!(same.ok().map(|same| same.camera.frames), Some(frames));
    }

    #[test]
    fn frames_whose_pictures_cannot_be_read_are_placed_and_not_aligned() {
        let (matched, hypothesis) = (matched_views(), hypothesis(&soccer().assumed));
        let no_picture = &mut |_: usize| None;
        let aligned = align_frames(hypothesis, &matched, no_picture, &Progress::default());
        let camera = aligned.ok().map(|aligned| aligned.camera).unwrap();
        assert_eq!((camera.frames.len(), camera.aligned_frame_count()), (7, 0));
        assert!(
            camera
                .frames
                .iter()
                .all(|frame| frame.uncertainty.is_some())
        );
        assert!(
            !camera.paint.is_empty(),
            "the directions of the paint are reported"
        );
    }

    /// The scores of the line checks in pictures of one colour.
    fn scores_on(rgb: [u8; 3]) -> Vec<Option<f64>> {
        let (matched, hypothesis) = (matched_views(), hypothesis(&soccer().assumed));
        let num_pixels = (IMAGE_SIZE.width * IMAGE_SIZE.height) as usize;
        let [red, green, blue] = rgb;
        let picture = Picture::new(IMAGE_SIZE, [red, green, blue, 255].repeat(num_pixels)).unwrap();
        let mut picture = |_: usize| Some(picture.clone());
        let aligned = align_frames(hypothesis, &matched, &mut picture, &Progress::default());
        let frames = aligned.ok().unwrap().camera.frames;
        frames
            .iter()
            .map(AutocalibratedFrame::line_check_score)
            .collect()
    }

    #[test]
    fn bare_turf_contradicts_a_camera_and_a_dark_picture_says_nothing() {
        let on_turf = scores_on([60, 120, 60]);
        let is_contradicted = |score: &Option<f64>| score.is_some_and(|score| score < 0.1);
        assert!(on_turf.iter().all(is_contradicted), "{on_turf:?}");
        assert_eq!(scores_on([8, 8, 8]), vec![None; 7]);
    }

    #[test]
    fn a_frame_that_nothing_places_well_is_not_answered() {
        let (mut matched, mut hypothesis) = (matched_views(), hypothesis(&soccer().assumed));
        matched.matches.retain(|pair| pair.first != 0);
        hypothesis.paint_priors[0].information = Mat3::identity();
        let no_picture = &mut |_: usize| None;
        let aligned = align_frames(hypothesis, &matched, no_picture, &Progress::default());
        let indices = aligned
            .ok()
            .map(|aligned| aligned.camera.frames.iter().map(|f| f.index).collect());
        assert_eq!(indices, Some(vec![11, 12, 13, 14, 15, 16]));
    }

    #[test]
    fn alignment_stops_when_it_is_told_to() {
        let (matched, hypothesis) = (matched_views(), hypothesis(&soccer().assumed));
        let stopped = align_frames(
            hypothesis,
            &matched,
            &mut |_| None,
            &Progress::new(|_| ControlFlow::Break(())),
        );
        assert!(matches!(
            stopped,
            Err(Stop::Failed(
                crate::autocalibrate::AutocalibrationError::Stopped
            ))
        ));
    }

    #[test]
    fn an_alignment_is_never_taken_as_exact() {
        let ptz = Ptz::from_degrees(10.0, -8.0, 2000.0);
        let prior = prior_from_alignment(4, ptz, &Mat3::zeros(), SIZE).unwrap();
        let sigma = |axis: usize| prior.information[(axis, axis)].sqrt().recip();
        assert_eq!(prior.frame, 4);
        assert!(
            (sigma(0) - 1.0 / 2000.0).abs() < 1e-12,
            "1 px as an angle: {}",
            sigma(0)
        );
        assert!(
            (sigma(2) - 2.0 / 1920.0).abs() < 1e-12,
            "1 px half a width away: {}",
            sigma(2)
        );
        // 20 px of focal length are 1 % of it.
        let wide = Mat3::from_diagonal(&Vec3::new(0.0, 0.0, 400.0));
        let prior = prior_from_alignment(4, ptz, &wide, SIZE).unwrap();
        let sigma = prior.information[(2, 2)].sqrt().recip();
        assert!(
            (sigma - 0.01_f64.hypot(2.0 / 1920.0)).abs() < 1e-12,
            "{sigma}"
        );
    }
}
