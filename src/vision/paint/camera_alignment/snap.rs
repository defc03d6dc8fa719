//! Aligns a camera to the painted lines of one picture, or says why it cannot. Users know this as
//! *snapping*.
//!
//! # Problem
//!
//! Given: the base, and a camera that is right within some 50 px. Wanted: pan, tilt and focal
//! length that put the field's lines on their paint, or an error if the paint does not determine
//! them. A wrong camera with a small covariance does more harm than none.
//!
//! # Method
//!
//! 1. **Observations** (`sightings.rs`): the field's lines are sampled as the camera predicts them,
//!    and the picture is searched across each sample for ridges of paint: as narrow as predicted,
//!    brighter than both sides, with ground beside them (`ridge.rs`; for floors `floor_ridge.rs`).
//! 2. **Grid search** (`search.rs`): every change of the camera within reach is scored by the
//!    number of samples that then find a ridge. Several are kept, because a parallel line may be as
//!    near as the right one.
//! 3. **Alignment** (`alignment.rs`) from each: Gauss–Newton on distances across the lines, with
//!    Geman–McClure weights whose scale shrinks. Steps 1 and 3 are repeated with a smaller reach:
//!    48, 16 and 8 px at 1920 px width.
//! 4. **Acceptance**. The best fit is rejected if another one more than 10 px away has 90 % of its
//!    agreement (ambiguous); if fewer than 40 samples show paint; if two halves of the samples give
//!    cameras more than 1.5 px apart; if a click is more than 6 σ from where the result puts it; if
//!    1-σ of the overlay at the worst corner exceeds 8 px; or if the line check (`check.rs`), which
//!    reads the picture again, gives a probability below 0.8.
//!
//! The covariance assumes 1-σ of 0.5 px for each ridge and of 0.16 px for an error that all ridges
//! of a line share (paint is not exactly where the rules put it). It includes the uncertainty of
//! the base.
//!
//! # Robustness
//!
//! Robust against parallel lines, boards, second sets of lines on a training ground, shadows and
//! players. Not robust against an error of the base that pan and tilt can compensate for in one
//! picture; `calibrate::estimate_on_paint` adjusts base and frames together for that.

use super::alignment::{
    ClickAlignment, LinearisedCamera, RidgeAlignment, StepPx, sample_sigmas_px,
};
use super::check::{check_lines, halves_apart_px, overlays_apart_px};
use super::ground_on_field::ground_on_field;
use super::lens::{OwnLens, own_lens};
use super::search::likely_steps;
use super::sightings::{LineObservations, SamplingDistances};
use crate::paint::{GroundPicture, LineCheck, SnapError};
use touchline_core::camera::{CameraBase, FocalCurve, Ptz, PtzCamera};
use touchline_core::field::FieldModel;
use touchline_core::geometry::{stride_of_subsample, subsample};
use touchline_core::solve::{Observation, SolveError, Uncertainty};

/// Settings of the alignment. Lengths are px at 1920 px width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SnapOptions {
    /// Maximum distance of paint from where the starting camera predicts it. 48 by default.
    pub reach_px: f64,
    /// Minimum number of samples with paint. 40 by default.
    pub min_samples: usize,
    /// Maximum distance between the overlays of the cameras that two halves of the samples give.
    /// 1.5 by default.
    pub halves_px: f64,
    /// Maximum 1-σ of the overlay at the worst corner of the picture, from paint and clicks alone.
    /// 8 by default.
    pub max_corner_sigma_px: f64,
    /// Maximum distance of a click from where the result puts it, in σ of the click. 6 by default.
    pub click_sigmas: f64,
    /// Minimum score of the result's line check. 0.8 by default.
    pub min_score: f64,
    /// Whether to fit the frame's own k₁ in place of the base's lens. Off by default.
    pub own_k1: bool,
}

impl Default for SnapOptions {
    fn default() -> Self {
        Self {
            reach_px: 48.0,
            min_samples: 40,
            halves_px: 1.5,
            max_corner_sigma_px: 8.0,
            click_sigmas: 6.0,
            min_score: 0.8,
            own_k1: false,
        }
    }
}

impl SnapOptions {
    /// Looser limits, for a lens that is not yet right: lines look curved then, so that the two
    /// halves of a frame's paint may disagree by more than in a final alignment.
    pub fn for_unknown_lens() -> Self {
        Self {
            halves_px: 4.0,
            min_score: 0.5,
            ..Self::default()
        }
    }
}

/// A camera aligned to the painted lines.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapped {
    /// Pan, tilt and focal length.
    pub ptz: Ptz,
    /// The fitted lens, if [`SnapOptions::own_k1`] is set.
    pub own_lens: Option<FocalCurve>,
    /// Number of samples whose ridges were used.
    pub samples: usize,
    /// Root mean square of the ridges' distances from their lines, px.
    pub rms_px: f64,
    /// Distance between the overlays of the cameras that two halves of the samples give, px.
    pub halves_px: f64,
    /// Covariance, from the paint, the clicks and the base.
    pub uncertainty: Uncertainty,
    /// The line check of the result.
    pub check: LineCheck,
}

/// Scales of the robust loss in the three stages (coarse, middle, fine), one for each Gauss–Newton
/// step, px at 1920 px width.
const SCALES_PX: [&[f64]; 3] = [
    &[8.0, 6.0, 4.0, 3.0],
    &[5.0, 4.0, 3.0, 2.0],
    &[3.0, 2.0, 1.5, 1.5],
];

/// Sampling of the picture in the three stages, px at 1920 px width. The reach of the first stage
/// is [`SnapOptions::reach_px`].
const COARSE_SPACING_PX: f64 = 32.0;
const MIDDLE: SamplingDistances = SamplingDistances {
    reach_px: 16.0,
    spacing_px: 24.0,
    step_px: 1.0,
};
const FINE: SamplingDistances = SamplingDistances {
    reach_px: 8.0,
    spacing_px: 12.0,
    step_px: 0.5,
};

/// Maximum distance of a ridge from its line after the last step, px at 1920 px width. Ridges
/// farther away belong to something else.
const TAKES_PART_PX: f64 = 4.0;

/// A fit is ambiguous if another one reaches this share of its agreement and lies farther away than
/// [`ELSEWHERE_PX`].
const AMBIGUOUS_SHARE: f64 = 0.9;

/// Fits nearer to the best one than this use the same lines, px at 1920 px width.
const ELSEWHERE_PX: f64 = 10.0;

/// Fits nearer to each other than this count as one, px at 1920 px width.
const SAME_PX: f64 = 4.0;

/// Maximum number of samples from which the covariance is computed.
const UNCERTAINTY_SAMPLES: usize = 120;

/// Aligns a camera to the painted lines, from `start` and constrained by `clicks` with their σ.
///
/// # Errors
///
/// [`SnapError`] names the test that failed: too little paint, halves that disagree, another camera
/// that fits as well, clicks far from the result, a wide covariance, a low line check.
pub fn snap(
    ground: &GroundPicture,
    field: &FieldModel,
    base: &CameraBase,
    start: Ptz,
    clicks: &[Observation],
    options: &SnapOptions,
) -> Result<Snapped, SnapError> {
    let ground = &*ground_on_field(ground, field, &PtzCamera::new(*base, start));
    let problem = Problem {
        ground,
        field,
        base,
        clicks,
        scale: ground.size().scale_from_1920(),
        options,
    };
    let (mut fits, why_none) = problem.fits(start);
    fits.sort_by(|a, b| b.agreeing.total_cmp(&a.agreeing));
    let Some(best) = fits.first() else {
        return Err(why_none);
    };
    // Ambiguous: a fit that is nearly as good lies elsewhere. Parallel lines cause this.
    for other in fits
        .iter()
        .filter(|other| other.agreeing >= AMBIGUOUS_SHARE * best.agreeing)
    {
        let apart_px = problem.apart_px(best.ptz, other.ptz);
        if apart_px > ELSEWHERE_PX * problem.scale {
            return Err(SnapError::Ambiguous { apart_px });
        }
    }
    if !options.own_k1 {
        return problem.verify(best);
    }
    // A new k₁ moves the predicted lines, so the picture is read again and the camera aligned once
    // more. The test for ambiguity is not repeated.
    let OwnLens { base, ptz } = own_lens(ground, field, &PtzCamera::new(*base, best.ptz), clicks)?;
    let problem = Problem {
        base: &base,
        ..problem
    };
    let realigned = problem.refine(ptz)?;
    Ok(Snapped {
        own_lens: Some(base.distortion),
        ..problem.verify(&realigned)?
    })
}

/// The inputs of one alignment, and the factor `scale` from px at 1920 px width to px.
struct Problem<'a> {
    ground: &'a GroundPicture,
    field: &'a FieldModel,
    base: &'a CameraBase,
    clicks: &'a [Observation],
    scale: f64,
    options: &'a SnapOptions,
}

/// The result of one alignment.
struct Fit {
    ptz: Ptz,
    /// The last observations, and the camera around which they were linearised.
    seen: LineObservations,
    around: LinearisedCamera,
    /// The last step, from the linearised camera to `ptz`.
    step: StepPx,
    /// Share of the open samples that have paint where it is predicted, each weighted by its
    /// distance.
    agreeing: f64,
}

impl Problem<'_> {
    /// The picture's paint near the lines that a camera predicts. Reach and spacing are px at 1920
    /// px width; the step of the profiles is px, because blur does not scale with the picture.
    fn look(&self, ptz: Ptz, look: SamplingDistances) -> (LinearisedCamera, LineObservations) {
        let around = LinearisedCamera::new(self.base, ptz, self.ground.size().width);
        let scaled = SamplingDistances {
            reach_px: look.reach_px * self.scale,
            spacing_px: look.spacing_px * self.scale,
            step_px: look.step_px,
        };
        let seen = LineObservations::search(self.ground, self.field, &around.camera, scaled);
        (around, seen)
    }

    /// The scales of the loss in a stage (0: coarse), px of the picture.
    fn scales_px(&self, stage: usize) -> Vec<f64> {
        SCALES_PX[stage]
            .iter()
            .map(|scale_px| scale_px * self.scale)
            .collect()
    }

    fn apart_px(&self, one: Ptz, other: Ptz) -> f64 {
        overlays_apart_px(&PtzCamera::new(*self.base, one), other, self.ground.size())
    }

    /// Aligns a linearised camera to the ridges around it and to the clicks. The step leads from
    /// there to the aligned camera.
    fn align(
        &self,
        around: &LinearisedCamera,
        ridges: &RidgeAlignment<'_>,
        stage: usize,
    ) -> StepPx {
        let clicks = ClickAlignment::new(around, self.clicks);
        let scales_px = self.scales_px(stage);
        ridges.align(StepPx::zeros(), &scales_px, Some(&clicks), |_| true)
    }

    /// The distinct results of aligning from every likely step within reach of `start`, and the
    /// reason if there are none: no step finds paint, or the camera diverges from all that do.
    fn fits(&self, start: Ptz) -> (Vec<Fit>, SnapError) {
        let mut why_none = SnapError::TooFewSamples {
            found: 0,
            needed: self.options.min_samples,
        };
        let coarse = SamplingDistances {
            reach_px: self.options.reach_px,
            spacing_px: COARSE_SPACING_PX,
            step_px: 1.0,
        };
        // Coarse stage. The picture is read once; every likely step is aligned within the same
        // observations, the widest that are made.
        let (around, seen) = self.look(start, coarse);
        let ridges = RidgeAlignment::new(&around, &seen, self.scale);
        let clicks = ClickAlignment::new(&around, self.clicks);
        let mut fits: Vec<Fit> = Vec::new();
        for step in likely_steps(&ridges, &clicks, self.options.reach_px * self.scale) {
            // The loss scales of the coarse stage, on the ridges of the coarse observations.
            let step = ridges.align(step, &self.scales_px(0), Some(&clicks), |_| true);
            let fit = match self.refine(around.ptz_after(&step)) {
                Ok(fit) => fit,
                Err(diverged) => {
                    why_none = diverged;
                    continue;
                }
            };
            // Several starts often end in one minimum; it is kept once.
            if fits
                .iter()
                .all(|other| self.apart_px(other.ptz, fit.ptz) > SAME_PX * self.scale)
            {
                fits.push(fit);
            }
        }
        (fits, why_none)
    }

    /// The middle and the fine stage.
    ///
    /// # Errors
    /// [`SnapError::Undetermined`] if the camera diverges: the paint that is seen keeps it nowhere.
    fn refine(&self, start: Ptz) -> Result<Fit, SnapError> {
        let diverged = SnapError::Undetermined {
            sigma_px: f64::INFINITY,
        };
        if !start.is_finite() {
            return Err(diverged);
        }
        // In each stage the picture is read again around the new camera, within a smaller reach,
        // because the linearisation was exact at the old camera only. The fine stage has denser
        // samples and half-pixel profiles.
        let (around, seen) = self.look(start, MIDDLE);
        let ridges = RidgeAlignment::new(&around, &seen, self.scale);
        let middle = around.ptz_after(&self.align(&around, &ridges, 1));
        if !middle.is_finite() {
            return Err(diverged);
        }
        let (around, seen) = self.look(middle, FINE);
        let ridges = RidgeAlignment::new(&around, &seen, self.scale);
        let step = self.align(&around, &ridges, 2);
        let ptz = around.ptz_after(&step);
        if !ptz.is_finite() {
            return Err(diverged);
        }
        // Agreement: a sample counts 1 for a ridge on its line, 1/2 for one 2 px away (at 1920 px
        // width), 0 for open ground without paint. Hidden samples do not count. The 1 in the
        // denominator lowers the score of fits with few samples.
        let residuals =
            (0..ridges.num_samples()).filter_map(|sample| ridges.residual_px(sample, &step));
        let (count, sum) = residuals.fold((0.0, 0.0), |(count, sum), residual| {
            (
                count + 1.0,
                sum + 1.0 / (1.0 + (residual / (2.0 * self.scale)).powi(2)),
            )
        });
        let agreeing = sum / (count + seen.bare() as f64 + 1.0);
        Ok(Fit {
            ptz,
            seen,
            around,
            step,
            agreeing,
        })
    }

    /// Tests a fit and computes its covariance.
    fn verify(&self, fit: &Fit) -> Result<Snapped, SnapError> {
        let options = self.options;
        let ridges = RidgeAlignment::new(&fit.around, &fit.seen, self.scale);
        // Enough samples with a ridge on their line.
        let taking_part: Vec<(usize, f64)> = (0..ridges.num_samples())
            .filter_map(|sample| Some((sample, ridges.residual_px(sample, &fit.step)?.abs())))
            .filter(|(_, distance_px)| *distance_px <= TAKES_PART_PX * self.scale)
            .collect();
        let found = taking_part.len();
        if found < options.min_samples {
            return Err(SnapError::TooFewSamples {
                found,
                needed: options.min_samples,
            });
        }
        let size = self.ground.size();
        // Two halves of the samples, each aligned alone with the last scale of the loss, must
        // agree.
        let last_scales_px = &self.scales_px(2)[2..];
        let halves_px = halves_apart_px(&ridges, &fit.around, fit.step, last_scales_px, size);
        // This and the comparisons below are negated, so that NaN fails them.
        let allowed_px = options.halves_px * self.scale;
        if !(halves_px <= allowed_px) {
            return Err(SnapError::HalvesDisagree {
                apart_px: halves_px,
                allowed_px,
            });
        }
        // Huber's loss limits the influence of a click, so the paint can overrule one. Then either
        // the alignment or the click is wrong.
        let camera = PtzCamera::new(*self.base, fit.ptz);
        for click in self.clicks.iter().filter(|click| !click.check) {
            let sigmas = click.distance_sigmas(&camera);
            if !(sigmas <= options.click_sigmas) {
                return Err(SnapError::AgainstClicks {
                    click: click.click,
                    sigmas,
                });
            }
        }
        // The paint and the clicks must determine the camera everywhere in the picture.
        let uncertainty = self.uncertainty(fit, &camera, &taking_part);
        let uncertainty = uncertainty.map_err(|_| SnapError::Undetermined {
            sigma_px: f64::INFINITY,
        })?;
        // Without the base's uncertainty, which no paint in this frame can reduce.
        let by_paint = uncertainty.with_exact_base();
        let sigma_px = by_paint.worst_corner_sigma_px(&camera, size);
        if !(sigma_px <= options.max_corner_sigma_px * self.scale) {
            return Err(SnapError::Undetermined { sigma_px });
        }
        // The line check samples the picture again, independently of the pairs that the fit used.
        // It comes last: it is the most expensive test, and the error names the first that fails.
        let check = check_lines(self.ground, self.field, &camera);
        if !(check.score >= options.min_score) {
            return Err(SnapError::NotBorneOut { score: check.score });
        }
        let squares = taking_part
            .iter()
            .map(|(_, distance_px)| distance_px * distance_px);
        let rms_px = (squares.sum::<f64>() / found as f64).sqrt();
        Ok(Snapped {
            ptz: fit.ptz,
            own_lens: None,
            samples: found,
            rms_px,
            halves_px,
            uncertainty,
            check,
        })
    }

    /// Covariance from the samples' ridges and the clicks, including that of the base.
    fn uncertainty(
        &self,
        fit: &Fit,
        camera: &PtzCamera,
        taking_part: &[(usize, f64)],
    ) -> Result<Uncertainty, SolveError> {
        let sigmas_px = sample_sigmas_px(&fit.seen, self.scale);
        // Every s-th sample stands for s samples: dividing its σ by √s keeps the total information.
        // The σ are those of all samples, so that the common error of a line stays what it is.
        let stands_for =
            (stride_of_subsample(taking_part.len(), UNCERTAINTY_SAMPLES) as f64).sqrt();
        let of_paint = subsample(taking_part, UNCERTAINTY_SAMPLES).filter_map(|(index, _)| {
            let sample = &fit.seen.samples[*index];
            let image = camera.image_from_world(sample.at).ok()?;
            Observation::from_paint(
                self.field,
                sample.line,
                image,
                sigmas_px[*index] / stands_for,
                *index,
            )
        });
        let clicks = self.clicks.iter().filter(|click| !click.check).copied();
        let observations: Vec<Observation> = of_paint.chain(clicks).collect();
        Uncertainty::from_observations(camera, &observations, None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::drawn::{PICTURE, SIZE, camera, soccer, truth};
    use touchline_core::geometry::{ImagePoint, Vec2};

    fn snapped(start: &PtzCamera, clicks: &[Observation]) -> Result<Snapped, SnapError> {
        let field = soccer();
        let ground = GroundPicture::new(&PICTURE, &[]);
        snap(
            &ground,
            &field,
            start.base(),
            start.ptz(),
            clicks,
            &SnapOptions::default(),
        )
    }

    fn click(landmark: &str, off_px: Vec2) -> Observation {
        let field = soccer();
        let world = field.landmark_in_world(field.landmark(landmark).unwrap());
        let image: ImagePoint = truth().image_from_world(world).unwrap().translate(off_px);
        Observation::from_point(world, image, 1.5, 0)
    }

    #[test]
    fn a_drawn_picture_gives_its_camera_back_from_near_and_far() {
        for start in [
            camera(4.0, -14.0, 1500.0),
            camera(4.4, -14.3, 1510.0),
            camera(3.0, -14.6, 1480.0),
        ] {
            let found = snapped(&start, &[]).unwrap();
            let apart_px = overlays_apart_px(&truth(), found.ptz, SIZE);
            assert!(
                apart_px < 0.15,
                "{apart_px} px from {:?}: {found:?}",
                start.ptz()
            );
            assert!(
                found.halves_px < 0.3 && found.rms_px < 0.5 && found.samples > 150,
                "{found:?}"
            );
        }
    }

    #[test]
    fn the_stated_uncertainty_is_small_and_grows_with_the_bases() {
        let exact = snapped(&truth(), &[]).unwrap();
        let corner_px = exact.uncertainty.worst_corner_sigma_px(&truth(), SIZE);
        assert!((0.01..1.5).contains(&corner_px), "{corner_px}");
        let mut base = *truth().base();
        base.sigma.position_m = touchline_core::geometry::Vec3::repeat(0.2);
        let unsure = snapped(&PtzCamera::new(base, truth().ptz()), &[]).unwrap();
        assert!(unsure.uncertainty.worst_corner_sigma_px(&truth(), SIZE) > 2.0 * corner_px);
    }

    #[test]
    fn clicks_that_are_a_little_off_do_not_hold_the_camera_back_and_far_ones_are_named() {
        let clicks = [
            click("centre_mark", Vec2::new(2.0, 1.0)),
            click("halfway_far", Vec2::new(-1.5, 2.0)),
        ];
        let found = snapped(&camera(4.1, -14.05, 1504.0), &clicks).unwrap();
        assert!(overlays_apart_px(&truth(), found.ptz, SIZE) < 1.0);
        let wrong = [Observation {
            click: 3,
            ..click("centre_mark", Vec2::new(40.0, 0.0))
        }];
        let refused = snapped(&truth(), &wrong).unwrap_err();
        assert!(
            matches!(refused, SnapError::AgainstClicks { click: 3, sigmas } if sigmas > 6.0),
            "{refused:?}"
        );
    }

    #[test]
    fn where_there_is_no_paint_the_reason_is_named() {
        let away = snapped(&camera(180.0, -14.0, 1500.0), &[]).unwrap_err();
        assert!(
            matches!(away, SnapError::TooFewSamples { found: 0, .. }),
            "{away:?}"
        );
        // 150 px off another line may be within reach; it is refused whatever it is.
        let elsewhere = snapped(&camera(9.8, -14.0, 1500.0), &[]);
        assert!(elsewhere.is_err(), "{elsewhere:?}");
    }

    #[test]
    fn a_camera_that_diverges_is_undetermined_and_not_without_paint() {
        let (truth, field) = (truth(), soccer());
        let ground = GroundPicture::new(&PICTURE, &[]);
        let options = SnapOptions::default();
        let problem = Problem {
            ground: &ground,
            field: &field,
            base: truth.base(),
            clicks: &[],
            scale: 1.0,
            options: &options,
        };
        let refused = problem.refine(Ptz::from_degrees(f64::NAN, -14.0, 1500.0));
        let undetermined = SnapError::Undetermined {
            sigma_px: f64::INFINITY,
        };
        assert_eq!(refused.err(), Some(undetermined));
    }
}
